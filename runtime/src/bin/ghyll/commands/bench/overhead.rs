//! `ghyll bench overhead`: what the language costs. One picture (primary ray, shadow ray, shading) by a hand-written kernel,
//! by the fused program, by the same program with every stage a task, and by the paper's algorithm.

use super::kernel::Kernel;
use super::{Spread, program};
use crate::arguments::Bench;
use crate::failure::Failure;
use ghyll_compiler::compile::{Compiled, EntryKind};
use ghyll_compiler::front::Checked;
use ghyll_runtime::config::{Config, Rewriter};
use ghyll_runtime::gpu::{Engine, Gpu};
use ghyll_runtime::machine::Job;
use ghyll_runtime::terrain::{Scene, SceneOptions, Terrain};
use serde_json::{Value, json};
use std::sync::Arc;
use std::time::Instant;

const FUSED: &str = include_str!("../../../../../../benches/overhead/fused.ghyll");
const TASKS: &str = include_str!("../../../../../../benches/overhead/tasks.ghyll");
const SIZE: u32 = 1024;

/// Something that draws the picture on the device and can hand it over.
enum Subject {
    Kernel(Box<Kernel>),
    Program(Box<Engine>, u32),
}

impl Subject {
    /// Seconds from the first submission until the device is done; the picture stays there.
    fn draw(&mut self, gpu: &Gpu) -> Result<f64, Failure> {
        let started = Instant::now();
        match self {
            Subject::Kernel(kernel) => kernel.draw(gpu).map_err(Failure::Run)?,
            Subject::Program(engine, entry) => {
                engine.draw(SIZE, SIZE, *entry).map_err(Failure::run)?;
            }
        }
        Ok(started.elapsed().as_secs_f64())
    }

    /// The picture last drawn, three floats a pixel.
    fn picture(&mut self, gpu: &Gpu) -> Result<Vec<f32>, Failure> {
        match self {
            Subject::Kernel(kernel) => kernel.picture(gpu).map_err(Failure::Run),
            Subject::Program(engine, _) => engine.picture(SIZE, SIZE).map_err(Failure::run),
        }
    }
}

pub fn rows(arguments: &Bench, gpu: Option<&Gpu>) -> Result<Vec<Value>, Failure> {
    let Some(gpu) = gpu else {
        return Err(Failure::Usage("bench overhead needs a GPU adapter; `ghyll info` lists them".into()));
    };
    let options = SceneOptions { size: (SIZE, SIZE), ..SceneOptions::default() };
    let scene =
        Scene::new(Arc::new(Terrain::builtin()), &options).map_err(|e| Failure::Run(e.to_string()))?;
    let fused = program("fused", FUSED, EntryKind::Image)?;
    let tasks = program("tasks", TASKS, EntryKind::Image)?;
    let paper = Config { rewriter: Rewriter::Block, depth: Some(1), block: 512, ..Config::default() };
    let mut subjects = [
        ("kernel", Subject::Kernel(Box::new(Kernel::new(gpu, &scene, SIZE).map_err(Failure::Run)?))),
        ("fused", subject(gpu, &fused, &scene, &Config::default())?),
        ("tasks", subject(gpu, &tasks, &scene, &Config::default())?),
        ("paper", subject(gpu, &tasks, &scene, &paper)?),
    ];

    // Every picture must be the kernel's, bit for bit; this is the warm-up too.
    let mut wanted = Vec::new();
    for (name, subject) in &mut subjects {
        subject.draw(gpu)?;
        let picture = subject.picture(gpu)?;
        if wanted.is_empty() {
            wanted = picture;
        } else if let Some(at) = first_difference(&wanted, &picture) {
            let others = wanted.iter().zip(&picture).filter(|(a, b)| a.to_bits() != b.to_bits()).count();
            return Err(Failure::Run(format!(
                "{name} drew another picture than the kernel in {others} components, first {} for {} at pixel ({}, {}): \
                 its times mean nothing",
                picture[at],
                wanted[at],
                at / 3 % SIZE as usize,
                at / 3 / SIZE as usize,
            )));
        }
    }

    let mut times = vec![Vec::new(); subjects.len()];
    for _ in 0..arguments.repeat {
        for ((_, subject), times) in subjects.iter_mut().zip(&mut times) {
            times.push(subject.draw(gpu)? * 1e3);
        }
    }
    // Ratios frame by frame: a machine that drifts does so for all of them.
    let ratios: Vec<f64> = times
        .iter()
        .map(|own| Spread::of(own.iter().zip(&times[0]).map(|(a, b)| a / b).collect()).median)
        .collect();
    let rows = subjects.iter().zip(times).zip(ratios).map(|(((name, _), times), ratio)| {
        let spread = Spread::of(times);
        json!({
            "name": name,
            "ms_median": spread.median,
            "ms_min": spread.least,
            "ms_max": spread.greatest,
            "ratio": ratio,
        })
    });
    Ok(rows.collect())
}

fn subject(
    gpu: &Gpu,
    (checked, compiled): &(Checked, Compiled),
    scene: &Scene,
    config: &Config,
) -> Result<Subject, Failure> {
    let job = Job { checked, compiled, scene: Some(scene) };
    let engine = job.engine(gpu, config, 3).map_err(Failure::run)?;
    Ok(Subject::Program(Box::new(engine), compiled.back.entry.0))
}

/// Index of the first component that has other bits.
fn first_difference(a: &[f32], b: &[f32]) -> Option<usize> {
    if a.len() != b.len() {
        return Some(a.len().min(b.len()));
    }
    a.iter().zip(b).position(|(a, b)| a.to_bits() != b.to_bits())
}

#[cfg(test)]
mod tests {
    use super::first_difference;

    #[test]
    fn one_planted_bit_is_a_difference() {
        let picture = vec![0.25f32; 12];
        assert_eq!(first_difference(&picture, &picture), None);
        let mut other = picture.clone();
        other[7] = f32::from_bits(other[7].to_bits() ^ 1);
        assert_eq!(first_difference(&picture, &other), Some(7));
        assert_eq!(first_difference(&picture, &picture[..9]), Some(9));
    }
}
