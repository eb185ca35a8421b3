//! Images: pixels straight to the image buffer where the entry is fused whole, else by lanes that draw pixels from a
//! counter, else (the block rewriter) as streams written in parts.

use std::time::{Duration, Instant};

use super::buffers::Capacity;
use super::engine::{Ended, Engine, Frame, Job, Stats};
use super::layout::{FLAG_EXHAUSTED, FLAG_LOOPS, FLAG_MEMORY, NO_TASK, Params, State};
use super::readback::Readback;
use super::shader::Kernel;
use crate::config::Rewriter;
use crate::error::RunError;
use crate::memory::Memory;

/// What a submission of pixels should take; a driver's watchdog waits for 2 s.
const SUBMISSION: Duration = Duration::from_millis(400);
const STATE_WORDS: usize = size_of::<State>() / 4;
/// Workgroups of one dispatch's row.
const MOST_GROUPS: u32 = 32768;
/// Steps that a lane may make in a dispatch before it leaves its last pixel to the rounds.
pub const PIXEL_FUEL: i32 = 1 << 13;
const LEAST_PIXEL_FUEL: i32 = 32;
/// Steps after which a lane draws no further pixel in a dispatch.
pub const PIXEL_SHARE: i32 = 256;
/// Steps of fused loops in one pixel of `direct`, to begin with.
const DIRECT_FUEL: i32 = 1 << 16;

/// Bytes of a picture that are read back at a time.
const PIECE: u64 = 16 << 20;

/// Bytes that reading a picture of so many takes.
pub fn readback_of_picture(bytes: u64) -> u64 {
    Readback::needed(bytes.min(PIECE))
}

/// Pixel at an index in tile order, which runs over whole tiles of 8x8.
fn pixel_at(index: u32, width: u32) -> (u32, u32) {
    let tiles = width.div_ceil(8);
    let tile = index / 64;
    ((tile % tiles) * 8 + index % 8, (tile / tiles) * 8 + index / 8 % 8)
}

impl Engine {
    /// Renders `entry`, a task from pixel position (x, y) to as many words as the engine was made for.
    pub fn render(&mut self, width: u32, height: u32, entry: u32) -> Result<Frame, RunError> {
        let start = Instant::now();
        let stats = self.draw(width, height, entry)?;
        let words = self.picture(width, height)?;
        Ok(Frame { words, stats: Stats { time: start.elapsed(), memory: self.memory(), ..stats } })
    }

    /// As [`Engine::render`], leaving the picture on the device.
    pub fn draw(&mut self, width: u32, height: u32, entry: u32) -> Result<Stats, RunError> {
        let mut job = Job::new();
        self.readback.wait_for(job.started, self.config.timeout);
        let compiled = self.pipelines.compiling;
        loop {
            match self.draw_all(&mut job, width, height, entry) {
                Err(error @ RunError::LoopTooLong { .. }) => self.suspend_loops(&mut job, error)?,
                other => break other?,
            }
        }
        Ok(self.close(job, compiled))
    }

    fn draw_all(&mut self, job: &mut Job, width: u32, height: u32, entry: u32) -> Result<(), RunError> {
        self.lean = false;
        self.fit(width, height)?;
        let direct = match self.config.rewriter {
            Rewriter::Auto => self.code.has_shade,
            Rewriter::Lane => self.code.fused,
            Rewriter::Block => false,
        };
        let mut done = false;
        if direct {
            done = match self.direct(job, width, height, entry) {
                // A lane with a window can be suspended, one without cannot.
                Err(RunError::LoopTooLong { .. }) if !self.code.fused => false,
                other => other.map(|()| true)?,
            };
            job.stats.direct = done;
        }
        if !done && self.config.rewriter == Rewriter::Block {
            self.stream_pixels(job, width, height, entry)?;
        } else if !done {
            self.draw_pixels(job, width, height, entry)?;
        }
        Ok(())
    }

    /// The picture that was last drawn, of the same size.
    pub fn picture(&mut self, width: u32, height: u32) -> Result<Vec<f32>, RunError> {
        self.readback.wait_for(Instant::now(), self.config.timeout);
        let words = u64::from(width * height * self.shape.components);
        let mut picture = Vec::with_capacity(words as usize);
        for first in (0..words).step_by(PIECE as usize / 4) {
            let count = (words - first).min(PIECE / 4) as usize;
            let bits = self.readback.read(&self.gpu, &[(&self.buffers.image, first, count)])?;
            picture.extend(bits.into_iter().map(f32::from_bits));
        }
        Ok(picture)
    }

