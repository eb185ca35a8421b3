fn terrain_bound(index: u32) -> f32 {
    return terrain_half(terrain_bounds[index >> 1u], index);
}
