// What surfaces share which depend on the 4 x 4 samples around a cell. SURFACE stands for the surface's name.
// Weights below 0 add up to 9/32 at most (`compiler/src/bounds/surfaces.rs`): a patch passes its samples by no more of their
// spread.
const TERRAIN_OVERSHOOT_SURFACE: f32 = 0.28125;
// Rounding of its heights, as a part of the relief of the cell's samples.
const TERRAIN_ROUNDED_SURFACE: f32 = 1e-6;

fn terrain_samples_SURFACE(cell: vec2<u32>) -> TerrainAround {
    return terrain_around(cell.x, cell.y);
}

fn terrain_void_SURFACE(samples: TerrainAround) -> bool {
    return samples.base == TERRAIN_VOID;
}

// Upper bound over a node of the pyramid.
fn terrain_top_SURFACE(index: u32) -> f32 {
    return terrain_crest(index);
}

// Bounds over the cell.
fn terrain_range_SURFACE(samples: TerrainAround) -> vec2<f32> {
    let least = min(min(samples.a, samples.b), min(samples.c, samples.d));
    let most = max(max(samples.a, samples.b), max(samples.c, samples.d));
    let low = min(min(least.x, least.y), min(least.z, least.w));
    let high = max(max(most.x, most.y), max(most.z, most.w));
    let over = TERRAIN_OVERSHOOT_SURFACE * (high - low);
    return vec2<f32>(samples.base + (low - over), samples.base + (high + over));
}

// Height of a corner: in the east, in the north.
fn terrain_corner_SURFACE(samples: TerrainAround, at: vec2<bool>) -> f32 {
    return samples.base + terrain_raised_SURFACE(samples, at);
}

// The same less `base`.
fn terrain_raised_SURFACE(samples: TerrainAround, at: vec2<bool>) -> f32 {
    return select(select(samples.b.y, samples.b.z, at.x), select(samples.c.y, samples.c.z, at.x), at.y);
}
