//! `ghyll`, the command line: arguments, then one call. Values go to standard output, everything else to
//! standard error. Exit status: 0 success, 1 the program or an input file is wrong, 2 wrong usage, 3 the run failed.

mod arguments;
mod commands;
mod failure;
mod report;

use arguments::{Arguments, Command};
use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = Arguments::parse_from(arguments::prepared(std::env::args_os()));
    let outcome = match &arguments.command {
        Command::Run(a) => commands::run::run(a),
        Command::Render(a) => commands::render::render(a),
        Command::Check(a) => commands::check::check(a),
        Command::Build(a) => commands::build::build(a),
        Command::Trace(a) => commands::trace::trace(a),
        Command::Info(a) => commands::info::info(a),
        Command::Bench(a) => commands::bench::bench(a),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.tell(),
    }
}
