//! What the scene takes on the device, and what of it is not made.

use ghyll_compiler::compile::Compiled;
use ghyll_compiler::front::Checked;
use ghyll_compiler::layout;
use ghyll_runtime::memory::size;
use ghyll_runtime::terrain::pyramid::levels;
use ghyll_runtime::terrain::wgsl::{Format, wgsl};
use ghyll_runtime::terrain::{Micro, Terrain};
use serde_json::{Value, json};

pub struct Resource {
    name: String,
    /// None where only the file tells.
    bytes: Option<u64>,
    made: bool,
}

impl Resource {
    pub fn text(&self) -> String {
        let bytes = self.bytes.map_or("as large as its file".to_owned(), size);
        match self.made {
            true => format!("{}: {bytes}", self.name),
            false => format!("{}: not made, which saves {bytes}", self.name),
        }
    }

    pub fn json(&self) -> Value {
        json!({ "name": self.name, "bytes": self.bytes, "made": self.made })
    }
}

/// Bytes of the average mipmap, but for a few.
fn means(terrain: &Terrain, number: u64) -> u64 {
    let (mut width, mut height) = (u64::from(terrain.width), u64::from(terrain.height));
    let mut nodes = 0;
    while width > 1 || height > 1 {
        (width, height) = (width.div_ceil(2), height.div_ceil(2));
        nodes += width * height;
    }
    nodes * number
}

/// Resources of a program over a field, in the order in which they are made.
pub fn resources(checked: &Checked, compiled: &Compiled, terrain: &Terrain) -> Vec<Resource> {
    let module = &checked.module;
    let format = Format::of(terrain);
    let backs = [&compiled.back].into_iter().chain(compiled.bakes.iter().map(|bake| &bake.back));
    let intrinsics: Vec<_> = backs.flat_map(|back| back.wgsl.intrinsics.clone()).collect();
    let uses = wgsl(&intrinsics, format).uses;
    let library = module.functions.iter().any(|f| f.library && f.name != "Option");
    if intrinsics.is_empty() && !library && module.rasters.is_empty() {
        return Vec::new();
    }
    let (width, height) = (u64::from(terrain.width), u64::from(terrain.height));
    let number = if format == Format::I16 { 2 } else { 4 };
    let pyramid = u64::from(levels(terrain.width, terrain.height).1) * number;
    let fixed = |name: &str, bytes: u64, made| Resource { name: name.into(), bytes: Some(bytes), made };
    let mut all = vec![
        fixed("heights", (width * height * number).next_multiple_of(4), uses.samples),
        fixed("maximum mipmap", pyramid.max(4), uses.bounds),
        fixed("minimum mipmap", pyramid.max(4), uses.floors),
        fixed("average mipmap", means(terrain, number), uses.means),
        fixed("micro-heightfield", 4 * Micro::shipped().words().len() as u64, uses.micro),
    ];
    for (at, raster) in module.rasters.iter().enumerate() {
        let made = compiled.rasters.iter().any(|id| id.0 as usize == at);
        all.push(Resource { name: format!("raster `{}`", raster.name), bytes: None, made });
    }
    for (at, function) in module.functions.iter().enumerate().filter(|(_, f)| f.attributes.bake) {
        let components = layout::scalars(module, &function.result).map_or(0, |scalars| scalars.len() as u64);
        let made = compiled.bakes.iter().any(|bake| bake.function.0 as usize == at);
        all.push(fixed(&format!("bake `{}`", function.name), 4 * components * width * height, made));
    }
    all
}
