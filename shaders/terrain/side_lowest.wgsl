// Of every sampler, from below.
fn terrain_node_lowest(index: u32) -> f32 {
    return terrain_floor(index);
}

fn terrain_outer_lowest(a: f32, b: f32) -> f32 {
    return min(a, b);
}

// The relief of a field of one cell is that of its corners.
fn terrain_whole_lowest() -> f32 {
    return terrain_scene.raw_relief.x;
}
