// With so many parts along a cell's side.
struct trace_subdivided_result {
    r0: bool,
    r1: f32,
}

fn trace_subdivided(
    ox: f32, oy: f32, oz: f32, dx: f32, dy: f32, dz: f32, near: f32, far: f32, parts: f32,
) -> trace_subdivided_result {
    var ray = terrain_enter(ox, oy, oz, dx, dy, dz, near, far, TERRAIN_OVERSHOOT_subdivided);
    ray.parts = parts;
    if !ray.valid {
        return trace_subdivided_result(false, 0.0);
    }
    let met = terrain_walk_subdivided(ray);
    if met.at.y < 0.0 {
        return trace_subdivided_result(false, 0.0);
    }
    return trace_subdivided_result(true, clamp(terrain_settled_subdivided(met), near, far));
}
