// SURFACE stands for the surface's name.
struct trace_SURFACE_result {
    r0: bool,
    r1: f32,
}

fn trace_SURFACE(
    ox: f32, oy: f32, oz: f32, dx: f32, dy: f32, dz: f32, near: f32, far: f32,
) -> trace_SURFACE_result {
    let ray = terrain_enter(ox, oy, oz, dx, dy, dz, near, far, TERRAIN_OVERSHOOT_SURFACE);
    if !ray.valid {
        return trace_SURFACE_result(false, 0.0);
    }
    let met = terrain_walk_SURFACE(ray);
    if met.at.y < 0.0 {
        return trace_SURFACE_result(false, 0.0);
    }
    return trace_SURFACE_result(true, clamp(terrain_settled_SURFACE(met), near, far));
}
