//! `ghyll check`: diagnostics only, or what one means.

use super::{options, read, refused};
use crate::arguments::Check;
use crate::failure::{self, Failure};
use crate::report::line;
use ghyll_compiler::diagnostic::Report;
use ghyll_compiler::{compile, explain};
use ghyll_runtime::files::Disk;
use serde_json::json;

pub fn check(arguments: &Check) -> Result<(), Failure> {
    let json = arguments.program.json;
    if let Some(code) = &arguments.explain {
        line!("{}", explanation(code, json)?);
        return Ok(());
    }
    let Some(file) = &arguments.file else {
        return Err(Failure::Usage("name a program, or a code with --explain".into()));
    };
    let checked =
        compile::check_with(read(file)?, &Disk).map_err(|report| Failure::Diagnostics { report, json })?;
    let options = options(&arguments.program, None)?;
    let reached = compile::reach(&checked, &options).map_err(|error| refused(error, json))?;
    let diagnostics = [checked.warnings.clone(), reached].concat();
    let report = Report { sources: checked.sources, diagnostics };
    if report.has_errors() {
        return Err(Failure::Diagnostics { report, json });
    }
    failure::show(&report, json);
    if !json {
        eprintln!("{}: no errors", file.display());
    }
    Ok(())
}

/// The page of a code, or why there is none.
fn explanation(code: &str, json: bool) -> Result<String, Failure> {
    let code = code.trim();
    let page = explain::page(code).map_err(|meant| {
        let hint = match meant {
            Some(meant) => format!("did you mean {meant}?"),
            None => "codes look like E0301 and stand in the first line of each message".to_owned(),
        };
        Failure::Usage(format!("there is no diagnostic `{}`; {hint}", code.escape_debug()))
    })?;
    Ok(match json {
        true => json!({ "code": code.to_ascii_uppercase(), "page": page }).to_string(),
        false => page.trim_end().to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_explained() {
        let page = explanation("e0106", false).ok().unwrap();
        assert!(page.starts_with("# E0106") && page.contains("0.0 < x < 1.0"), "{page}");
        assert!(explanation("E0106", true).ok().unwrap().starts_with("{\"code\":\"E0106\""));
        match explanation("E106", false) {
            Err(Failure::Usage(message)) => assert!(message.contains("did you mean E0106?"), "{message}"),
            _ => panic!("E106 is no code"),
        }
    }
}
