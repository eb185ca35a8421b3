//! First intersection by a walk over the maximum mipmap (paper, section 3.1). Twin of `shaders/terrain/walk.wgsl`.
//!
//! The position is a node's integer index and nothing else; it changes by steps, descents and ascents. Distances are
//! only ever distances to grid planes, by one expression ([`planes`]), which is monotone in the plane's index. Hence
//! neighbouring nodes agree on every crossing to the bit between two bases, and no rounding can lead to a node twice.

use super::field::{VOID_F32, VOID_I16};
use super::layout::SceneUniform;
use super::patch::{Bicubic, Patch, Way};
use super::ray::{GridRay, WorldRay, enter, off_plane, onward, planes};
use super::transforms::{high, sum};

/// Samples and bounds as raw floats.
pub(super) trait Heights {
    fn sample(&self, index: usize) -> f32;
    fn bound(&self, index: usize) -> f32;
    /// Of the minimum mipmap.
    fn floor(&self, index: usize) -> f32;
    /// Of the bicubic surface's upper bounds.
    fn crest(&self, index: usize) -> f32;
}

pub(super) struct Heights16<'a> {
    pub samples: &'a [i16],
    pub bounds: &'a [i16],
    pub floors: &'a [i16],
    pub crests: &'a [i16],
}

pub(super) struct Heights32<'a> {
    pub samples: &'a [f32],
    pub bounds: &'a [f32],
    pub floors: &'a [f32],
    pub crests: &'a [f32],
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

    /// The highest number stands for all above it.
    #[inline]
    fn crest(&self, index: usize) -> f32 {
        if self.crests[index] == i16::MAX { f32::MAX } else { raw16(self.crests[index]) }
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

    #[inline]
    fn crest(&self, index: usize) -> f32 {
        self.crests[index]
    }
}

/// Told of every node and cell that a ray is tested against.
pub(super) trait Meter {
    fn count(&mut self);
}

impl Meter for () {
    #[inline]
    fn count(&mut self) {}
}

impl Meter for u64 {
    #[inline]
    fn count(&mut self) {
        *self += 1;
    }
}

/// Distance along the ray of the first surface point, if any.
pub(super) fn trace<H: Heights, P: Patch>(
    scene: &SceneUniform,
    heights: &H,
    patch: P,
    ray: &WorldRay<f32>,
) -> Option<f32> {
    metered(scene, heights, patch, ray, &mut ())
}

/// The same, counted.
pub(super) fn metered<H: Heights, P: Patch, M: Meter>(
    scene: &SceneUniform,
    heights: &H,
    patch: P,
    ray: &WorldRay<f32>,
    meter: &mut M,
) -> Option<f32> {
    let grid = enter(scene, ray, P::OVERSHOOT)?;
    let met = walk(scene, heights, Some(&patch), grid, meter)?;
    Some(settle(scene, heights, &patch, &met).clamp(ray.near, ray.far))
}

/// The first cell in which the ray may be no more than `raise` over the bicubic surface: where the ray comes into it, and the cell.
/// Twin of `shaders/terrain/next_cell.wgsl`.
pub(super) fn next_cell<H: Heights>(
    scene: &SceneUniform,
    heights: &H,
    ray: &WorldRay<f32>,
    raise: f32,
) -> Option<[f32; 3]> {
    let [x, y, z] = ray.origin;
    let lowered = WorldRay { origin: [x, y, z - raise], ..*ray };
    let grid = enter(scene, &lowered, Bicubic::OVERSHOOT)?;
    let met = walk::<H, Bicubic, ()>(scene, heights, None, grid, &mut ())?;
    let entry = (met.ray.start + met.at[0]).clamp(ray.near, ray.far);
    Some([entry, met.node[0] as f32, met.node[1] as f32])
}

/// What a walk meets: the ray by its last base, the cell, the distance there with the rest of it.
struct Met {
    ray: GridRay,
    node: [i32; 2],
    at: [f32; 2],
}

/// The level of the node that a walk begins with.
const FIRST: u32 = 2;

