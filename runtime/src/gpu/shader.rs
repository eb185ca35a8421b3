//! Assembles the kernels from `shaders/` and the generated functions.

use super::code::Code;
use super::error::RunError;
use super::shape::Shape;
use super::template::fill;

/// A kernel: a WGSL entry point with all it needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Kernel {
    Decode,
    Execute,
    Allocate,
    Splice,
    DrawPixels,
    Direct,
}

const STREAM: &str = include_str!("../../../shaders/stream.wgsl");
const PAIR: &str = include_str!("../../../shaders/pair.wgsl");
const WINDOW: &str = include_str!("../../../shaders/window.wgsl");
const FAR: &str = include_str!("../../../shaders/far.wgsl");
const LANE: &str = include_str!("../../../shaders/lane.wgsl");
const STORE: &str = include_str!("../../../shaders/store.wgsl");
/// Without an image every task is the compiler's.
const NO_STORE: &str = "fn rewrite_any(task: u32) {\n    rewrite(task);\n}\n";

impl Kernel {
    #[cfg(test)]
    pub const ALL: [Kernel; 6] = [
        Kernel::Decode,
        Kernel::Execute,
        Kernel::Allocate,
        Kernel::Splice,
        Kernel::DrawPixels,
        Kernel::Direct,
    ];

    /// Name of the entry point, of the stage and of the pipeline.
    pub fn name(self) -> &'static str {
        match self {
            Kernel::Decode => "decode",
            Kernel::Execute => "execute",
            Kernel::Allocate => "allocate",
            Kernel::Splice => "splice",
            Kernel::DrawPixels => "draw_pixels",
            Kernel::Direct => "direct",
        }
    }

    fn text(self) -> &'static str {
        match self {
            Kernel::Decode => include_str!("../../../shaders/decode.wgsl"),
            Kernel::Execute => include_str!("../../../shaders/execute.wgsl"),
            Kernel::Allocate => include_str!("../../../shaders/allocate.wgsl"),
            Kernel::Splice => include_str!("../../../shaders/splice.wgsl"),
            Kernel::DrawPixels => include_str!("../../../shaders/pixels.wgsl"),
            Kernel::Direct => include_str!("../../../shaders/direct.wgsl"),
        }
    }

    /// Whether the kernel holds the program's functions.
    pub fn runs_code(self) -> bool {
        matches!(self, Kernel::Execute | Kernel::DrawPixels | Kernel::Direct)
    }
}

/// Words that are moved by straight code before a loop takes over.
const UNROLLED: u32 = 4;

/// WGSL that moves `count` words, at most `most`. Segments are short, so this is faster than a loop.
fn moves(most: u32) -> String {
    let mut text: String =
        (0..most.min(UNROLLED)).map(|i| format!("if (count > {i}u) {{ move_word(); }}\n    ")).collect();
    if most > UNROLLED {
        text += &format!("for (var index = {UNROLLED}u; index < count; index += 1u) {{ move_word(); }}");
    }
    text
}

fn window(shape: &Shape) -> Result<String, RunError> {
    let slot = if shape.interleaved { "index * LANES + lane" } else { "lane * WINDOW + index" };
    let guard = if shape.can_exhaust { "if (exhausted) {\n        return;\n    }" } else { "" };
    let text = fill(&fill(WINDOW, "SLOT", slot)?, "GUARD", guard)?;
    fill(&text, "MOVES", &moves(shape.emission.saturating_sub(2)))
}

/// The whole WGSL of a kernel.
pub fn source(kernel: Kernel, shape: &Shape, code: &Code) -> Result<String, RunError> {
    let header = shape.header();
    let mut parts: Vec<&str> = vec![&header, STREAM];
    let window = window(shape)?;
    let store = if shape.components == 0 { NO_STORE } else { STORE };
    match kernel {
        Kernel::Decode | Kernel::Splice => parts.push(PAIR),
        Kernel::Allocate => {}
        Kernel::Execute | Kernel::DrawPixels => {
            parts.extend([PAIR, &window, &code.prelude, &code.functions, store, FAR, LANE]);
        }
        Kernel::Direct => parts.extend([window.as_str(), &code.prelude, &code.functions]),
    }
    parts.push(kernel.text());
    Ok(parts.join("\n"))
}
