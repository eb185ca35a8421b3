// Slopes of the half that the way enters by (xy), and of the other (zw); the surface is linear in each. `side` is how far the entry is
// from the diagonal.
fn terrain_halves(corners: TerrainCorners, way: TerrainWay, side: f32) -> vec4<f32> {
    let lower = side > 0.0 || (side == 0.0 && way.d.x - way.d.y >= 0.0);
    let south_east = vec2<f32>(corners.se - corners.sw, corners.ne - corners.se);
    let north_west = vec2<f32>(corners.ne - corners.nw, corners.nw - corners.sw);
    return select(vec4<f32>(north_west, south_east), vec4<f32>(south_east, north_west), lower);
}

// Height over the surface at the way's entry, and its change by s; the way is seen from one of the corners, which is in the
// east, in the north.
fn terrain_over_triangulated(corners: TerrainCorners, way: TerrainWay, corner: vec2<bool>, parts: f32) -> vec2<f32> {
    let aside = select(0.0, 1.0, corner.x) - select(0.0, 1.0, corner.y);
    let first = terrain_halves(corners, way, way.u - way.v + aside).xy;
    return vec2<f32>(
        way.z - (first.x * way.u + first.y * way.v),
        way.d.z - first.x * way.d.x - first.y * way.d.y,
    );
}

fn terrain_patch_triangulated(corners: TerrainCorners, way: TerrainWay, parts: f32) -> f32 {
    let over = terrain_over_triangulated(corners, way, vec2<bool>(false), parts);
    let f_in = over.x;
    let b = over.y;
    if f_in <= 0.0 {
        return 0.0;
    }
    let side = way.u - way.v;
    let second = terrain_halves(corners, way, side).zw;
    let turn = way.d.x - way.d.y;
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
