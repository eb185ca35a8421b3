//! Rounds until normal form: load a stream, play batches of rounds, give them memory and fuel, read the result.

use std::time::{Duration, Instant};

use super::engine::{Ended, Engine, Job};
use super::layout::{
    DONE, FLAG_EXHAUSTED, FLAG_LOOPS, FLAG_MEMORY, NEEDS_MEMORY, NO_TASK, Params, RESUME, RUNNING, STUCK,
    State,
};
use super::shader::Kernel;
use super::shape::GRID;
use crate::error::RunError;
use crate::progress::Step;

const STAGES: [Kernel; 4] = [Kernel::Decode, Kernel::Execute, Kernel::Allocate, Kernel::Splice];
/// Rounds without a rewrite after which what is short will not come by itself.
const PATIENCE: u32 = 4;

/// Blocks that the pages of a lane and the splice of its round take at least.
const LEAST_FLOOR: u32 = 8;

/// Fuel of a lane at which a loop that is still cut short by the adapter must be one task's own.
const LEAST_CAP: i32 = 16;

/// Words of a block: tokens, then their function bits.
fn block_words(tokens: &[(u32, bool)], block: usize, stride: usize, out: &mut Vec<u32>) {
    let base = out.len();
    out.resize(base + stride, 0);
    for (index, (word, function)) in tokens.iter().enumerate() {
        out[base + index] = *word;
        out[base + block + index / 32] |= u32::from(*function) << (index % 32);
    }
}

impl Engine {
    /// Blocks that the arena can have next.
    pub(super) fn next_blocks(&self) -> u32 {
        let limits = &self.gpu.info().limits;
        let bytes = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        let most = (bytes / (u64::from(self.shape.stride()) * 4)).min(1 << 28) as u32;
        let capacity = self.buffers.capacity;
        let memory = self.memory();
        let others = memory.total() - memory.stream;
        capacity.growth(self.config.max_memory, others, &self.shape).min(most).max(capacity.blocks)
    }

    /// Writes the stream to the arena, and everything else afresh.
    pub(super) fn load(&mut self, stream: &[(u32, bool)]) -> Result<State, RunError> {
        let block = self.shape.block as usize;
        let blocks = stream.len().div_ceil(block) as u32;
        while blocks * 2 + 4 > self.buffers.capacity.blocks {
            if !self.grow_arena() {
                return Err(self.out_of_memory(NO_TASK));
            }
        }
        let mut words = Vec::with_capacity(blocks as usize * self.shape.stride() as usize);
        let mut order = Vec::with_capacity(blocks as usize * 2);
        for (index, tokens) in stream.chunks(block).enumerate() {
            block_words(tokens, block, self.shape.stride() as usize, &mut words);
            order.extend([index as u32, tokens.len() as u32]);
        }
        let queue = &self.gpu.queue;
        queue.write_buffer(&self.buffers.arena, 0, bytemuck::cast_slice(&words));
        queue.write_buffer(&self.buffers.lists, 0, bytemuck::cast_slice(&order));
        Ok(self.begin(blocks))
    }

    /// The state of a stream whose blocks are the arena's first ones and the first order list's entries.
    pub(super) fn begin(&mut self, blocks: u32) -> State {
        let free: Vec<u32> = (blocks..self.buffers.capacity.blocks).rev().collect();
        let offset = self.buffers.free_offset(0);
        self.gpu.queue.write_buffer(&self.buffers.lists, offset, bytemuck::cast_slice(&free));
        let mut state = State {
            blocks,
            pairs: blocks.div_ceil(2),
            free: free.len() as i32,
            culprit: NO_TASK,
            latest: NO_TASK,
            peak: blocks,
            sole: NO_TASK,
            next_sole: NO_TASK,
            ..State::default()
        };
        self.permit(&mut state);
        state
    }

