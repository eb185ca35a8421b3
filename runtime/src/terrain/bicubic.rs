//! Catmull-Rom bicubic heights with their derivatives, and the paper's approximation of them (section 3.2): bicubic at the
//! points of an n x n split of each cell, bilinear between. Twin of `shaders/terrain/neighbours.wgsl`, `bicubic.wgsl`,
//! `part.wgsl`, `fine.wgsl`, `subdivided.wgsl` and those of their derivatives.

use super::field::VOID_F32;
use super::layout::SceneUniform;
use super::patch::{Bilinear, Corners, Interpolation};
use super::surface::{at_rim, slope};
use super::walk::Heights;

/// The 4 x 4 samples around a cell less its south-western one, rows from south to north. Beyond the rim and beyond a
/// void the nearer sample is repeated.
#[derive(Clone, Copy, Debug)]
pub(super) struct Around {
    pub rows: [[f32; 4]; 4],
    pub base: f32,
}

impl Around {
    /// None if the cell touches a void.
    pub fn new<H: Heights>(scene: &SceneUniform, heights: &H, [i, j]: [u32; 2]) -> Option<Around> {
        Around::of(scene.size, |i, j| heights.sample((j * scene.size[0] + i) as usize), [i, j])
    }

    /// The same of a field of so many samples in a row and rows.
    pub fn of(size: [u32; 2], sample: impl Fn(u32, u32) -> f32, [i, j]: [u32; 2]) -> Option<Around> {
        let last = size.map(|n| n - 1);
        let columns = [i.max(1) - 1, i, i + 1, (i + 2).min(last[0])];
        let row = |j: u32| columns.map(|i| sample(i, j));
        let (b, c) = (row(j), row(j + 1));
        if [b[1], b[2], c[1], c[2]].contains(&VOID_F32) {
            return None;
        }
        let nearer = |outer: [f32; 4], inner: [f32; 4]| {
            [0, 1, 2, 3].map(|k| if outer[k] == VOID_F32 { inner[k] } else { outer[k] })
        };
        let a = nearer(row(j.max(1) - 1), b);
        let d = nearer(row((j + 2).min(last[1])), c);
        let base = b[1];
        let repaired = |row: [f32; 4]| {
            let west = if row[0] == VOID_F32 { row[1] } else { row[0] };
            let east = if row[3] == VOID_F32 { row[2] } else { row[3] };
            [west, row[1], row[2], east].map(|z| z - base)
        };
        Some(Around { rows: [a, b, c, d].map(repaired), base })
    }

    /// Blend across the rows, then along them.
    pub fn blend(&self, across: [f32; 4], along: [f32; 4]) -> f32 {
        blend(along, self.rows.map(|row| blend(across, row)))
    }

    /// Heights less `base` at the corners of a part of an n x n split.
    pub fn part(&self, [i, j]: [f32; 2], n: f32) -> Corners {
        let [west, east] = [weights(i / n), weights((i + 1.0) / n)];
        let [south, north] = [weights(j / n), weights((j + 1.0) / n)];
        Corners {
            sw: self.blend(west, south),
            se: self.blend(east, south),
            nw: self.blend(west, north),
            ne: self.blend(east, north),
        }
    }

    /// Least and greatest sample less `base`.
    pub fn range(&self) -> [f32; 2] {
        let all = self.rows.as_flattened().iter();
        all.fold([f32::MAX, f32::MIN], |[low, high], z| [low.min(*z), high.max(*z)])
    }

    /// Least and greatest slope over the cell by x, by y, raw units a cell.
    pub fn inclines(&self) -> [[f32; 2]; 2] {
        let rows = &self.rows;
        let columns = [0, 1, 2, 3].map(|k| [rows[0][k], rows[1][k], rows[2][k], rows[3][k]]);
        [hull(self.rows), hull(columns)]
    }

