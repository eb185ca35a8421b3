// Where the slopes of a data layer are read. At the outermost texels the cell inside counts, so slopes do not vanish there.
struct TerrainSlopes {
    texels: TerrainTexels,
    // Texels a metre; 0 along an axis where the position is beyond the outermost texels' centres.
    scale: vec2<f32>,
}

fn terrain_slopes(layer: TerrainLayer, x: f32, y: f32) -> TerrainSlopes {
    let last = vec2<u32>(layer.width, layer.height) - vec2<u32>(1u);
    let most = vec2<f32>(last);
    let at = vec2<f32>(
        terrain_unbounded(x, layer.scale.x, layer.shift.x),
        terrain_unbounded(y, layer.scale.y, layer.shift.y),
    );
    let inside = (at >= vec2<f32>(0.0)) & (at <= most);
    let grid = min(max(at, vec2<f32>(0.0)), most);
    let cell = min(vec2<u32>(grid), max(last, vec2<u32>(1u)) - vec2<u32>(1u));
    let next = min(cell + vec2<u32>(1u), last);
    let north = cell.y * layer.width;
    let south = next.y * layer.width;
    let within = grid - vec2<f32>(cell);
    let texels = TerrainTexels(north + cell.x, north + next.x, south + cell.x, south + next.x, within.x, within.y);
    return TerrainSlopes(texels, select(vec2<f32>(0.0), layer.scale, inside));
}
