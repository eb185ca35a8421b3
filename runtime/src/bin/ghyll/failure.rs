//! Why a command failed: what is printed and with which status the process ends.

use ghyll_compiler::diagnostic::Report;
use ghyll_runtime::error::RunError;
use std::io::IsTerminal;
use std::process::ExitCode;

#[derive(Debug)]
pub enum Failure {
    /// The program has diagnostics; status 1.
    Diagnostics { report: Report, json: bool },
    /// An input file is wrong; status 1.
    Input(String),
    /// Wrong usage; status 2.
    Usage(String),
    /// A value on the command line is wrong; status 2.
    Value { report: Report, json: bool },
    /// The run failed; status 3.
    Run(String),
}

impl Failure {
    pub fn run(error: RunError) -> Failure {
        Failure::Run(error.to_string())
    }

    /// Prints the failure and says how the process ends.
    pub fn tell(self) -> ExitCode {
        match self {
            Failure::Diagnostics { report, json } => {
                show(&report, json);
                ExitCode::from(1)
            }
            Failure::Value { report, json } => {
                show(&report, json);
                ExitCode::from(2)
            }
            Failure::Input(message) => say(&message, 1),
            Failure::Usage(message) => say(&message, 2),
            Failure::Run(message) => say(&message, 3),
        }
    }
}

/// Prints diagnostics: for people to standard error, as JSON to standard output.
pub fn show(report: &Report, json: bool) {
    if json {
        crate::report::line!("{}", ghyll_compiler::report::to_json(report));
    } else if !report.diagnostics.is_empty() {
        eprint!("{}", ghyll_compiler::report::render(report, std::io::stderr().is_terminal()));
    }
}

fn say(message: &str, status: u8) -> ExitCode {
    eprintln!("ghyll: {message}");
    ExitCode::from(status)
}
