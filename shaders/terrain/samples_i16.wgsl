// Two 16-bit samples to a word, the first in the low half.
fn terrain_half(word: u32, index: u32) -> f32 {
    let raw = extractBits(bitcast<i32>(word), (index & 1u) * 16u, 16u);
    return select(f32(raw), TERRAIN_VOID, raw == -32768);
}

fn terrain_sample(index: u32) -> f32 {
    return terrain_half(terrain_samples[index >> 1u], index);
}
