// The part of an n x n split of the cell that a ground position lies in: bicubic heights at its corners less `base`, and the
// position in it.
struct TerrainFine {
    corners: TerrainCorners,
    base: f32,
    u: f32,
    v: f32,
}

fn terrain_fine(x: f32, y: f32, n: f32) -> TerrainFine {
    let found = terrain_neighbours(x, y);
    let place = vec2<f32>(found.u, found.v);
    let at = terrain_part(place, n);
    let inner = place * n - at;
    return TerrainFine(terrain_part_corners(found.around, at, n), found.around.base, inner.x, inner.y);
}
