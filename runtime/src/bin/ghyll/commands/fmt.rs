//! `ghyll fmt`: programs in the usual layout.

use super::read;
use crate::arguments::Fmt;
use crate::failure::Failure;
use crate::report::{line, write_bytes};
use ghyll_compiler::diagnostic::{Diagnostic, Report};
use ghyll_compiler::format::format;
use ghyll_compiler::source::{Source, SourceId, Sources};
use serde_json::json;
use std::path::Path;

pub fn fmt(arguments: &Fmt) -> Result<(), Failure> {
    let from_input = arguments.files.iter().any(|file| file.as_os_str() == "-");
    if from_input && arguments.files.len() > 1 {
        return Err(Failure::Usage("`-` is standard input and stands alone".into()));
    }
    let mut outcomes = Vec::new();
    let mut refused = None;
    for file in &arguments.files {
        // The other files are formatted all the same.
        match one(file, arguments) {
            Ok(changed) => outcomes.push((file, changed)),
            Err(Failure::Diagnostics { report, json }) => {
                if let Some(failure) = refused.replace(Failure::Diagnostics { report, json }) {
                    failure.tell();
                }
            }
            Err(other) => return Err(other),
        }
    }
    if arguments.json && refused.is_none() {
        let files: Vec<_> = outcomes
            .iter()
            .map(|(file, changed)| json!({ "file": file.display().to_string(), "changed": changed }))
            .collect();
        line!("{}", json!({ "files": files }));
    }
    if let Some(failure) = refused {
        return Err(failure);
    }
    let other = outcomes.iter().filter(|(_, changed)| *changed).count();
    if arguments.check && other > 0 {
        let mend = "run `ghyll fmt` without --check to format";
        return Err(Failure::Input(match other {
            1 => format!("one file is not formatted; {mend} it"),
            n => format!("{n} files are not formatted; {mend} them"),
        }));
    }
    Ok(())
}

/// Formats one file, or standard input to standard output; says whether that changed anything.
fn one(file: &Path, arguments: &Fmt) -> Result<bool, Failure> {
    let input = file.as_os_str() == "-";
    let source = read(file)?;
    let formatted = format(SourceId(0), &source.text).map_err(|diagnostics| Failure::Diagnostics {
        report: report(&source, diagnostics),
        json: arguments.json,
    })?;
    // Line ends and the byte order mark are seen in the bytes only.
    let before =
        if input { source.text.clone().into_bytes() } else { std::fs::read(file).unwrap_or_default() };
    let changed = before != formatted.as_bytes();
    let shown = if input { "standard input".into() } else { file.display().to_string() };
    if arguments.check {
        if changed {
            eprintln!("{shown}: not formatted");
        }
    } else if input {
        if !arguments.json {
            write_bytes(formatted.as_bytes());
        }
    } else if changed {
        std::fs::write(file, &formatted).map_err(|e| Failure::Input(format!("cannot write {shown}: {e}")))?;
        eprintln!("{shown}: formatted");
    }
    Ok(changed)
}

fn report(source: &Source, diagnostics: Vec<Diagnostic>) -> Report {
    Report { sources: Sources::of(source.clone()), diagnostics }
}
