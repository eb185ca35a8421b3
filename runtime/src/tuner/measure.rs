//! Draws choices and takes their figures.

use super::choices::Choice;
use crate::config::{Config, Stats};
use crate::error::RunError;
use crate::image::{Image, compare};
use crate::machine::{Job, Machine};
use crate::renderer::Renderer;
use crate::terrain::Scene;
use ghyll_compiler::compile::Compiled;
use ghyll_compiler::front::Checked;
use std::time::{Duration, Instant};

/// A choice with what it takes and gives.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    pub choice: Choice,
    /// Median milliseconds of a frame, kernels compiled and functions baked before.
    pub frame_ms: f64,
    /// Decibels against the best choice's picture; infinite where it is the same.
    pub psnr: f64,
    /// Bytes at their greatest; what was asked for, where that was too much to draw anything.
    pub memory: u64,
    /// False where memory did not suffice: the other figures are not known then.
    pub drawn: bool,
}

/// Frames of which the median is taken, unless they take longer than this together.
const FRAMES: usize = 3;
const LONG: Duration = Duration::from_secs(2);
/// Choices whose frame would take longer are not tried, but for those of the fewest samples.
const LONGEST: Duration = Duration::from_secs(20);

/// A program with what it looks at.
pub type Opened = (Compiled, Option<Scene>);

/// Where choices are drawn.
pub struct Studio<'a, E> {
    pub checked: &'a Checked,
    pub machine: &'a Machine,
    pub config: &'a Config,
    pub size: (u32, u32),
    /// Compiles the program for a choice and opens what it looks at.
    pub open: &'a mut dyn FnMut(&Choice) -> Result<Opened, E>,
    /// Told of each choice when it is measured.
    pub tell: &'a mut dyn FnMut(&Measured),
    pub failed: fn(RunError) -> E,
}

impl<E> Studio<'_, E> {
    /// Figures of the choices, which stand in the order of [`super::choices`]. The first that can be drawn is the reference. Programs
    /// without bakes are tried only if no other fits into the memory.
    pub fn measure(&mut self, choices: &[Choice]) -> Result<Vec<Measured>, E> {
        let mut reference: Option<Image> = None;
        let mut all: Vec<Measured> = Vec::new();
        for group in choices.chunk_by(|a, b| a.same_program(b)) {
            if !group[0].bake && all.iter().any(|measured| measured.drawn) {
                continue;
            }
            self.group(group, &mut reference, &mut all)?;
        }
        Ok(all)
    }

    /// Choices of one program, the most samples first.
    fn group(
        &mut self,
        group: &[Choice],
        reference: &mut Option<Image>,
        all: &mut Vec<Measured>,
    ) -> Result<(), E> {
        let (compiled, scene) = (self.open)(&group[0])?;
        let (checked, machine, config, size) = (self.checked, self.machine, self.config, self.size);
        let job = Job { checked, compiled: &compiled, scene: scene.as_ref() };
        let mut renderer = Renderer::default();
        // Compiles and bakes; the second is a frame's time.
        let mut alone = Duration::ZERO;
        for _ in 0..2 {
            let started = Instant::now();
            if let Err(error) = renderer.render(&job, machine, size, config) {
                let Some(memory) = lacking(&error) else { return Err((self.failed)(error)) };
                let failed = |choice: &Choice| Measured {
                    choice: choice.clone(),
                    frame_ms: f64::INFINITY,
                    psnr: f64::NEG_INFINITY,
                    memory,
                    drawn: false,
                };
                all.extend(group.iter().map(failed));
                return Ok(());
            }
            alone = started.elapsed();
        }
        let fewest = group.iter().map(|choice| choice.samples).min().unwrap_or(1);
        for choice in group {
            if choice.samples > fewest && alone * choice.samples > LONGEST {
                continue;
            }
            let drawn = self.frames(&job, &mut renderer, choice.samples);
            let (image, ms, stats) = drawn.map_err(self.failed)?;
            let psnr = match reference {
                Some(best) => compare(&image, best).map_or(f64::NEG_INFINITY, |apart| apart.psnr),
                None => f64::INFINITY,
            };
            let memory = stats.memory.total();
            let measured = Measured { choice: choice.clone(), frame_ms: ms, psnr, memory, drawn: true };
            reference.get_or_insert(image);
            (self.tell)(&measured);
            all.push(measured);
        }
        Ok(())
    }

    fn frames(
        &self,
        job: &Job,
        renderer: &mut Renderer,
        samples: u32,
    ) -> Result<(Image, f64, Stats), RunError> {
        let begun = Instant::now();
        let mut times = Vec::new();
        loop {
            let started = Instant::now();
            let (image, stats) =
                renderer.render_samples(job, self.machine, self.size, self.config, samples)?;
            times.push(1e3 * started.elapsed().as_secs_f64());
            if times.len() == FRAMES || begun.elapsed() > LONG {
                times.sort_by(f64::total_cmp);
                return Ok((image, times[times.len() / 2], stats));
            }
        }
    }
}

/// Bytes that a run failed for.
fn lacking(error: &RunError) -> Option<u64> {
    match error {
        RunError::TooLittleMemory { needed, .. } => Some(needed.total()),
        RunError::OutOfMemory { bytes, limit, .. } => Some((*bytes).max(limit + 1)),
        _ => None,
    }
}