    /// What the surface over the cell does not pass, less `base`: the highest of the patch's Bezier points.
    pub fn crest(&self) -> f32 {
        let row = |[a, b, c, d]: [f32; 4]| [b, b + (c - a) * SIXTH, c - (d - b) * SIXTH, c];
        let rows = self.rows.map(row);
        let points = [0, 1, 2, 3].map(|k| row([rows[0][k], rows[1][k], rows[2][k], rows[3][k]]));
        points.as_flattened().iter().copied().fold(f32::MIN, f32::max)
    }
}

/// Differences of a cubic's Bezier points between the second and the third of four samples.
fn steps([a, b, c, d]: [f32; 4]) -> [f32; 3] {
    let (first, third) = ((c - a) * SIXTH, (d - b) * SIXTH);
    [first, (c - b) - (first + third), third]
}

/// Least and greatest slope along the rows of a patch, by the cell.
fn hull(rows: [[f32; 4]; 4]) -> [f32; 2] {
    let along = rows.map(steps);
    let mut found = [f32::MAX, f32::MIN];
    for across in [0, 1, 2].map(|k| along.map(|row| row[k])) {
        let [first, second, _] = steps(across);
        let b = across[1] + first;
        for z in [across[1], b, b + second, across[2]] {
            found = [found[0].min(z), found[1].max(z)];
        }
    }
    found.map(|step| 3.0 * step)
}

const SIXTH: f32 = 1.0 / 6.0;

/// The samples around the cell under a position, and the position in it. A cell that touches a void has the field's lowest height,
/// but where a sample stands.
struct Neighbours {
    around: Around,
    u: f32,
    v: f32,
}

fn neighbours<H: Heights>(scene: &SceneUniform, heights: &H, x: f32, y: f32) -> Neighbours {
    let [cells_x, cells_y] = scene.cells();
    let gx = (x * scene.inverse_spacing[0]).max(0.0).min(cells_x as f32);
    let gy = (y * scene.inverse_spacing[1]).max(0.0).min(cells_y as f32);
    let i = (gx as u32).min(cells_x - 1);
    let j = (gy as u32).min(cells_y - 1);
    match Around::new(scene, heights, [i, j]) {
        Some(around) => Neighbours { around, u: gx - i as f32, v: gy - j as f32 },
        None => {
            let around = Around { rows: [[0.0; 4]; 4], base: at_rim(scene, heights, [gx, gy]) };
            Neighbours { around, u: 0.0, v: 0.0 }
        }
    }
}

fn blend(w: [f32; 4], z: [f32; 4]) -> f32 {
    (w[0] * z[0] + w[1] * z[1]) + (w[2] * z[2] + w[3] * z[3])
}

/// Catmull-Rom weights of the samples at -1, 0, 1 and 2 for a position in [0, 1].
pub(super) fn weights(t: f32) -> [f32; 4] {
    [
        0.5 * t * ((2.0 - t) * t - 1.0),
        0.5 * (t * t * (3.0 * t - 5.0) + 2.0),
        0.5 * t * ((4.0 - 3.0 * t) * t + 1.0),
        0.5 * t * t * (t - 1.0),
    ]
}

/// Their first derivatives.
pub(super) fn slope_weights(t: f32) -> [f32; 4] {
    [
        0.5 * ((4.0 - 3.0 * t) * t - 1.0),
        0.5 * t * (9.0 * t - 10.0),
        0.5 * ((8.0 - 9.0 * t) * t + 1.0),
        0.5 * t * (3.0 * t - 2.0),
    ]
}

/// Their second derivatives.
fn bend_weights(t: f32) -> [f32; 4] {
    [2.0 - 3.0 * t, 9.0 * t - 5.0, 4.0 - 9.0 * t, 3.0 * t - 1.0]
}

/// Height of a cell's south-western sample, and the 4 x 4 samples around the cell less that one, in metres. A cell that touches a
/// void has a void's height. Twin of `shaders/terrain/patch_around.wgsl`.
pub(super) fn patch_around<H: Heights>(scene: &SceneUniform, heights: &H, at: [f32; 2]) -> [f32; 17] {
    let cell = [0, 1].map(|axis| at[axis].clamp(0.0, (scene.size[axis] - 2) as f32) as u32);
    let mut words = [0.0; 17];
    words[0] = VOID_F32;
    if let Some(around) = Around::new(scene, heights, cell) {
        words[0] = around.base * scene.z_scale + scene.z_offset;
        words[1..].iter_mut().zip(around.rows.as_flattened()).for_each(|(word, z)| *word = z * scene.z_scale);
    }
    words
}

