fn gradient_raster_2(slot: u32, x: f32, y: f32) -> vec4<f32> {
    let slope = terrain_slope_2(slot, x, y);
    return vec4<f32>(slope.x, slope.y);
}
