//! The machine and its limits, from arguments.

use crate::arguments::{self, On};
use crate::failure::Failure;
use ghyll_runtime::config::{Config, Rewriter};
use ghyll_runtime::gpu::GpuOptions;
use ghyll_runtime::machine::{Job, Machine, StandIn, Wanted};
use ghyll_runtime::progress::Progress;

fn wanted(arguments: &arguments::Machine) -> Wanted {
    match arguments.on {
        On::Auto => Wanted::Auto,
        On::Gpu => Wanted::Gpu,
        On::Cpu => Wanted::Cpu,
        On::Oracle => Wanted::Oracle,
    }
}

/// Why the program runs on this machine.
pub fn reason(arguments: &arguments::Machine, machine: &Machine) -> &'static str {
    machine.reason(wanted(arguments))
}

pub fn open(arguments: &arguments::Machine) -> Result<(Machine, Config), Failure> {
    let wanted = wanted(arguments);
    let options = GpuOptions { adapter: arguments.adapter.clone(), validate_indirect: arguments.checked };
    let machine = Machine::open(wanted, &options).map_err(|e| Failure::Usage(e.to_string()))?;
    note_ignored(arguments, &machine);
    let config = Config {
        rewriter: match arguments.rewriter {
            arguments::Rewriter::Auto => Rewriter::Auto,
            arguments::Rewriter::Block => Rewriter::Block,
            arguments::Rewriter::Lane => Rewriter::Lane,
        },
        depth: arguments.depth,
        block: arguments.block.unwrap_or(Config::default().block),
        threads: arguments.threads.map(|n| n as usize),
        groups: arguments.groups,
        max_memory: arguments.max_memory.unwrap_or(Config::default().max_memory),
        max_rewrites: arguments.max_rewrites,
        timeout: arguments.timeout,
        trusted: !arguments.checked,
        progress: Progress::default(),
        ..Config::default()
    };
    Ok((machine, config))
}

/// The machine, or the one that takes its place for a program, which is said with the reason.
pub fn settled(machine: Machine, job: &Job) -> Result<Machine, Failure> {
    match machine.stand_in(job).map_err(Failure::run)? {
        Some(StandIn { machine: other, why }) => {
            eprintln!("the {} takes the place of the {}: {why}", other.describe(), machine.describe());
            Ok(other)
        }
        None => Ok(machine),
    }
}

/// Says which options mean nothing to the machine that was picked.
fn note_ignored(arguments: &arguments::Machine, machine: &Machine) {
    let off_gpu = [
        ("--adapter", arguments.adapter.is_some()),
        ("--checked", arguments.checked),
        ("--groups", arguments.groups.is_some()),
    ];
    let no_stream = [
        ("--rewriter", arguments.rewriter != arguments::Rewriter::Auto),
        ("--depth", arguments.depth.is_some()),
        ("--block", arguments.block.is_some()),
    ];
    let ignored: &[&[(&str, bool)]] = match machine {
        Machine::Gpu(_) => &[],
        Machine::Cpu => &[&off_gpu],
        Machine::Oracle(_) => &[&off_gpu, &no_stream],
    };
    for (option, _) in ignored.iter().copied().flatten().filter(|(_, given)| *given) {
        eprintln!("{option} has no effect here: the program runs on the {}", machine.describe());
    }
}
