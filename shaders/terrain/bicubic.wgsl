fn bicubic(x: f32, y: f32) -> f32 {
    let n = terrain_neighbours(x, y);
    let raw = n.around.base + terrain_blend_all(n.around, terrain_weights(n.u), terrain_weights(n.v));
    return raw * terrain_scene.z_scale + terrain_scene.z_offset;
}
