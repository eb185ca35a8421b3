//! A ray carried into grid units and re-based where it enters the field's box, and again in tiles, so that its precision
//! is that of a few cells: neither the way from the camera nor the size of the field counts. A base is computed from the
//! ray itself by error-free transforms, so errors do not add up. Twin of `shaders/terrain/ray.wgsl`.

use super::layout::SceneUniform;
use super::transforms::{product, quotient, sum};

/// Components below this are taken as zero.
pub(super) const TINY: f32 = 1e-18;
/// Stands for the inverse of zero; finite, so that its product with zero is not NaN.
pub(super) const HUGE: f32 = 1e30;
/// The last place in a cell that is not the next one's.
const INSIDE: f32 = 0.9999999;
/// Cells after which a ray is re-based.
const TILE: f32 = 256.0;

/// `origin, direction, near, far`, in metres, as the intrinsics take it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldRay<T> {
    pub origin: [T; 3],
    pub dir: [T; 3],
    pub near: T,
    pub far: T,
}

/// Position `cell + p + s * (d + rest)` in grid units (x, y in cells, z raw); the world's t is `start + s`.
#[derive(Clone, Copy, Debug)]
pub(super) struct GridRay {
    pub origin: [f32; 3],
    pub dir: [f32; 3],
    pub start: f32,
    /// The world's t beyond which nothing is hit.
    pub far: f32,
    /// Cell of the base.
    pub cell: [i32; 2],
    /// The base in its cell.
    pub p: [f32; 2],
    /// Its raw z and what rounding lost of it.
    pub z: [f32; 2],
    pub d: [f32; 3],
    /// What rounding lost of d.
    pub rest: [f32; 3],
    /// Inverse of the horizontal components of d.
    pub inverse: [f32; 2],
    /// -1 / d.z of a ray that falls, else 0.
    pub fall: f32,
    /// z lowered by the rounding of the walk's heights.
    pub low: f32,
    /// The part of s that is walked from this base.
    pub from: f32,
    pub end: f32,
    /// Nothing is left behind the end.
    pub last: bool,
}

/// Clips the ray to the field's box, whose top is raised by a part of the relief; none if it misses it or is not a ray at all.
pub(super) fn enter(scene: &SceneUniform, ray: &WorldRay<f32>, overshoot: f32) -> Option<GridRay> {
    let [ox, oy, oz] = ray.origin;
    let [dx, dy, dz] = ray.dir;
    if ![ox, oy, oz, dx, dy, dz].iter().all(|x| x.is_finite()) || ray.near.is_nan() || ray.far.is_nan() {
        return None;
    }
    let near = ray.near.max(-HUGE);
    let mut from = near;
    let mut to = ray.far.min(HUGE);
    let units = [scene.spacing[0], scene.spacing[1], scene.z_scale];
    let inverses = [scene.inverse_spacing[0], scene.inverse_spacing[1], scene.z_inverse_scale];
    let p =
        [ox * scene.inverse_spacing[0], oy * scene.inverse_spacing[1], (oz - scene.z_offset) * inverses[2]];
    let mut d = [0.0; 3];
    let mut rest = [0.0; 3];
    for axis in 0..3 {
        let [q, lost] = quotient([ray.dir[axis], 0.0], units[axis], inverses[axis]);
        if q.abs() > TINY {
            (d[axis], rest[axis]) = (q, lost);
        }
    }

    // The sides, roughly: single precision is that of the origin here.
    let mut inverse = [HUGE; 2];
    let cells = [(scene.size[0] - 1) as f32, (scene.size[1] - 1) as f32];
    for axis in 0..2 {
        if d[axis] == 0.0 {
            if p[axis] < 0.0 || p[axis] > cells[axis] * 1.000001 {
                return None;
            }
            continue;
        }
        inverse[axis] = 1.0 / d[axis];
        let a = (0.0 - p[axis]) * inverse[axis];
        let b = (cells[axis] - p[axis]) * inverse[axis];
        let slack = 5e-7 * (p[axis].abs() + cells[axis]) * inverse[axis].abs();
        from = from.max(a.min(b) - slack);
        to = to.min(a.max(b) + slack);
    }

    // Above the surface nothing can be hit.
    let low = scene.raw_relief[0];
    let high = scene.raw_relief[1] + overshoot * (scene.raw_relief[1] - low);
    let size = high.abs() + low.abs();
    let top = high + 1e-3 + 1e-5 * (high - low) + 1e-6 * size + 1e-6 * p[2].abs();
    let mut begin = near;
    let mut far = ray.far.min(HUGE);
    if d[2] < 0.0 {
        begin = begin.max((top - p[2]) / d[2]);
        from = from.max(begin);
    } else if d[2] > 0.0 {
        far = far.min((top - p[2]) / d[2]);
        to = to.min(far);
    } else if p[2] > top {
        return None;
    }
    if from > to {
        return None;
    }
    let fall = if d[2] < 0.0 { -1.0 / d[2] } else { 0.0 };
    let base = GridRay {
        origin: ray.origin,
        dir: ray.dir,
        start: from,
        far,
        cell: [0; 2],
        p: [0.0; 2],
        z: [0.0; 2],
        d,
        rest,
        inverse,
        fall,
        low: 0.0,
        from: begin - from,
        end: 0.0,
        last: true,
    };
    placed(scene, base)
}

