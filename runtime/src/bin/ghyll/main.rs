//! `ghyll`, the command line: arguments, then one call. Values go to standard output, everything else to
//! standard error. Exit status: 0 success, 1 the program or an input file is wrong, 2 wrong usage, 3 the run failed.

/// As in the standard library, but for a standard error that takes nothing: that is no reason to panic. Declared before the
/// modules, they hold in all of them.
macro_rules! eprint {
    ($($text:tt)*) => {
        $crate::report::complain(format_args!($($text)*))
    };
}
macro_rules! eprintln {
    ($($text:tt)*) => {
        $crate::report::complain(format_args!("{}\n", format_args!($($text)*)))
    };
}

mod arguments;
mod commands;
mod failure;
mod moving;
mod report;

use arguments::{Arguments, Command};
use clap::Parser;
use mimalloc::MiMalloc;
use std::process::ExitCode;

/// Compiling allocates much and little at a time.
#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

fn main() -> ExitCode {
    quiet_without_a_display();
    let given = arguments::prepared(std::env::args_os());
    let arguments = Arguments::try_parse_from(given).unwrap_or_else(|error| arguments::told(error).exit());
    let outcome = match &arguments.command {
        Command::Run(a) => commands::run::run(a),
        Command::Render(a) => commands::render::render(a),
        Command::Map(a) => commands::map::map(a),
        Command::Check(a) => commands::check::check(a),
        Command::Build(a) => commands::build::build(a),
        Command::Explain(a) => commands::explain::explain(a),
        Command::Fmt(a) => commands::fmt::fmt(a),
        Command::Repl(a) => commands::repl::repl(a),
        Command::View(a) => commands::view::view(a),
        Command::Lsp(_) => commands::lsp::lsp(),
        Command::Trace(a) => commands::trace::trace(a),
        Command::Info(a) => commands::info::info(a),
        Command::Bench(a) => commands::bench::bench(a),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.tell(),
    }
}

/// Mesa's layer for choosing a device asks the Wayland display, and complains on standard error where there is no session.
/// Ghyll opens no window and ranks the adapters itself, so without a session the layer is left out.
fn quiet_without_a_display() {
    if cfg!(target_os = "linux") && std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        // SAFETY: this is the first statement of the process; no other thread can read the environment meanwhile.
        #[allow(unsafe_code)]
        unsafe {
            std::env::set_var("NODEVICE_SELECT", "1");
        }
    }
}
