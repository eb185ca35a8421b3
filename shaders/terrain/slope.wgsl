// From raw units a cell to metres a metre.
fn terrain_slope(east: f32, north: f32) -> vec2<f32> {
    return vec2<f32>(
        east * terrain_scene.z_scale * terrain_scene.inverse_spacing.x,
        north * terrain_scene.z_scale * terrain_scene.inverse_spacing.y,
    );
}
