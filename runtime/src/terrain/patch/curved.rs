//! The bicubic patch and the paper's approximation of it (section 3.2). Twin of `shaders/terrain/patch_bicubic.wgsl` and
//! `patch_subdivided.wgsl`.

use super::sextic::Sextic;
use super::{Bilinear, MISS, Patch, Way};
use crate::terrain::bicubic::{Around, part, slope_weights, weights};
use crate::terrain::layout::SceneUniform;
use crate::terrain::walk::Heights;

/// Weights below 0 add up to 9/32 at most (`compiler/src/bounds/surfaces.rs`): a patch passes its samples by no more of their
/// spread.
const OVERSHOOT: f32 = 9.0 / 32.0;

/// The part of [`Patch`] that surfaces share which depend on the 4 x 4 samples around a cell.
macro_rules! around {
    () => {
        type Samples = Around;
        const OVERSHOOT: f32 = OVERSHOOT;
        const ROUNDED: f32 = 1e-6;

        fn samples<H: Heights>(&self, scene: &SceneUniform, heights: &H, cell: [i32; 2]) -> Option<Around> {
            Around::new(scene, heights, cell.map(|i| i as u32))
        }

        fn bound<H: Heights>(heights: &H, index: usize) -> f32 {
            heights.crest(index)
        }

        fn range(samples: &Around) -> [f32; 2] {
            let [low, high] = samples.range();
            let over = OVERSHOOT * (high - low);
            [samples.base + (low - over), samples.base + (high + over)]
        }

        fn corner(samples: &Around, [east, north]: [bool; 2]) -> f32 {
            samples.base + samples.rows[1 + usize::from(north)][1 + usize::from(east)]
        }
    };
}

/// A place in the cell and the way's height over the surface's `base`, of a way that is seen from one of the corners.
fn within(samples: &Around, way: &Way, [east, north]: [bool; 2]) -> [f32; 3] {
    let corner = samples.rows[1 + usize::from(north)][1 + usize::from(east)];
    [way.u + f32::from(u8::from(east)), way.v + f32::from(u8::from(north)), corner]
}

#[derive(Clone, Copy)]
pub(in crate::terrain) struct Bicubic;

/// Coefficients of 1, t, t^2, t^3 of a row of samples.
fn powers([a, b, c, d]: [f32; 4]) -> [f32; 4] {
    [b, 0.5 * (c - a), (a - 2.5 * b) + (2.0 * c - 0.5 * d), 1.5 * (b - c) + 0.5 * (d - a)]
}

/// Of a cubic whose variable is `at + by * x`.
fn along([a, b, c, d]: [f32; 4], at: f32, by: f32) -> [f32; 4] {
    [
        a + at * (b + at * (c + at * d)),
        by * (b + at * (2.0 * c + at * (3.0 * d))),
        by * by * (c + 3.0 * d * at),
        by * by * by * d,
    ]
}

/// Height of the way over the patch, by the share of the way.
fn height_over(samples: &Around, way: &Way) -> Sextic {
    let [du, dv] = [way.du * way.length, way.dv * way.length];
    let rows = samples.rows.map(|row| along(powers(row), way.u, du));
    // Cubics of the share for each power of v.
    let column = |k: usize| powers([rows[0][k], rows[1][k], rows[2][k], rows[3][k]]);
    let columns = [column(0), column(1), column(2), column(3)];
    let by_v = |power: usize| [columns[0][power], columns[1][power], columns[2][power], columns[3][power]];
    let mut sum = [0.0; 7];
    for power in (0..4).rev() {
        // Times v, and the next power's.
        for k in (1..7).rev() {
            sum[k] = sum[k] * way.v + sum[k - 1] * dv;
        }
        sum[0] *= way.v;
        for (sum, c) in sum.iter_mut().zip(by_v(power)) {
            *sum += c;
        }
    }
    let mut f = sum.map(|c| -c);
    f[0] += way.z;
    f[1] += way.dz * way.length;
    Sextic(f)
}

impl Patch for Bicubic {
    around!();

    fn over(&self, samples: &Around, way: &Way, from: [bool; 2]) -> [f32; 2] {
        let [u, v, corner] = within(samples, way, from);
        let east = samples.blend(slope_weights(u), weights(v));
        let north = samples.blend(weights(u), slope_weights(v));
        let height = samples.blend(weights(u), weights(v)) - corner;
        [way.z - height, way.dz - east * way.du - north * way.dv]
    }

    /// A ray that falls is under all of it long before a way ends that is without end.
    fn intersect(&self, samples: &Around, way: &Way) -> f32 {
        let mut way = *way;
        if way.dz < 0.0 {
            let [low, high] = Bicubic::range(samples).map(|z| z - samples.base);
            let below = way.z - low + 0.1 * (high - low) + 1e-5 * (way.z.abs() + low.abs()) + 1e-3;
            way.length = way.length.min(below.max(0.0) / -way.dz);
        }
        match height_over(samples, &way).first() {
            Some(share) => share * way.length,
            None => MISS,
        }
    }
}

#[derive(Clone, Copy)]
pub(in crate::terrain) struct Subdivided {
    /// Along a cell's side, whole.
    pub parts: f32,
}

impl Patch for Subdivided {
    around!();

    fn over(&self, samples: &Around, way: &Way, from: [bool; 2]) -> [f32; 2] {
        let [u, v, corner] = within(samples, way, from);
        let n = self.parts;
        let at = [part(u, n), part(v, n)];
        let corners = samples.part(at, n);
        let way = Way {
            u: u * n - at[0],
            v: v * n - at[1],
            z: way.z - (corners.sw - corner),
            du: way.du * n,
            dv: way.dv * n,
            ..*way
        };
        Bilinear.over(&corners, &way, [false; 2])
    }

    /// From part to part by their indices.
    fn intersect(&self, samples: &Around, way: &Way) -> f32 {
        let n = self.parts;
        let (start, dir) = ([way.u * n, way.v * n], [way.du * n, way.dv * n]);
        let mut at = [part(way.u, n), part(way.v, n)];
        let mut s = 0.0f32;
        loop {
            let exit = [0, 1].map(|k| {
                let plane = at[k] + f32::from(u8::from(dir[k] > 0.0));
                if dir[k] == 0.0 { way.length } else { (plane - start[k]) / dir[k] }
            });
            let out = exit[0].min(exit[1]).clamp(s, way.length);
            let corners = samples.part(at, n);
            let piece = Way {
                u: start[0] + s * dir[0] - at[0],
                v: start[1] + s * dir[1] - at[1],
                z: (way.z + s * way.dz) - corners.sw,
                du: dir[0],
                dv: dir[1],
                dz: way.dz,
                length: out - s,
            };
            let met = Bilinear.intersect(&corners, &piece);
            if met >= 0.0 {
                return s + met;
            }
            let axis = usize::from(exit[1] < exit[0]);
            at[axis] += if dir[axis] > 0.0 { 1.0 } else { -1.0 };
            if out >= way.length || at[axis] < 0.0 || at[axis] >= n {
                return MISS;
            }
            s = out;
        }
    }
}
