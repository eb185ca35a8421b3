// The highest number stands for all above it.
fn terrain_crest(index: u32) -> f32 {
    let raw = terrain_half(terrain_crests[index >> 1u], index);
    return select(raw, 3e38, raw == 32767.0);
}
