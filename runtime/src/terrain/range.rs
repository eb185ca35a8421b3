//! Bounds of the samplers over a box of ground. What is missing counts as the field's lowest height, as it does to the
//! samplers. Twin of `shaders/terrain/box.wgsl`, `extreme.wgsl` and `hole.wgsl`.

use super::bicubic::Around;
use super::field::VOID_F32;
use super::layout::SceneUniform;
use super::walk::Heights;

/// The cells that a box touches, and the least level of a mipmap at which they are at most 2 x 2 nodes.
struct Touched {
    low: [u32; 2],
    high: [u32; 2],
    level: u32,
}

/// `[x0, y0, x1, y1]` in metres.
fn touched(scene: &SceneUniform, ends: &[f32; 4]) -> Touched {
    let cells = scene.cells();
    let index = |axis: usize, w: f32| {
        let grid = (w * scene.inverse_spacing[axis]).max(0.0).min(cells[axis] as f32);
        (grid as u32).min(cells[axis] - 1)
    };
    let low = [index(0, ends[0]), index(1, ends[1])];
    let high = [index(0, ends[2]).max(low[0]), index(1, ends[3]).max(low[1])];
    let span = (high[0] - low[0]).max(high[1] - low[1]);
    let level = if span > 1 { 32 - (span - 1).leading_zeros() } else { 0 };
    Touched { low, high, level }
}

/// A box within 2 x 2 cells is looked up like one of 4 x 4: a load costs more than what it would tell. The relief of a field of
/// one cell is that of its corners.
fn range(
    scene: &SceneUniform,
    ends: &[f32; 4],
    relief: f32,
    node: impl Fn(usize) -> f32,
    outer: impl Fn(f32, f32) -> f32,
) -> f32 {
    let Touched { low, high, level } = touched(scene, ends);
    let level = level.max(1).min(scene.top);
    let raw = if level == 0 {
        relief
    } else {
        let [offset, width, _, _] = scene.levels[level as usize];
        let at = |i: u32, j: u32| node((offset + (j >> level) * width + (i >> level)) as usize);
        let south = outer(at(low[0], low[1]), at(high[0], low[1]));
        let north = outer(at(low[0], high[1]), at(high[0], high[1]));
        outer(south, north)
    };
    raw.max(scene.raw_relief[0]) * scene.z_scale + scene.z_offset
}

pub(super) fn highest<H: Heights>(scene: &SceneUniform, heights: &H, ends: &[f32; 4]) -> f32 {
    range(scene, ends, scene.raw_relief[1], |i| heights.bound(i), f32::max)
}

pub(super) fn lowest<H: Heights>(scene: &SceneUniform, heights: &H, ends: &[f32; 4]) -> f32 {
    range(scene, ends, scene.raw_relief[0], |i| heights.floor(i), f32::min)
}

/// Of the bicubic surface, from above. In a field of one cell it passes no sample.
pub(super) fn crest<H: Heights>(scene: &SceneUniform, heights: &H, ends: &[f32; 4]) -> f32 {
    range(scene, ends, scene.raw_relief[1], |i| heights.crest(i), f32::max)
}

/// Steps from the first to the last cell of a box whose samples are looked at one by one.
const MOST_STEPS: u32 = 3;

