fn gradient_subdivided(x: f32, y: f32, n: f32) -> vec2<f32> {
    let fine = terrain_fine(x, y, n);
    let c = fine.corners;
    let east = (c.se - c.sw) * (1.0 - fine.v) + (c.ne - c.nw) * fine.v;
    let north = (c.nw - c.sw) * (1.0 - fine.u) + (c.ne - c.se) * fine.u;
    return terrain_slope(x, y, east * n, north * n);
}
