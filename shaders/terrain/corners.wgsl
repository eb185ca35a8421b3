// Raw heights of a cell's corners.
struct TerrainCorners {
    sw: f32,
    se: f32,
    nw: f32,
    ne: f32,
}

fn terrain_corners(i: u32, j: u32) -> TerrainCorners {
    let at = j * terrain_scene.size.x + i;
    let north = at + terrain_scene.size.x;
    return TerrainCorners(
        terrain_sample(at),
        terrain_sample(at + 1u),
        terrain_sample(north),
        terrain_sample(north + 1u),
    );
}

fn terrain_lowest(c: TerrainCorners) -> f32 {
    return min(min(c.sw, c.se), min(c.nw, c.ne));
}

fn terrain_highest(c: TerrainCorners) -> f32 {
    return max(max(c.sw, c.se), max(c.nw, c.ne));
}
