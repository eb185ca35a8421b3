//! `ghyll bench calls`: rewrites per second of recursive programs, by block (depth 1: the paper's algorithm), lane and
//! auto on the GPU, and by the twin.

use super::{Spread, program};
use crate::arguments::Bench;
use crate::failure::Failure;
use ghyll_compiler::compile::{Compiled, EntryKind};
use ghyll_compiler::front::Checked;
use ghyll_runtime::config::{Config, Rewriter};
use ghyll_runtime::gpu::Gpu;
use ghyll_runtime::machine::{Job, gpu_stats};
use ghyll_runtime::value::Value as GhyllValue;
use serde_json::{Value, json};
use std::time::Instant;

const DEFINITIONS: &str = include_str!("../../../../../../benches/calls.json");
const PROGRAMS: &[(&str, &str)] = &[
    ("fib", include_str!("../../../../../../benches/calls/fib.ghyll")),
    ("tak", include_str!("../../../../../../benches/calls/tak.ghyll")),
    ("ackermann", include_str!("../../../../../../benches/calls/ackermann.ghyll")),
    ("queens", include_str!("../../../../../../benches/calls/queens.ghyll")),
];

/// What a run's figures are called: backend, rewriter, configuration.
const VARIANTS: &[(&str, &str, Rewriter)] = &[
    ("gpu", "auto", Rewriter::Auto),
    ("gpu", "lane", Rewriter::Lane),
    ("gpu", "block", Rewriter::Block),
    ("cpu", "auto", Rewriter::Auto),
];

/// One definition: arguments, the value they must give, calls in the source's sense.
struct Definition {
    args: Vec<String>,
    value: String,
    calls: u64,
}

impl Definition {
    fn read(from: &Value) -> Option<Definition> {
        let args =
            from["args"].as_array()?.iter().map(|a| Some(a.as_str()?.to_string())).collect::<Option<_>>()?;
        Some(Definition { args, value: from["value"].as_str()?.to_string(), calls: from["calls"].as_u64()? })
    }
}

pub fn rows(arguments: &Bench, gpu: Option<&Gpu>) -> Result<Vec<Value>, Failure> {
    let fault = || Failure::Run("benches/calls.json is damaged".into());
    let definitions: Value = serde_json::from_str(DEFINITIONS).map_err(|_| fault())?;
    let mut rows = Vec::new();
    for entry in definitions.as_array().ok_or_else(fault)? {
        let name = entry["name"].as_str().ok_or_else(fault)?;
        let (_, text) = PROGRAMS.iter().find(|(known, _)| *known == name).ok_or_else(fault)?;
        let (checked, compiled) = program(name, text, EntryKind::Value)?;
        let wide = Definition::read(entry).ok_or_else(fault)?;
        let narrow = Definition::read(&entry["narrow"]);
        for (backend, rewriter, strategy) in VARIANTS {
            let definition = match (strategy, &narrow) {
                (Rewriter::Block, Some(narrow)) => narrow,
                _ => &wide,
            };
            let bench = Variant { checked: &checked, compiled: &compiled, definition, strategy: *strategy };
            let measured = match (*backend, gpu) {
                ("gpu", Some(gpu)) => bench.on_gpu(gpu, arguments.repeat)?,
                ("gpu", None) => continue,
                _ => bench.on_cpu(arguments.repeat)?,
            };
            let seconds = measured.0.median;
            rows.push(json!({
                "name": name,
                "args": definition.args.join(" "),
                "backend": backend,
                "rewriter": rewriter,
                "calls": definition.calls,
                "rewrites": measured.1,
                "seconds_median": seconds,
                "seconds_min": measured.0.least,
                "seconds_max": measured.0.greatest,
                "rewrites_per_s": (measured.1 as f64 / seconds).round(),
                "calls_per_s": (definition.calls as f64 / seconds).round(),
            }));
        }
    }
    Ok(rows)
}

struct Variant<'a> {
    checked: &'a Checked,
    compiled: &'a Compiled,
    definition: &'a Definition,
    strategy: Rewriter,
}

impl Variant<'_> {
    fn job(&self) -> Job<'_> {
        Job { checked: self.checked, compiled: self.compiled, scene: None }
    }

    fn args(&self) -> Result<Vec<GhyllValue>, Failure> {
        crate::commands::run::arguments(self.checked, self.compiled, &self.definition.args, false)
    }

    /// The paper's algorithm where blocks are measured, else what the rewriter chooses.
    fn config(&self) -> Config {
        let depth = (self.strategy == Rewriter::Block).then_some(1);
        Config { rewriter: self.strategy, depth, ..Config::default() }
    }

    fn check(&self, value: &GhyllValue) -> Result<(), Failure> {
        let (got, wanted) = (value.to_string(), &self.definition.value);
        if got == *wanted {
            return Ok(());
        }
        Err(Failure::Run(format!("a benchmark gave {got} instead of {wanted}: its times mean nothing")))
    }

    /// One warm-up, then `repeat` runs with the kernels kept.
    fn on_gpu(&self, gpu: &Gpu, repeat: u32) -> Result<(Spread, u64), Failure> {
        let job = self.job();
        let stream = job.stream(&self.args()?).map_err(Failure::run)?;
        let mut engine = job.engine(gpu, &self.config(), 0).map_err(Failure::run)?;
        let mut times = Vec::new();
        let mut rewrites = 0;
        for round in 0..=repeat {
            let started = Instant::now();
            let outcome = engine.run(&stream).map_err(Failure::run)?;
            let seconds = started.elapsed().as_secs_f64();
            let module = &self.checked.module;
            let value = GhyllValue::unflatten(&outcome.words, &self.compiled.result, module);
            self.check(&value.map_err(Failure::run)?)?;
            if round > 0 {
                times.push(seconds);
                rewrites = gpu_stats(&outcome.stats).rewrites;
            }
        }
        Ok((Spread::of(times), rewrites))
    }

    fn on_cpu(&self, repeat: u32) -> Result<(Spread, u64), Failure> {
        let job = self.job();
        let args = self.args()?;
        let machine = ghyll_runtime::machine::Machine::Cpu;
        let mut times = Vec::new();
        let mut rewrites = 0;
        for round in 0..=repeat {
            let (value, stats) = job.run(&machine, &args, &self.config()).map_err(Failure::run)?;
            self.check(&value)?;
            if round > 0 {
                times.push(stats.total.as_secs_f64());
                rewrites = stats.rewrites;
            }
        }
        Ok((Spread::of(times), rewrites))
    }
}
