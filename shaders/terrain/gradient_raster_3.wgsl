struct gradient_raster_3_result {
    r0: f32,
    r1: f32,
    r2: f32,
    r3: f32,
    r4: f32,
    r5: f32,
}

fn gradient_raster_3(slot: u32, x: f32, y: f32) -> gradient_raster_3_result {
    let slope = terrain_slope_3(slot, x, y);
    return gradient_raster_3_result(slope.x.x, slope.x.y, slope.x.z, slope.y.x, slope.y.y, slope.y.z);
}
