//! `ghyll bench scaling`: the paper's Figs. 10 and 11 done again: frame time against the number of workgroups that rewrite, and
//! what doubling it gains; also against invocations in a workgroup, and threads of the twin. Every picture must be the same.

mod report;

use super::folder::Folder;
use super::network::Form;
use super::reference::PATIENCE;
use super::{Spread, machines, sites};
use crate::arguments::{Bench, On};
use crate::failure::Failure;
use ghyll_runtime::config::{Config, Rewriter};
use ghyll_runtime::gpu::Gpu;
use ghyll_runtime::machine::{Job, Machine};
use ghyll_runtime::renderer::Renderer;
use ghyll_runtime::terrain::Scene;
use serde_json::{Value, json};
use std::time::Instant;

/// What is varied along a series.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Axis {
    /// Workgroups of as many invocations as the paper's.
    Workgroups,
    /// Invocations in each of so many workgroups.
    Invocations,
    /// Threads of the twin.
    Threads,
}

/// Invocations in a workgroup while workgroups are counted, as in the paper.
const INVOCATIONS: u32 = 16;
/// Workgroups while invocations are counted: those of the paper's best configuration.
const WORKGROUPS: u32 = 8;

impl Axis {
    fn name(self) -> &'static str {
        match self {
            Axis::Workgroups => "workgroups",
            Axis::Invocations => "invocations in a workgroup",
            Axis::Threads => "threads",
        }
    }

    fn counts(self) -> Vec<u32> {
        match self {
            Axis::Workgroups => vec![1, 2, 4, 8, 16, 32, 64],
            Axis::Invocations => vec![4, 8, 16, 32, 64],
            Axis::Threads => {
                let cores = std::thread::available_parallelism().map_or(1, |n| n.get() as u32);
                std::iter::successors(Some(1), |n| Some(n * 2)).take_while(|n| *n <= 2 * cores).collect()
            }
        }
    }

    fn config(self, count: u32, (_, rewriter, depth): Way) -> Config {
        let (groups, threads) = match self {
            Axis::Workgroups => (Some(count), INVOCATIONS),
            Axis::Invocations => (Some(WORKGROUPS), count),
            Axis::Threads => (None, count),
        };
        let threads = Some(threads as usize);
        Config { rewriter, depth, groups, threads, timeout: PATIENCE, ..Config::default() }
    }
}

