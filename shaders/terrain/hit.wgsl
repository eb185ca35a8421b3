// SURFACE stands for the surface's name.

// Where the ray meets the cell that it is in between two distances: a distance, and the rest of it, less than 0 for none. The heights are the walk's, a little too
// low; what decides is computed here from the base without loss.
fn terrain_hit_SURFACE(ray: TerrainRay, node: vec2<i32>, entry: f32, out: f32, z: f32, z_out: f32) -> vec2<f32> {
    let samples = terrain_samples_SURFACE(vec2<u32>(node));
    let highest = terrain_range_SURFACE(samples).y;
    if min(z, z_out) > highest || terrain_void_SURFACE(samples) {
        return vec2<f32>(0.0, TERRAIN_MISS);
    }
    // From high above, begin where the cell's top is near.
    let s = min(entry + max(z - highest, 0.0) * ray.fall * 0.999999, out);
    let way = terrain_reach_SURFACE(ray, node, terrain_corner_SURFACE(samples, vec2<bool>(false)), s, s * ray.rest, out - s);
    return vec2<f32>(s, terrain_patch_SURFACE(samples, way, ray.parts));
}

// The way from s on, seen from a sample of that height: computed from the base without loss. `more` is what single precision leaves out of it.
fn terrain_reach_SURFACE(ray: TerrainRay, corner: vec2<i32>, height: f32, s: f32, more: vec3<f32>, length: f32) -> TerrainWay {
    let upper = terrain_high(s);
    let lower = s - upper;
    // s * d, and what rounding lost of it.
    let p = bitcast<vec3<f32>>(bitcast<vec3<u32>>(s * ray.d) ^ vec3<u32>(terrain_scene.zero));
    let dh = bitcast<vec3<f32>>(bitcast<vec3<u32>>(ray.d) & vec3<u32>(0xfffff000u));
    let dl = ray.d - dh;
    let lost = (((upper * dh - p) + upper * dl + lower * dh) + lower * dl) + more;
    let place = (vec2<f32>(ray.cell - corner) + p.xy) + (lost.xy + ray.p);
    let above = terrain_sum(ray.z.x, -height);
    return TerrainWay(place.x, place.y, (above.x + p.z) + (above.y + (ray.z.y + lost.z)), ray.d, length);
}
