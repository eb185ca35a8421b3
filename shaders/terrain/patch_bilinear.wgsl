// Height over the surface at the way's entry, and its change by s; the way is seen from one of the corners, which is in the
// east, in the north.
fn terrain_over_bilinear(corners: TerrainCorners, way: TerrainWay, corner: vec2<bool>, parts: f32) -> vec2<f32> {
    let south_edge = corners.se - corners.sw;
    let north_edge = corners.ne - corners.nw;
    let east = select(south_edge, north_edge, corner.y);
    let north = select(corners.nw - corners.sw, corners.ne - corners.se, corner.x);
    let twist = north_edge - south_edge;
    return vec2<f32>(
        way.z - (east * way.u + (north + twist * way.u) * way.v),
        way.d.z - east * way.d.x - north * way.d.y - twist * (way.u * way.d.y + way.v * way.d.x),
    );
}

// First s with z(ray) <= surface: a ray that comes in under the surface hits at once, so nothing slips between cells.
fn terrain_patch_bilinear(corners: TerrainCorners, way: TerrainWay, parts: f32) -> f32 {
    let over = terrain_over_bilinear(corners, way, vec2<bool>(false), parts);
    let f_in = over.x;
    let b = over.y;
    if f_in <= 0.0 {
        return 0.0;
    }

    // f(s) = a s^2 + b s + f_in
    let a = -(((corners.ne - corners.nw) - (corners.se - corners.sw)) * way.d.x * way.d.y);
    let f_out = f_in + way.length * (b + way.length * a);
    // Both ends above: only a dip below the surface in between can hit.
    if f_out > 0.0 && !(a > 0.0 && b < 0.0 && -b < 2.0 * a * way.length) {
        return TERRAIN_MISS;
    }
    let discriminant = b * b - 4.0 * a * f_in;
    if f_out > 0.0 && discriminant < 0.0 {
        return TERRAIN_MISS;
    }
    let root = sqrt(max(discriminant, 0.0));
    // The root without cancellation.
    if b < 0.0 {
        return clamp(2.0 * f_in / (root - b), 0.0, way.length);
    }
    return clamp((b + root) / (-2.0 * a), 0.0, way.length);
}