/// The ray from a base at s, for the way behind it; none if none is left.
pub(super) fn onward(scene: &SceneUniform, ray: &GridRay, s: f32) -> Option<GridRay> {
    let start = ray.start + s;
    placed(scene, GridRay { start, from: s - (start - ray.start), ..*ray })
}

/// Computes the base at `start` and clips the way from `from` on.
fn placed(scene: &SceneUniform, ray: GridRay) -> Option<GridRay> {
    let mut ray = ray;
    for axis in 0..2 {
        (ray.cell[axis], ray.p[axis]) = place(
            ray.origin[axis],
            ray.dir[axis],
            ray.start,
            (scene.spacing[axis], scene.inverse_spacing[axis]),
            scene.size[axis] as i32 - 2,
        );
    }
    let way = product(ray.start, ray.dir[2]);
    let height = sum(ray.origin[2], way[0]);
    let above = sum(height[0], -scene.z_offset);
    ray.z = quotient([above[0], above[1] + (height[1] + way[1])], scene.z_scale, scene.z_inverse_scale);
    let (low, high) = (scene.raw_relief[0], scene.raw_relief[1]);
    // Far away what rounding lost is more than the margin.
    ray.low = ray.z[0] + ray.z[1] - 5e-7 * (ray.z[0].abs() + high.abs() + low.abs());

    let mut end = ray.far - ray.start;
    let rim = [scene.size[0] as i32 - 1, scene.size[1] as i32 - 1];
    let (south_west, north_east) = (planes(&ray, 0, 0), planes(&ray, rim[0], rim[1]));
    for axis in 0..2 {
        if ray.d[axis] != 0.0 {
            ray.from = ray.from.max(south_west[axis].min(north_east[axis]));
            end = end.min(south_west[axis].max(north_east[axis]));
        } else if (ray.cell[axis] - rim[axis]) as f32 + ray.p[axis] > 0.0 {
            return None;
        } else {
            // Without motion the far rim belongs to the last cell.
            ray.p[axis] = ray.p[axis].min(INSIDE);
        }
    }
    let tile = ray.from + TILE * ray.inverse[0].abs().min(ray.inverse[1].abs());
    ray.last = end <= tile;
    ray.end = end.min(tile);
    (ray.from <= ray.end).then_some(ray)
}

/// Cell and position in it of `origin + t * dir` along one axis; the cell is one of 0 to `last`.
fn place(origin: f32, dir: f32, t: f32, (unit, inverse): (f32, f32), last: i32) -> (i32, f32) {
    let x = origin + t * dir;
    let index = (x * inverse).floor().clamp(0.0, last as f32) as i32;
    (index, off_plane(origin, dir, t, unit, index) * inverse)
}

/// Metres by which `origin + t * dir` is beyond a grid plane, without loss.
pub(super) fn off_plane(origin: f32, dir: f32, t: f32, unit: f32, plane: i32) -> f32 {
    let way = product(t, dir);
    let x = sum(origin, way[0]);
    let edge = product(plane as f32, unit);
    ((x[0] - edge[0]) - edge[1]) + (x[1] + way[1])
}

/// Distances to the planes `x = i` and `y = j`: the only expression for them, monotone in i and j.
#[inline]
pub(super) fn planes(ray: &GridRay, i: i32, j: i32) -> [f32; 2] {
    [
        ((i - ray.cell[0]) as f32 - ray.p[0]) * ray.inverse[0],
        ((j - ray.cell[1]) as f32 - ray.p[1]) * ray.inverse[1],
    ]
}
