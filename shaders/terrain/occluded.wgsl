// SURFACE stands for the surface's name.
fn occluded_SURFACE(
    ox: f32, oy: f32, oz: f32, dx: f32, dy: f32, dz: f32, near: f32, far: f32,
) -> bool {
    let ray = terrain_enter(ox, oy, oz, dx, dy, dz, near, far, TERRAIN_OVERSHOOT_SURFACE);
    if !ray.valid {
        return false;
    }
    return terrain_walk_SURFACE(ray).at.y >= 0.0;
}