    /// Lets the rounds go on: sets what the allocate stage sets between two of them.
    pub(super) fn permit(&self, state: &mut State) {
        state.lean = u32::from(state.free.max(0) as u32 + state.freed < 2 * self.floor());
        if state.lean == 0 {
            state.sole = NO_TASK;
        }
        state.limit = self.memory_limit(state);
        state.status = RUNNING;
        let grid = |count: u32| [count.min(GRID), count.div_ceil(GRID), 1];
        let sizes = [grid(state.pairs), grid(0)];
        self.gpu.queue.write_buffer(&self.buffers.pair_groups, 0, bytemuck::cast_slice(&sizes));
        self.gpu.queue.write_buffer(&self.buffers.lane_groups, 0, bytemuck::cast_slice(&[0u32, 1, 1]));
    }

    /// Free blocks that are kept for a lane that goes on alone: below twice as many, breadth turns into depth.
    pub(super) fn floor(&self) -> u32 {
        let capacity = self.buffers.capacity.blocks;
        if self.lean { capacity } else { (capacity / 8).max(LEAST_FLOOR) }
    }

    /// `memory_limit` of the allocate stage.
    fn memory_limit(&self, state: &State) -> u32 {
        let (block, output) = (u64::from(self.shape.block), u64::from(self.shape.output()));
        let cost = 2 + output.div_ceil(block);
        let available = state.free.max(0) as u64 + u64::from(state.freed);
        let share = if available / 2 < cost { available } else { available / 2 };
        let records = u64::from(self.buffers.capacity.records);
        if state.lean != 0 {
            return (share / cost).min(1 + available / (4 * cost)).min(records) as u32;
        }
        let spread = u64::from(state.blocks + state.pairs);
        let wide = share.saturating_sub(spread) * block / output;
        (share / cost).max(wide).min(records) as u32
    }

    /// Compiles kernels; true if any was not ready.
    pub(super) fn prepare(&mut self, job: &mut Job, kernels: &[Kernel]) -> Result<bool, RunError> {
        let start = Instant::now();
        let mut cold = false;
        for kernel in kernels {
            cold |= self.pipelines.prepare(&self.gpu, *kernel, &self.shape, &self.code)?;
        }
        job.preparing += start.elapsed();
        Ok(cold)
    }

    pub(super) fn write(&self, params: &Params, state: &State) {
        self.gpu.queue.write_buffer(&self.buffers.params, 0, bytemuck::bytes_of(params));
        self.gpu.queue.write_buffer(&self.buffers.state, 0, bytemuck::bytes_of(state));
    }

    /// Binds a kernel; its dispatch follows.
    pub(super) fn bind(&self, pass: &mut wgpu::ComputePass, kernel: Kernel) {
        if let Some(pipeline) = self.pipelines.get(kernel) {
            pass.set_pipeline(pipeline);
        }
        pass.set_bind_group(0, &self.groups.stream, &[]);
        let scene = self.scene.as_ref().filter(|_| kernel.runs_code());
        pass.set_bind_group(1, scene.unwrap_or(&self.groups.empty), &[]);
        match kernel {
            Kernel::Decode => pass.set_bind_group(2, &self.groups.decode_sizes, &[]),
            Kernel::Allocate => pass.set_bind_group(2, &self.groups.allocate_sizes, &[]),
            _ => {}
        }
    }

    fn record_rounds(&self, encoder: &mut wgpu::CommandEncoder, rounds: u32) {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        for _ in 0..rounds {
            for kernel in STAGES {
                self.bind(&mut pass, kernel);
                match kernel {
                    Kernel::Decode => pass.dispatch_workgroups_indirect(&self.buffers.pair_groups, 0),
                    Kernel::Execute => pass.dispatch_workgroups_indirect(&self.buffers.lane_groups, 0),
                    Kernel::Splice => pass.dispatch_workgroups_indirect(&self.buffers.pair_groups, 12),
                    _ => pass.dispatch_workgroups(1, 1, 1),
                }
            }
        }
    }

