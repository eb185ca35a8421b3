struct patch_around_result {
    r0: f32,
    r1: f32,
    r2: f32,
    r3: f32,
    r4: f32,
    r5: f32,
    r6: f32,
    r7: f32,
    r8: f32,
    r9: f32,
    r10: f32,
    r11: f32,
    r12: f32,
    r13: f32,
    r14: f32,
    r15: f32,
    r16: f32,
}

// Height of a cell's south-western sample, and the 4 x 4 samples around the cell less that one: rows from south to north. A cell that
// touches a void has a void's height.
fn patch_around(i: f32, j: f32) -> patch_around_result {
    let last = vec2<f32>(terrain_scene.size - vec2<u32>(2u));
    let cell = vec2<u32>(clamp(vec2<f32>(i, j), vec2<f32>(0.0), last));
    let around = terrain_around(cell.x, cell.y);
    let scale = terrain_scene.z_scale;
    let a = around.a * scale;
    let b = around.b * scale;
    let c = around.c * scale;
    let d = around.d * scale;
    let base = select(around.base * scale + terrain_scene.z_offset, TERRAIN_VOID, around.base == TERRAIN_VOID);
    return patch_around_result(
        base, a.x, a.y, a.z, a.w, b.x, b.y, b.z, b.w, c.x, c.y, c.z, c.w, d.x, d.y, d.z, d.w,
    );
}
