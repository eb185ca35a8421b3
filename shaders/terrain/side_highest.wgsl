// Of every sampler, from above.
fn terrain_node_highest(index: u32) -> f32 {
    return terrain_bound(index);
}

fn terrain_outer_highest(a: f32, b: f32) -> f32 {
    return max(a, b);
}

// The relief of a field of one cell is that of its corners.
fn terrain_whole_highest() -> f32 {
    return terrain_scene.raw_relief.y;
}