    /// The picture on the device: words as in [`Frame`], valid until the next call.
    pub fn image(&self) -> &wgpu::Buffer {
        &self.buffers.image
    }

    fn fit(&mut self, width: u32, height: u32) -> Result<(), RunError> {
        let limits = &self.gpu.info().limits;
        let limit = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        let bytes = u64::from(width) * u64::from(height) * u64::from(self.shape.components) * 4;
        if bytes > limit || bytes > u64::from(u32::MAX) {
            return Err(RunError::ImageTooLarge { width, height, limit });
        }
        // The image has its place first; the stream has what is left.
        let image = bytes.max(self.buffers.image.size());
        let readback = self.readback.bytes().max(readback_of_picture(bytes));
        let fixed = Memory { image, readback, terrain: self.scene_bytes, ..Memory::default() };
        let stream = self.buffers.capacity.memory(&self.shape);
        let crowded = stream.total() + fixed.total() > self.config.max_memory;
        if crowded {
            let capacity = Capacity::within(self.config.max_memory, fixed, &self.shape)?;
            self.buffers.shrink(&self.gpu.device, &self.shape, capacity);
        }
        if self.buffers.fit_image(&self.gpu.device, bytes) || crowded {
            self.groups = self.pipelines.groups(&self.gpu.device, &self.buffers);
        }
        Ok(())
    }

