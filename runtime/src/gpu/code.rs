//! What the rewriter is given: the program's code, and how to run it.

/// A compiled program. The WGSL functions are written for the window that `shaders/window.wgsl` declares.
#[derive(Clone, Debug, Default)]
pub struct Code {
    /// WGSL of `task_N`, `rewrite` and, if `has_shade`, `shade`.
    pub functions: String,
    pub has_shade: bool,
    /// `shade` is the entry fused whole, without tokens.
    pub fused: bool,
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
