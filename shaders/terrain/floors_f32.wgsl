fn terrain_floor(index: u32) -> f32 {
    return bitcast<f32>(terrain_floors[index]);
}
