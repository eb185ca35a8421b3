fn gradient_raster_1(slot: u32, x: f32, y: f32) -> vec2<f32> {
    let slope = terrain_slope_1(slot, x, y);
    return vec2<f32>(slope.x, slope.y);
}
