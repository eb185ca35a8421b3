// Sums and products with what rounding loses of them (Knuth 1969, Dekker 1971). A driver may fuse and reorder, so what must
// be rounded goes through an exclusive or with a zero that only the host knows.
fn terrain_rounded(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) ^ terrain_scene.zero);
}

// The upper 12 bits of the significand; those and the rest multiply without rounding.
fn terrain_high(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) & 0xfffff000u);
}

// The rounded sum and its error.
fn terrain_sum(a: f32, b: f32) -> vec2<f32> {
    let s = terrain_rounded(a + b);
    let part = terrain_rounded(s - a);
    return vec2<f32>(s, (a - terrain_rounded(s - part)) + (b - part));
}

// The rounded product and its error.
fn terrain_product(a: f32, b: f32) -> vec2<f32> {
    let p = terrain_rounded(a * b);
    let ah = terrain_high(a);
    let bh = terrain_high(b);
    let al = a - ah;
    let bl = b - bh;
    // Parts that share a factor may not be drawn together.
    let ll = terrain_rounded(al * bl);
    let hl = terrain_rounded(ah * bl);
    let lh = terrain_rounded(al * bh);
    return vec2<f32>(p, ((terrain_rounded(ah * bh) - p) + hl + lh) + ll);
}

// The quotient x / unit and its error, by the unit's rounded inverse.
fn terrain_quotient(x: vec2<f32>, unit: f32, inverse: f32) -> vec2<f32> {
    let q = terrain_rounded(x.x * inverse);
    let back = terrain_product(q, unit);
    return vec2<f32>(q, (((x.x - back.x) - back.y) + x.y) * inverse);
}
