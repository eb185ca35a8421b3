// Samples -1, 0, 1 and 2 of a row from one on, which is not the row's last; the nearest where the field ends. The word of the first of
// a pair is that of one of its neighbours, so three words hold all four.
fn terrain_row(j: u32, i: u32) -> vec4<f32> {
    let row = terrain_scene.size.x;
    let at = j * row + i;
    let start = at - min(i, 1u);
    let end = at + min(row - 1u - i, 2u);
    let first = terrain_samples[start >> 1u];
    let middle = terrain_samples[at >> 1u];
    let last = terrain_samples[end >> 1u];
    let next = select(last, middle, (at & 1u) == 0u);
    return vec4<f32>(
        terrain_half(first, start), terrain_half(middle, at), terrain_half(next, at + 1u), terrain_half(last, end),
    );
}
