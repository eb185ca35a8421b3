//! What the runtime makes of a program, for people and other tools: the shader in several languages, and a drawing.

mod drawing;
mod translate;

pub use drawing::{DrawError, MOST_DRAWN, drawing};
pub use translate::{Language, translate};

use crate::error::RunError;
use crate::gpu;
use crate::machine::Job;
use crate::terrain::wgsl::{self, Format};
use ghyll_compiler::compile::EntryKind;

/// A WGSL module with one entry point.
#[derive(Clone, Debug)]
pub struct Shader {
    pub entry_point: &'static str,
    pub wgsl: String,
}

impl Job<'_> {
    /// The kernel that holds the program's functions, as hardware adapters are given it. Without a scene its samples
    /// are taken for 16-bit ones.
    pub fn shader(&self) -> Result<Shader, RunError> {
        let back = &self.compiled.back;
        let format = self.scene.map_or(Format::I16, |scene| Format::of(scene.terrain()));
        let prelude = match back.wgsl.intrinsics.is_empty() {
            true => String::new(),
            false => wgsl::wgsl(&back.wgsl.intrinsics, format).text,
        };
        let components = match self.compiled.kind {
            EntryKind::Value => 0,
            _ => self.compiled.result_words(&self.checked.module),
        };
        let code = self.code(self.compiled.entry, back, prelude);
        let (entry_point, wgsl) = gpu::shader(&code, components)?;
        Ok(Shader { entry_point, wgsl })
    }
}