/// Without a patch every cell that the ray comes near to is met. Three loops: bases of the ray, cells that may be hit, nodes over them. A SIMD machine without branches pays for what a
/// loop holds in every turn of it, so what is dear stands in the loop that turns least.
fn walk<H: Heights, P: Patch, M: Meter>(
    scene: &SceneUniform,
    heights: &H,
    patch: Option<&P>,
    ray: GridRay,
    meter: &mut M,
) -> Option<Met> {
    let mut ray = ray;
    let cells = [scene.size[0] as i32 - 1, scene.size[1] as i32 - 1];
    // 1 where the ray leaves a node through its upper plane.
    let ahead = [i32::from(ray.d[0] >= 0.0), i32::from(ray.d[1] >= 0.0)];
    let outside =
        |node: [i32; 2], level: u32, axis: usize| node[axis] < 0 || (node[axis] << level) >= cells[axis];
    let leave = |ray: &GridRay, node: [i32; 2], level: u32| {
        planes(ray, (node[0] + ahead[0]) << level, (node[1] + ahead[1]) << level)
    };
    // Rays meet something near where they begin more often than not, so they begin low, unless rounding has put their
    // beginning outside of the planes of its own node, or on the one that it leaves by.
    let first = FIRST.min(scene.top);
    let mut level = first;
    let mut node = ray.cell.map(|cell| cell >> first);
    let entry = planes(&ray, (node[0] + 1 - ahead[0]) << first, (node[1] + 1 - ahead[1]) << first);
    let exit = leave(&ray, node, first);
    if (0..2).any(|axis| entry[axis] > ray.from || ray.from >= exit[axis]) {
        (level, node) = (scene.top, [0; 2]);
    }
    let mut fuel = scene.fuel;
    let mut gone = false;
    loop {
        let mut s = ray.from;
        let mut z = ray.low + s * ray.d[2];
        let mut exit = leave(&ray, node, level);
        let mut out = exit[0].min(exit[1]).min(ray.end);
        let mut ended = false;
        loop {
            while level > 0 && !(gone || ended) {
                meter.count();
                let z_out = ray.low + out * ray.d[2];
                let [offset, width, _, _] = scene.levels[level as usize];
                let bound = P::bound(heights, (offset + node[1] as u32 * width + node[0] as u32) as usize);
                if z.min(z_out) <= bound {
                    // Descend to the half of each axis that the ray is in at s; on the plane between them to that which it leaves,
                    // so that a ray through a corner is tested against the cells beside it, but for one that begins there.
                    level -= 1;
                    let middle = [(2 * node[0] + 1) << level, (2 * node[1] + 1) << level];
                    let distance = planes(&ray, middle[0], middle[1]);
                    for axis in 0..2 {
                        let crossed = s > distance[axis] || (s == distance[axis] && s <= ray.from);
                        let upper = crossed == (ahead[axis] == 1) && middle[axis] < cells[axis];
                        node[axis] = 2 * node[axis] + i32::from(upper);
                        if !crossed {
                            exit[axis] = distance[axis];
                        }
                    }
                } else if out >= ray.end {
                    ended = true;
                } else {
                    // Step to the neighbour behind the nearer plane; ascend when that leaves the parent.
                    fuel -= 1;
                    s = out;
                    z = z_out;
                    let axis = usize::from(exit[1] < exit[0]);
                    node[axis] += 2 * ahead[axis] - 1;
                    gone = outside(node, level, axis) || fuel == 0;
                    if (node[axis] & 1) != ahead[axis] && level < scene.top {
                        level += 1;
                        node = [node[0] >> 1, node[1] >> 1];
                    }
                    exit = leave(&ray, node, level);
                }
                out = exit[0].min(exit[1]).min(ray.end);
            }
            if gone || ended {
                break;
            }
            meter.count();
            let z_out = ray.low + out * ray.d[2];
            let found = match patch {
                Some(patch) => cell(scene, heights, patch, &ray, node, (s, out), (z, z_out)),
                None => Some([s, 0.0]),
            };
            if let Some(at) = found {
                return Some(Met { ray, node, at });
            }
            if out >= ray.end {
                break;
            }
            fuel -= 1;
            s = out;
            z = z_out;
            let axis = usize::from(exit[1] < exit[0]);
            node[axis] += 2 * ahead[axis] - 1;
            gone = outside(node, 0, axis) || fuel == 0;
            if (node[axis] & 1) != ahead[axis] && scene.top > 0 {
                level = 1;
                node = [node[0] >> 1, node[1] >> 1];
            }
            exit = leave(&ray, node, level);
            out = exit[0].min(exit[1]).min(ray.end);
        }
        // A base ends where the ray is still over the field.
        if ray.last || gone {
            return None;
        }
        ray = onward(scene, &ray, out)?;
    }
}

