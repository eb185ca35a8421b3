// Samples -1, 0, 1 and 2 of a row from one on, which is not the row's last; the nearest where the field ends.
fn terrain_row(j: u32, i: u32) -> vec4<f32> {
    let row = terrain_scene.size.x;
    let at = j * row + i;
    return vec4<f32>(
        terrain_sample(at - min(i, 1u)), terrain_sample(at), terrain_sample(at + 1u),
        terrain_sample(at + min(row - 1u - i, 2u)),
    );
}
