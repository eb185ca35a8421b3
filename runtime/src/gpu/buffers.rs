//! The rewriter's buffers and how they grow.

use super::layout::{PAIR_BYTES, Params, State};
use super::shape::Shape;
use crate::error::RunError;
use crate::memory::Memory;

const WORD: u64 = 4;
/// The least buffer.
const EMPTY: u64 = 16;

/// Sizes in units of their stages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capacity {
    /// Blocks of the arena.
    pub blocks: u32,
    pub records: u32,
}

/// Arena to begin with, and what the records of one round may take.
const ARENA_BYTES: u64 = 16 << 20;
const RECORD_BYTES: u64 = 24 << 20;
/// Least arena: a lane's pages, its round's splice and some stream.
const LEAST_BLOCKS: u32 = 24;
const LEAST_RECORDS: u32 = 8;
const MOST_RECORDS: u64 = 1 << 18;

impl Capacity {
    const LEAST: Capacity = Capacity { blocks: LEAST_BLOCKS, records: LEAST_RECORDS };

    /// What to begin with where `limit` bytes are allowed for it and for `fixed`.
    pub fn within(limit: u64, fixed: Memory, shape: &Shape) -> Result<Capacity, RunError> {
        let least = Capacity::LEAST.memory(shape);
        let needed = Memory { stream: least.stream, records: least.records, ..fixed };
        if needed.total() > limit {
            return Err(RunError::TooLittleMemory { needed, limit });
        }
        let free = limit - fixed.total();
        let records = RECORD_BYTES.min(free / 4).min(free - least.stream) / record_bytes(shape);
        let records = records.clamp(u64::from(LEAST_RECORDS), MOST_RECORDS) as u32;
        let capacity = Capacity { records, ..Capacity::LEAST };
        let stream = (free - capacity.memory(shape).records - 2 * PAIR_BYTES).min(ARENA_BYTES);
        let blocks = stream / block_bytes(shape);
        Ok(Capacity { blocks: blocks.max(u64::from(LEAST_BLOCKS)) as u32, records })
    }

    /// Blocks that the arena may grow to while the old one is still held, within `limit` bytes for all and with `others` in
    /// use beside the stream.
    pub fn growth(&self, limit: u64, others: u64, shape: &Shape) -> u32 {
        let most = limit.saturating_sub(others) / block_bytes(shape);
        let most = most.saturating_sub(u64::from(self.blocks)).min(u64::from(self.blocks) * 4);
        most.max(u64::from(self.blocks)).min(1 << 28) as u32
    }

    pub fn arena_bytes(&self, shape: &Shape) -> u64 {
        u64::from(self.blocks) * u64::from(shape.stride()) * WORD
    }

    pub fn memory(&self, shape: &Shape) -> Memory {
        Memory {
            stream: u64::from(self.blocks) * block_bytes(shape) + 2 * PAIR_BYTES,
            records: u64::from(self.records) * record_bytes(shape),
            ..Memory::default()
        }
    }
}

/// A block with its places in the lists and its half of a pair.
fn block_bytes(shape: &Shape) -> u64 {
    u64::from(shape.stride()) * WORD + list_words(1) * WORD + PAIR_BYTES / 2
}

fn record_bytes(shape: &Shape) -> u64 {
    u64::from(shape.record()) * WORD
}

pub struct Buffers {
    pub capacity: Capacity,
    pub params: wgpu::Buffer,
    pub state: wgpu::Buffer,
    pub arena: wgpu::Buffer,
    pub lists: wgpu::Buffer,
    pub pairs: wgpu::Buffer,
    pub records: wgpu::Buffer,
    pub image: wgpu::Buffer,
    pub tables: wgpu::Buffer,
    /// Indirect sizes of execute.
    pub lane_groups: wgpu::Buffer,
    /// Indirect sizes of decode and splice.
    pub pair_groups: wgpu::Buffer,
}

fn storage(device: &wgpu::Device, label: &str, bytes: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: bytes.max(EMPTY).next_multiple_of(WORD),
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    })
}

fn indirect(device: &wgpu::Device, label: &str, bytes: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: bytes,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::INDIRECT,
        mapped_at_creation: false,
    })
}

/// Words of the list buffer: two order lists, the free stack, the blocks given back.
fn list_words(blocks: u32) -> u64 {
    6 * u64::from(blocks)
}

impl Buffers {
    pub fn new(device: &wgpu::Device, shape: &Shape, capacity: Capacity, table_words: u64) -> Buffers {
        let params = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("params"),
            size: size_of::<Params>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Buffers {
            capacity,
            params,
            state: storage(device, "state", size_of::<State>() as u64),
            arena: storage(device, "arena", capacity.arena_bytes(shape)),
            lists: storage(device, "lists", list_words(capacity.blocks) * WORD),
            pairs: storage(device, "pairs", (u64::from(capacity.blocks) / 2 + 2) * PAIR_BYTES),
            records: storage(device, "records", u64::from(capacity.records) * record_bytes(shape)),
            image: storage(device, "image", 0),
            tables: storage(device, "tables", table_words * WORD),
            lane_groups: indirect(device, "lane groups", 12),
            pair_groups: indirect(device, "pair groups", 24),
        }
    }

    pub fn memory(&self, shape: &Shape) -> Memory {
        let image = if self.image.size() > EMPTY { self.image.size() } else { 0 };
        Memory { image, ..self.capacity.memory(shape) }
    }

    /// Makes room for an image; true if the buffer is a new one.
    pub fn fit_image(&mut self, device: &wgpu::Device, bytes: u64) -> bool {
        if self.image.size() >= bytes {
            return false;
        }
        self.image = storage(device, "image", bytes);
        true
    }

    /// Smaller buffers for the streams to come.
    pub fn shrink(&mut self, device: &wgpu::Device, shape: &Shape, capacity: Capacity) {
        let table_words = self.tables.size() / WORD;
        let new = Buffers::new(device, shape, capacity, table_words);
        let old = std::mem::replace(self, new);
        (self.tables, self.image) = (old.tables, old.image);
    }

    /// Moves the stream into an arena of `blocks` blocks. The free stack's new entries are the host's to write.
    pub fn grow(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, shape: &Shape, blocks: u32) {
        let old = self.capacity.blocks;
        self.capacity.blocks = blocks;
        let arena = storage(device, "arena", self.capacity.arena_bytes(shape));
        let lists = storage(device, "lists", list_words(blocks) * WORD);
        let mut encoder = device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(&self.arena, 0, &arena, 0, self.arena.size());
        // Two order lists of 2 words an entry, the free stack, the blocks given back.
        for (segment, words) in [(0, 2), (2, 2), (4, 1), (5, 1)] {
            let (from, to) = (segment * u64::from(old), segment * u64::from(blocks));
            encoder.copy_buffer_to_buffer(
                &self.lists,
                from * WORD,
                &lists,
                to * WORD,
                words * u64::from(old) * WORD,
            );
        }
        queue.submit([encoder.finish()]);
        self.arena = arena;
        self.lists = lists;
        self.pairs = storage(device, "pairs", (u64::from(blocks) / 2 + 2) * PAIR_BYTES);
    }

    /// Byte offset of an entry of the free stack.
    pub fn free_offset(&self, index: u32) -> u64 {
        (4 * u64::from(self.capacity.blocks) + u64::from(index)) * WORD
    }
}
