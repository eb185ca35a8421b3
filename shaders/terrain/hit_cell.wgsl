// Cells that a ray comes near to, by the bicubic surface's bounds alone.
const TERRAIN_OVERSHOOT_cell: f32 = 0.28125;

fn terrain_top_cell(index: u32) -> f32 {
    return terrain_crest(index);
}

fn terrain_hit_cell(ray: TerrainRay, node: vec2<i32>, entry: f32, out: f32, z: f32, z_out: f32) -> vec2<f32> {
    return vec2<f32>(entry, 0.0);
}
