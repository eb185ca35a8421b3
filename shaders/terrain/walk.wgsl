// First intersection by a walk over the maximum mipmap (paper, section 3.1). SURFACE stands for the surface's name.
//
// The position is a node's integer index and nothing else; it changes by steps, descents and ascents, so no rounding
// can lead to a node twice.
fn terrain_walk_SURFACE(ray: TerrainRay) -> f32 {
    let cells = vec2<i32>(terrain_scene.size) - vec2<i32>(1);
    // 1 where the ray leaves a node through its upper plane.
    let ahead = select(vec2<i32>(0), vec2<i32>(1), ray.d.xy >= vec2<f32>(0.0));
    let top = terrain_scene.top;
    var level = top;
    var row = terrain_scene.levels[level];
    var node = vec2<i32>(0);
    var exit = terrain_planes(ray, ahead << vec2<u32>(level));
    var s = 0.0;
    var z = ray.p.z;

    for (var fuel = terrain_scene.fuel; fuel > 0u; fuel--) {
        let out = min(min(exit.x, exit.y), ray.end);
        let z_out = ray.p.z + out * ray.d.z;
        let lowest = min(z, z_out);
        if level > 0u {
            if lowest <= terrain_bound(row.x + u32(node.y) * row.y + u32(node.x)) {
                // Descend to the half of each axis that the ray is in at s.
                level -= 1u;
                row = terrain_scene.levels[level];
                let middle = (2 * node + vec2<i32>(1)) << vec2<u32>(level);
                let distance = terrain_planes(ray, middle);
                let crossed = vec2<f32>(s) >= distance;
                let upper = (crossed == (ahead == vec2<i32>(1))) & (middle < cells);
                node = 2 * node + select(vec2<i32>(0), vec2<i32>(1), upper);
                exit = select(distance, exit, crossed);
                continue;
            }
        } else {
            let hit = terrain_hit_SURFACE(ray, node, s, out, z, z_out);
            if hit >= 0.0 {
                return hit;
            }
        }
        if out >= ray.end {
            return TERRAIN_MISS;
        }

        // Step to the neighbour behind the nearer plane; ascend when that leaves the parent.
        s = out;
        z = z_out;
        let along_y = exit.y < exit.x;
        let onward = select(vec2<i32>(1, 0), vec2<i32>(0, 1), along_y) * (2 * ahead - vec2<i32>(1));
        node += onward;
        if any(node < vec2<i32>(0)) || any((node << vec2<u32>(level)) >= cells) {
            return TERRAIN_MISS;
        }
        let parity = select((node.x & 1) != ahead.x, (node.y & 1) != ahead.y, along_y);
        if parity && level < top {
            level += 1u;
            row = terrain_scene.levels[level];
            node = node >> vec2<u32>(1u);
        }
        exit = terrain_planes(ray, (node + ahead) << vec2<u32>(level));
    }
    return TERRAIN_MISS;
}

// Intersection with one cell between two distances.
fn terrain_hit_SURFACE(ray: TerrainRay, node: vec2<i32>, s: f32, out: f32, z: f32, z_out: f32) -> f32 {
    let corners = terrain_corners(u32(node.x), u32(node.y));
    if min(z, z_out) > terrain_highest(corners) || terrain_lowest(corners) == TERRAIN_VOID {
        return TERRAIN_MISS;
    }
    let cell = vec2<f32>(node);
    let entry = clamp((ray.p.xy + s * ray.d.xy) - cell, vec2<f32>(0.0), vec2<f32>(1.0));
    let leave = clamp((ray.p.xy + out * ray.d.xy) - cell, vec2<f32>(0.0), vec2<f32>(1.0));
    let way = TerrainWay(
        vec2<f32>(entry.x, leave.x),
        vec2<f32>(entry.y, leave.y),
        vec2<f32>(z, z_out),
        ray.d,
        out - s,
    );
    let hit = terrain_patch_SURFACE(corners, way);
    return select(TERRAIN_MISS, s + hit, hit >= 0.0);
}
