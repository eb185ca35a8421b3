// Between two texels; at the first one its value exactly, whatever the other is.
fn terrain_between_SURFACE(a: TerrainTexel_SURFACE, b: TerrainTexel_SURFACE, t: f32) -> TerrainTexel_SURFACE {
    return select(a * (1.0 - t) + b * t, a, t == 0.0);
}

fn raster_SURFACE(slot: u32, x: f32, y: f32) -> TerrainTexel_SURFACE {
    let layer = terrain_layer(slot);
    let at = terrain_texels(layer, x, y);
    let north = terrain_between_SURFACE(terrain_texel_SURFACE(layer, at.nw), terrain_texel_SURFACE(layer, at.ne), at.u);
    let south = terrain_between_SURFACE(terrain_texel_SURFACE(layer, at.sw), terrain_texel_SURFACE(layer, at.se), at.u);
    return terrain_between_SURFACE(north, south, at.v);
}
