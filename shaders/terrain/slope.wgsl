// From raw units a cell to metres a metre; 0 along an axis where the position is beyond the rim.
fn terrain_slope(x: f32, y: f32, east: f32, north: f32) -> vec2<f32> {
    let p = vec2<f32>(x, y);
    let size = vec2<f32>(terrain_scene.size - vec2<u32>(1u)) * terrain_scene.spacing;
    let slope = vec2<f32>(
        east * terrain_scene.z_scale * terrain_scene.inverse_spacing.x,
        north * terrain_scene.z_scale * terrain_scene.inverse_spacing.y,
    );
    return select(vec2<f32>(0.0), slope, (p >= vec2<f32>(0.0)) & (p <= size));
}
