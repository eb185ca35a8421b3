fn terrain_sample(index: u32) -> f32 {
    return bitcast<f32>(terrain_samples[index]);
}
