// A ray carried into grid units and re-based where it enters the field's box, and again in tiles, so that its precision is
// that of a few cells: neither the way from the camera nor the size of the field counts. A base is computed from the ray
// itself by error-free transforms, so errors do not add up.
const TERRAIN_TINY: f32 = 1e-18;
const TERRAIN_HUGE: f32 = 1e30;
// Cells after which a ray is re-based.
const TERRAIN_TILE: f32 = 256.0;

// Position cell + p + s * (d + rest) (x, y in cells, z raw); the world's t is start + s.
struct TerrainRay {
    origin: vec3<f32>,
    dir: vec3<f32>,
    start: f32,
    // The world's t beyond which nothing is hit.
    far: f32,
    // The base: its cell, the place in it, raw z and what rounding lost of that.
    cell: vec2<i32>,
    p: vec2<f32>,
    z: vec2<f32>,
    d: vec3<f32>,
    // What rounding lost of d.
    rest: vec3<f32>,
    inverse: vec2<f32>,
    // -1 / d.z of a ray that falls, else 0.
    fall: f32,
    // z lowered by the rounding of the walk's heights.
    low: f32,
    // The part of s that is walked from this base; nothing is left behind the last.
    begin: f32,
    end: f32,
    last: bool,
    valid: bool,
    // Along a cell's side, of a subdivided surface.
    parts: f32,
}

// What a walk meets: the ray by its last base, the cell, the distance there with the rest of it, which is less than 0 if nothing
// is met.
struct TerrainMet {
    ray: TerrainRay,
    node: vec2<i32>,
    at: vec2<f32>,
}

// By the bits, since the language lets compilers assume that NaN and infinity do not occur.
fn terrain_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

fn terrain_nan(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7fffffffu) > 0x7f800000u;
}

// A direction's component in grid units and what rounding lost of it.
fn terrain_scaled(x: f32, unit: f32, inverse: f32) -> vec2<f32> {
    let q = terrain_quotient(vec2<f32>(x, 0.0), unit, inverse);
    return select(vec2<f32>(0.0), q, abs(q.x) > TERRAIN_TINY);
}

// Roughly: single precision is that of the origin here.
fn terrain_clip(p: f32, inverse: f32, size: f32, part: vec2<f32>) -> vec2<f32> {
    let a = (0.0 - p) * inverse;
    let b = (size - p) * inverse;
    let slack = 5e-7 * (abs(p) + size) * abs(inverse);
    return vec2<f32>(max(part.x, min(a, b) - slack), min(part.y, max(a, b) + slack));
}

// The field's box is raised by a part of the relief.
fn terrain_enter(
    ox: f32, oy: f32, oz: f32, dx: f32, dy: f32, dz: f32, near: f32, far: f32, overshoot: f32,
) -> TerrainRay {
    var ray: TerrainRay;
    ray.valid = false;
    if !(terrain_finite(ox) && terrain_finite(oy) && terrain_finite(oz)
        && terrain_finite(dx) && terrain_finite(dy) && terrain_finite(dz))
        || terrain_nan(near) || terrain_nan(far) {
        return ray;
    }
    var begin = max(near, -TERRAIN_HUGE);
    var end = min(far, TERRAIN_HUGE);
    var part = vec2<f32>(begin, end);
    let p = vec3<f32>(
        ox * terrain_scene.inverse_spacing.x,
        oy * terrain_scene.inverse_spacing.y,
        (oz - terrain_scene.z_offset) * terrain_scene.z_inverse_scale,
    );
    let x = terrain_scaled(dx, terrain_scene.spacing.x, terrain_scene.inverse_spacing.x);
    let y = terrain_scaled(dy, terrain_scene.spacing.y, terrain_scene.inverse_spacing.y);
    let z = terrain_scaled(dz, terrain_scene.z_scale, terrain_scene.z_inverse_scale);
    let d = vec3<f32>(x.x, y.x, z.x);
    var inverse = vec2<f32>(TERRAIN_HUGE);
    let cells = vec2<f32>(terrain_scene.size - vec2<u32>(1u));

    // The sides.
    if d.x != 0.0 {
        inverse.x = 1.0 / d.x;
        part = terrain_clip(p.x, inverse.x, cells.x, part);
    } else if p.x < 0.0 || p.x > cells.x * 1.000001 {
        return ray;
    }
    if d.y != 0.0 {
        inverse.y = 1.0 / d.y;
        part = terrain_clip(p.y, inverse.y, cells.y, part);
    } else if p.y < 0.0 || p.y > cells.y * 1.000001 {
        return ray;
    }

    // Above the surface nothing can be hit.
    let low = terrain_scene.raw_relief.x;
    let high = terrain_scene.raw_relief.y + overshoot * (terrain_scene.raw_relief.y - low);
    let size = abs(high) + abs(low);
    let top = high + 1e-3 + 1e-5 * (high - low) + 1e-6 * size + 1e-6 * abs(p.z);
    ray.fall = 0.0;
    if d.z < 0.0 {
        begin = max(begin, (top - p.z) / d.z);
        part.x = max(part.x, begin);
        ray.fall = -1.0 / d.z;
    } else if d.z > 0.0 {
        end = min(end, (top - p.z) / d.z);
        part.y = min(part.y, end);
    } else if p.z > top {
        return ray;
    }
    if part.x > part.y {
        return ray;
    }
    ray.origin = vec3<f32>(ox, oy, oz);
    ray.dir = vec3<f32>(dx, dy, dz);
    ray.start = part.x;
    ray.far = end;
    ray.d = d;
    ray.rest = vec3<f32>(x.y, y.y, z.y);
    ray.inverse = inverse;
    ray.begin = begin - part.x;
    return terrain_placed(ray);
}

