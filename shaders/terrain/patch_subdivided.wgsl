// Height over the surface at the way's entry, and its change by s; the way is seen from one of the corners, which is in the
// east, in the north.
fn terrain_over_subdivided(samples: TerrainAround, way: TerrainWay, corner: vec2<bool>, parts: f32) -> vec2<f32> {
    let place = vec2<f32>(way.u, way.v) + select(vec2<f32>(0.0), vec2<f32>(1.0), corner);
    let at = terrain_part(place, parts);
    let corners = terrain_part_corners(samples, at, parts);
    let inner = place * parts - at;
    let z = way.z - (corners.sw - terrain_raised_subdivided(samples, corner));
    let piece = TerrainWay(inner.x, inner.y, z, vec3<f32>(way.d.xy * parts, way.d.z), way.length);
    return terrain_over_bilinear(corners, piece, vec2<bool>(false), 1.0);
}

// From part to part by their indices. First s with z(ray) <= surface.
fn terrain_patch_subdivided(samples: TerrainAround, way: TerrainWay, parts: f32) -> f32 {
    let start = vec2<f32>(way.u, way.v) * parts;
    let d = vec3<f32>(way.d.xy * parts, way.d.z);
    let ahead = select(vec2<f32>(0.0), vec2<f32>(1.0), d.xy > vec2<f32>(0.0));
    var at = terrain_part(vec2<f32>(way.u, way.v), parts);
    var s = 0.0;
    loop {
        let still = d.xy == vec2<f32>(0.0);
        let exit = select((at + ahead - start) / select(d.xy, vec2<f32>(1.0), still), vec2<f32>(way.length), still);
        let out = clamp(min(exit.x, exit.y), s, way.length);
        let corners = terrain_part_corners(samples, at, parts);
        let inner = start + s * d.xy - at;
        let piece = TerrainWay(inner.x, inner.y, (way.z + s * d.z) - corners.sw, d, out - s);
        let met = terrain_patch_bilinear(corners, piece, 1.0);
        if met >= 0.0 {
            return s + met;
        }
        at += select(vec2<f32>(2.0 * ahead.x - 1.0, 0.0), vec2<f32>(0.0, 2.0 * ahead.y - 1.0), exit.y < exit.x);
        if out >= way.length || any(at < vec2<f32>(0.0)) || any(at >= vec2<f32>(parts)) {
            return TERRAIN_MISS;
        }
        s = out;
    }
    return TERRAIN_MISS;
}
