fn terrain_mean_at(offset: u32, node: u32) -> f32 {
    return bitcast<f32>(terrain_mean_words[offset + node]);
}
