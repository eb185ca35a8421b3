fn terrain_bound(index: u32) -> f32 {
    return bitcast<f32>(terrain_bounds[index]);
}
