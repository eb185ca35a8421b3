fn gradient_triangulated(x: f32, y: f32) -> vec2<f32> {
    let cell = terrain_cell(terrain_onto(x), terrain_onto(y));
    let c = cell.corners;
    if cell.u >= cell.v {
        return terrain_slope(x, y, c.se - c.sw, c.ne - c.se);
    }
    return terrain_slope(x, y, c.ne - c.nw, c.nw - c.sw);
}
