fn extent() -> vec2<f32> {
    return vec2<f32>(terrain_scene.size - vec2<u32>(1u)) * terrain_scene.spacing;
}
