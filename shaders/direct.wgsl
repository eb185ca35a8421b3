// An image entry that is fused whole needs no stream: one invocation a pixel.

@compute @workgroup_size(8, 8)
fn direct(@builtin(global_invocation_id) id: vec3<u32>) {
    let y = id.y + params.first;
    if (id.x >= params.width || y >= params.last) {
        return;
    }
    fuel = params.fuel;
    exhausted = false;
    let value = shade(f32(id.x) + params.point_x, f32(y) + params.point_y);
    if (!loops_alive()) {
        atomicOr(&state.flags, FLAG_LOOPS);
    }
    if (exhausted) {
        atomicOr(&state.flags, FLAG_EXHAUSTED);
        atomicStore(&state.culprit, params.entry);
    }
    let at = (y * params.width + id.x) * COMPONENTS;
    for (var component = 0u; component < COMPONENTS; component += 1u) {
        image[at + component] = bitcast<u32>(value[component]);
    }
}