    /// Plays rounds until only literals are left.
    pub(super) fn rewrite(&mut self, job: &mut Job, state: &mut State) -> Result<Ended, RunError> {
        // A driver may compile at the first dispatch, so the first submission's time says nothing.
        let mut cold = self.prepare(job, &STAGES)?;
        loop {
            let rounds = self.fuel.rounds;
            let start = Instant::now();
            self.write(&self.params(), state);
            let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
            self.record_rounds(&mut encoder, rounds);
            let range = (&self.buffers.state, 0, size_of::<State>() / 4);
            let words = self.readback.submit(&self.gpu, encoder, &[range])?;
            *state = bytemuck::pod_read_unaligned(bytemuck::cast_slice(&words));
            let time = start.elapsed();
            job.stats.dispatches += u64::from(rounds) * STAGES.len() as u64;
            let full = std::mem::take(&mut state.full);
            job.absorb(state);
            self.config.progress.tell(Step::Rewrites(job.stats.rewrites));
            if state.flags & FLAG_LOOPS != 0 {
                self.lower_cap(state)?;
                return Ok(Ended::Void);
            }
            if state.status == DONE {
                return Ok(Ended::Normal);
            }
            let cold = std::mem::take(&mut cold);
            if cold {
                job.preparing += time;
            }
            if job.latest == NO_TASK && self.check_limits(job).is_err() {
                // Lanes of little depth are never cut short: what comes next in the stream is to blame.
                job.latest = self.first_function(state)?;
            }
            self.check_limits(job)?;
            if state.flags & FLAG_EXHAUSTED != 0 && state.idle > 0 {
                let time = if cold { Duration::ZERO } else { time / rounds };
                if state.idle >= 2 && !self.fuel.extend(time, self.cap) {
                    return Err(self.loop_too_long(state));
                }
            } else if !cold {
                self.fuel.learn(time, full);
            }
            if self.mend(job, state)? == Ended::Void {
                return Ok(Ended::Void);
            }
        }
    }

    /// After a submission that did not finish: gives memory where it was short.
    fn mend(&mut self, job: &Job, state: &mut State) -> Result<Ended, RunError> {
        let short = state.status == NEEDS_MEMORY || state.flags & FLAG_MEMORY != 0;
        if short {
            let grown = self.grow(state);
            if !grown && (state.status == NEEDS_MEMORY || state.idle >= PATIENCE) {
                if !self.lean && self.is_broad(state)? {
                    // What many lanes hold may be more than one by one needs: from the start, without breadth.
                    self.lean = true;
                    return Ok(Ended::Void);
                }
                let task = if job.latest == NO_TASK { self.first_function(state)? } else { job.latest };
                return Err(self.out_of_memory(task));
            }
        } else if state.status == STUCK && state.flags & FLAG_EXHAUSTED == 0 {
            let task = self.first_function(state)?;
            return Err(RunError::Stuck { function: self.code.name(task).to_owned() });
        }
        if state.status != RUNNING {
            self.permit(state);
        }
        state.flags = 0;
        Ok(Ended::Normal)
    }

    pub(super) fn check_limits(&self, job: &Job) -> Result<(), RunError> {
        let seconds = job.elapsed();
        let function = || self.code.name(job.latest).to_owned();
        let rewrites = job.stats.rewrites;
        if seconds > self.config.timeout {
            return Err(RunError::Timeout {
                function: function(),
                seconds: seconds.as_secs_f64(),
                reached: format!("{rewrites} rewrites"),
            });
        }
        if let Some(limit) = self.config.max_rewrites.filter(|most| rewrites > *most) {
            return Err(RunError::MaxRewrites { function: function(), limit });
        }
        Ok(())
    }

    /// After loops were cut short by the adapter: fewer steps in a dispatch, down to those of a single task.
    pub(super) fn lower_cap(&mut self, state: &State) -> Result<(), RunError> {
        if self.cap <= LEAST_CAP {
            return Err(self.loop_too_long(state));
        }
        self.cap = (self.cap / 4).max(LEAST_CAP);
        Ok(())
    }

