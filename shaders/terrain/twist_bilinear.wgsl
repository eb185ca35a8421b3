fn twist_bilinear(x: f32, y: f32) -> f32 {
    let c = terrain_cell(terrain_onto(x), terrain_onto(y)).corners;
    let twist = (c.ne - c.nw) - (c.se - c.sw);
    let slope = terrain_slope(x, y, twist, terrain_scene.z_inverse_scale);
    return slope.x * slope.y;
}
