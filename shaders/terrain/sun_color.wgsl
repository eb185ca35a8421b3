fn sun_color() -> vec3<f32> {
    return terrain_scene.sun_color;
}
