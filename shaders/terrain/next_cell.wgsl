struct next_cell_result {
    r0: bool,
    r1: f32,
    r2: f32,
    r3: f32,
}

// The first cell in which the ray may be no more than `raise` over the bicubic surface. What would be raised is the surface, but the
// ray is lowered instead.
fn next_cell(
    ox: f32, oy: f32, oz: f32, dx: f32, dy: f32, dz: f32, near: f32, far: f32, raise: f32,
) -> next_cell_result {
    let ray = terrain_enter(ox, oy, oz - raise, dx, dy, dz, near, far, TERRAIN_OVERSHOOT_cell);
    if !ray.valid {
        return next_cell_result(false, 0.0, 0.0, 0.0);
    }
    let met = terrain_walk_cell(ray);
    if met.at.y < 0.0 {
        return next_cell_result(false, 0.0, 0.0, 0.0);
    }
    return next_cell_result(true, clamp(met.ray.start + met.at.x, near, far), f32(met.node.x), f32(met.node.y));
}
