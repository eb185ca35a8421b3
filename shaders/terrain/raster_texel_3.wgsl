alias TerrainTexel_3 = vec3<f32>;

fn terrain_texel_3(layer: TerrainLayer, texel: u32) -> vec3<f32> {
    let at = 3u * texel;
    return vec3<f32>(
        terrain_number(layer, at),
        terrain_number(layer, at + 1u),
        terrain_number(layer, at + 2u),
    );
}