/// Where the ray meets the cell that it is in between two distances: a distance, and the rest of it. The heights are the walk's, a little too
/// low; what decides is computed here from the base without loss.
#[inline]
fn cell<H: Heights, P: Patch>(
    scene: &SceneUniform,
    heights: &H,
    patch: &P,
    ray: &GridRay,
    node: [i32; 2],
    (s, out): (f32, f32),
    (z, z_out): (f32, f32),
) -> Option<[f32; 2]> {
    let samples = patch.samples(scene, heights, node)?;
    let [_, highest] = P::range(&samples);
    if z.min(z_out) > highest {
        return None;
    }
    // From high above, begin where the cell's top is near.
    let s = (s + (z - highest).max(0.0) * ray.fall * 0.999999).min(out);
    let way = reach(ray, node, P::corner(&samples, [false; 2]), s, ray.rest.map(|rest| s * rest), out - s);
    let hit = patch.intersect(&samples, &way);
    (hit >= 0.0).then_some([s, hit])
}

/// The way from s on, seen from a sample of that height: computed from the base without loss. `more` is what single precision leaves out of it.
#[inline]
fn reach(ray: &GridRay, at: [i32; 2], corner: f32, s: f32, more: [f32; 3], length: f32) -> Way {
    let upper = high(s);
    let lower = s - upper;
    // s * d, and what rounding lost of it.
    let way = [0, 1, 2].map(|axis| {
        let d = ray.d[axis];
        let p = s * d;
        let (dh, dl) = (high(d), d - high(d));
        [p, (((upper * dh - p) + upper * dl + lower * dh) + lower * dl) + more[axis]]
    });
    let place =
        |axis: usize| ((ray.cell[axis] - at[axis]) as f32 + way[axis][0]) + (way[axis][1] + ray.p[axis]);
    let above = sum(ray.z[0], -corner);
    Way {
        u: place(0),
        v: place(1),
        z: (above[0] + way[2][0]) + (above[1] + (ray.z[1] + way[2][1])),
        du: ray.d[0],
        dv: ray.d[1],
        dz: ray.d[2],
        length,
    }
}

/// The world's t. A root is as exact as the way through a cell is long and as its corners are far apart; one step of Newton's
/// method, seen from the nearest corner, makes it as exact as heights there are. It is left out where it is more than such
/// roundings: there the ray grazes, or it came in under the surface, at a wall along the rim or a void. Then it is one step to
/// the wall, for distances to planes are only as exact as the way from a base. Beside a sample the ray may so
/// come into a cell a little under its surface, which is no wall.
fn settle<H: Heights, P: Patch>(scene: &SceneUniform, heights: &H, patch: &P, met: &Met) -> f32 {
    let Met { ray, node, at: [s, hit], .. } = *met;
    let ray = &ray;
    let Some(samples) = patch.samples(scene, heights, node) else { return ray.start + (s + hit) };
    let at = sum(s, hit);
    let more = [0, 1, 2].map(|axis| at[0] * ray.rest[axis] + at[1] * ray.d[axis]);
    let far =
        [0, 1].map(|axis| (ray.cell[axis] - node[axis]) as f32 + (at[0] * ray.d[axis] + ray.p[axis]) > 0.5);
    let corner = [0, 1].map(|axis| node[axis] + i32::from(far[axis]));
    let way = reach(ray, corner, P::corner(&samples, far), at[0], more, 0.0);
    let [over, change] = patch.over(&samples, &way, far);
    let [lowest, highest] = P::range(&samples);
    let step = -over / change;
    let rounded = over.abs() <= P::ROUNDED * (highest - lowest);
    let cell = ray.inverse[0].abs().min(ray.inverse[1].abs());
    let most = if rounded { 1e-5 * cell } else { 2e-6 * cell + 1.2e-7 * s };
    let base = sum(ray.start, at[0]);
    let t = base[0] + (base[1] + at[1]);

    let entry = [0, 1].map(|axis| node[axis] + i32::from(ray.d[axis] < 0.0));
    let distance = planes(ray, entry[0], entry[1]);
    let axis = usize::from(distance[1] > distance[0]);
    let back =
        -off_plane(ray.origin[axis], ray.dir[axis], t, scene.spacing[axis], entry[axis]) / ray.dir[axis];
    if hit == 0.0 && !rounded && back.abs() <= 2e-6 * ray.inverse[axis].abs() + 6e-8 * t.abs() {
        t + back
    } else if change < 0.0 && step.abs() <= most {
        base[0] + (base[1] + (at[1] + step))
    } else {
        t
    }
}
