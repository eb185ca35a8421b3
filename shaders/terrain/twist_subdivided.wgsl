fn twist_subdivided(x: f32, y: f32, n: f32) -> f32 {
    let z = terrain_fine(x, y, n).z;
    let twist = ((z.w - z.z) - (z.y - z.x)) * n * n;
    let slope = terrain_slope(x, y, twist, terrain_scene.z_inverse_scale);
    return slope.x * slope.y;
}
