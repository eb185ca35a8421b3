//! A ray carried into grid units (x, y in cells, z raw) and re-based where it enters the field's box, so that its
//! precision is that of the field and not of the way from the camera. Twin of `shaders/terrain/ray.wgsl`.

use super::layout::SceneUniform;

/// Components below this are taken as zero.
pub(super) const TINY: f32 = 1e-18;
/// Stands for the inverse of zero; finite, so that its product with zero is not NaN.
pub(super) const HUGE: f32 = 1e30;

/// `origin, direction, near, far`, in metres, as the intrinsics take it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldRay<T> {
    pub origin: [T; 3],
    pub dir: [T; 3],
    pub near: T,
    pub far: T,
}

/// Position `p + s * d` in grid units for s from 0 to `end`; the world's t is `start + s`.
#[derive(Clone, Copy, Debug)]
pub(super) struct GridRay {
    pub p: [f32; 3],
    pub d: [f32; 3],
    /// Inverse of the horizontal components of d.
    pub inverse: [f32; 2],
    pub start: f32,
    pub end: f32,
}

/// Clips the ray to the field's box; none if it misses it or is not a ray at all.
pub(super) fn enter(scene: &SceneUniform, ray: &WorldRay<f32>) -> Option<GridRay> {
    let [ox, oy, oz] = ray.origin;
    let [dx, dy, dz] = ray.dir;
    if ![ox, oy, oz, dx, dy, dz].iter().all(|x| x.is_finite()) || ray.near.is_nan() || ray.far.is_nan() {
        return None;
    }
    let mut from = ray.near.max(-HUGE);
    let mut to = ray.far.min(HUGE);
    let mut p = [
        ox * scene.inverse_spacing[0],
        oy * scene.inverse_spacing[1],
        (oz - scene.z_offset) * scene.z_inverse_scale,
    ];
    let mut d = [dx * scene.inverse_spacing[0], dy * scene.inverse_spacing[1], dz * scene.z_inverse_scale];
    let mut inverse = [HUGE; 2];
    let cells = [(scene.size[0] - 1) as f32, (scene.size[1] - 1) as f32];

    // The sides.
    for axis in 0..2 {
        if d[axis].abs() > TINY {
            inverse[axis] = 1.0 / d[axis];
            let a = (0.0 - p[axis]) * inverse[axis];
            let b = (cells[axis] - p[axis]) * inverse[axis];
            from = from.max(a.min(b));
            to = to.min(a.max(b));
        } else {
            d[axis] = 0.0;
            if p[axis] < 0.0 || p[axis] > cells[axis] {
                return None;
            }
        }
    }

    // Above the highest sample nothing can be hit.
    let (low, high) = (scene.raw_relief[0], scene.raw_relief[1]);
    let pad = 1e-3 + 1e-5 * (high - low) + 1e-6 * (high.abs() + low.abs());
    if d[2] < -TINY {
        from = from.max((high + pad - p[2]) / d[2]);
    } else if d[2] > TINY {
        to = to.min((high + pad - p[2]) / d[2]);
    } else {
        d[2] = 0.0;
        if p[2] > high + pad {
            return None;
        }
    }
    if from > to {
        return None;
    }

    // Re-base. Without horizontal motion the far rim belongs to the last cell.
    for axis in 0..2 {
        p[axis] = (p[axis] + from * d[axis]).clamp(0.0, cells[axis]);
        if d[axis] == 0.0 {
            p[axis] = p[axis].min(cells[axis] * 0.9999999);
        }
    }
    p[2] += from * d[2];
    Some(GridRay { p, d, inverse, start: from, end: to - from })
}
