fn sun_dir() -> vec3<f32> {
    return terrain_scene.sun_dir;
}
