fn terrain_height_bilinear(c: TerrainCorners, u: f32, v: f32) -> f32 {
    let south = c.sw * (1.0 - u) + c.se * u;
    let north = c.nw * (1.0 - u) + c.ne * u;
    return south * (1.0 - v) + north * v;
}
