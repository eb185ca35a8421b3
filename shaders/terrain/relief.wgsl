fn relief() -> vec2<f32> {
    return terrain_scene.relief;
}
