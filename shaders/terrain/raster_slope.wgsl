// Slopes of each component by x and by y, and their second derivative by both.
struct TerrainSlope_SURFACE {
    x: TerrainTexel_SURFACE,
    y: TerrainTexel_SURFACE,
    twist: TerrainTexel_SURFACE,
}

fn terrain_slope_SURFACE(slot: u32, x: f32, y: f32) -> TerrainSlope_SURFACE {
    let layer = terrain_layer(slot);
    let at = terrain_slopes(layer, x, y);
    let nw = terrain_texel_SURFACE(layer, at.texels.nw);
    let ne = terrain_texel_SURFACE(layer, at.texels.ne);
    let sw = terrain_texel_SURFACE(layer, at.texels.sw);
    let se = terrain_texel_SURFACE(layer, at.texels.se);
    let u = at.texels.u;
    let v = at.texels.v;
    return TerrainSlope_SURFACE(
        ((ne - nw) * (1.0 - v) + (se - sw) * v) * at.scale.x,
        ((sw - nw) * (1.0 - u) + (se - ne) * u) * at.scale.y,
        ((se - sw) - (ne - nw)) * at.scale.x * at.scale.y,
    );
}
