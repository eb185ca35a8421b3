// The part of an n x n split of the cell that a ground position lies in: bicubic heights at its corners, south-west,
// south-east, north-west, north-east, less `base`, and the position in it.
struct TerrainFine {
    z: vec4<f32>,
    base: f32,
    u: f32,
    v: f32,
}

fn terrain_fine(x: f32, y: f32, n: f32) -> TerrainFine {
    let around = terrain_neighbours(x, y);
    let i = min(floor(around.u * n), n - 1.0);
    let j = min(floor(around.v * n), n - 1.0);
    let west = terrain_weights(i / n);
    let east = terrain_weights((i + 1.0) / n);
    let south = terrain_weights(j / n);
    let north = terrain_weights((j + 1.0) / n);
    let z = vec4<f32>(
        terrain_blend_all(around, west, south), terrain_blend_all(around, east, south),
        terrain_blend_all(around, west, north), terrain_blend_all(around, east, north),
    );
    return TerrainFine(z, around.base, around.u * n - i, around.v * n - j);
}
