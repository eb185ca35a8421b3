//! Heights and gradients of the surfaces at a ground position. Outside the field the nearest rim counts; a cell that
//! touches a void has the field's lowest height, but where a sample stands. Twin of `shaders/terrain/cell.wgsl` and the surfaces beside it.

use super::field::VOID_F32;
use super::layout::SceneUniform;
use super::patch::{Corners, Interpolation};
use super::walk::Heights;

/// A cell with the position in it.
pub(super) struct Cell {
    pub corners: Corners,
    pub u: f32,
    pub v: f32,
}

/// The cell under (x, y) in metres.
pub(super) fn locate<H: Heights>(scene: &SceneUniform, heights: &H, x: f32, y: f32) -> Cell {
    let [cells_x, cells_y] = scene.cells();
    let gx = (x * scene.inverse_spacing[0]).max(0.0).min(cells_x as f32);
    let gy = (y * scene.inverse_spacing[1]).max(0.0).min(cells_y as f32);
    let i = (gx as u32).min(cells_x - 1);
    let j = (gy as u32).min(cells_y - 1);
    let mut corners = Corners::new(scene, heights, [i as i32, j as i32]);
    if corners.lowest() == VOID_F32 {
        let low = at_rim(scene, heights, [gx, gy]);
        corners = Corners { sw: low, se: low, nw: low, ne: low };
    }
    Cell { corners, u: gx - i as f32, v: gy - j as f32 }
}

/// Raw height at a grid position in a cell that touches a void. Twin of `shaders/terrain/rim.wgsl`.
pub(super) fn at_rim<H: Heights>(scene: &SceneUniform, heights: &H, grid: [f32; 2]) -> f32 {
    let nearest = grid.map(f32::round_ties_even);
    let raw = heights.sample(nearest[1] as usize * scene.size[0] as usize + nearest[0] as usize);
    let stands = grid.iter().zip(nearest).all(|(g, n)| (g - n).abs() <= 2.4e-7 * n.max(1.0));
    if stands && raw != VOID_F32 { raw } else { scene.raw_relief[0] }
}

/// Twin of `shaders/terrain/onto.wgsl`.
fn onto(w: f32) -> f32 {
    w * 1.000_000_2
}

pub(super) fn height<H: Heights, P: Interpolation>(scene: &SceneUniform, heights: &H, x: f32, y: f32) -> f32 {
    let cell = locate(scene, heights, x, y);
    P::height(&cell.corners, cell.u, cell.v) * scene.z_scale + scene.z_offset
}

pub(super) fn nearest<H: Heights>(scene: &SceneUniform, heights: &H, x: f32, y: f32) -> f32 {
    let [cells_x, cells_y] = scene.cells();
    let gx = (x * scene.inverse_spacing[0] + 0.5).max(0.0).min(cells_x as f32);
    let gy = (y * scene.inverse_spacing[1] + 0.5).max(0.0).min(cells_y as f32);
    let raw = heights.sample(gy as usize * scene.size[0] as usize + gx as usize);
    (if raw == VOID_F32 { scene.raw_relief[0] } else { raw }) * scene.z_scale + scene.z_offset
}

/// Metres per metre; 0 along an axis where the position is beyond the rim.
pub(super) fn slope(scene: &SceneUniform, x: f32, y: f32, east: f32, north: f32) -> [f32; 2] {
    let across = |axis: usize, w: f32, raw: f32| {
        let inside = w >= 0.0 && w <= scene.cells()[axis] as f32 * scene.spacing[axis];
        if inside { raw * scene.z_scale * scene.inverse_spacing[axis] } else { 0.0 }
    };
    [across(0, x, east), across(1, y, north)]
}

pub(super) fn gradient_bilinear<H: Heights>(scene: &SceneUniform, heights: &H, x: f32, y: f32) -> [f32; 2] {
    let Cell { corners: c, u, v } = locate(scene, heights, onto(x), onto(y));
    let east = (c.se - c.sw) * (1.0 - v) + (c.ne - c.nw) * v;
    let north = (c.nw - c.sw) * (1.0 - u) + (c.ne - c.se) * u;
    slope(scene, x, y, east, north)
}

/// Second derivative by x and y.
pub(super) fn twist_bilinear<H: Heights>(scene: &SceneUniform, heights: &H, x: f32, y: f32) -> f32 {
    let Cell { corners: c, .. } = locate(scene, heights, onto(x), onto(y));
    let twist = (c.ne - c.nw) - (c.se - c.sw);
    let [across, _] = slope(scene, x, y, twist, 0.0);
    let [_, along] = slope(scene, x, y, 0.0, scene.z_inverse_scale);
    across * along
}

pub(super) fn gradient_triangulated<H: Heights>(
    scene: &SceneUniform,
    heights: &H,
    x: f32,
    y: f32,
) -> [f32; 2] {
    let Cell { corners: c, u, v } = locate(scene, heights, onto(x), onto(y));
    let [east, north] = if u >= v { [c.se - c.sw, c.ne - c.se] } else { [c.ne - c.nw, c.nw - c.sw] };
    slope(scene, x, y, east, north)
}
