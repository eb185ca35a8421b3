alias TerrainTexel_1 = f32;

fn terrain_texel_1(layer: TerrainLayer, texel: u32) -> f32 {
    return terrain_number(layer, texel);
}
