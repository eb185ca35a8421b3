fn texel() -> vec2<f32> {
    return terrain_scene.spacing;
}
