//! `ghyll check`: diagnostics only.

use super::read;
use crate::arguments::Check;
use crate::failure::{self, Failure};
use ghyll_compiler::compile;
use ghyll_compiler::diagnostic::Report;

pub fn check(arguments: &Check) -> Result<(), Failure> {
    let json = arguments.json;
    let checked =
        compile::check(read(&arguments.file)?).map_err(|report| Failure::Diagnostics { report, json })?;
    let diagnostics = [checked.warnings.clone(), compile::reach(&checked)].concat();
    let report = Report { sources: checked.sources, diagnostics };
    if report.has_errors() {
        return Err(Failure::Diagnostics { report, json });
    }
    failure::show(&report, json);
    if !json {
        eprintln!("{}: no errors", arguments.file.display());
    }
    Ok(())
}
