// What surfaces share which depend on a cell's corners alone. SURFACE stands for the surface's name.
const TERRAIN_OVERSHOOT_SURFACE: f32 = 0.0;
// Rounding of its heights, as a part of the relief of the cell's samples.
const TERRAIN_ROUNDED_SURFACE: f32 = 2.4e-7;

fn terrain_samples_SURFACE(cell: vec2<u32>) -> TerrainCorners {
    return terrain_corners(cell.x, cell.y);
}

fn terrain_void_SURFACE(corners: TerrainCorners) -> bool {
    return terrain_lowest(corners) == TERRAIN_VOID;
}

// Upper bound over a node of the pyramid.
fn terrain_top_SURFACE(index: u32) -> f32 {
    return terrain_bound(index);
}

// Bounds over the cell.
fn terrain_range_SURFACE(corners: TerrainCorners) -> vec2<f32> {
    return vec2<f32>(terrain_lowest(corners), terrain_highest(corners));
}

// Height of a corner: in the east, in the north.
fn terrain_corner_SURFACE(corners: TerrainCorners, at: vec2<bool>) -> f32 {
    return select(select(corners.sw, corners.se, at.x), select(corners.nw, corners.ne, at.x), at.y);
}