pub(super) fn bicubic<H: Heights>(scene: &SceneUniform, heights: &H, x: f32, y: f32) -> f32 {
    let n = neighbours(scene, heights, x, y);
    (n.around.base + n.around.blend(weights(n.u), weights(n.v))) * scene.z_scale + scene.z_offset
}

pub(super) fn gradient_bicubic<H: Heights>(scene: &SceneUniform, heights: &H, x: f32, y: f32) -> [f32; 2] {
    let n = neighbours(scene, heights, x, y);
    let east = n.around.blend(slope_weights(n.u), weights(n.v));
    let north = n.around.blend(weights(n.u), slope_weights(n.v));
    slope(scene, x, y, east, north)
}

/// Second derivatives by x twice, by x and y, by y twice.
pub(super) fn bend_bicubic<H: Heights>(scene: &SceneUniform, heights: &H, x: f32, y: f32) -> [f32; 3] {
    let n = neighbours(scene, heights, x, y);
    let east = n.around.blend(bend_weights(n.u), weights(n.v));
    let twist = n.around.blend(slope_weights(n.u), slope_weights(n.v));
    let north = n.around.blend(weights(n.u), bend_weights(n.v));
    // Metres per raw unit are in one of the two factors.
    let once = slope(scene, x, y, east, north);
    let inside = slope(scene, x, y, scene.z_inverse_scale, scene.z_inverse_scale);
    let [across, _] = slope(scene, x, y, twist, 0.0);
    [once[0] * inside[0], across * inside[1], once[1] * inside[1]]
}

/// The part of an n x n split of a cell that a position lies in: bicubic heights at its corners less `base`.
struct Fine {
    corners: Corners,
    base: f32,
    u: f32,
    v: f32,
}

fn fine<H: Heights>(scene: &SceneUniform, heights: &H, [x, y, n]: [f32; 3]) -> Fine {
    let Neighbours { around, u, v } = neighbours(scene, heights, x, y);
    let [i, j] = [part(u, n), part(v, n)];
    Fine { corners: around.part([i, j], n), base: around.base, u: u * n - i, v: v * n - j }
}

/// Index of the part of a cell's side that a place on it lies in.
pub(super) fn part(at: f32, n: f32) -> f32 {
    (at * n).floor().clamp(0.0, n - 1.0)
}

/// At (x, y) with n parts along each side of a cell.
pub(super) fn subdivided<H: Heights>(scene: &SceneUniform, heights: &H, at: [f32; 3]) -> f32 {
    let fine = fine(scene, heights, at);
    (fine.base + Bilinear::height(&fine.corners, fine.u, fine.v)) * scene.z_scale + scene.z_offset
}

pub(super) fn gradient_subdivided<H: Heights>(scene: &SceneUniform, heights: &H, at: [f32; 3]) -> [f32; 2] {
    let Fine { corners: c, u, v, .. } = fine(scene, heights, at);
    let east = (c.se - c.sw) * (1.0 - v) + (c.ne - c.nw) * v;
    let north = (c.nw - c.sw) * (1.0 - u) + (c.ne - c.se) * u;
    slope(scene, at[0], at[1], east * at[2], north * at[2])
}

/// Second derivative by x and y.
pub(super) fn twist_subdivided<H: Heights>(scene: &SceneUniform, heights: &H, at: [f32; 3]) -> f32 {
    let Fine { corners: c, .. } = fine(scene, heights, at);
    let twist = ((c.ne - c.nw) - (c.se - c.sw)) * at[2] * at[2];
    let [across, along] = slope(scene, at[0], at[1], twist, scene.z_inverse_scale);
    across * along
}

#[cfg(test)]
mod tests;
