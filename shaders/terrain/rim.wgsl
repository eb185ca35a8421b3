// Raw height in a cell that touches a void: that of the sample on which the position stands, if there is one; else the field's
// lowest.
fn terrain_at_rim(gx: f32, gy: f32) -> f32 {
    let nearest = round(vec2<f32>(gx, gy));
    let apart = abs(vec2<f32>(gx, gy) - nearest);
    let raw = terrain_sample(u32(nearest.y) * terrain_scene.size.x + u32(nearest.x));
    let stands = all(apart <= 2.4e-7 * max(nearest, vec2<f32>(1.0)));
    return select(terrain_scene.raw_relief.x, raw, stands && raw != TERRAIN_VOID);
}
