fn pixel_width() -> vec2<f32> {
    return terrain_scene.pixel_width;
}
