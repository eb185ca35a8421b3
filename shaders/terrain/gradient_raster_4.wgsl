struct gradient_raster_4_result {
    r0: f32,
    r1: f32,
    r2: f32,
    r3: f32,
    r4: f32,
    r5: f32,
    r6: f32,
    r7: f32,
}

fn gradient_raster_4(slot: u32, x: f32, y: f32) -> gradient_raster_4_result {
    let slope = terrain_slope_4(slot, x, y);
    return gradient_raster_4_result(slope.x.x, slope.x.y, slope.x.z, slope.x.w, slope.y.x, slope.y.y, slope.y.z, slope.y.w);
}
