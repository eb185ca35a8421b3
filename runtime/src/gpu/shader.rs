//! Assembles the kernels from `shaders/` and the generated functions.

use super::code::Code;
use super::hand;
use super::shape::{Shape, Windows};
use super::template::fill;
use crate::config::Config;
use crate::error::RunError;

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

/// Tasks up to which the arities are part of the code; beyond, they are read from a table.
const INLINE_TASKS: usize = 32;

/// Reads the arity of `task` from memory.
const ARITY: &str = "return tables[task];";

/// WGSL that returns the arity of `task`: eight to a word where they fit, as a read from memory is dear.
fn arity(shape: &Shape, code: &Code) -> String {
    let mut arities = code.arities.clone();
    arities.push(shape.components + 1);
    if arities.len() > INLINE_TASKS || arities.iter().any(|arity| *arity > 15) {
        return ARITY.to_owned();
    }
    let pack = |group: &[u32]| group.iter().rev().fold(0u32, |word, arity| word << 4 | arity);
    let mut text = "var word = 0u;".to_owned();
    for (index, group) in arities.chunks(8).enumerate() {
        text += &format!(" word = select(word, {:#x}u, task / 8u == {index}u);", pack(group));
    }
    text + " return (word >> (task % 8u * 4u)) & 15u;"
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
    let (memory, slot) = match shape.windows {
        Windows::Private => ("var<private> window: array<u32, WINDOW>;", "index"),
        Windows::Workgroup => ("var<workgroup> window: array<u32, LANES * WINDOW>;", "index * LANES + lane"),
    };
    let text = fill(&fill(WINDOW, "MEMORY", memory)?, "SLOT", slot)?;
    let text = fill(&text, "HAND", &hand::functions(shape)?)?;
    fill(&text, "MOVES", &moves(shape.segment))
}

/// The whole WGSL of a kernel.
pub fn source(kernel: Kernel, shape: &Shape, code: &Code) -> Result<String, RunError> {
    let header = shape.header(kernel.runs_code());
    let arity = if kernel.runs_code() { arity(shape, code) } else { ARITY.to_owned() };
    let stream = fill(STREAM, "ARITY", &arity)?;
    let mut parts: Vec<&str> = vec![&header, &stream];
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

/// Entry point and WGSL of the kernel that a hardware adapter runs the program's functions in, with the usual
/// configuration; `components` is 0 without an image.
pub fn of_program(code: &Code, components: u32) -> Result<(&'static str, String), RunError> {
    let kernel = match components {
        0 => Kernel::Execute,
        _ if code.has_shade => Kernel::Direct,
        _ => Kernel::DrawPixels,
    };
    let shape = Shape::new(code, &Config::default(), components, false)?;
    Ok((kernel.name(), source(kernel, &shape, code)?))
}
