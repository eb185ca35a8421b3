//! How a stream is to be rewritten, and what is known afterwards.

use std::time::Duration;

use crate::memory::Memory;
use crate::progress::Progress;

/// Strategy of the rewriter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rewriter {
    /// Breadth first until there are enough redexes, then lanes, depth first.
    #[default]
    Auto,
    /// Rounds over blocks of the stream, as in the paper.
    Block,
    /// One window per pixel or program, rewritten depth first.
    Lane,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    pub rewriter: Rewriter,
    /// Rewrites that a lane makes before its window is published; none lets the rewriter choose.
    pub depth: Option<u32>,
    /// Tokens in a block; raised to what the longest arity needs.
    pub block: u32,
    /// Threads of the twin; on the GPU invocations in a workgroup of lanes.
    pub threads: Option<usize>,
    /// On the GPU: workgroups of lanes in one dispatch.
    pub groups: Option<u32>,
    /// Bytes for all that a run keeps: [`Memory`].
    pub max_memory: u64,
    pub max_rewrites: Option<u64>,
    pub timeout: Duration,
    /// On the GPU: leaves out the checks that wgpu adds to shaders.
    pub trusted: bool,
    /// Where in a pixel its value is taken, from its top left corner.
    pub point: [f32; 2],
    /// Told how far a run has come.
    pub progress: Progress,
}

impl Default for Config {
    fn default() -> Config {
        Config {
            rewriter: Rewriter::Auto,
            depth: None,
            block: 512,
            threads: None,
            groups: None,
            max_memory: 1 << 30,
            max_rewrites: None,
            timeout: Duration::from_secs(60),
            trusted: true,
            point: [0.5, 0.5],
            progress: Progress::default(),
        }
    }
}

/// Counts and times of one run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stats {
    pub rounds: u64,
    /// Function tokens rewritten; an iteration of a tail call loop counts as one.
    pub rewrites: u64,
    /// The GPU computed the picture without a stream: one invocation a pixel. There are no rewrites to count.
    pub direct: bool,
    /// Tokens written by the splice stage of all rounds.
    pub tokens_moved: u64,
    /// The longest stream between two rounds, in tokens.
    pub longest_stream: u64,
    /// Bytes at their greatest.
    pub memory: Memory,
    pub decode: Duration,
    pub execute: Duration,
    pub allocate: Duration,
    pub splice: Duration,
    /// On the GPU.
    pub dispatches: u64,
    pub submissions: u64,
    /// Lanes that ran out of window or fuel and were continued later.
    pub suspended: u64,
    /// Making pipelines, within the total.
    pub compiling: Duration,
    /// Evaluating baked functions before the first picture, not within the total.
    pub baking: Duration,
    /// The whole run.
    pub total: Duration,
}

impl Stats {
    /// The stages of all rounds with their times. None on the GPU, where they run in one submission, and without rounds.
    pub fn stages(&self) -> Option<[(&'static str, Duration); 4]> {
        let stages = [
            ("decode", self.decode),
            ("execute", self.execute),
            ("allocate", self.allocate),
            ("splice", self.splice),
        ];
        stages.iter().any(|(_, time)| !time.is_zero()).then_some(stages)
    }
}
