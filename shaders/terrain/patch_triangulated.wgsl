fn terrain_patch_triangulated(corners: TerrainCorners, way: TerrainWay) -> f32 {
    let side = way.u - way.v;
    let turn = way.d.x - way.d.y;
    // The surface is linear up to the diagonal and behind it.
    let lower = side > 0.0 || (side == 0.0 && turn >= 0.0);
    let south_east = vec2<f32>(corners.se - corners.sw, corners.ne - corners.se);
    let north_west = vec2<f32>(corners.ne - corners.nw, corners.nw - corners.sw);
    let first = select(north_west, south_east, lower);
    let second = select(south_east, north_west, lower);
    let f_in = way.z - (first.x * way.u + first.y * way.v);
    if f_in <= 0.0 {
        return 0.0;
    }
    let b = way.d.z - first.x * way.d.x - first.y * way.d.y;
    if side * (side + turn * way.length) < 0.0 {
        let s = min(-side / turn, way.length);
        let f_mid = f_in + s * b;
        if f_mid <= 0.0 {
            return s * (f_in / (f_in - f_mid));
        }
        let rest = way.length - s;
        let f_out = f_mid + rest * (way.d.z - second.x * way.d.x - second.y * way.d.y);
        if f_out <= 0.0 {
            return s + rest * (f_mid / (f_mid - f_out));
        }
        return TERRAIN_MISS;
    }
    let f_out = f_in + way.length * b;
    if f_out > 0.0 {
        return TERRAIN_MISS;
    }
    return way.length * (f_in / (f_in - f_out));
}
