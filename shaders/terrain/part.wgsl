// Bicubic heights less `base` at the corners of a part.
fn terrain_part_corners(samples: TerrainAround, at: vec2<f32>, parts: f32) -> TerrainCorners {
    let west = terrain_weights(at.x / parts);
    let east = terrain_weights((at.x + 1.0) / parts);
    let south = terrain_weights(at.y / parts);
    let north = terrain_weights((at.y + 1.0) / parts);
    return TerrainCorners(
        terrain_blend_all(samples, west, south), terrain_blend_all(samples, east, south),
        terrain_blend_all(samples, west, north), terrain_blend_all(samples, east, north),
    );
}

fn terrain_part(at: vec2<f32>, parts: f32) -> vec2<f32> {
    return clamp(floor(at * parts), vec2<f32>(0.0), vec2<f32>(parts - 1.0));
}
