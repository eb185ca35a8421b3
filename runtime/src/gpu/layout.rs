//! Every struct shared with `shaders/stream.wgsl`, and nothing else. A test compares them with what naga reads.

use bytemuck::{Pod, Zeroable};

pub const RUNNING: u32 = 0;
pub const DONE: u32 = 1;
pub const NEEDS_MEMORY: u32 = 2;
pub const STUCK: u32 = 3;

pub const FLAG_MEMORY: u32 = 1;
pub const FLAG_EXHAUSTED: u32 = 2;
pub const FLAG_LOOPS: u32 = 4;

/// No task, no block.
pub const NO_TASK: u32 = 0xffff_ffff;
/// Function tokens from here on are suspended lanes.
pub const RESUME: u32 = 0x4000_0000;

/// Bytes of a `Pair`, which only the shaders touch.
pub const PAIR_BYTES: u64 = 48;

macro_rules! shared {
    ($(#[$meta:meta])* $name:ident { $($field:ident: $type:ty),* $(,)? }) => {
        $(#[$meta])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
        pub struct $name { $(pub $field: $type),* }

        #[cfg(test)]
        impl $name {
            /// Field names with their offsets.
            pub const FIELDS: &'static [(&'static str, usize)] =
                &[$((stringify!($field), std::mem::offset_of!($name, $field))),*];
        }
    };
}

shared! {
    /// Sizes and budgets of a submission.
    Params {
        capacity: u32,
        record_capacity: u32,
        fuel: i32,
        depth: u32,
        threshold: u32,
        groups: u32,
        width: u32,
        height: u32,
        first: u32,
        last: u32,
        entry: u32,
        soft: i32,
        parallel: u32,
        cap: i32,
        canary: u32,
        most_turns: u32,
        floor: u32,
        may_grow: u32,
        zero: u32,
        point_x: f32,
        point_y: f32,
    }
}

shared! {
    /// The stream's state between rounds.
    State {
        status: u32,
        blocks: u32,
        list: u32,
        parity: u32,
        pairs: u32,
        limit: u32,
        returning: u32,
        depth: u32,
        previous: u32,
        idle: u32,
        rounds: u32,
        moved: u32,
        peak: u32,
        rewrites_before: u32,
        full: u32,
        spliced: u32,
        free: i32,
        freed: u32,
        records: u32,
        redexes: u32,
        drawn: u32,
        functions: u32,
        rewrites: u32,
        flags: u32,
        culprit: u32,
        latest: u32,
        suspended: u32,
        cut: u32,
        pixel: u32,
        published: u32,
        lean: u32,
        sole: u32,
        next_sole: u32,
        chosen: u32,
        merges: u32,
    }
}
