// With so many parts along a cell's side.
fn occluded_subdivided(
    ox: f32, oy: f32, oz: f32, dx: f32, dy: f32, dz: f32, near: f32, far: f32, parts: f32,
) -> bool {
    var ray = terrain_enter(ox, oy, oz, dx, dy, dz, near, far, TERRAIN_OVERSHOOT_subdivided);
    ray.parts = parts;
    if !ray.valid {
        return false;
    }
    return terrain_walk_subdivided(ray).at.y >= 0.0;
}
