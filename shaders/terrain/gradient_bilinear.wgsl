fn gradient_bilinear(x: f32, y: f32) -> vec2<f32> {
    let cell = terrain_cell(terrain_onto(x), terrain_onto(y));
    let c = cell.corners;
    let east = (c.se - c.sw) * (1.0 - cell.v) + (c.ne - c.nw) * cell.v;
    let north = (c.nw - c.sw) * (1.0 - cell.u) + (c.ne - c.se) * cell.u;
    return terrain_slope(x, y, east, north);
}
