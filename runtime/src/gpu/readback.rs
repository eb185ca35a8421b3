//! Reading buffers back.

use std::sync::mpsc;
use std::time::{Duration, Instant};

use super::device::Gpu;
use crate::error::RunError;

/// Words to read: buffer, first word, number.
pub type Range<'a> = (&'a wgpu::Buffer, u64, usize);

/// A staging buffer that is kept between readbacks.
#[derive(Default)]
pub struct Readback {
    buffer: Option<wgpu::Buffer>,
    /// Until when the adapter must have answered.
    deadline: Option<Deadline>,
}

#[derive(Clone, Copy)]
struct Deadline {
    started: Instant,
    at: Instant,
}

/// Time after a run's own that an adapter has for an answer: for the driver's compiling, which does not count as the program's
/// time. Between two submissions the run itself looks at the clock, and can name the function.
const COMPILING: Duration = Duration::from_secs(30);

impl Readback {
    /// What the state of a run takes.
    pub const LEAST: u64 = 256;

    /// Waits until so long after `started` at most.
    pub fn wait_for(&mut self, started: Instant, timeout: Duration) {
        let at = timeout.checked_add(COMPILING).and_then(|time| started.checked_add(time));
        self.deadline = at.map(|at| Deadline { started, at });
    }

    /// What reading so many bytes takes.
    pub fn needed(bytes: u64) -> u64 {
        bytes.next_multiple_of(Self::LEAST)
    }

    pub fn bytes(&self) -> u64 {
        self.buffer.as_ref().map_or(Self::LEAST, wgpu::Buffer::size)
    }

    fn buffer(&mut self, device: &wgpu::Device, bytes: u64) -> &wgpu::Buffer {
        if self.buffer.as_ref().is_some_and(|buffer| buffer.size() < bytes) {
            self.buffer = None;
        }
        self.buffer.get_or_insert_with(|| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("readback"),
                size: Self::needed(bytes),
                usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        })
    }

    /// Submits the encoder with copies of the ranges and waits for their words, one range after the other.
    pub fn submit(
        &mut self,
        gpu: &Gpu,
        mut encoder: wgpu::CommandEncoder,
        ranges: &[Range],
    ) -> Result<Vec<u32>, RunError> {
        let deadline = self.deadline;
        let bytes: u64 = ranges.iter().map(|range| range.2 as u64 * 4).sum();
        let buffer = self.buffer(&gpu.device, bytes.max(4));
        let mut at = 0;
        for (source, first, words) in ranges {
            let length = *words as u64 * 4;
            if length > 0 {
                encoder.copy_buffer_to_buffer(source, first * 4, buffer, at, length);
            }
            at += length;
        }
        gpu.queue.submit([encoder.finish()]);
        if bytes == 0 {
            return wait(gpu, deadline).map(|()| Vec::new());
        }
        let (sender, receiver) = mpsc::channel();
        buffer.map_async(wgpu::MapMode::Read, 0..bytes, move |result| {
            // The receiver is gone only if the wait below has failed already.
            let _ = sender.send(result);
        });
        if let Err(error) = wait(gpu, deadline) {
            if matches!(error, RunError::Unanswered { .. }) {
                abandon(gpu, self.buffer.take());
            }
            return Err(error);
        }
        let lost = |text: String| RunError::Device(gpu.lost().unwrap_or(text));
        let mapped = receiver.recv().map_err(|error| lost(error.to_string()))?;
        mapped.map_err(|error| lost(error.to_string()))?;
        let view = buffer.get_mapped_range(0..bytes).map_err(|error| lost(error.to_string()))?;
        let result = bytemuck::pod_collect_to_vec(&view);
        drop(view);
        buffer.unmap();
        Ok(result)
    }

    pub fn read(&mut self, gpu: &Gpu, ranges: &[Range]) -> Result<Vec<u32>, RunError> {
        let encoder = gpu.device.create_command_encoder(&Default::default());
        self.submit(gpu, encoder, ranges)
    }
}

fn wait(gpu: &Gpu, deadline: Option<Deadline>) -> Result<(), RunError> {
    let left = deadline.map(|deadline| deadline.at.saturating_duration_since(Instant::now()));
    let polled = gpu.device.poll(wgpu::PollType::Wait { submission_index: None, timeout: left });
    match (gpu.lost(), polled, deadline) {
        (Some(text), ..) => Err(RunError::Device(text)),
        (None, Err(wgpu::PollError::Timeout), Some(deadline)) => {
            Err(RunError::Unanswered { seconds: deadline.started.elapsed().as_secs_f64() })
        }
        (None, Err(error), _) => Err(RunError::Device(error.to_string())),
        (None, Ok(_), _) => Ok(()),
    }
}

/// Keeps a device for as long as the process lives: letting go of one waits for what it was given to do.
fn abandon(gpu: &Gpu, buffer: Option<wgpu::Buffer>) {
    std::mem::forget((gpu.clone(), buffer));
}
