// First intersection by a walk over the maximum mipmap (paper, section 3.1). SURFACE stands for the surface's name.
//
// The position is a node's integer index and nothing else; it changes by steps, descents and ascents, so no rounding
// can lead to a node twice.
// `settled` asks for the distance as exact as it can be.
//
// Three loops: bases of the ray, cells that may be hit, nodes over them. A SIMD machine without branches pays for what a
// loop holds in every turn of it, so what is dear stands in the loop that turns least.
fn terrain_walk_SURFACE(entered: TerrainRay, settled: bool) -> f32 {
    var ray = entered;
    let cells = vec2<i32>(terrain_scene.size) - vec2<i32>(1);
    // 1 where the ray leaves a node through its upper plane.
    let ahead = select(vec2<i32>(0), vec2<i32>(1), ray.d.xy >= vec2<f32>(0.0));
    let onward = 2 * ahead - vec2<i32>(1);
    let top = terrain_scene.top;
    // Rays meet something near where they begin more often than not, so they begin low, unless rounding has put their
    // beginning outside of the planes of its own node, or on the one that it leaves by.
    let first = min(2u, top);
    var level = first;
    var node = ray.cell >> vec2<u32>(first);
    let entry = terrain_planes(ray, (node + vec2<i32>(1) - ahead) << vec2<u32>(first));
    let leave = terrain_planes(ray, (node + ahead) << vec2<u32>(first));
    if any(entry > vec2<f32>(ray.begin)) || any(vec2<f32>(ray.begin) >= leave) {
        level = top;
        node = vec2<i32>(0);
    }
    var fuel = terrain_scene.fuel;
    var gone = false;
    // A distance, and the rest of it.
    var met = vec2<f32>(0.0, TERRAIN_MISS);
    loop {
        var s = ray.begin;
        var z = ray.low + s * ray.d.z;
        var exit = terrain_planes(ray, (node + ahead) << vec2<u32>(level));
        var out = min(min(exit.x, exit.y), ray.end);
        var ended = false;
        loop {
            // Descend where the ray is under the bound, else step.
            var row = terrain_scene.levels[level];
            while level > 0u && !(gone || ended) {
                let z_out = ray.low + out * ray.d.z;
                if min(z, z_out) <= terrain_top_SURFACE(row.x + u32(node.y) * row.y + u32(node.x)) {
                    // Descend to the half of each axis that the ray is in at s.
                    level -= 1u;
                    row = terrain_scene.levels[level];
                    let middle = (2 * node + vec2<i32>(1)) << vec2<u32>(level);
                    let distance = terrain_planes(ray, middle);
                    let crossed = vec2<f32>(s) >= distance;
                    let upper = (crossed == (ahead == vec2<i32>(1))) & (middle < cells);
                    node = 2 * node + select(vec2<i32>(0), vec2<i32>(1), upper);
                    exit = select(distance, exit, crossed);
                } else if out >= ray.end {
                    ended = true;
                } else {
                    // Step to the neighbour behind the nearer plane; ascend when that leaves the parent.
                    fuel -= 1u;
                    s = out;
                    z = z_out;
                    let along_y = exit.y < exit.x;
                    node += select(vec2<i32>(onward.x, 0), vec2<i32>(0, onward.y), along_y);
                    gone = any(node < vec2<i32>(0)) || any((node << vec2<u32>(level)) >= cells) || fuel == 0u;
                    if select((node.x & 1) != ahead.x, (node.y & 1) != ahead.y, along_y) && level < top {
                        level += 1u;
                        row = terrain_scene.levels[level];
                        node = node >> vec2<u32>(1u);
                    }
                    exit = terrain_planes(ray, (node + ahead) << vec2<u32>(level));
                }
                out = min(min(exit.x, exit.y), ray.end);
            }
            if gone || ended {
                break;
            }
            let z_out = ray.low + out * ray.d.z;
            met = terrain_hit_SURFACE(ray, node, s, out, z, z_out);
            if met.y >= 0.0 || out >= ray.end {
                break;
            }
            fuel -= 1u;
            s = out;
            z = z_out;
            let along_y = exit.y < exit.x;
            node += select(vec2<i32>(onward.x, 0), vec2<i32>(0, onward.y), along_y);
            gone = any(node < vec2<i32>(0)) || any(node >= cells) || fuel == 0u;
            if select((node.x & 1) != ahead.x, (node.y & 1) != ahead.y, along_y) && top > 0u {
                level = 1u;
                node = node >> vec2<u32>(1u);
            }
            exit = terrain_planes(ray, (node + ahead) << vec2<u32>(level));
            out = min(min(exit.x, exit.y), ray.end);
        }
        // A base ends where the ray is still over the field.
        if met.y >= 0.0 || ray.last || gone {
            break;
        }
        ray = terrain_onward(ray, out);
        if !ray.valid {
            break;
        }
    }
    if met.y < 0.0 {
        return TERRAIN_NEVER;
    }
    if settled {
        return terrain_settled_SURFACE(ray, node, met);
    }
    return ray.start + met.x;
}

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

// The world's t. A root is as exact as the way through a cell is long and as its corners are far apart; one step of Newton's
// method, seen from the nearest corner, makes it as exact as heights there are. It is left out where it is more than such
// roundings: there the ray grazes, or it came in under the surface, at a wall along the rim or a void. Then it is one step to
// the wall, for distances to planes are only as exact as the way from a base. Beside a sample the ray may so come into a cell
// a little under its surface, which is no wall.
fn terrain_settled_SURFACE(ray: TerrainRay, node: vec2<i32>, met: vec2<f32>) -> f32 {
    let samples = terrain_samples_SURFACE(vec2<u32>(node));
    let at = terrain_sum(met.x, met.y);
    let far = vec2<f32>(ray.cell - node) + (at.x * ray.d.xy + ray.p) > vec2<f32>(0.5);
    let height = terrain_corner_SURFACE(samples, far);
    let corner = node + select(vec2<i32>(0), vec2<i32>(1), far);
    let way = terrain_reach_SURFACE(ray, corner, height, at.x, at.x * ray.rest + at.y * ray.d, 0.0);
    let over = terrain_over_SURFACE(samples, way, far, ray.parts);
    let range = terrain_range_SURFACE(samples);
    let step = -over.x / over.y;
    let inverse = abs(ray.inverse);
    let rounded = abs(over.x) <= TERRAIN_ROUNDED_SURFACE * (range.y - range.x);
    let cell = min(inverse.x, inverse.y);
    let most = select(2e-6 * cell + 1.2e-7 * met.x, 1e-5 * cell, rounded);
    let base = terrain_sum(ray.start, at.x);
    let t = base.x + (base.y + at.y);

    let entry = node + select(vec2<i32>(0), vec2<i32>(1), ray.d.xy < vec2<f32>(0.0));
    let distance = terrain_planes(ray, entry);
    let axis = select(0u, 1u, distance.y > distance.x);
    let dir = ray.dir[axis];
    let back = -terrain_off_plane(ray.origin[axis], dir, t, terrain_scene.spacing[axis], f32(entry[axis])) / dir;
    if met.y == 0.0 && !rounded && abs(back) <= 2e-6 * inverse[axis] + 6e-8 * abs(t) {
        return t + back;
    }
    if over.y < 0.0 && abs(step) <= most {
        return base.x + (base.y + (at.y + step));
    }
    return t;
}
