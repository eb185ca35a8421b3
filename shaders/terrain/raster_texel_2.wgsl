alias TerrainTexel_2 = vec2<f32>;

fn terrain_texel_2(layer: TerrainLayer, texel: u32) -> vec2<f32> {
    let at = 2u * texel;
    return vec2<f32>(
        terrain_number(layer, at),
        terrain_number(layer, at + 1u),
    );
}
