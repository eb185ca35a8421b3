fn twist_subdivided(x: f32, y: f32, n: f32) -> f32 {
    let c = terrain_fine(x, y, n).corners;
    let twist = ((c.ne - c.nw) - (c.se - c.sw)) * n * n;
    let slope = terrain_slope(x, y, twist, terrain_scene.z_inverse_scale);
    return slope.x * slope.y;
}
