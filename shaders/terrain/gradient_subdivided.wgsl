fn gradient_subdivided(x: f32, y: f32, n: f32) -> vec2<f32> {
    let fine = terrain_fine(x, y, n);
    let z = fine.z;
    let east = (z.y - z.x) * (1.0 - fine.v) + (z.w - z.z) * fine.v;
    let north = (z.z - z.x) * (1.0 - fine.u) + (z.w - z.y) * fine.u;
    return terrain_slope(x, y, east * n, north * n);
}
