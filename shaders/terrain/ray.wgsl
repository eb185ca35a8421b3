// A ray carried into grid units (x, y in cells, z raw) and re-based where it enters the field's box, so that its
// precision is that of the field and not of the way from the camera.
const TERRAIN_TINY: f32 = 1e-18;
const TERRAIN_HUGE: f32 = 1e30;

// Position p + s * d for s from 0 to end; the world's t is start + s.
struct TerrainRay {
    p: vec3<f32>,
    d: vec3<f32>,
    inverse: vec2<f32>,
    start: f32,
    end: f32,
    valid: bool,
}

// By the bits, since the language lets compilers assume that NaN and infinity do not occur.
fn terrain_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

fn terrain_nan(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7fffffffu) > 0x7f800000u;
}

fn terrain_clip(p: f32, inverse: f32, size: f32, part: vec2<f32>) -> vec2<f32> {
    let a = (0.0 - p) * inverse;
    let b = (size - p) * inverse;
    return vec2<f32>(max(part.x, min(a, b)), min(part.y, max(a, b)));
}

fn terrain_rebase(p: f32, d: f32, t: f32, size: f32) -> f32 {
    let q = clamp(p + t * d, 0.0, size);
    // Without motion the far rim belongs to the last cell.
    return select(q, min(q, size * 0.9999999), d == 0.0);
}

fn terrain_enter(
    ox: f32, oy: f32, oz: f32, dx: f32, dy: f32, dz: f32, near: f32, far: f32,
) -> TerrainRay {
    var ray: TerrainRay;
    ray.valid = false;
    if !(terrain_finite(ox) && terrain_finite(oy) && terrain_finite(oz)
        && terrain_finite(dx) && terrain_finite(dy) && terrain_finite(dz))
        || terrain_nan(near) || terrain_nan(far) {
        return ray;
    }
    var part = vec2<f32>(max(near, -TERRAIN_HUGE), min(far, TERRAIN_HUGE));
    let p = vec3<f32>(
        ox * terrain_scene.inverse_spacing.x,
        oy * terrain_scene.inverse_spacing.y,
        (oz - terrain_scene.z_offset) * terrain_scene.z_inverse_scale,
    );
    var d = vec3<f32>(
        dx * terrain_scene.inverse_spacing.x,
        dy * terrain_scene.inverse_spacing.y,
        dz * terrain_scene.z_inverse_scale,
    );
    var inverse = vec2<f32>(TERRAIN_HUGE);
    let cells = vec2<f32>(terrain_scene.size - vec2<u32>(1u));

    // The sides.
    if abs(d.x) > TERRAIN_TINY {
        inverse.x = 1.0 / d.x;
        part = terrain_clip(p.x, inverse.x, cells.x, part);
    } else {
        d.x = 0.0;
        if p.x < 0.0 || p.x > cells.x {
            return ray;
        }
    }
    if abs(d.y) > TERRAIN_TINY {
        inverse.y = 1.0 / d.y;
        part = terrain_clip(p.y, inverse.y, cells.y, part);
    } else {
        d.y = 0.0;
        if p.y < 0.0 || p.y > cells.y {
            return ray;
        }
    }

    // Above the highest sample nothing can be hit.
    let low = terrain_scene.raw_relief.x;
    let high = terrain_scene.raw_relief.y;
    let pad = 1e-3 + 1e-5 * (high - low) + 1e-6 * (abs(high) + abs(low));
    if d.z < -TERRAIN_TINY {
        part.x = max(part.x, (high + pad - p.z) / d.z);
    } else if d.z > TERRAIN_TINY {
        part.y = min(part.y, (high + pad - p.z) / d.z);
    } else {
        d.z = 0.0;
        if p.z > high + pad {
            return ray;
        }
    }
    if part.x > part.y {
        return ray;
    }

    // Re-base.
    ray.p = vec3<f32>(
        terrain_rebase(p.x, d.x, part.x, cells.x),
        terrain_rebase(p.y, d.y, part.x, cells.y),
        p.z + part.x * d.z,
    );
    ray.d = d;
    ray.inverse = inverse;
    ray.start = part.x;
    ray.end = part.y - part.x;
    ray.valid = true;
    return ray;
}
