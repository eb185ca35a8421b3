// The world's t, as exact as it can be. SURFACE stands for the surface's name. A root is as exact as the way through a cell is long and as its corners are far apart; one step of Newton's
// method, seen from the nearest corner, makes it as exact as heights there are. It is left out where it is more than such
// roundings: there the ray grazes, or it came in under the surface, at a wall along the rim or a void. Then it is one step to
// the wall, for distances to planes are only as exact as the way from a base. Beside a sample the ray may so come into a cell
// a little under its surface, which is no wall.
fn terrain_settled_SURFACE(found: TerrainMet) -> f32 {
    let ray = found.ray;
    let node = found.node;
    let met = found.at;
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
