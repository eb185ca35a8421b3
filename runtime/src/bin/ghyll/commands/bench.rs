//! `ghyll bench`: measurements that check their answers. What is compared runs interleaved, medians are reported.

mod accuracy;
mod calls;
mod charts;
mod errors;
mod folder;
mod kernel;
mod network;
mod numerics;
mod overhead;
mod reference;
mod scaling;
mod sites;
mod stability;
mod table1;

use crate::arguments::{Bench, On};
use crate::failure::Failure;
use ghyll_compiler::compile::{self, Compiled, EntryKind, Options};
use ghyll_compiler::front::Checked;
use ghyll_compiler::source::Source;
use ghyll_runtime::gpu::{Gpu, GpuError, GpuOptions};
use ghyll_runtime::machine::Machine;
use serde_json::{Value, json};

type Benchmark = fn(&Bench, Option<&Gpu>) -> Result<Vec<Value>, Failure>;

/// All benchmarks by name.
const BENCHMARKS: &[(&str, Benchmark)] = &[
    ("overhead", overhead::rows),
    ("calls", calls::rows),
    ("table1", table1::rows),
    ("scaling", scaling::rows),
    ("stability", stability::rows),
    ("accuracy", accuracy::rows),
    ("numerics", numerics::rows),
];

pub fn bench(arguments: &Bench) -> Result<(), Failure> {
    let options = GpuOptions { adapter: arguments.adapter.clone(), ..GpuOptions::default() };
    let gpu = match Gpu::new(&options) {
        Ok(gpu) => Some(gpu),
        Err(GpuError::NoAdapter) => None,
        Err(error) => return Err(Failure::Usage(error.to_string())),
    };
    let adapter = gpu.as_ref().map_or("none", |gpu| &gpu.info().name);
    let wanted = |name: &str| arguments.name.as_deref().is_none_or(|one| one == name);
    let chosen = || BENCHMARKS.iter().filter(|(name, _)| wanted(name));
    if let Some(path) = &arguments.output {
        folder::Folder::create(path)?;
        chosen().try_for_each(|(name, _)| super::writable_file(&path.join(format!("{name}.json"))))?;
    }
    let mut broken = 0;
    for (name, rows) in chosen() {
        let rows = rows(arguments, gpu.as_ref())?;
        broken += stability::broken(&rows);
        let date = humantime::format_rfc3339_seconds(std::time::SystemTime::now()).to_string();
        let report =
            json!({ "bench": name, "machine": machine(), "adapter": adapter, "date": date, "rows": rows });
        if let Some(path) = &arguments.output {
            folder::Folder::create(path)?.save(&format!("{name}.json"), report.to_string())?;
        }
        if arguments.json {
            crate::report::line!("{report}");
        } else {
            crate::report::line!("{name} on {adapter}, {}", machine());
            table(&rows);
        }
    }
    match broken {
        0 => Ok(()),
        n => Err(Failure::Run(format!("{n} figures are beyond their bounds: the rows that say so"))),
    }
}

/// Processor and threads.
fn machine() -> String {
    let about = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = about.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    let name = model.map_or(std::env::consts::ARCH, |(_, name)| name.trim());
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    format!("{name}, {threads} threads")
}

/// The machines that a benchmark of pictures runs on.
fn machines(on: On, gpu: Option<&Gpu>) -> Result<Vec<(Machine, &'static str)>, Failure> {
    let device = |gpu: &Gpu| vec![(Machine::Gpu(Box::new(gpu.clone())), "gpu")];
    match (on, gpu) {
        (On::Oracle, _) => Err(Failure::Usage("the oracle is the judge; use --on cpu, gpu or auto".into())),
        (On::Gpu, None) => Err(Failure::Usage("there is no GPU adapter; use --on cpu".into())),
        (On::Gpu | On::Auto, Some(gpu)) => Ok(device(gpu)),
        _ => Ok(vec![(Machine::Cpu, "cpu")]),
    }
}

/// Rows as aligned columns, a line for each; rows of other figures begin another table.
fn table(rows: &[Value]) {
    let keys = |row: &Value| row.as_object().map(|row| row.keys().cloned().collect::<Vec<_>>());
    rows.chunk_by(|a, b| keys(a) == keys(b)).for_each(columns);
}

fn columns(rows: &[Value]) {
    let Some(Value::Object(first)) = rows.first() else { return };
    let keys: Vec<&String> = first.keys().collect();
    let cell = |row: &Value, key: &str| match &row[key] {
        Value::String(text) => text.clone(),
        Value::Number(n) if n.is_f64() => match n.as_f64().unwrap_or_default() {
            x if x != 0.0 && x.abs() < 1e-2 => format!("{x:.2e}"),
            x => format!("{x:.4}"),
        },
        Value::Null => "-".into(),
        other => other.to_string(),
    };
    let width = |key: &String| {
        rows.iter().map(|row| cell(row, key).len()).chain([key.len()]).max().unwrap_or_default()
    };
    let widths: Vec<usize> = keys.iter().map(|key| width(key)).collect();
    let line = |cells: Vec<String>| {
        let padded: Vec<String> = cells.iter().zip(&widths).map(|(c, w)| format!("{c:>w$}")).collect();
        crate::report::line!("{}", padded.join("  "));
    };
    line(keys.iter().map(|k| k.to_string()).collect());
    for row in rows {
        line(keys.iter().map(|k| cell(row, k)).collect());
    }
}

/// A benchmark's program, which is known to compile.
fn program(name: &str, text: &str, want: EntryKind) -> Result<(Checked, Compiled), Failure> {
    program_with(name, text, &Options { want: Some(want), ..Options::default() })
}

fn program_with(name: &str, text: &str, options: &Options) -> Result<(Checked, Compiled), Failure> {
    let fault = || Failure::Run(format!("benchmark program {name} does not compile"));
    let checked = compile::check(Source::new(name, text)).map_err(|_| fault())?;
    let compiled = compile::compile(&checked, options).map_err(|_| fault())?;
    Ok((checked, compiled))
}

/// Middle of the sorted values; least and greatest beside it.
struct Spread {
    median: f64,
    least: f64,
    greatest: f64,
}

impl Spread {
    fn of(mut values: Vec<f64>) -> Spread {
        values.sort_by(f64::total_cmp);
        let n = values.len();
        let median = (values[(n - 1) / 2] + values[n / 2]) / 2.0;
        Spread { median, least: values[0], greatest: values[n - 1] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_median_is_in_the_middle() {
        let spread = Spread::of(vec![3.0, 1.0, 10.0, 2.0]);
        assert_eq!((spread.least, spread.median, spread.greatest), (1.0, 2.5, 10.0));
    }
}
