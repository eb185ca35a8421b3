//! Reading buffers back.

use std::sync::mpsc;

use super::device::Gpu;
use crate::error::RunError;

/// Words to read: buffer, first word, number.
pub type Range<'a> = (&'a wgpu::Buffer, u64, usize);

/// A staging buffer that is kept between readbacks.
#[derive(Default)]
pub struct Readback {
    buffer: Option<wgpu::Buffer>,
}

impl Readback {
    /// What the state of a run takes.
    pub const LEAST: u64 = 256;

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
            return wait(gpu).map(|()| Vec::new());
        }
        let (sender, receiver) = mpsc::channel();
        buffer.map_async(wgpu::MapMode::Read, 0..bytes, move |result| {
            // The receiver is gone only if the wait below has failed already.
            let _ = sender.send(result);
        });
        wait(gpu)?;
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

fn wait(gpu: &Gpu) -> Result<(), RunError> {
    let polled = gpu.device.poll(wgpu::PollType::wait_indefinitely());
    match (gpu.lost(), polled) {
        (Some(text), _) => Err(RunError::Device(text)),
        (None, Err(error)) => Err(RunError::Device(error.to_string())),
        (None, Ok(_)) => Ok(()),
    }
}
