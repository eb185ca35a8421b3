// Data layers, one after the other: a record of 8 words for each slot, then the texels, rows from north to south.
// Their Rust side is `terrain::layers`.
@group(1) @binding(3) var<storage, read> terrain_rasters: array<u32>;

// One slot's record.
struct TerrainLayer {
    first: u32,
    width: u32,
    height: u32,
    // Components are bytes, four to a word, the first in the low bits; else they are floats.
    bytes: bool,
    scale: vec2<f32>,
    shift: vec2<f32>,
}

// The four texels around a position; u and v run to the east and to the south.
struct TerrainTexels {
    nw: u32,
    ne: u32,
    sw: u32,
    se: u32,
    u: f32,
    v: f32,
}

fn terrain_layer(slot: u32) -> TerrainLayer {
    let at = slot * 8u;
    return TerrainLayer(
        terrain_rasters[at], terrain_rasters[at + 1u], terrain_rasters[at + 2u], terrain_rasters[at + 3u] != 0u,
        bitcast<vec2<f32>>(vec2<u32>(terrain_rasters[at + 4u], terrain_rasters[at + 5u])),
        bitcast<vec2<f32>>(vec2<u32>(terrain_rasters[at + 6u], terrain_rasters[at + 7u])),
    );
}

fn terrain_number(layer: TerrainLayer, at: u32) -> f32 {
    if layer.bytes {
        let word = terrain_rasters[layer.first + (at >> 2u)];
        return f32((word >> ((at & 3u) * 8u)) & 255u) / 255.0;
    }
    return bitcast<f32>(terrain_rasters[layer.first + at]);
}

// A product within rounding of a whole number counts as that number, so that a position computed for a texel meets it.
fn terrain_unbounded(x: f32, scale: f32, shift: f32) -> f32 {
    let product = x * scale;
    let whole = round(product);
    let near = abs(product - whole) <= abs(product) * 2.3841858e-7;
    return select(product, whole, near) + shift;
}

fn terrain_grid(x: f32, scale: f32, shift: f32, size: u32) -> f32 {
    return min(max(terrain_unbounded(x, scale, shift), 0.0), f32(size - 1u));
}

fn terrain_texels(layer: TerrainLayer, x: f32, y: f32) -> TerrainTexels {
    let gx = terrain_grid(x, layer.scale.x, layer.shift.x, layer.width);
    let gy = terrain_grid(y, layer.scale.y, layer.shift.y, layer.height);
    let i = min(u32(gx), layer.width - 1u);
    let j = min(u32(gy), layer.height - 1u);
    let east = min(i + 1u, layer.width - 1u);
    let north = j * layer.width;
    let south = min(j + 1u, layer.height - 1u) * layer.width;
    return TerrainTexels(north + i, north + east, south + i, south + east, gx - f32(i), gy - f32(j));
}
