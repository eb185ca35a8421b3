// First intersection by a walk over the maximum mipmap (paper, section 3.1). SURFACE stands for the surface's name.
//
// The position is a node's integer index and nothing else; it changes by steps, descents and ascents, so no rounding
// can lead to a node twice.
//
// Three loops: bases of the ray, cells that may be hit, nodes over them. A SIMD machine without branches pays for what a
// loop holds in every turn of it, so what is dear stands in the loop that turns least.
fn terrain_walk_SURFACE(entered: TerrainRay) -> TerrainMet {
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
                    // Descend to the half of each axis that the ray is in at s; on the plane between them to that which it leaves, so that
                    // a ray through a corner is tested against the cells beside it, but for one that begins there.
                    level -= 1u;
                    row = terrain_scene.levels[level];
                    let middle = (2 * node + vec2<i32>(1)) << vec2<u32>(level);
                    let distance = terrain_planes(ray, middle);
                    let crossed = select(vec2<f32>(s) > distance, vec2<f32>(s) >= distance, vec2<bool>(s <= ray.begin));
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
    return TerrainMet(ray, node, met);
}
