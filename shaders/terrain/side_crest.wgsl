// Of the bicubic surface, from above.
fn terrain_node_crest(index: u32) -> f32 {
    return terrain_crest(index);
}

fn terrain_outer_crest(a: f32, b: f32) -> f32 {
    return max(a, b);
}

// In a field of one cell the spline passes no sample.
fn terrain_whole_crest() -> f32 {
    return terrain_scene.raw_relief.y;
}
