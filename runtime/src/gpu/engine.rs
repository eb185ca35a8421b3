//! A program on the device: its kernels, its buffers, and the two ways to run it.

use std::time::{Duration, Instant};

use super::buffers::{Buffers, Capacity};
use super::code::Code;
use super::device::Gpu;
use super::fuel::Fuel;
use super::image::{PIXEL_FUEL, PIXEL_SHARE};
use super::layout::{NO_TASK, Params, State};
use super::pipelines::{Groups, Pipelines, SceneLayout};
use super::readback::Readback;
use super::shape::Shape;
use crate::config::{Config, Rewriter};
use crate::error::RunError;
use crate::memory::Memory;

/// Bind group 1 of the program's functions.
#[derive(Clone)]
pub struct Scene {
    pub layout: SceneLayout,
    pub group: wgpu::BindGroup,
    /// What its buffers take.
    pub bytes: u64,
}

/// What a run cost.
#[derive(Clone, Debug, Default)]
pub struct Stats {
    pub rounds: u64,
    pub rewrites: u64,
    /// The picture needed no stream, so nothing was rewritten that could be counted.
    pub direct: bool,
    /// Tokens written by splice.
    pub moved: u64,
    pub dispatches: u64,
    pub submissions: u64,
    pub memory: Memory,
    /// Most blocks in use.
    pub blocks_peak: u32,
    /// Lanes that were suspended.
    pub suspended: u64,
    /// From the first write to the last readback.
    pub time: Duration,
    /// Time spent compiling pipelines, within `time`.
    pub compiling: Duration,
}

/// Literals of the normal form.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub words: Vec<u32>,
    pub stats: Stats,
}

/// Pixels row by row, components one after the other.
#[derive(Clone, Debug)]
pub struct Frame {
    pub words: Vec<f32>,
    pub stats: Stats,
}

pub struct Engine {
    pub(super) gpu: Gpu,
    pub(super) code: Code,
    pub(super) config: Config,
    pub(super) shape: Shape,
    pub(super) pipelines: Pipelines,
    pub(super) buffers: Buffers,
    pub(super) groups: Groups,
    pub(super) scene: Option<wgpu::BindGroup>,
    pub(super) scene_bytes: u64,
    pub(super) readback: Readback,
    pub(super) fuel: Fuel,
    /// Most fuel of a lane in a dispatch.
    pub(super) cap: i32,
    /// Workgroups that draw pixels in one dispatch, and the steps each lane makes for them.
    pub(super) pixel_groups: u32,
    pub(super) pixel_share: i32,
    /// Pixels that a workgroup drew in one dispatch.
    pub(super) pixels_per_group: u32,
    pub(super) pixel_fuel: i32,
    /// Tile rows that `direct` computes in one submission.
    pub(super) direct_rows: u32,
    /// One lane at a time, from the start: a run needed more memory than there is.
    pub(super) lean: bool,
    live: Vec<u32>,
}

/// How a rewriting ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ended {
    Normal,
    /// The adapter cut loops short: nothing of it may be used, and the next attempt has less fuel.
    Void,
}

/// One run: when it began and what it has cost so far.
pub(super) struct Job {
    pub started: Instant,
    /// Spent on making kernels ready, which the program is not to blame for.
    pub preparing: Duration,
    pub stats: Stats,
    /// A task that was cut short or ran out of something last.
    pub latest: u32,
}

impl Job {
    pub fn new() -> Job {
        Job { started: Instant::now(), preparing: Duration::ZERO, stats: Stats::default(), latest: NO_TASK }
    }

    /// Time that counts against the limit.
    pub fn elapsed(&self) -> Duration {
        self.started.elapsed().saturating_sub(self.preparing)
    }

    /// Adds a submission's counters, which start from 0 again.
    pub fn absorb(&mut self, state: &mut State) {
        self.stats.submissions += 1;
        self.stats.rounds += u64::from(state.rounds);
        self.stats.rewrites += u64::from(state.rewrites);
        self.stats.moved += u64::from(state.moved);
        self.stats.suspended += u64::from(state.suspended);
        self.stats.blocks_peak = self.stats.blocks_peak.max(state.peak);
        for task in [state.latest, state.culprit] {
            if task != NO_TASK {
                self.latest = task;
            }
        }
        state.rounds = 0;
        state.rewrites = 0;
        state.rewrites_before = 0;
        state.moved = 0;
        state.suspended = 0;
    }
}

impl Engine {
    pub fn new(gpu: &Gpu, code: Code, config: Config, scene: Option<Scene>) -> Result<Engine, RunError> {
        Engine::with_components(gpu, code, config, scene, 0)
    }

    /// An engine that can also render images of so many words a pixel.
    pub fn with_components(
        gpu: &Gpu,
        code: Code,
        config: Config,
        scene: Option<Scene>,
        components: u32,
    ) -> Result<Engine, RunError> {
        let shape = Shape::new(&code, &config, components, gpu.info().software)?;
        let (layout, group, scene_bytes) = match scene {
            Some(scene) => (Some(scene.layout), Some(scene.group), scene.bytes),
            None => (None, None, 0),
        };
        let pipelines = Pipelines::new(&gpu.device, layout, config.trusted);
        let mut tables = code.arities.clone();
        tables.push(shape.components + 1);
        tables.extend(std::iter::repeat_n(0, code.live_words as usize));
        tables.extend(&code.constants);
        let fixed = Memory { terrain: scene_bytes, readback: Readback::LEAST, ..Memory::default() };
        let capacity = Capacity::within(config.max_memory, fixed, &shape)?;
        let buffers = Buffers::new(&gpu.device, &shape, capacity, tables.len() as u64);
        let groups = pipelines.groups(&gpu.device, &buffers);
        let pixel_groups = config.groups.unwrap_or(gpu.parallel_groups() * 4).max(1);
        gpu.queue.write_buffer(&buffers.tables, 0, bytemuck::cast_slice(&tables));
        Ok(Engine {
            gpu: gpu.clone(),
            live: vec![0; code.live_words as usize],
            code,
            config,
            shape,
            pipelines,
            buffers,
            groups,
            scene: group,
            scene_bytes,
            readback: Readback::default(),
            fuel: Fuel::default(),
            cap: gpu.loop_turns().map_or(i32::MAX, |turns| turns as i32 / 3),
            pixel_groups,
            pixel_share: PIXEL_SHARE,
            pixels_per_group: 1,
            pixel_fuel: PIXEL_FUEL,
            direct_rows: 1,
            lean: false,
        })
    }