type Way = (&'static str, Rewriter, Option<u32>);
/// The first is the paper's algorithm.
const WAYS: [Way; 2] = [("block", Rewriter::Block, Some(1)), ("lane", Rewriter::Lane, None)];

/// Frame times along an axis.
#[derive(Clone, Debug)]
struct Series {
    axis: Axis,
    geometry: &'static str,
    way: &'static str,
    backend: &'static str,
    /// Counts with median, least and greatest milliseconds.
    points: Vec<(u32, [f64; 3])>,
}

impl Series {
    fn name(&self) -> String {
        let Series { axis, geometry, way, backend, .. } = self;
        format!("{geometry}, {way}, {}, {backend}", axis.name())
    }

    /// How much faster the count is than the one before, which is half of it.
    fn gain(&self, at: usize) -> Option<f64> {
        let (_, before) = self.points.get(at.checked_sub(1)?)?;
        Some(before[0] / self.points[at].1[0])
    }

    fn rows(&self) -> Vec<Value> {
        let row = |(at, (count, ms)): (usize, &(u32, [f64; 3]))| {
            json!({
                "name": format!("{}: {count}", self.name()),
                "geometry": self.geometry,
                "rewriter": self.way,
                "backend": self.backend,
                "axis": self.axis.name(),
                "count": count,
                "ms_median": ms[0],
                "ms_min": ms[1],
                "ms_max": ms[2],
                "speedup_ratio": self.points[0].1[0] / ms[0],
                "doubling_ratio": self.gain(at),
            })
        };
        self.points.iter().enumerate().map(row).collect()
    }
}

pub fn rows(arguments: &Bench, gpu: Option<&Gpu>) -> Result<Vec<Value>, Failure> {
    let size = arguments.size.map_or((96, 96), |[width, height]| (width, height));
    let scene = sites::aconcagua()?.seen(&sites::VIEWS[0], size)?;
    let mut seats = machines(arguments.on, gpu)?;
    if arguments.on == On::Auto && gpu.is_some() {
        seats.push((Machine::Cpu, "cpu"));
    }
    let mut all = Vec::new();
    for (machine, backend) in &seats {
        let axes: &[Axis] = match machine {
            Machine::Gpu(_) => &[Axis::Workgroups, Axis::Invocations],
            _ => &[Axis::Threads],
        };
        for detail in [false, true] {
            let form = Form { detail, dynamic: true, exact: true, work: true };
            let series = axes.iter().flat_map(|axis| WAYS.map(|way| (*axis, way)));
            let wanted: Vec<(Series, Way)> = series
                .map(|(axis, way)| {
                    let (geometry, points) = (form.geometry(), Vec::new());
                    (Series { axis, geometry, way: way.0, backend, points }, way)
                })
                .filter(|(s, _)| arguments.only.as_deref().is_none_or(|part| s.name().contains(part)))
                .collect();
            if !wanted.is_empty() {
                eprintln!("ghyll: {} on {backend}", form.geometry());
                all.extend(measured(wanted, form, &scene, machine, arguments.repeat)?);
            }
        }
    }
    if all.is_empty() {
        let message = "--only fits no series; they are named GEOMETRY, REWRITER, AXIS, MACHINE, such as \
                       `basic, block, workgroups, gpu`";
        return Err(Failure::Usage(message.into()));
    }
    if let Some(path) = &arguments.output {
        report::write(&Folder::create(path)?, &all, size)?;
    }
    Ok(all.iter().flat_map(Series::rows).collect())
}

/// Fills the series; frames of all their points are taken in turn.
fn measured(
    wanted: Vec<(Series, Way)>,
    form: Form,
    scene: &Scene,
    machine: &Machine,
    repeat: u32,
) -> Result<Vec<Series>, Failure> {
    let (checked, compiled) = form.compiled_with("pixel", &[("lighting", "plain")])?;
    let job = Job { checked: &checked, compiled: &compiled, scene: Some(scene) };
    struct Subject {
        series: usize,
        count: u32,
        config: Config,
        renderer: Renderer,
        ms: Vec<f64>,
    }
    let mut subjects: Vec<Subject> = Vec::new();
    for (series, (own, way)) in wanted.iter().enumerate() {
        subjects.extend(own.axis.counts().into_iter().map(|count| {
            let config = own.axis.config(count, *way);
            Subject { series, count, config, renderer: Renderer::default(), ms: Vec::new() }
        }));
    }
    let mut first = None;
    for turn in 0..=repeat {
        for subject in &mut subjects {
            let started = Instant::now();
            let size = scene.options().size;
            let (image, _) =
                subject.renderer.render(&job, machine, size, &subject.config).map_err(Failure::run)?;
            let ms = 1e3 * started.elapsed().as_secs_f64();
            if turn > 0 {
                subject.ms.push(ms);
            }
            if first.get_or_insert_with(|| image.clone()).data != image.data {
                let (own, count) = (&wanted[subject.series].0, subject.count);
                return Err(Failure::Run(format!(
                    "{}: {count} drew another picture than the others: its times mean nothing",
                    own.name()
                )));
            }
        }
    }
    let mut filled: Vec<Series> = wanted.into_iter().map(|(series, _)| series).collect();
    for subject in subjects {
        let spread = Spread::of(subject.ms);
        let point = (subject.count, [spread.median, spread.least, spread.greatest]);
        filled[subject.series].points.push(point);
    }
    Ok(filled)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn doubling_is_measured_against_the_half() {
        let points = vec![(1, [8.0; 3]), (2, [4.0; 3]), (4, [5.0; 3])];
        let series =
            Series { axis: Axis::Workgroups, geometry: "basic", way: "block", backend: "gpu", points };
        assert_eq!([0, 1, 2].map(|at| series.gain(at)), [None, Some(2.0), Some(0.8)]);
        assert_eq!(series.rows()[2]["speedup_ratio"], 1.6);
    }
}
