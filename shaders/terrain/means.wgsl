// The average mipmap: the number of its last level, then two words on how means are stored, then offset, width and height
// of levels 1, 2, .., then the means. Its Rust side is `terrain::means`.
@group(1) @binding(6) var<storage, read> terrain_mean_words: array<u32>;

fn terrain_mean(level: u32, i: u32, j: u32) -> f32 {
    if level == 0u {
        return terrain_sample(j * terrain_scene.size.x + i);
    }
    let record = 3u * level;
    return terrain_mean_at(terrain_mean_words[record], j * terrain_mean_words[record + 1u] + i);
}

// Means (i, j), (i + 1, j), (i, j + 1) and (i + 1, j + 1) of a level, in metres; where samples are missing altogether the
// mean of the others stands for them. Beyond the rim the outermost ones are repeated.
fn means(level: f32, i: f32, j: f32) -> vec4<f32> {
    let k = min(u32(max(level, 0.0)), terrain_mean_words[0]);
    var size = terrain_scene.size;
    if k > 0u {
        size = vec2<u32>(terrain_mean_words[3u * k + 1u], terrain_mean_words[3u * k + 2u]);
    }
    let west = min(u32(max(i, 0.0)), size.x - 1u);
    let south = min(u32(max(j, 0.0)), size.y - 1u);
    let east = min(west + 1u, size.x - 1u);
    let north = min(south + 1u, size.y - 1u);
    let z = vec4<f32>(
        terrain_mean(k, west, south), terrain_mean(k, east, south), terrain_mean(k, west, north), terrain_mean(k, east, north),
    );
    let there = z != vec4<f32>(TERRAIN_VOID);
    let known = select(vec4<f32>(0.0), z, there);
    let count = select(vec4<f32>(0.0), vec4<f32>(1.0), there);
    let sum = (known.x + known.y) + (known.z + known.w);
    let number = (count.x + count.y) + (count.z + count.w);
    let other = select(terrain_scene.raw_relief.x, sum / max(number, 1.0), number > 0.0);
    return select(vec4<f32>(other), z, there) * terrain_scene.z_scale + terrain_scene.z_offset;
}
