// The micro-heightfield: its width and height, then texels of 16 bits, two to a word; rows from south to north. It repeats
// in both directions.
@group(1) @binding(5) var<storage, read> terrain_micro: array<u32>;

fn terrain_wrapped(x: f32, n: u32) -> u32 {
    let m = i32(x) % i32(n);
    return u32(select(m, m + i32(n), m < 0));
}

fn terrain_micro_texel(at: u32) -> f32 {
    return f32(extractBits(bitcast<i32>(terrain_micro[2u + (at >> 1u)]), (at & 1u) * 16u, 16u)) / 32767.0;
}

// Texels (i - 1, j) to (i + 2, j), in [-1, 1].
fn micro_row(i: f32, j: f32) -> vec4<f32> {
    let width = terrain_micro[0];
    let row = terrain_wrapped(j, terrain_micro[1]) * width;
    let a = terrain_wrapped(i - 1.0, width);
    let b = (a + 1u) % width;
    let c = (a + 2u) % width;
    let d = (a + 3u) % width;
    return vec4<f32>(
        terrain_micro_texel(row + a), terrain_micro_texel(row + b), terrain_micro_texel(row + c), terrain_micro_texel(row + d),
    );
}
