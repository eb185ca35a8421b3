fn gradient_bicubic(x: f32, y: f32) -> vec2<f32> {
    let n = terrain_neighbours(x, y);
    let east = terrain_blend_all(n.around, terrain_slope_weights(n.u), terrain_weights(n.v));
    let north = terrain_blend_all(n.around, terrain_weights(n.u), terrain_slope_weights(n.v));
    return terrain_slope(x, y, east, north);
}
