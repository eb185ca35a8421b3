//! Operators for `ghyll render`, chosen by measurement.

use super::scene::{Asked, Look, Views};
use super::{refused, writable_file};
use crate::arguments::{On, Render};
use crate::failure::Failure;
use ghyll_compiler::compile::{self, Options};
use ghyll_compiler::front::Checked;
use ghyll_runtime::config::Config;
use ghyll_runtime::machine::Machine;
use ghyll_runtime::memory::size;
use ghyll_runtime::terrain::Terrain;
use ghyll_runtime::tuner::{
    self, FileError, Limits, Measured, Shortfall, Studio, Subject, TuningFile, file::measured_json,
};
use serde_json::Value;
use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;

/// What was chosen, and the field if it was read.
pub struct Tuned {
    pub measured: Measured,
    pub field: Option<Arc<Terrain>>,
}

impl Tuned {
    pub fn json(&self) -> Value {
        measured_json(&self.measured)
    }
}

/// Where figures are kept.
fn file(arguments: &Render) -> &Path {
    arguments.tuning.tuning.as_deref().unwrap_or(Path::new("ghyll.tuning.json"))
}

/// The limits that are given; none if nothing is to be chosen. A file that could not keep the figures is refused before they
/// are measured.
pub fn limits(arguments: &Render) -> Result<Option<Limits>, Failure> {
    let tuning = &arguments.tuning;
    if !(tuning.tune || tuning.frame_ms.is_some() || tuning.min_psnr.is_some()) {
        if let Some(file) = &tuning.tuning {
            eprintln!("--tuning {} has no effect without --frame-ms, --min-psnr or --tune", file.display());
        }
        return Ok(None);
    }
    writable_file(file(arguments))?;
    let (frame_ms, min_psnr, max_memory) = (tuning.frame_ms, tuning.min_psnr, arguments.machine.max_memory);
    Ok(Some(Limits { frame_ms, min_psnr, max_memory }))
}

/// The best choice within the limits, for the look of the first frame.
pub fn tune(
    checked: &Checked,
    options: &Options,
    arguments: &Render,
    look: Look,
    (machine, config): (&Machine, &Config),
    limits: Limits,
) -> Result<Tuned, Failure> {
    if limits.max_memory.is_some() && arguments.machine.on == On::Oracle {
        return Err(Failure::Usage("the oracle does not tell its memory; tune on another machine".into()));
    }
    let module = &checked.module;
    let plain = compile::compile(checked, options).map_err(|e| refused(e, arguments.program.json))?;
    let choices = tuner::choices(module, options, arguments.samples, !plain.bakes.is_empty());
    let mut field = None;
    let mut views = |compiled: &compile::Compiled| -> Result<Views, Failure> {
        let mut asked = Asked::new(checked, compiled, arguments.machine.on);
        asked.field = field.clone();
        let views = Views::open(&asked, arguments, vec![look])?;
        field = views.field().cloned();
        Ok(views)
    };
    let first = views(&plain)?;
    let subject = subject(checked, options, arguments, look, machine, &first);
    let size = first.size();
    drop(first);

    let path = file(arguments);
    let mut file = TuningFile::open(path).map_err(wrong)?;
    let known = file.find(&subject).map(<[Measured]>::to_vec);
    let all = match known {
        Some(all) => {
            let plural = if all.len() == 1 { "" } else { "s" };
            eprintln!("tuner: {} choice{plural} as measured before, of {}", all.len(), path.display());
            all
        }
        None => {
            let plural = if choices.len() == 1 { "" } else { "s" };
            eprintln!("tuner: measuring {} choice{plural}", choices.len());
            let mut open = |choice: &tuner::Choice| {
                let told = choice.apply(options);
                let compiled =
                    compile::compile(checked, &told).map_err(|e| refused(e, arguments.program.json))?;
                let scene = views(&compiled)?.only()?;
                Ok((compiled, scene))
            };
            let mut tell = |measured: &Measured| eprintln!("tuner: {}: {}", measured.choice, told(measured));
            let mut studio = Studio {
                checked,
                machine,
                config,
                size,
                open: &mut open,
                tell: &mut tell,
                failed: Failure::run,
            };
            let all = studio.measure(&choices)?;
            file.keep(subject, &all).map_err(wrong)?;
            all
        }
    };
    let measured = limits.pick(&all).map_err(|missed| Failure::Run(none(&missed)))?.clone();
    eprintln!("tuner: chose {}; expects {}", measured.choice, told(&measured));
    Ok(Tuned { measured, field })
}

fn wrong(error: FileError) -> Failure {
    match error {
        FileError::Write { .. } => Failure::Usage(error.to_string()),
        _ => Failure::Input(error.to_string()),
    }
}

/// Figures of a choice for people.
fn told(measured: &Measured) -> String {
    let mut text = format!("{:.1} ms a frame, ", measured.frame_ms);
    let _ = match measured.psnr {
        psnr if psnr.is_finite() => write!(text, "{psnr:.1} dB"),
        _ => write!(text, "the best picture"),
    };
    if measured.memory > 0 {
        let _ = write!(text, ", {}", size(measured.memory));
    }
    text
}

fn none(missed: &[Shortfall]) -> String {
    let alone = missed.iter().all(|shortfall| shortfall.alone);
    let told: Vec<String> = missed.iter().map(Shortfall::to_string).collect();
    match (told.len(), alone) {
        (0 | 1, _) => format!("no choice meets the limits: {}", told.concat()),
        (_, true) => {
            format!("no choice meets all limits; one of them is in the way: {}", told.join("; or: "))
        }
        (_, false) => format!("no choice meets any of the limits: {}", told.join("; and: ")),
    }
}

/// All that the figures depend on.
fn subject(
    checked: &Checked,
    options: &Options,
    arguments: &Render,
    look: Look,
    machine: &Machine,
    views: &Views,
) -> Subject {
    let name = arguments.file.as_ref().map_or("the built-in example".into(), |f| f.display().to_string());
    let (width, height) = views.size();
    let about = format!("{name}, {width}x{height}, {}", machine.describe());
    let mut details = format!("{}\n{about}\n{options:?}\n{look:?}\n", env!("CARGO_PKG_VERSION"));
    let m = &arguments.machine;
    let _ = writeln!(details, "{:?} {:?} {:?} {:?}", m.rewriter, m.depth, m.block, (m.threads, m.groups));
    let _ = writeln!(details, "{:?} {} {:?}", m.max_memory, m.checked, arguments.samples);
    let terrain = &arguments.terrain;
    let _ = writeln!(details, "{:?} {:?} {}", terrain.rasters, terrain.micro, terrain.exaggerate);
    let _ = writeln!(details, "{:?} {:?}", arguments.camera.sun_at, arguments.curvature);
    if let Some(field) = views.field() {
        let Terrain { width, height, spacing, min, max, voids, format, .. } = &**field;
        let _ = writeln!(details, "{:?} {width} {height} {spacing:?}", terrain.dem);
        let _ = writeln!(details, "{min} {max} {voids} {format}");
    }
    checked.sources.iter().for_each(|source| details.push_str(&source.text));
    Subject::new(about, &details)
}