    fn play(
        &mut self,
        job: &mut Job,
        kernel: Kernel,
        size: [u32; 2],
        params: &Params,
        state: &mut State,
    ) -> Result<Duration, RunError> {
        let start = Instant::now();
        self.write(params, state);
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            self.bind(&mut pass, kernel);
            pass.dispatch_workgroups(size[0], size[1], 1);
        }
        let words = self.readback.submit(&self.gpu, encoder, &[(&self.buffers.state, 0, STATE_WORDS)])?;
        *state = bytemuck::pod_read_unaligned(bytemuck::cast_slice(&words));
        job.stats.dispatches += 1;
        job.absorb(state);
        Ok(start.elapsed())
    }

    /// One invocation a pixel, a band of tile rows per submission.
    fn direct(&mut self, job: &mut Job, width: u32, height: u32, entry: u32) -> Result<(), RunError> {
        let mut cold = self.prepare(job, &[Kernel::Direct])?;
        let mut params = Params { width, height, entry, fuel: DIRECT_FUEL, ..self.params() };
        let mut first = 0;
        while first < height {
            let rows = self.direct_rows.min((height - first).div_ceil(8));
            (params.first, params.last) = (first, height.min(first + rows * 8));
            let mut state = State { culprit: NO_TASK, latest: NO_TASK, ..State::default() };
            let time = self.play(job, Kernel::Direct, [width.div_ceil(8), rows], &params, &mut state)?;
            if std::mem::take(&mut cold) {
                job.preparing += time;
            }
            self.check_limits(job)?;
            if state.flags & FLAG_LOOPS != 0 {
                return Err(self.loop_too_long(&State { culprit: entry, ..state }));
            }
            if state.flags & FLAG_EXHAUSTED != 0 {
                // The band is computed again with more fuel, in smaller bands if that took long.
                if rows == 1 && (time > SUBMISSION || params.fuel > i32::MAX / 8) {
                    return Err(RunError::LoopTooLong {
                        function: self.code.name(entry).to_owned(),
                        steps: params.fuel as u64,
                    });
                }
                params.fuel = params.fuel.saturating_mul(8);
                self.direct_rows = (rows / 8).max(1);
                continue;
            }
            first += rows * 8;
            self.config.progress.part((width, height), first.into(), height.into());
            let scale = (SUBMISSION.as_secs_f64() / time.as_secs_f64().max(1e-6)).clamp(0.1, 8.0);
            if rows == self.direct_rows || scale < 1.0 {
                self.direct_rows = ((f64::from(rows) * scale) as u32).clamp(1, 8192);
            }
        }
        Ok(())
    }

    /// Lanes draw pixels; what they cannot finish is left to the rounds.
    fn draw_pixels(&mut self, job: &mut Job, width: u32, height: u32, entry: u32) -> Result<(), RunError> {
        let mut cold = self.prepare(job, &[Kernel::DrawPixels])?;
        let total = width.div_ceil(8) * height.div_ceil(8) * 64;
        let mut pixel = 0;
        while pixel < total {
            let fuel = self.cap.min(self.pixel_fuel);
            let soft = (fuel - self.pixel_share).max(0);
            // Without breadth, a pixel at a time.
            let last = if self.lean { pixel + 1 } else { total };
            let params = Params { width, height, entry, last, fuel, soft, ..self.params() };
            let groups = self.groups_for(last - pixel);
            let mut state = self.begin(0);
            state.pixel = pixel;
            let time = self.play(job, Kernel::DrawPixels, [groups, 1], &params, &mut state)?;
            if std::mem::take(&mut cold) {
                job.preparing += time;
            }
            self.check_limits(job)?;
            if state.flags & FLAG_LOOPS != 0 {
                state.culprit = entry;
                self.lower_pixel_share(&state)?;
                continue;
            }
            if state.pixel < total && self.config.groups.is_none() {
                self.pixels_per_group = ((state.pixel - pixel) / groups).max(1);
                let scale = SUBMISSION.as_secs_f64() / time.as_secs_f64().max(1e-6);
                let groups = f64::from(self.pixel_groups) * scale.clamp(1.0 / 16.0, 8.0);
                self.pixel_groups = (groups as u32).clamp(self.gpu.parallel_groups(), MOST_GROUPS);
            }
            if self.finish_pixels(job, pixel, &mut state)? == Ended::Normal {
                pixel = state.pixel.min(last);
                self.config.progress.part((width, height), pixel.into(), total.into());
            }
        }
        Ok(())
    }

    /// Workgroups that draw so many pixels: no more than have something to do, as a start costs a few pixels' time.
    fn groups_for(&self, pixels: u32) -> u32 {
        let needed = (pixels / self.pixels_per_group).saturating_add(self.gpu.parallel_groups());
        if self.config.groups.is_some() { self.pixel_groups } else { needed.min(self.pixel_groups) }
    }

    /// After loops were cut short by the adapter: fewer pixels for a lane in one dispatch, and less of its last one.
    fn lower_pixel_share(&mut self, state: &State) -> Result<(), RunError> {
        if self.pixel_share == 1 && self.pixel_fuel <= LEAST_PIXEL_FUEL {
            return Err(self.loop_too_long(state));
        }
        self.pixel_share = (self.pixel_share / 4).max(1);
        self.pixel_fuel = (self.pixel_fuel / 4).max(LEAST_PIXEL_FUEL);
        Ok(())
    }

    /// Rounds for what lanes have published.
    fn finish_pixels(&mut self, job: &mut Job, before: u32, state: &mut State) -> Result<Ended, RunError> {
        let next = state.pixel;
        if state.published == 0 {
            if state.flags & FLAG_MEMORY != 0 && next == before && !self.grow(state) {
                return Err(self.out_of_memory(job.latest));
            }
            return Ok(Ended::Normal);
        }
        state.blocks = state.published;
        state.pairs = state.blocks.div_ceil(2);
        (state.published, state.flags, state.cut) = (0, 0, 0);
        self.permit(state);
        let ended = self.rewrite(job, state)?;
        state.pixel = next;
        Ok(ended)
    }

    /// The initial stream `index x y entry store` of every pixel, in parts of an eighth of the arena.
    fn stream_pixels(&mut self, job: &mut Job, width: u32, height: u32, entry: u32) -> Result<(), RunError> {
        let total = width.div_ceil(8) * height.div_ceil(8) * 64;
        let words = u64::from(self.buffers.capacity.blocks) * u64::from(self.shape.block);
        let mut part = (words / 8 / 5).max(1) as u32;
        let store = self.code.store();
        let mut stream = Vec::new();
        let mut first = 0;
        while first < total {
            stream.clear();
            let last = total.min(first.saturating_add(part));
            for (x, y) in (first..last).map(|index| pixel_at(index, width)) {
                if x < width && y < height {
                    let [dx, dy] = self.config.point;
                    let word = |position: u32, within: f32| (position as f32 + within).to_bits();
                    stream.extend([(y * width + x, false), (word(x, dx), false), (word(y, dy), false)]);
                    stream.extend([(entry, true), (store, true)]);
                }
            }
            let mut state = self.load(&stream)?;
            if self.rewrite(job, &mut state)? == Ended::Normal {
                first = last;
                self.config.progress.part((width, height), first.into(), total.into());
            } else if self.lean {
                part = 1;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::pixel_at;

    #[test]
    fn tiles_cover_every_pixel_once() {
        let (width, height) = (19u32, 10u32);
        let total = width.div_ceil(8) * height.div_ceil(8) * 64;
        let mut seen = vec![0; (width * height) as usize];
        for (x, y) in (0..total).map(|index| pixel_at(index, width)) {
            if x < width && y < height {
                seen[(y * width + x) as usize] += 1;
            }
        }
        assert!(seen.iter().all(|count| *count == 1));
    }
}
