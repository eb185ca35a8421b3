//! `ghyll bench calls`: rewrites per second of recursive programs, by block (depth 1: the paper's algorithm), lane and
//! auto on the GPU, and by the twin. The variants of a program run in turn, so that what else the machine does falls
//! on all of them.

use super::{Spread, program};
use crate::arguments::Bench;
use crate::failure::Failure;
use ghyll_compiler::compile::{Compiled, EntryKind};
use ghyll_compiler::front::Checked;
use ghyll_runtime::config::{Config, Rewriter};
use ghyll_runtime::gpu::{Engine, Gpu};
use ghyll_runtime::machine::{Job, Machine};
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

/// What is measured.
struct Variant {
    backend: &'static str,
    name: &'static str,
    rewriter: Rewriter,
    depth: Option<u32>,
    trusted: bool,
}

const fn variant(backend: &'static str, name: &'static str, rewriter: Rewriter) -> Variant {
    Variant { backend, name, rewriter, depth: None, trusted: true }
}

const VARIANTS: &[Variant] = &[
    variant("gpu", "auto", Rewriter::Auto),
    Variant { trusted: false, ..variant("gpu", "auto, checked", Rewriter::Auto) },
    variant("gpu", "lane", Rewriter::Lane),
    Variant { depth: Some(1), ..variant("gpu", "block, depth 1", Rewriter::Block) },
    Variant { depth: Some(8), ..variant("gpu", "block, depth 8", Rewriter::Block) },
    variant("cpu", "auto", Rewriter::Auto),
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
        let mut subjects = Vec::new();
        for variant in VARIANTS.iter().filter(|v| v.backend != "gpu" || gpu.is_some()) {
            let definition = match (variant.rewriter, &narrow) {
                (Rewriter::Block, Some(narrow)) => narrow,
                _ => &wide,
            };
            subjects.push(Subject::new(&checked, &compiled, gpu, variant, definition)?);
        }
        // The first turn warms up.
        for turn in 0..=arguments.repeat {
            for subject in &mut subjects {
                subject.run(turn > 0)?;
            }
        }
        rows.extend(subjects.into_iter().map(|subject| subject.row(name)));
    }
    Ok(rows)
}

/// A program in one variant, with its kernels.
struct Subject<'a> {
    job: Job<'a>,
    variant: &'a Variant,
    definition: &'a Definition,
    args: Vec<GhyllValue>,
    config: Config,
    engine: Option<(Engine, Vec<(u32, bool)>)>,
    seconds: Vec<f64>,
    rewrites: u64,
}

impl<'a> Subject<'a> {
    fn new(
        checked: &'a Checked,
        compiled: &'a Compiled,
        gpu: Option<&Gpu>,
        variant: &'a Variant,
        definition: &'a Definition,
    ) -> Result<Self, Failure> {
        let job = Job { checked, compiled, scene: None };
        let Variant { rewriter, depth, trusted, .. } = *variant;
        let config = Config { rewriter, depth, trusted, ..Config::default() };
        let args = crate::commands::run::arguments(checked, compiled, &definition.args, false)?;
        let engine = match gpu.filter(|_| variant.backend == "gpu") {
            None => None,
            Some(gpu) => {
                let engine = job.engine(gpu, &config, 0).map_err(Failure::run)?;
                Some((engine, job.stream(&args).map_err(Failure::run)?))
            }
        };
        Ok(Subject { job, variant, definition, args, config, engine, seconds: Vec::new(), rewrites: 0 })
    }

    fn run(&mut self, measured: bool) -> Result<(), Failure> {
        let started = Instant::now();
        let (value, rewrites) = match &mut self.engine {
            Some((engine, stream)) => {
                let outcome = engine.run(stream).map_err(Failure::run)?;
                let compiled = self.job.compiled;
                let value = GhyllValue::unflatten(&outcome.words, &compiled.result, &self.job.checked.module);
                (value.map_err(Failure::run)?, outcome.stats.rewrites)
            }
            None => {
                let (value, stats) =
                    self.job.run(&Machine::Cpu, &self.args, &self.config).map_err(Failure::run)?;
                (value, stats.rewrites)
            }
        };
        let seconds = started.elapsed().as_secs_f64();
        let (got, wanted) = (value.to_string(), &self.definition.value);
        if got != *wanted {
            return Err(Failure::Run(format!(
                "a benchmark gave {got} instead of {wanted}: its times mean nothing"
            )));
        }
        if measured {
            self.seconds.push(seconds);
            self.rewrites = rewrites;
        }
        Ok(())
    }

    fn row(self, name: &str) -> Value {
        let spread = Spread::of(self.seconds);
        json!({
            "name": name,
            "args": self.definition.args.join(" "),
            "backend": self.variant.backend,
            "rewriter": self.variant.name,
            "calls": self.definition.calls,
            "rewrites": self.rewrites,
            "seconds_median": spread.median,
            "seconds_min": spread.least,
            "seconds_max": spread.greatest,
            "rewrites_per_s": (self.rewrites as f64 / spread.median).round(),
            "calls_per_s": (self.definition.calls as f64 / spread.median).round(),
        })
    }
}
