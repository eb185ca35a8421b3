// Primary ray through pixel position (x, y).
struct camera_result {
    r0: f32,
    r1: f32,
    r2: f32,
    r3: f32,
    r4: f32,
    r5: f32,
    r6: f32,
    r7: f32,
}

fn camera(x: f32, y: f32) -> camera_result {
    let i = x - terrain_scene.middle.x;
    let j = y - terrain_scene.middle.y;
    let offset = i * terrain_scene.across + j * terrain_scene.down;
    let near = terrain_scene.near;
    let far = terrain_scene.far;
    if terrain_scene.orthographic != 0u {
        let o = terrain_scene.eye + offset;
        let d = terrain_scene.forward;
        return camera_result(o.x, o.y, o.z, d.x, d.y, d.z, near, far);
    }
    let o = terrain_scene.eye;
    let d = terrain_scene.forward + offset;
    let size = sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
    return camera_result(o.x, o.y, o.z, d.x / size, d.y / size, d.z / size, near, far);
}
