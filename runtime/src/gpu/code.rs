//! What the rewriter is given: the program's code, and how to run it.

use std::time::Duration;

/// A compiled program. The WGSL functions are written for the window that `shaders/window.wgsl` declares.
#[derive(Clone, Debug, Default)]
pub struct Code {
    /// WGSL of `task_N`, `rewrite` and, if `has_shade`, `shade`.
    pub functions: String,
    pub has_shade: bool,
    /// Operands of each task; a task's id is its index.
    pub arities: Vec<u32>,
    /// The most tokens that one rewrite emits.
    pub longest_emission: u32,
    /// The source function of each task, for messages; then the entry's, to blame where no task is known.
    pub names: Vec<String>,
    /// WGSL of the scene: declarations of group 1 and intrinsics.
    pub prelude: String,
    /// Words of live parameters.
    pub live_words: u32,
}

impl Code {
    /// Id of the runtime's own task, which stores a pixel.
    pub fn store(&self) -> u32 {
        self.arities.len() as u32
    }

    pub fn name(&self, task: u32) -> &str {
        self.names.get(task as usize).or(self.names.last()).map_or("the program", String::as_str)
    }
}

/// How the stream is rewritten.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Rewriter {
    /// Expand while redexes are few, then let every lane go deep.
    #[default]
    Auto,
    /// Every redex once per round (or `depth` times): the paper's algorithm.
    Block,
    /// Every redex to its normal form by the lane that takes it.
    Lane,
}

#[derive(Clone, Debug)]
pub struct Config {
    pub rewriter: Rewriter,
    /// Rewrites of a redex in one round; overrides what the rewriter would choose.
    pub depth: Option<u32>,
    /// Words of a block; raised to what the program's longest call and emission need.
    pub block: u32,
    /// Lanes; none for the adapter's default.
    pub threads: Option<u32>,
    /// Most bytes that the arena may take.
    pub max_memory: u64,
    pub max_rewrites: Option<u64>,
    pub timeout: Duration,
    /// Leaves out the bounds checks that wgpu adds to shaders.
    pub trusted: bool,
}

impl Default for Config {
    fn default() -> Config {
        Config {
            rewriter: Rewriter::Auto,
            depth: None,
            block: 512,
            threads: None,
            max_memory: 1 << 30,
            max_rewrites: None,
            timeout: Duration::from_secs(60),
            trusted: true,
        }
    }
}
