// The cells that a box of ground touches, and the least level of a mipmap at which they are at most 2 x 2 nodes.
struct TerrainBox {
    low: vec2<u32>,
    high: vec2<u32>,
    level: u32,
}

fn terrain_box(x0: f32, y0: f32, x1: f32, y1: f32) -> TerrainBox {
    let cells = terrain_scene.size - vec2<u32>(1u);
    let last = cells - vec2<u32>(1u);
    let inverse = terrain_scene.inverse_spacing;
    let a = clamp(vec2<f32>(x0, y0) * inverse, vec2<f32>(0.0), vec2<f32>(cells));
    let b = clamp(vec2<f32>(x1, y1) * inverse, vec2<f32>(0.0), vec2<f32>(cells));
    let low = min(vec2<u32>(a), last);
    let high = max(low, min(vec2<u32>(b), last));
    let span = max(high.x - low.x, high.y - low.y);
    let level = select(0u, 32u - countLeadingZeros(span - 1u), span > 1u);
    return TerrainBox(low, high, level);
}
