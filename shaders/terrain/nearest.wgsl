fn nearest(x: f32, y: f32) -> f32 {
    let cells = terrain_scene.size - vec2<u32>(1u);
    let gx = min(max(x * terrain_scene.inverse_spacing.x + 0.5, 0.0), f32(cells.x));
    let gy = min(max(y * terrain_scene.inverse_spacing.y + 0.5, 0.0), f32(cells.y));
    let raw = terrain_sample(min(u32(gy), cells.y) * terrain_scene.size.x + min(u32(gx), cells.x));
    let height = select(raw, terrain_scene.raw_relief.x, raw == TERRAIN_VOID);
    return height * terrain_scene.z_scale + terrain_scene.z_offset;
}
