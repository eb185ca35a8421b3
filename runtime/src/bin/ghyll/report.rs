//! What is said beside the value: statistics and progress.

use crate::arguments;
use ghyll_runtime::config::Stats;
use ghyll_runtime::machine::Machine;
use ghyll_runtime::memory::size;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;
use std::io::Write;
use std::time::Duration;

/// A line of a value or report on standard output. A reader that has seen enough, such as `head`, is no failure.
macro_rules! line {
    ($($text:tt)*) => {
        $crate::report::write_line(format_args!($($text)*))
    };
}
pub(crate) use line;

pub fn write_line(text: std::fmt::Arguments) {
    let mut out = std::io::stdout().lock();
    if let Err(error) = writeln!(out, "{text}") {
        let quiet = error.kind() == std::io::ErrorKind::BrokenPipe;
        if !quiet {
            eprintln!("ghyll: cannot write to standard output: {error}");
        }
        std::process::exit(if quiet { 0 } else { 3 });
    }
}

/// Prints statistics to standard error if they were asked for.
pub fn stats(arguments: &arguments::Machine, machine: &Machine, stats: &Stats) {
    let seconds = |d: Duration| d.as_secs_f64();
    match arguments.stats.as_deref() {
        Some("json") => {
            let memory: serde_json::Map<_, _> =
                stats.memory.parts().into_iter().map(|(name, bytes)| (name.into(), bytes.into())).collect();
            let report = json!({
                "machine": machine.describe(),
                "seconds": seconds(stats.total),
                "compiling_seconds": seconds(stats.compiling),
                "rounds": stats.rounds,
                "rewrites": stats.rewrites,
                "tokens_moved": stats.tokens_moved,
                "dispatches": stats.dispatches,
                "submissions": stats.submissions,
                "suspended_lanes": stats.suspended,
                "memory_bytes": memory,
            });
            eprintln!("{report}");
        }
        Some(_) => {
            eprintln!("machine      {}", machine.describe());
            eprintln!("time         {:.3} s", seconds(stats.total));
            eprintln!("  compiling  {:.3} s", seconds(stats.compiling));
            eprintln!("rounds       {}", stats.rounds);
            eprintln!("rewrites     {}", stats.rewrites);
            eprintln!("tokens moved {}", stats.tokens_moved);
            eprintln!("submissions  {} with {} dispatches", stats.submissions, stats.dispatches);
            eprintln!("suspended    {} lanes", stats.suspended);
            eprintln!("memory       {}", size(stats.memory.total()));
            for (name, bytes) in stats.memory.parts() {
                eprintln!("  {name:10} {}", size(bytes));
            }
        }
        None => {}
    }
}

/// A sign of life on a terminal for work that takes over a second.
pub struct Progress(ProgressBar);

impl Progress {
    pub fn start(what: &'static str) -> Progress {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        let style = ProgressStyle::with_template("{spinner} {msg} {elapsed}")
            .unwrap_or_else(|_| ProgressStyle::default_spinner());
        bar.set_style(style);
        bar.set_message(what);
        let shown = bar.clone();
        std::thread::spawn(move || {
            std::thread::sleep(Duration::from_secs(1));
            if !shown.is_finished() {
                shown.set_draw_target(ProgressDrawTarget::stderr());
                shown.enable_steady_tick(Duration::from_millis(120));
            }
        });
        Progress(bar)
    }

    pub fn finish(self) {
        self.0.finish_and_clear();
    }
}
