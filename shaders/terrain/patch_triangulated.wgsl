fn terrain_patch_triangulated(corners: TerrainCorners, way: TerrainWay) -> f32 {
    let f_in = way.z.x - terrain_height_triangulated(corners, way.u.x, way.v.x);
    if f_in <= 0.0 {
        return 0.0;
    }
    let f_out = way.z.y - terrain_height_triangulated(corners, way.u.y, way.v.y);
    let side_in = way.u.x - way.v.x;
    let side_out = way.u.y - way.v.y;

    // The surface is linear up to the diagonal and behind it.
    if side_in * side_out < 0.0 {
        let s = side_in / (side_in - side_out) * way.length;
        let m = clamp(way.u.x + s * way.d.x, 0.0, 1.0);
        let f_mid = way.z.x + s * way.d.z - (corners.sw * (1.0 - m) + corners.ne * m);
        if f_mid <= 0.0 {
            return s * (f_in / (f_in - f_mid));
        }
        if f_out <= 0.0 {
            return s + (way.length - s) * (f_mid / (f_mid - f_out));
        }
        return TERRAIN_MISS;
    }
    if f_out > 0.0 {
        return TERRAIN_MISS;
    }
    return way.length * (f_in / (f_in - f_out));
}
