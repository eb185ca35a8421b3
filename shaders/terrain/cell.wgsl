// The cell under a ground position. Outside the field the nearest rim counts; a cell that touches a void has the
// field's lowest height, but where a sample stands.
struct TerrainCell {
    corners: TerrainCorners,
    u: f32,
    v: f32,
}

fn terrain_cell(x: f32, y: f32) -> TerrainCell {
    let cells = terrain_scene.size - vec2<u32>(1u);
    let gx = min(max(x * terrain_scene.inverse_spacing.x, 0.0), f32(cells.x));
    let gy = min(max(y * terrain_scene.inverse_spacing.y, 0.0), f32(cells.y));
    let i = min(u32(gx), cells.x - 1u);
    let j = min(u32(gy), cells.y - 1u);
    var corners = terrain_corners(i, j);
    if terrain_lowest(corners) == TERRAIN_VOID {
        let low = terrain_at_rim(gx, gy);
        corners = TerrainCorners(low, low, low, low);
    }
    return TerrainCell(corners, gx - f32(i), gy - f32(j));
}
