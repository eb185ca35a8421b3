// Split along the diagonal from the north-east to the south-west corner.
fn terrain_height_triangulated(c: TerrainCorners, u: f32, v: f32) -> f32 {
    if u >= v {
        return c.sw * (1.0 - u) + c.se * (u - v) + c.ne * v;
    }
    return c.sw * (1.0 - v) + c.nw * (v - u) + c.ne * u;
}
