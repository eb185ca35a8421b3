// Coefficients of 1, t, t^2, t^3 of four rows of samples at once: each vector holds a sample of every row.
struct TerrainCubics {
    c0: vec4<f32>,
    c1: vec4<f32>,
    c2: vec4<f32>,
    c3: vec4<f32>,
}

fn terrain_powers(a: vec4<f32>, b: vec4<f32>, c: vec4<f32>, d: vec4<f32>) -> TerrainCubics {
    return TerrainCubics(b, 0.5 * (c - a), (a - 2.5 * b) + (2.0 * c - 0.5 * d), 1.5 * (b - c) + 0.5 * (d - a));
}

// Times `at + by * x`.
fn terrain_raise(c: TerrainSextic, at: f32, by: f32) -> TerrainSextic {
    return TerrainSextic(
        c.low * at + vec4<f32>(0.0, c.low.xyz) * by,
        c.high * at + vec3<f32>(c.low.w, c.high.xy) * by,
    );
}

// Height of the way over the patch, by the share of the way.
fn terrain_height_over(samples: TerrainAround, way: TerrainWay) -> TerrainSextic {
    let du = way.d.x * way.length;
    let dv = way.d.y * way.length;
    let columns = transpose(mat4x4<f32>(samples.a, samples.b, samples.c, samples.d));
    let p = terrain_powers(columns[0], columns[1], columns[2], columns[3]);
    let u = way.u;
    // Rows as cubics of the share.
    let r0 = p.c0 + u * (p.c1 + u * (p.c2 + u * p.c3));
    let r1 = du * (p.c1 + u * (2.0 * p.c2 + u * (3.0 * p.c3)));
    let r2 = du * du * (p.c2 + 3.0 * p.c3 * u);
    let r3 = du * du * du * p.c3;
    // Cubics of the share for each power of v: a vector holds the share's powers.
    let rows = transpose(mat4x4<f32>(r0, r1, r2, r3));
    let q = terrain_powers(rows[0], rows[1], rows[2], rows[3]);
    let none = vec3<f32>(0.0);
    var sum = terrain_raise(TerrainSextic(q.c3, none), way.v, dv);
    sum.low += q.c2;
    sum = terrain_raise(sum, way.v, dv);
    sum.low += q.c1;
    sum = terrain_raise(sum, way.v, dv);
    sum.low += q.c0;
    return TerrainSextic(vec4<f32>(way.z, way.d.z * way.length, 0.0, 0.0) - sum.low, -sum.high);
}

// Height over the surface at the way's entry, and its change by s; the way is seen from one of the corners, which is in the
// east, in the north.
fn terrain_over_bicubic(samples: TerrainAround, way: TerrainWay, corner: vec2<bool>, parts: f32) -> vec2<f32> {
    let u = way.u + select(0.0, 1.0, corner.x);
    let v = way.v + select(0.0, 1.0, corner.y);
    let across = terrain_weights(u);
    let along = terrain_weights(v);
    let east = terrain_blend_all(samples, terrain_slope_weights(u), along);
    let north = terrain_blend_all(samples, across, terrain_slope_weights(v));
    let height = terrain_blend_all(samples, across, along) - terrain_raised_bicubic(samples, corner);
    return vec2<f32>(way.z - height, way.d.z - east * way.d.x - north * way.d.y);
}

// First s with z(ray) <= surface: a ray that comes in under the surface hits at once, so nothing slips between cells.
// A ray that falls is under all of it long before a way ends that is without end.
fn terrain_patch_bicubic(samples: TerrainAround, entered: TerrainWay, parts: f32) -> f32 {
    var way = entered;
    if way.d.z < 0.0 {
        let range = terrain_range_bicubic(samples) - vec2<f32>(samples.base);
        let below = way.z - range.x + 0.1 * (range.y - range.x) + 1e-5 * (abs(way.z) + abs(range.x)) + 1e-3;
        way.length = min(way.length, max(below, 0.0) / -way.d.z);
    }
    let share = terrain_sextic_first(terrain_height_over(samples, way));
    return select(share * way.length, TERRAIN_MISS, share < 0.0);
}
