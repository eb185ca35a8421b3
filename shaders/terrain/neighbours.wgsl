// The 4 x 4 samples around a cell, less its south-western one (`base`): rows from south to north, each from west to east. Beyond
// the rim and beyond a void the nearer sample is repeated; `base` is a void if the cell touches one.
struct TerrainAround {
    a: vec4<f32>,
    b: vec4<f32>,
    c: vec4<f32>,
    d: vec4<f32>,
    base: f32,
}

// Those of the cell under a ground position, and the position in it. A cell that touches a void has the field's lowest height, but
// where a sample stands.
struct TerrainNeighbours {
    around: TerrainAround,
    u: f32,
    v: f32,
}

fn terrain_repaired(row: vec4<f32>) -> vec4<f32> {
    return vec4<f32>(
        select(row.x, row.y, row.x == TERRAIN_VOID), row.yz, select(row.w, row.z, row.w == TERRAIN_VOID),
    );
}

fn terrain_around(i: u32, j: u32) -> TerrainAround {
    let b = terrain_row(j, i);
    let c = terrain_row(j + 1u, i);
    if min(min(b.y, b.z), min(c.y, c.z)) == TERRAIN_VOID {
        let none = vec4<f32>(0.0);
        return TerrainAround(none, none, none, none, TERRAIN_VOID);
    }
    let below = terrain_row(max(j, 1u) - 1u, i);
    let above = terrain_row(min(j + 2u, terrain_scene.size.y - 1u), i);
    let hole = vec4<f32>(TERRAIN_VOID);
    let a = terrain_repaired(select(below, b, below == hole));
    let d = terrain_repaired(select(above, c, above == hole));
    let base = vec4<f32>(b.y);
    return TerrainAround(a - base, terrain_repaired(b) - base, terrain_repaired(c) - base, d - base, b.y);
}

// The samples that were looked up last: a search evaluates its surface many times in one cell.
var<private> terrain_kept: TerrainAround;
var<private> terrain_kept_cell: vec2<u32> = vec2<u32>(0xffffffffu);

fn terrain_around_kept(i: u32, j: u32) -> TerrainAround {
    let cell = vec2<u32>(i, j);
    if any(cell != terrain_kept_cell) {
        terrain_kept = terrain_around(i, j);
        terrain_kept_cell = cell;
    }
    return terrain_kept;
}

fn terrain_neighbours(x: f32, y: f32) -> TerrainNeighbours {
    let cells = terrain_scene.size - vec2<u32>(1u);
    let gx = min(max(x * terrain_scene.inverse_spacing.x, 0.0), f32(cells.x));
    let gy = min(max(y * terrain_scene.inverse_spacing.y, 0.0), f32(cells.y));
    let i = min(u32(gx), cells.x - 1u);
    let j = min(u32(gy), cells.y - 1u);
    var around = terrain_around_kept(i, j);
    if around.base == TERRAIN_VOID {
        around.base = terrain_at_rim(gx, gy);
        return TerrainNeighbours(around, 0.0, 0.0);
    }
    return TerrainNeighbours(around, gx - f32(i), gy - f32(j));
}

fn terrain_blend(weights: vec4<f32>, z: vec4<f32>) -> f32 {
    return (weights.x * z.x + weights.y * z.y) + (weights.z * z.z + weights.w * z.w);
}

// Blend across the rows, then along them.
fn terrain_blend_all(n: TerrainAround, across: vec4<f32>, along: vec4<f32>) -> f32 {
    let rows = vec4<f32>(
        terrain_blend(across, n.a), terrain_blend(across, n.b), terrain_blend(across, n.c), terrain_blend(across, n.d),
    );
    return terrain_blend(along, rows);
}

// Catmull-Rom weights of the samples at -1, 0, 1 and 2 for a position in [0, 1], and their first and second derivatives.
fn terrain_weights(t: f32) -> vec4<f32> {
    return vec4<f32>(
        0.5 * t * ((2.0 - t) * t - 1.0),
        0.5 * (t * t * (3.0 * t - 5.0) + 2.0),
        0.5 * t * ((4.0 - 3.0 * t) * t + 1.0),
        0.5 * t * t * (t - 1.0),
    );
}

fn terrain_slope_weights(t: f32) -> vec4<f32> {
    return vec4<f32>(
        0.5 * ((4.0 - 3.0 * t) * t - 1.0),
        0.5 * t * (9.0 * t - 10.0),
        0.5 * ((8.0 - 9.0 * t) * t + 1.0),
        0.5 * t * (3.0 * t - 2.0),
    );
}

fn terrain_bend_weights(t: f32) -> vec4<f32> {
    return vec4<f32>(2.0 - 3.0 * t, 9.0 * t - 5.0, 4.0 - 9.0 * t, 3.0 * t - 1.0);
}
