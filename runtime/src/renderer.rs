//! Pictures of one program, one after the other: kernels, buffers and bakes are kept between them.

use crate::bake::BakedScene;
use crate::config::{Config, Stats};
use crate::error::RunError;
use crate::image::Image;
use crate::kernels::Kernels;
use crate::machine::{Job, Machine, gpu_stats};
use crate::needs::Needs;
use crate::samples::{self, Sum};
use std::time::{Duration, Instant};

/// What is kept. It serves one compiled program; the scene and live parameters may change between pictures.
#[derive(Default)]
pub struct Renderer {
    kernels: Option<Kernels>,
    baked: Option<BakedScene>,
}

impl Renderer {
    /// The picture of the job's entry at one point of every pixel, `config.point`.
    pub fn render(
        &mut self,
        job: &Job,
        machine: &Machine,
        size: (u32, u32),
        config: &Config,
    ) -> Result<(Image, Stats), RunError> {
        let started = Instant::now();
        let stand_in = machine.stand_in(job)?;
        let (data, stats) = match stand_in.as_ref().map_or(machine, |other| &other.machine) {
            Machine::Oracle(precision) => {
                let options = job.oracle_options(*precision, config);
                let wide = job.oracle_picture(size, config.point, &options)?;
                let data = wide.into_iter().map(|x| x as f32).collect();
                (data, Stats { total: started.elapsed(), ..Stats::default() })
            }
            Machine::Cpu => {
                let whole = |error| Needs::on_twin(job, size).whole(error);
                let scene = match job.scene.filter(|_| !job.compiled.bakes.is_empty()) {
                    Some(scene) => {
                        let baked = BakedScene::new(job, scene, config, self.baked.take()).map_err(whole)?;
                        Some(self.baked.insert(baked).scene())
                    }
                    None => job.scene,
                };
                let baking = started.elapsed();
                let (data, stats) = job.render_twin(scene, size, config).map_err(whole)?;
                (data, job.looked_at(stats, baking))
            }
            Machine::Gpu(gpu) => {
                let whole = |error| Needs::on_device(job, size).whole(error);
                let components = job.compiled.result_words(&job.checked.module);
                let same_field = |kernels: &Kernels| job.scene.is_none_or(|scene| kernels.serves(scene));
                match self.kernels.take().filter(same_field) {
                    Some(mut kept) => {
                        kept.update(job, gpu, config).map_err(whole)?;
                        self.kernels = Some(kept);
                    }
                    None => {
                        let made = Kernels::new(job, gpu, config, components).map_err(whole)?;
                        self.kernels = Some(made);
                    }
                }
                let baking = started.elapsed();
                let kernels = self.kernels.as_mut().ok_or_else(no_kernels)?;
                kernels.engine.set_point(config.point);
                let drawn = kernels.engine.render(size.0, size.1, job.compiled.back.entry.0);
                let frame = drawn.map_err(whole)?;
                (frame.words, job.looked_at(gpu_stats(&frame.stats), baking))
            }
        };
        Ok((job.image(size, data)?, stats))
    }

    /// The mean of `count` pictures, taken at points that cover a pixel evenly.
    pub fn render_samples(
        &mut self,
        job: &Job,
        machine: &Machine,
        size: (u32, u32),
        config: &Config,
        count: u32,
    ) -> Result<(Image, Stats), RunError> {
        if count <= 1 {
            return self.render(job, machine, size, config);
        }
        let mut sum = Sum::default();
        let mut all: Option<Stats> = None;
        for point in samples::points(count) {
            let config = Config { point, ..config.clone() };
            let (picture, stats) = self.render(job, machine, size, &config)?;
            sum.add(&picture);
            all = Some(all.map_or(stats, |all| together(all, stats)));
        }
        Ok((job.image(size, sum.mean())?, all.unwrap_or_default()))
    }
}

fn no_kernels() -> RunError {
    RunError::Internal("a picture without kernels".into())
}

/// Figures of two pictures; memory is that of the later one, bakes are made for the first.
fn together(a: Stats, b: Stats) -> Stats {
    let sum = |x: Duration, y: Duration| x + y;
    Stats {
        rounds: a.rounds + b.rounds,
        rewrites: a.rewrites + b.rewrites,
        tokens_moved: a.tokens_moved + b.tokens_moved,
        longest_stream: a.longest_stream.max(b.longest_stream),
        decode: sum(a.decode, b.decode),
        execute: sum(a.execute, b.execute),
        allocate: sum(a.allocate, b.allocate),
        splice: sum(a.splice, b.splice),
        dispatches: a.dispatches + b.dispatches,
        submissions: a.submissions + b.submissions,
        suspended: a.suspended + b.suspended,
        compiling: sum(a.compiling, b.compiling),
        total: sum(a.total, b.total),
        baking: a.baking,
        ..b
    }
}
