// Means of 16-bit data are fractions of its range in 16 bits, two to a word; the greatest number is a void.
fn terrain_mean_at(offset: u32, node: u32) -> f32 {
    let code = extractBits(terrain_mean_words[offset + (node >> 1u)], (node & 1u) * 16u, 16u);
    let low = bitcast<f32>(terrain_mean_words[1]);
    let step = bitcast<f32>(terrain_mean_words[2]);
    return select(low + f32(code) * step, TERRAIN_VOID, code == 65535u);
}