/// Least and greatest slope between neighbouring samples of the cells that a box touches, by x and by y: metres a metre.
/// More than 4 x 4 cells are bounded by the field's relief; beside a void by that of the cells, as surfaces repeat samples there.
/// Twin of `shaders/terrain/inclines.wgsl`.
pub(super) fn inclines<H: Heights>(scene: &SceneUniform, heights: &H, ends: &[f32; 4]) -> [f32; 4] {
    let Touched { low, high, .. } = touched(scene, ends);
    let scale = scene.inverse_spacing.map(|inverse| scene.z_scale * inverse);
    if (high[0] - low[0]).max(high[1] - low[1]) > MOST_STEPS {
        let most = scale.map(|s| (scene.raw_relief[1] - scene.raw_relief[0]) * s);
        return [-most[0], most[0], -most[1], most[1]];
    }
    let row = scene.size[0] as usize;
    let sample = |i: u32, j: u32| heights.sample(j as usize * row + i as usize);
    let (mut found, mut void) = ([[f32::MAX, f32::MIN]; 2], false);
    let mut relief = [f32::MAX, f32::MIN];
    for j in low[1]..=high[1] + 1 {
        for i in low[0]..=high[0] + 1 {
            let here = sample(i, j);
            void |= here == VOID_F32;
            if here != VOID_F32 {
                relief = [relief[0].min(here), relief[1].max(here)];
            }
            let mut note = |axis: usize, step: f32| {
                found[axis] = [found[axis][0].min(step), found[axis][1].max(step)];
            };
            if i <= high[0] {
                note(0, sample(i + 1, j) - here);
            }
            if j <= high[1] {
                note(1, sample(i, j + 1) - here);
            }
        }
    }
    if void {
        let most = scale.map(|s| (relief[1] - relief[0]).max(0.0) * s);
        return [-most[0], most[0], -most[1], most[1]];
    }
    let axis = |axis: usize| {
        let size = scene.cells()[axis] as f32 * scene.spacing[axis];
        let outside = ends[axis] < 0.0 || ends[axis + 2] > size;
        let [least, most] = found[axis];
        let (least, most) = if outside { (least.min(0.0), most.max(0.0)) } else { (least, most) };
        [least * scale[axis], most * scale[axis]]
    };
    let ([x0, x1], [y0, y1]) = (axis(0), axis(1));
    [x0, x1, y0, y1]
}

/// A slope is a sum of the steps between neighbours, whose weights below 0 add up to at most 7/16.
const STEEPEST: f32 = 1.875;
/// How far a box may leave its cell, as a part of the field: a rounding beyond it slopes are the same, as they do not jump.
const BESIDE: f32 = 2e-6;

/// Bounds of the bicubic surface's slopes over a box within a cell: by x, then by y, metres a metre. They are those of the patch's
/// Bezier points. Over a wider box, and beside a void, they are those that the field's relief allows. Twin of
/// `shaders/terrain/inclines_bicubic.wgsl`.
pub(super) fn inclines_bicubic<H: Heights>(scene: &SceneUniform, heights: &H, ends: &[f32; 4]) -> [f32; 4] {
    let cells = scene.cells();
    let grid = |axis: usize, w: f32| (w * scene.inverse_spacing[axis]).max(0.0).min(cells[axis] as f32);
    let (low, high) = ([0, 1].map(|a| grid(a, ends[a])), [0, 1].map(|a| grid(a, ends[a + 2])));
    let cell = [0, 1].map(|a| ((0.5 * (low[a] + high[a])) as u32).min(cells[a] - 1));
    let scale = scene.inverse_spacing.map(|inverse| scene.z_scale * inverse);
    let within = |a: usize| low[a] >= cell[a] as f32 - BESIDE && high[a] <= cell[a] as f32 + (1.0 + BESIDE);
    let around = if within(0) && within(1) { Around::new(scene, heights, cell) } else { None };
    let Some(around) = around else {
        let most = scale.map(|s| STEEPEST * (scene.raw_relief[1] - scene.raw_relief[0]) * s);
        return [-most[0], most[0], -most[1], most[1]];
    };
    let [least, greatest] = around.range();
    let rounded = 1e-6 * (greatest - least);
    let found = around.inclines();
    let axis = |axis: usize| {
        let size = cells[axis] as f32 * scene.spacing[axis];
        // Beyond the rim surfaces are flat.
        let outside = ends[axis] < 0.0 || ends[axis + 2] > size;
        let [least, most] = [found[axis][0] - rounded, found[axis][1] + rounded];
        let (least, most) = if outside { (least.min(0.0), most.max(0.0)) } else { (least, most) };
        [least * scale[axis], most * scale[axis]]
    };
    let ([x0, x1], [y0, y1]) = (axis(0), axis(1));
    [x0, x1, y0, y1]
}

/// Whether a cell that a box touches has a void among its corners, or may. Twin of `shaders/terrain/holed.wgsl`.
pub(super) fn holed<H: Heights>(scene: &SceneUniform, heights: &H, ends: &[f32; 4]) -> bool {
    if scene.voids == 0 {
        return false;
    }
    let Touched { low, high, .. } = touched(scene, ends);
    if (high[0] - low[0]).max(high[1] - low[1]) > MOST_STEPS {
        return true;
    }
    let row = scene.size[0] as usize;
    let mut corners = (low[1]..=high[1] + 1).flat_map(|j| (low[0]..=high[0] + 1).map(move |i| (i, j)));
    corners.any(|(i, j)| heights.sample(j as usize * row + i as usize) == VOID_F32)
}