    /// Where in a pixel its value is taken from now on.
    pub fn set_point(&mut self, point: [f32; 2]) {
        self.config.point = point;
    }

    /// Sets the words of the live parameters; missing ones stay.
    pub fn set_live(&mut self, words: &[u32]) {
        for (old, new) in self.live.iter_mut().zip(words) {
            *old = *new;
        }
        let offset = (self.code.arities.len() as u64 + 1) * 4;
        if !self.live.is_empty() {
            self.gpu.queue.write_buffer(&self.buffers.tables, offset, bytemuck::cast_slice(&self.live));
        }
    }

    /// Rewrites a stream of `(word, is it a function token)` to its normal form.
    pub fn run(&mut self, stream: &[(u32, bool)]) -> Result<Outcome, RunError> {
        let mut job = Job::new();
        self.readback.wait_for(job.started, self.config.timeout);
        let compiled = self.pipelines.compiling;
        let words = loop {
            match self.value(&mut job, stream) {
                Err(error @ RunError::LoopTooLong { .. }) => self.suspend_loops(&mut job, error)?,
                other => break other?,
            }
        };
        Ok(Outcome { words, stats: self.close(job, compiled) })
    }

    fn value(&mut self, job: &mut Job, stream: &[(u32, bool)]) -> Result<Vec<u32>, RunError> {
        self.lean = false;
        loop {
            let mut state = self.load(stream)?;
            if self.rewrite(job, &mut state)? == Ended::Normal {
                return self.literals(&state);
            }
        }
    }

    /// After a fused loop that cannot end within a submission: goes on with the form of the program whose long loops
    /// are tasks. `error` is returned if there is none.
    pub(super) fn suspend_loops(&mut self, job: &mut Job, error: RunError) -> Result<(), RunError> {
        let Some(suspendable) = self.code.suspendable.take() else { return Err(error) };
        let code = Code { prelude: std::mem::take(&mut self.code.prelude), ..suspendable.code() };
        let scene = self.pipelines.scene().cloned().zip(self.scene.clone());
        let scene = scene.map(|(layout, group)| Scene { layout, group, bytes: self.scene_bytes });
        let (config, components) = (self.config.clone(), self.shape.components);
        let old =
            std::mem::replace(self, Engine::with_components(&self.gpu, code, config, scene, components)?);
        self.pipelines.compiling += old.pipelines.compiling;
        self.set_live(&old.live);
        self.readback.wait_for(job.started, self.config.timeout);
        // Task numbers are others now.
        job.latest = NO_TASK;
        Ok(())
    }

    pub(super) fn close(&self, job: Job, compiled: Duration) -> Stats {
        Stats {
            time: job.started.elapsed(),
            compiling: self.pipelines.compiling - compiled,
            memory: self.memory(),
            ..job.stats
        }
    }

    /// What the engine's buffers take.
    pub(super) fn memory(&self) -> Memory {
        Memory {
            terrain: self.scene_bytes,
            readback: self.readback.bytes(),
            ..self.buffers.memory(&self.shape)
        }
    }

    /// Lanes in flight.
    fn groups_of_lanes(&self) -> u32 {
        let parallel = self.gpu.parallel_groups();
        match self.config.groups {
            Some(groups) => groups.max(1),
            // Expansion stops when all lanes are busy; the paper's rounds have no use for that.
            None if self.gpu.info().software && self.config.rewriter != Rewriter::Block => parallel * 4,
            None if self.gpu.info().software => parallel * 256,
            None => parallel * 4,
        }
    }

    pub(super) fn params(&self) -> Params {
        let groups = self.groups_of_lanes();
        let depth = match (self.config.depth, self.config.rewriter) {
            (Some(depth), _) => depth.max(1),
            (None, Rewriter::Auto) => 0,
            (None, Rewriter::Block) => 1,
            (None, Rewriter::Lane) => u32::MAX >> 2,
        };
        Params {
            capacity: self.buffers.capacity.blocks,
            record_capacity: self.buffers.capacity.records,
            fuel: self.fuel.steps,
            depth,
            threshold: (groups * self.shape.lanes).max(64),
            groups,
            cap: self.cap,
            canary: 3,
            most_turns: self.gpu.loop_turns().map_or(u32::MAX >> 1, |turns| turns / 2),
            parallel: self.gpu.parallel_groups(),
            floor: self.floor(),
            point_x: self.config.point[0],
            point_y: self.config.point[1],
            may_grow: u32::from(self.buffers.capacity.blocks < self.next_blocks()),
            ..Params::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn making_kernels_ready_is_not_held_against_a_program() {
        let started = Instant::now() - Duration::from_secs(5);
        let job = Job { started, preparing: Duration::from_secs(4), ..Job::new() };
        assert!((0.9..2.0).contains(&job.elapsed().as_secs_f64()), "{:?}", job.elapsed());
    }
}
