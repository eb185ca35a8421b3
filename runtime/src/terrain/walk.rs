//! First intersection by a walk over the maximum mipmap (paper, section 3.1). Twin of `shaders/terrain/walk.wgsl`.
//!
//! The position is a node's integer index and nothing else; it changes by steps, descents and ascents. Distances are
//! only ever distances to grid planes, by one expression ([`planes`]), which is monotone in the plane's index. Hence
//! neighbouring nodes agree on every crossing to the bit, and no rounding can lead to a node twice.

use super::field::{VOID_F32, VOID_I16};
use super::layout::SceneUniform;
use super::patch::{Corners, MISS, Patch, Way};
use super::ray::{GridRay, WorldRay, enter};

/// Samples and bounds as raw floats.
pub(super) trait Heights {
    fn sample(&self, index: usize) -> f32;
    fn bound(&self, index: usize) -> f32;
    /// Of the minimum mipmap.
    fn floor(&self, index: usize) -> f32;
}

pub(super) struct Heights16<'a> {
    pub samples: &'a [i16],
    pub bounds: &'a [i16],
    pub floors: &'a [i16],
}

pub(super) struct Heights32<'a> {
    pub samples: &'a [f32],
    pub bounds: &'a [f32],
    pub floors: &'a [f32],
}

impl Heights for Heights16<'_> {
    #[inline]
    fn sample(&self, index: usize) -> f32 {
        raw16(self.samples[index])
    }

    /// The void's own value is below every sample and serves as it is.
    #[inline]
    fn bound(&self, index: usize) -> f32 {
        raw16(self.bounds[index])
    }

    #[inline]
    fn floor(&self, index: usize) -> f32 {
        raw16(self.floors[index])
    }
}

#[inline]
fn raw16(raw: i16) -> f32 {
    if raw == VOID_I16 { VOID_F32 } else { f32::from(raw) }
}

impl Heights for Heights32<'_> {
    #[inline]
    fn sample(&self, index: usize) -> f32 {
        self.samples[index]
    }

    #[inline]
    fn bound(&self, index: usize) -> f32 {
        self.bounds[index]
    }

    #[inline]
    fn floor(&self, index: usize) -> f32 {
        self.floors[index]
    }
}

/// Distance along the ray of the first surface point, if any.
pub(super) fn trace<H: Heights, P: Patch>(
    scene: &SceneUniform,
    heights: &H,
    ray: &WorldRay<f32>,
) -> Option<f32> {
    let grid = enter(scene, ray)?;
    let s = walk::<H, P>(scene, heights, &grid);
    (s >= 0.0).then(|| (grid.start + s).clamp(ray.near, ray.far))
}

/// Distances to the planes `x = i` and `y = j`.
#[inline]
fn planes(ray: &GridRay, i: i32, j: i32) -> [f32; 2] {
    [(i as f32 - ray.p[0]) * ray.inverse[0], (j as f32 - ray.p[1]) * ray.inverse[1]]
}

fn walk<H: Heights, P: Patch>(scene: &SceneUniform, heights: &H, ray: &GridRay) -> f32 {
    let cells = [scene.size[0] as i32 - 1, scene.size[1] as i32 - 1];
    // 1 where the ray leaves a node through its upper plane.
    let ahead = [i32::from(ray.d[0] >= 0.0), i32::from(ray.d[1] >= 0.0)];
    let mut level = scene.top;
    let mut node = [0i32; 2];
    let mut exit = planes(ray, ahead[0] << level, ahead[1] << level);
    let mut s = 0.0f32;
    let mut z = ray.p[2];

    for _ in 0..scene.fuel {
        let out = exit[0].min(exit[1]).min(ray.end);
        let z_out = ray.p[2] + out * ray.d[2];
        let lowest = z.min(z_out);
        if level > 0 {
            let [offset, width, _, _] = scene.levels[level as usize];
            if lowest <= heights.bound((offset + node[1] as u32 * width + node[0] as u32) as usize) {
                // Descend to the half of each axis that the ray is in at s.
                level -= 1;
                let middle = [(2 * node[0] + 1) << level, (2 * node[1] + 1) << level];
                let distance = planes(ray, middle[0], middle[1]);
                for axis in 0..2 {
                    let crossed = s >= distance[axis];
                    let upper = crossed == (ahead[axis] == 1) && middle[axis] < cells[axis];
                    node[axis] = 2 * node[axis] + i32::from(upper);
                    if !crossed {
                        exit[axis] = distance[axis];
                    }
                }
                continue;
            }
        } else {
            let hit = cell::<H, P>(scene, heights, ray, node, (s, out), (z, z_out));
            if hit >= 0.0 {
                return hit;
            }
        }
        if out >= ray.end {
            return MISS;
        }

        // Step to the neighbour behind the nearer plane; ascend when that leaves the parent.
        s = out;
        z = z_out;
        let axis = usize::from(exit[1] < exit[0]);
        node[axis] += 2 * ahead[axis] - 1;
        let outside = node[axis] < 0 || (node[axis] << level) >= cells[axis];
        if outside {
            return MISS;
        }
        if (node[axis] & 1) != ahead[axis] && level < scene.top {
            level += 1;
            node = [node[0] >> 1, node[1] >> 1];
            exit = planes(ray, (node[0] + ahead[0]) << level, (node[1] + ahead[1]) << level);
        } else {
            exit[axis] = planes(ray, (node[0] + ahead[0]) << level, (node[1] + ahead[1]) << level)[axis];
        }
    }
    MISS
}

/// Intersection with the cell that the ray is in between two distances.
#[inline]
fn cell<H: Heights, P: Patch>(
    scene: &SceneUniform,
    heights: &H,
    ray: &GridRay,
    node: [i32; 2],
    (s, out): (f32, f32),
    (z, z_out): (f32, f32),
) -> f32 {
    let width = scene.size[0] as usize;
    let at = node[1] as usize * width + node[0] as usize;
    let corners = Corners {
        sw: heights.sample(at),
        se: heights.sample(at + 1),
        nw: heights.sample(at + width),
        ne: heights.sample(at + width + 1),
    };
    if z.min(z_out) > corners.highest() || corners.lowest() == VOID_F32 {
        return MISS;
    }
    let (x, y) = (node[0] as f32, node[1] as f32);
    let local = |s: f32| {
        (((ray.p[0] + s * ray.d[0]) - x).clamp(0.0, 1.0), ((ray.p[1] + s * ray.d[1]) - y).clamp(0.0, 1.0))
    };
    let (entry, leave) = (local(s), local(out));
    let way = Way {
        u: [entry.0, leave.0],
        v: [entry.1, leave.1],
        z: [z, z_out],
        du: ray.d[0],
        dv: ray.d[1],
        dz: ray.d[2],
        length: out - s,
    };
    let hit = P::intersect(&corners, &way);
    if hit >= 0.0 { s + hit } else { MISS }
}
