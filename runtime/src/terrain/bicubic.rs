//! Catmull-Rom bicubic heights with their derivatives, and the paper's approximation of them (section 3.2): bicubic at the
//! points of an n x n split of each cell, bilinear between. Twin of `shaders/terrain/neighbours.wgsl`, `bicubic.wgsl`,
//! `fine.wgsl`, `subdivided.wgsl` and those of their derivatives.

use super::field::VOID_F32;
use super::layout::SceneUniform;
use super::patch::{Bilinear, Corners, Patch};
use super::surface::{at_rim, slope};
use super::walk::Heights;

/// The 4 x 4 samples around a cell less its south-western one, rows from south to north. Beyond the rim and beyond a
/// void the nearer sample is repeated; a cell that touches a void has the field's lowest height, but where a sample stands.
struct Neighbours {
    rows: [[f32; 4]; 4],
    base: f32,
    u: f32,
    v: f32,
}

fn neighbours<H: Heights>(scene: &SceneUniform, heights: &H, x: f32, y: f32) -> Neighbours {
    let [cells_x, cells_y] = scene.cells();
    let gx = (x * scene.inverse_spacing[0]).max(0.0).min(cells_x as f32);
    let gy = (y * scene.inverse_spacing[1]).max(0.0).min(cells_y as f32);
    let i = (gx as u32).min(cells_x - 1);
    let j = (gy as u32).min(cells_y - 1);
    let columns = [i.max(1) - 1, i, i + 1, (i + 2).min(cells_x)];
    let row = |j: u32| columns.map(|i| heights.sample((j * scene.size[0] + i) as usize));
    let (b, c) = (row(j), row(j + 1));
    if [b[1], b[2], c[1], c[2]].contains(&VOID_F32) {
        return Neighbours { rows: [[0.0; 4]; 4], base: at_rim(scene, heights, [gx, gy]), u: 0.0, v: 0.0 };
    }
    let nearer = |outer: [f32; 4], inner: [f32; 4]| {
        [0, 1, 2, 3].map(|k| if outer[k] == VOID_F32 { inner[k] } else { outer[k] })
    };
    let a = nearer(row(j.max(1) - 1), b);
    let d = nearer(row((j + 2).min(cells_y)), c);
    let base = b[1];
    let repaired = |row: [f32; 4]| {
        let west = if row[0] == VOID_F32 { row[1] } else { row[0] };
        let east = if row[3] == VOID_F32 { row[2] } else { row[3] };
        [west, row[1], row[2], east].map(|z| z - base)
    };
    Neighbours { rows: [a, b, c, d].map(repaired), base, u: gx - i as f32, v: gy - j as f32 }
}

impl Neighbours {
    /// Blend across the rows, then along them.
    fn blend(&self, across: [f32; 4], along: [f32; 4]) -> f32 {
        blend(along, self.rows.map(|row| blend(across, row)))
    }
}

fn blend(w: [f32; 4], z: [f32; 4]) -> f32 {
    (w[0] * z[0] + w[1] * z[1]) + (w[2] * z[2] + w[3] * z[3])
}

/// Catmull-Rom weights of the samples at -1, 0, 1 and 2 for a position in [0, 1].
fn weights(t: f32) -> [f32; 4] {
    [
        0.5 * t * ((2.0 - t) * t - 1.0),
        0.5 * (t * t * (3.0 * t - 5.0) + 2.0),
        0.5 * t * ((4.0 - 3.0 * t) * t + 1.0),
        0.5 * t * t * (t - 1.0),
    ]
}

/// Their first derivatives.
fn slope_weights(t: f32) -> [f32; 4] {
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

pub(super) fn bicubic<H: Heights>(scene: &SceneUniform, heights: &H, x: f32, y: f32) -> f32 {
    let n = neighbours(scene, heights, x, y);
    (n.base + n.blend(weights(n.u), weights(n.v))) * scene.z_scale + scene.z_offset
}

pub(super) fn gradient_bicubic<H: Heights>(scene: &SceneUniform, heights: &H, x: f32, y: f32) -> [f32; 2] {
    let n = neighbours(scene, heights, x, y);
    let east = n.blend(slope_weights(n.u), weights(n.v));
    let north = n.blend(weights(n.u), slope_weights(n.v));
    slope(scene, x, y, east, north)
}

/// Second derivatives by x twice, by x and y, by y twice.
pub(super) fn bend_bicubic<H: Heights>(scene: &SceneUniform, heights: &H, x: f32, y: f32) -> [f32; 3] {
    let n = neighbours(scene, heights, x, y);
    let east = n.blend(bend_weights(n.u), weights(n.v));
    let twist = n.blend(slope_weights(n.u), slope_weights(n.v));
    let north = n.blend(weights(n.u), bend_weights(n.v));
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
    let around = neighbours(scene, heights, x, y);
    let i = (around.u * n).floor().min(n - 1.0);
    let j = (around.v * n).floor().min(n - 1.0);
    let [west, east] = [weights(i / n), weights((i + 1.0) / n)];
    let [south, north] = [weights(j / n), weights((j + 1.0) / n)];
    let corners = Corners {
        sw: around.blend(west, south),
        se: around.blend(east, south),
        nw: around.blend(west, north),
        ne: around.blend(east, north),
    };
    Fine { corners, base: around.base, u: around.u * n - i, v: around.v * n - j }
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
