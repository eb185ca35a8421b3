fn terrain_floor(index: u32) -> f32 {
    return terrain_half(terrain_floors[index >> 1u], index);
}
