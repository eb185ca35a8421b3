//! The machine and its limits, from arguments.

use crate::arguments::{self, On};
use crate::failure::Failure;
use ghyll_runtime::config::{Config, Rewriter};
use ghyll_runtime::gpu::GpuOptions;
use ghyll_runtime::machine::{Machine, Wanted};

pub fn open(arguments: &arguments::Machine) -> Result<(Machine, Config), Failure> {
    let wanted = match arguments.on {
        On::Auto => Wanted::Auto,
        On::Gpu => Wanted::Gpu,
        On::Cpu => Wanted::Cpu,
        On::Oracle => Wanted::Oracle,
    };
    let options = GpuOptions { adapter: arguments.adapter.clone(), validate_indirect: arguments.checked };
    let machine = Machine::open(wanted, &options).map_err(|e| Failure::Usage(e.to_string()))?;
    let config = Config {
        rewriter: match arguments.rewriter {
            arguments::Rewriter::Auto => Rewriter::Auto,
            arguments::Rewriter::Block => Rewriter::Block,
            arguments::Rewriter::Lane => Rewriter::Lane,
        },
        depth: arguments.depth,
        block: arguments.block,
        threads: arguments.threads.map(|n| n as usize),
        max_memory: arguments.max_memory,
        max_rewrites: arguments.max_rewrites,
        timeout: arguments.timeout,
        trusted: !arguments.checked,
    };
    Ok((machine, config))
}
