//! What the rewriter is given: the program's code, and how to run it.

use std::fmt::{self, Debug, Formatter};
use std::sync::Arc;

use ghyll_compiler::table::Widths;

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
    /// How many words of it go where.
    pub widths: Widths,
    /// The source function of each task, for messages; then the entry's, to blame where no task is known.
    pub names: Vec<String>,
    /// WGSL of the scene: declarations of group 1 and intrinsics.
    pub prelude: String,
    /// Words of live parameters.
    pub live_words: u32,
    /// What `constant_word` reads.
    pub constants: Vec<u32>,
    /// For an adapter or a time limit that does not let a fused loop end.
    pub suspendable: Option<Suspendable>,
}

/// Makes the same program with its long loops as tasks, which a lane can leave and take up again. The entry keeps its
/// number and operands; streams that hold other tasks do not fit it.
#[derive(Clone)]
pub struct Suspendable(Arc<dyn Fn() -> Code + Send + Sync>);

impl Suspendable {
    pub fn new(make: impl Fn() -> Code + Send + Sync + 'static) -> Suspendable {
        Suspendable(Arc::new(make))
    }

    pub fn code(&self) -> Code {
        (self.0)()
    }
}

impl Debug for Suspendable {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        f.write_str("Suspendable")
    }
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
