//! What is said beside the value: statistics and progress.

use crate::arguments;
use ghyll_runtime::config::Stats;
use ghyll_runtime::machine::Machine;
use ghyll_runtime::memory::size;
use ghyll_runtime::progress::{Progress, Step};
use indicatif::{HumanCount, ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::{Value, json};
use std::io::Write;
use std::path::PathBuf;
use std::time::Duration;

/// A line of a value or report on standard output. A reader that has seen enough, such as `head`, is no failure.
macro_rules! line {
    ($($text:tt)*) => {
        $crate::report::write_line(format_args!($($text)*))
    };
}
pub(crate) use line;

pub fn write_line(text: std::fmt::Arguments) {
    written(writeln!(std::io::stdout().lock(), "{text}"));
}

/// Bytes on standard output.
pub fn write_bytes(bytes: &[u8]) {
    let mut out = std::io::stdout().lock();
    written(out.write_all(bytes).and_then(|()| out.flush()));
}

/// Text on standard error, as far as it takes any.
pub fn complain(text: std::fmt::Arguments) {
    // There is no better place to say that it takes none.
    let _ = std::io::stderr().lock().write_fmt(text);
}

fn written(outcome: std::io::Result<()>) {
    if let Err(error) = outcome {
        let quiet = error.kind() == std::io::ErrorKind::BrokenPipe;
        if !quiet {
            eprintln!("ghyll: cannot write to standard output: {error}");
        }
        std::process::exit(if quiet { 0 } else { 3 });
    }
}

/// What `--json` prints of pictures that were written, with what the tuner chose and expects.
pub fn wrote(
    files: &[PathBuf],
    (width, height): (u32, u32),
    seconds: f64,
    machine: &Machine,
    tuned: Option<Value>,
) {
    let files: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
    let mut report = json!({
        "files": files, "width": width, "height": height, "seconds": seconds, "machine": machine.describe(),
    });
    if let Some(tuned) = tuned {
        report["tuned"] = tuned;
    }
    line!("{report}");
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
                "baking_seconds": seconds(stats.baking),
                "rounds": (!stats.direct).then_some(stats.rounds),
                "rewrites": (!stats.direct).then_some(stats.rewrites),
                "stage_seconds": stats.stages().map(|stages| {
                    stages.map(|(name, time)| (name.to_owned(), seconds(time).into()))
                        .into_iter().collect::<serde_json::Map<_, _>>()
                }),
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
            if stats.memory.bakes > 0 {
                eprintln!("  baking     {:.3} s, before the rest", seconds(stats.baking));
            }
            for (name, time) in stats.stages().into_iter().flatten() {
                eprintln!("  {name:10} {:.3} s", seconds(time));
            }
            let counted = |count: u64| match stats.direct {
                true => "none: one invocation a pixel, no stream".into(),
                false => count.to_string(),
            };
            eprintln!("rounds       {}", counted(stats.rounds));
            eprintln!("rewrites     {}", counted(stats.rewrites));
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

/// A bar, or a sign of life where the end is not known, on a terminal and for work that takes over a second.
pub struct Bar(ProgressBar);

const PIXELS: &str = "{msg} {bar:32} {percent}% of {len} pixels, {eta} left";
const REWRITES: &str = "{spinner} {msg} {elapsed}";

impl Bar {
    pub fn start(what: &'static str) -> Bar {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        bar.set_style(style(REWRITES));
        bar.set_message(what);
        let shown = bar.clone();
        std::thread::spawn(move || {
            std::thread::sleep(Duration::from_secs(1));
            if !shown.is_finished() {
                // Nothing is drawn where this is no terminal.
                shown.set_draw_target(ProgressDrawTarget::stderr());
                shown.enable_steady_tick(Duration::from_millis(120));
            }
        });
        Bar(bar)
    }

    /// Moves the bar.
    pub fn listener(&self) -> Progress {
        let bar = self.0.clone();
        let what = bar.message();
        Progress::new(move |step| show(&bar, &what, step))
    }

    pub fn finish(self) {
        self.0.finish_and_clear();
    }
}

fn show(bar: &ProgressBar, what: &str, step: Step) {
    match step {
        Step::Pixels { done, total } => {
            if bar.length().is_none() {
                bar.set_style(style(PIXELS));
                bar.set_length(total);
            }
            bar.set_position(done);
        }
        Step::Rewrites(rewrites) => {
            bar.set_message(format!("{what}, {} rewrites", HumanCount(rewrites)));
        }
    }
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_spinner())
}

#[cfg(test)]
mod tests {
    use super::*;
    use indicatif::InMemoryTerm;

    fn drawn(steps: &[Step]) -> String {
        let terminal = InMemoryTerm::new(4, 100);
        let bar =
            ProgressBar::with_draw_target(None, ProgressDrawTarget::term_like(Box::new(terminal.clone())));
        bar.set_style(style(REWRITES));
        steps.iter().for_each(|step| show(&bar, "working", *step));
        bar.force_draw();
        terminal.contents()
    }

    #[test]
    fn pixels_make_a_bar_and_rewrites_a_count() {
        let half = drawn(&[Step::Pixels { done: 500, total: 1000 }]);
        assert!(half.contains("50% of 1000 pixels") && half.contains("█"), "{half}");
        let none = drawn(&[Step::Pixels { done: 0, total: 1000 }]);
        assert!(none.contains("0% of 1000 pixels") && !none.contains("█"), "{none}");
        let count = drawn(&[Step::Rewrites(1_234_567)]);
        assert!(count.contains("working, 1,234,567 rewrites"), "{count}");
    }
}