    pub(super) fn loop_too_long(&self, state: &State) -> RunError {
        RunError::LoopTooLong {
            function: self.code.name(state.culprit).to_owned(),
            steps: self.fuel.steps as u64,
        }
    }

    pub(super) fn out_of_memory(&self, task: u32) -> RunError {
        RunError::OutOfMemory {
            function: self.code.name(task).to_owned(),
            bytes: self.memory().total(),
            limit: self.config.max_memory,
        }
    }

    /// False if the arena may not grow.
    fn grow_arena(&mut self) -> bool {
        let blocks = self.next_blocks();
        let grows = blocks > self.buffers.capacity.blocks;
        if grows {
            self.buffers.grow(&self.gpu.device, &self.gpu.queue, &self.shape, blocks);
            self.groups = self.pipelines.groups(&self.gpu.device, &self.buffers);
        }
        grows
    }

    /// Grows the arena under a stream; false if it may not grow.
    pub(super) fn grow(&mut self, state: &mut State) -> bool {
        let old = self.buffers.capacity.blocks;
        if !self.grow_arena() {
            return false;
        }
        let added: Vec<u32> = (old..self.buffers.capacity.blocks).rev().collect();
        let offset = self.buffers.free_offset(state.free.max(0) as u32);
        self.gpu.queue.write_buffer(&self.buffers.lists, offset, bytemuck::cast_slice(&added));
        state.free += added.len() as i32;
        self.permit(state);
        true
    }

    /// The order list: blocks and their sizes.
    fn order(&mut self, state: &State) -> Result<Vec<[u32; 2]>, RunError> {
        let first = u64::from(state.list) * u64::from(self.buffers.capacity.blocks) * 2;
        let range = (&self.buffers.lists, first, state.blocks as usize * 2);
        Ok(self.readback.read(&self.gpu, &[range])?.chunks_exact(2).map(|e| [e[0], e[1]]).collect())
    }

    /// The literals of a finished stream.
    pub(super) fn literals(&mut self, state: &State) -> Result<Vec<u32>, RunError> {
        let stride = u64::from(self.shape.stride());
        let order = self.order(state)?;
        let arena = &self.buffers.arena;
        let ranges: Vec<_> = order.iter().map(|e| (arena, u64::from(e[0]) * stride, e[1] as usize)).collect();
        self.readback.read(&self.gpu, &ranges)
    }

    /// Function tokens of the stream from the left, as long as `wanted` says so.
    fn functions(&mut self, state: &State, mut wanted: impl FnMut(u32) -> bool) -> Result<(), RunError> {
        let stride = self.shape.stride() as usize;
        for entries in self.order(state)?.chunks(256) {
            let arena = &self.buffers.arena;
            let ranges: Vec<_> =
                entries.iter().map(|[block, _]| (arena, u64::from(*block) * stride as u64, stride)).collect();
            let words = self.readback.read(&self.gpu, &ranges)?;
            for ([_, size], block) in entries.iter().zip(words.chunks(stride)) {
                let (tokens, bits) = block.split_at(self.shape.block as usize);
                let function = |i: &usize| bits[i / 32] >> (i % 32) & 1 != 0;
                if !(0..*size as usize).filter(function).all(|i| wanted(tokens[i])) {
                    return Ok(());
                }
            }
        }
        Ok(())
    }

    /// Task of the first function token, for messages.
    fn first_function(&mut self, state: &State) -> Result<u32, RunError> {
        let mut first = NO_TASK;
        self.functions(state, |task| {
            first = if task < RESUME { task } else { first };
            first == NO_TASK
        })?;
        Ok(first)
    }

    /// Whether much of the memory is the stream's, or more than one lane's.
    fn is_broad(&mut self, state: &State) -> Result<bool, RunError> {
        let mut suspended = 0;
        if state.blocks < self.buffers.capacity.blocks / 16 {
            self.functions(state, |task| {
                suspended += usize::from(task >= RESUME);
                suspended < 2
            })?;
            return Ok(suspended > 1);
        }
        Ok(true)
    }
}