// The ray from a base at s, for the way behind it.
fn terrain_onward(old: TerrainRay, s: f32) -> TerrainRay {
    var ray = old;
    ray.start = terrain_rounded(old.start + s);
    ray.begin = s - (ray.start - old.start);
    return terrain_placed(ray);
}

// Computes the base at start and clips the way from its beginning on; not valid if none is left.
fn terrain_placed(old: TerrainRay) -> TerrainRay {
    var ray = old;
    let last = vec2<f32>(terrain_scene.size - vec2<u32>(2u));
    let x = terrain_place(ray.origin.x, ray.dir.x, ray.start, terrain_scene.spacing.x, terrain_scene.inverse_spacing.x, last.x);
    let y = terrain_place(ray.origin.y, ray.dir.y, ray.start, terrain_scene.spacing.y, terrain_scene.inverse_spacing.y, last.y);
    ray.cell = vec2<i32>(i32(x.x), i32(y.x));
    ray.p = vec2<f32>(x.y, y.y);
    let way = terrain_product(ray.start, ray.dir.z);
    let height = terrain_sum(ray.origin.z, way.x);
    let above = terrain_sum(height.x, -terrain_scene.z_offset);
    ray.z = terrain_quotient(
        vec2<f32>(above.x, above.y + (height.y + way.y)),
        terrain_scene.z_scale,
        terrain_scene.z_inverse_scale,
    );
    let size = abs(terrain_scene.raw_relief.y) + abs(terrain_scene.raw_relief.x);
    // Far away what rounding lost is more than the margin.
    ray.low = ray.z.x + ray.z.y - 5e-7 * (abs(ray.z.x) + size);

    let rim = vec2<i32>(terrain_scene.size) - vec2<i32>(1);
    let a = terrain_planes(ray, vec2<i32>(0));
    let b = terrain_planes(ray, rim);
    let moves = ray.d.xy != vec2<f32>(0.0);
    let first = select(vec2<f32>(ray.begin), min(a, b), moves);
    let end = select(vec2<f32>(ray.far - ray.start), max(a, b), moves);
    ray.begin = max(ray.begin, max(first.x, first.y));
    ray.end = min(ray.far - ray.start, min(end.x, end.y));
    let tile = ray.begin + TERRAIN_TILE * min(abs(ray.inverse.x), abs(ray.inverse.y));
    ray.last = ray.end <= tile;
    ray.end = min(ray.end, tile);
    let beyond = vec2<f32>(ray.cell - rim) + ray.p > vec2<f32>(0.0);
    ray.valid = ray.begin <= ray.end && !any(!moves & beyond);
    // Without motion the far rim belongs to the last cell.
    ray.p = select(min(ray.p, vec2<f32>(0.9999999)), ray.p, moves);
    return ray;
}

// Cell and position in it of origin + t * dir along one axis; the cell is one of 0 to last.
fn terrain_place(origin: f32, dir: f32, t: f32, unit: f32, inverse: f32, last: f32) -> vec2<f32> {
    let x = origin + t * dir;
    let index = clamp(floor(x * inverse), 0.0, last);
    return vec2<f32>(index, terrain_off_plane(origin, dir, t, unit, index) * inverse);
}

// Metres by which origin + t * dir is beyond a grid plane, without loss.
fn terrain_off_plane(origin: f32, dir: f32, t: f32, unit: f32, plane: f32) -> f32 {
    let way = terrain_product(t, dir);
    let x = terrain_sum(origin, way.x);
    let edge = terrain_product(plane, unit);
    return ((x.x - edge.x) - edge.y) + (x.y + way.y);
}
