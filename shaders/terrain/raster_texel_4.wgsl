alias TerrainTexel_4 = vec4<f32>;

fn terrain_texel_4(layer: TerrainLayer, texel: u32) -> vec4<f32> {
    let at = 4u * texel;
    return vec4<f32>(
        terrain_number(layer, at),
        terrain_number(layer, at + 1u),
        terrain_number(layer, at + 2u),
        terrain_number(layer, at + 3u),
    );
}
