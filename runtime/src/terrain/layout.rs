//! The scene as the shaders see it (`shaders/terrain/scene.wgsl`); the twin reads the same record. A test compares
//! the layouts.

use super::pyramid::MAX_LEVELS;
use bytemuck::{Pod, Zeroable};

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct SceneUniform {
    /// Metres between samples.
    pub spacing: [f32; 2],
    pub inverse_spacing: [f32; 2],
    /// Lowest and highest z in metres, exaggeration included.
    pub relief: [f32; 2],
    /// The same in raw units.
    pub raw_relief: [f32; 2],
    /// z is `raw * z_scale + z_offset`.
    pub z_scale: f32,
    pub z_offset: f32,
    pub z_inverse_scale: f32,
    /// Level of the pyramid that is one node.
    pub top: u32,
    /// Samples in a row, rows.
    pub size: [u32; 2],
    /// Most nodes a ray can visit.
    pub fuel: u32,
    /// [`super::Projection`] by its number.
    pub projection: u32,
    pub eye: [f32; 3],
    pub near: f32,
    /// Unit vector of the line of sight.
    pub forward: [f32; 3],
    pub far: f32,
    /// From one pixel to the next, at distance 1 of a perspective camera; in x of a panorama as a part of a turn.
    pub across: [f32; 3],
    /// 0, which a driver's compiler does not know.
    pub zero: u32,
    pub down: [f32; 3],
    /// 1 if the field has voids.
    pub voids: u32,
    /// Towards the sun, unit.
    pub sun_dir: [f32; 3],
    pub padding2: u32,
    pub sun_color: [f32; 3],
    pub padding3: u32,
    /// The picture's middle in pixels.
    pub middle: [f32; 2],
    /// A pixel's width at distance t is x + y t.
    pub pixel_width: [f32; 2],
    /// Offset, width, height of each level of the pyramid.
    pub levels: [[u32; 4]; MAX_LEVELS],
}

impl SceneUniform {
    /// Cells in a row, rows of cells.
    pub fn cells(&self) -> [u32; 2] {
        [self.size[0] - 1, self.size[1] - 1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::mem::offset_of;

    macro_rules! offsets {
        ($($field:ident)*) => { vec![$((stringify!($field), offset_of!(SceneUniform, $field) as u32)),*] };
    }

    fn shader_offsets(text: &str) -> (Vec<(String, u32)>, u32) {
        let module = wgpu::naga::front::wgsl::parse_str(text).unwrap();
        let found = module.types.iter().find(|(_, t)| t.name.as_deref() == Some("TerrainScene")).unwrap();
        let wgpu::naga::TypeInner::Struct { members, span } = &found.1.inner else { panic!("not a struct") };
        (members.iter().map(|m| (m.name.clone().unwrap(), m.offset)).collect(), *span)
    }

    fn rust_offsets() -> (Vec<(String, u32)>, u32) {
        let all = offsets![spacing inverse_spacing relief raw_relief z_scale z_offset z_inverse_scale top size
            fuel projection eye near forward far across zero down voids sun_dir padding2 sun_color
            padding3 middle pixel_width levels];
        (all.into_iter().map(|(n, o)| (n.to_owned(), o)).collect(), size_of::<SceneUniform>() as u32)
    }

    const SHADER: &str = include_str!("../../../shaders/terrain/scene.wgsl");

    #[test]
    fn the_shader_has_the_same_layout() {
        assert_eq!(shader_offsets(SHADER), rust_offsets());
    }

    #[test]
    fn a_moved_member_is_noticed() {
        let moved = SHADER.replace("    spacing: vec2<f32>,", "    moved: u32, spacing: vec2<f32>,");
        assert_ne!(moved, SHADER);
        assert_ne!(shader_offsets(&moved), rust_offsets());
    }
}
