//! Cameras that frame a field of any shape.

use super::field::Terrain;
use super::view::{Camera, Projection, middle};
use glam::DVec3;

/// Part of the picture that a framed field may fill.
const FRAME: f64 = 0.94;

/// The highest sample, of several the one nearest to the field's middle: position and height in metres.
pub(super) fn highest(terrain: &Terrain) -> (f64, f64, f64) {
    let [dx, dy] = terrain.spacing;
    let [width, height] = terrain.extent();
    let away = |x: f64, y: f64| (x - width / 2.0).hypot(y - height / 2.0);
    let mut best = (0.0, 0.0, f64::MIN);
    for r in 0..terrain.height {
        for c in 0..terrain.width {
            let Some(z) = terrain.sample(c, r).filter(|z| *z >= best.2) else { continue };
            let (x, y) = (f64::from(c) * dx, f64::from(r) * dy);
            if z > best.2 || away(x, y) < away(best.0, best.1) {
                best = (x, y, z);
            }
        }
    }
    let (x, y, z) = best;
    (x, y, if z == f64::MIN { terrain.min } else { z })
}

/// The points turned about the field's middle into all directions.
pub(super) fn revolved(terrain: &Terrain, points: &[DVec3]) -> Vec<DVec3> {
    const TURNS: u32 = 96;
    let [width, height] = terrain.extent();
    let middle = DVec3::new(width / 2.0, height / 2.0, 0.0);
    // Of points on one level the outermost is enough, and levels are told apart well enough by steps of the relief.
    let step = (points.iter().map(|p| p.z).fold(f64::MIN, f64::max)
        - points.iter().map(|p| p.z).fold(f64::MAX, f64::min))
    .max(1e-9)
        / 64.0;
    let lowest = points.iter().map(|p| p.z).fold(f64::MAX, f64::min);
    let mut rings: Vec<Option<(f64, f64, f64)>> = vec![None; 66];
    for p in points {
        let radius = (*p - middle).truncate().length();
        let ring = &mut rings[((p.z - lowest) / step) as usize];
        let (r, low, high) = ring.unwrap_or((radius, p.z, p.z));
        *ring = Some((r.max(radius), low.min(p.z), high.max(p.z)));
    }
    let mut all = Vec::new();
    for (radius, low, high) in rings.into_iter().flatten() {
        for turn in 0..TURNS {
            let (sin, cos) = (f64::from(turn) / f64::from(TURNS) * std::f64::consts::TAU).sin_cos();
            let at = middle + DVec3::new(radius * cos, radius * sin, 0.0);
            all.extend([at + DVec3::Z * low, at + DVec3::Z * high]);
        }
    }
    all
}

/// Height of the model's underside, as `underside` of the module `terrain` has it.
fn underside(terrain: &Terrain, exaggerate: f64) -> f64 {
    let [width, height] = terrain.extent();
    let plain = (0.02 * width.hypot(height)).min(0.05 * width.min(height));
    exaggerate * terrain.min - (0.12 * exaggerate * (terrain.max - terrain.min)).max(plain)
}

/// Points whose hull is nearly that of the field as a model: a coarse grid of samples, the highest sample of each of its
/// cells, so that no spike between them is lost, and the corners of the underside.
pub(super) fn outline(terrain: &Terrain, exaggerate: f64) -> Vec<DVec3> {
    const GRID: u32 = 48;
    let picks = |n: u32| {
        let pick = |k: u32| (u64::from(n - 1) * u64::from(k) / u64::from(GRID)) as u32;
        let mut all: Vec<u32> = (0..=GRID).map(pick).collect();
        all.dedup();
        all
    };
    let place = |(c, r): (u32, u32), z: f64| {
        DVec3::new(f64::from(c) * terrain.spacing[0], f64::from(r) * terrain.spacing[1], z * exaggerate)
    };
    let (columns, rows) = (picks(terrain.width), picks(terrain.height));
    let mut points = Vec::new();
    for r in &rows {
        for at in columns.iter().map(|c| (*c, *r)) {
            points.extend(terrain.sample(at.0, at.1).map(|z| place(at, z)));
        }
    }
    for r in rows.windows(2) {
        for c in columns.windows(2) {
            let cell = (r[0]..r[1]).flat_map(|r| (c[0]..c[1]).map(move |c| (c, r)));
            let top = cell.filter_map(|at| Some((at, terrain.sample(at.0, at.1)?)));
            points.extend(top.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(at, z)| place(at, z)));
        }
    }
    let [width, height] = terrain.extent();
    let low = underside(terrain, exaggerate);
    points.extend(
        [(0.0, 0.0), (width, 0.0), (0.0, height), (width, height)].map(|(x, y)| DVec3::new(x, y, low)),
    );
    points
}

/// The nearest camera in the view's direction that sees all points.
pub(super) fn frame(
    (azimuth, dip): (f64, f64),
    fov: f64,
    orthographic: bool,
    points: &[DVec3],
    size: (u32, u32),
) -> Camera {
    let (sin_a, cos_a) = azimuth.to_radians().sin_cos();
    let (sin_d, cos_d) = dip.to_radians().sin_cos();
    // A quarter turn has an exact cosine, so that the map view is straight.
    let cos_d = if dip == 90.0 { 0.0 } else { cos_d };
    let forward = DVec3::new(sin_a * cos_d, cos_a * cos_d, -sin_d);
    let right = DVec3::new(cos_a, -sin_a, 0.0);
    let up = right.cross(forward);

    let tan_y = (fov.to_radians() / 2.0).tan();
    let tan_x = tan_y * f64::from(size.0) / f64::from(size.1);
    let (fit_x, fit_y) = (tan_x * FRAME, tan_y * FRAME);
    let local = |p: &DVec3| (p.dot(right), p.dot(up), p.dot(forward));
    let most =
        |f: &dyn Fn((f64, f64, f64)) -> f64| points.iter().map(|p| f(local(p))).fold(f64::MIN, f64::max);
    if orthographic {
        let (east, west) = (most(&|(x, _, _)| x), -most(&|(x, _, _)| -x));
        let (top, bottom) = (most(&|(_, y, _)| y), -most(&|(_, y, _)| -y));
        let near = -most(&|(_, _, z)| -z);
        let depth = most(&|(_, _, z)| z) - near;
        let half = ((top - bottom) / 2.0).max((east - west) / 2.0 * tan_y / tan_x) / FRAME;
        let pixel = 2.0 * half / f64::from(size.1);
        let back = near - 0.05 * (depth + half) - 1.0;
        let eye = right * (east + west) / 2.0 + up * (top + bottom) / 2.0 + forward * back;
        // The lowest rays begin above everything too: under the model they would meet nothing but its inside.
        let lowest = points.iter().map(|p| p.z).fold(f64::MAX, f64::min);
        let sunk = (lowest - (eye.z - half * up.z)).max(0.0) * 1.01;
        let eye = eye - if sunk > 0.0 { forward * (sunk / sin_d) } else { DVec3::ZERO };
        return Camera {
            eye,
            forward,
            across: right * pixel,
            down: -up * pixel,
            middle: middle(size),
            projection: Projection::Orthographic,
        };
    }
    // A point is inside if |x - x0| <= fit_x (z - z0), and so for y: the foremost z0.
    let (a, b) = (most(&|(x, _, z)| x / fit_x - z), most(&|(x, _, z)| -x / fit_x - z));
    let (c, d) = (most(&|(_, y, z)| y / fit_y - z), most(&|(_, y, z)| -y / fit_y - z));
    let back = ((a + b) / 2.0).max((c + d) / 2.0);
    // Between the bounds of x0, and of y0, where both margins of the picture are equal.
    let balance = |lo: f64, hi: f64, side: &dyn Fn((f64, f64, f64)) -> f64| {
        let (mut lo, mut hi) = (lo.min(hi), hi.max(lo));
        for _ in 0..60 {
            let at = 0.5 * (lo + hi);
            let over = most(&|p| (side(p) - at) / (p.2 + back));
            let under = most(&|p| (at - side(p)) / (p.2 + back));
            if over > under { lo = at } else { hi = at }
        }
        0.5 * (lo + hi)
    };
    let x0 = balance(fit_x * (a - back), fit_x * (back - b), &|(x, _, _)| x);
    let y0 = balance(fit_y * (c - back), fit_y * (back - d), &|(_, y, _)| y);
    let pixel = 2.0 * tan_y / f64::from(size.1);
    Camera {
        eye: right * x0 + up * y0 - forward * back,
        forward,
        across: right * pixel,
        down: -up * pixel,
        middle: middle(size),
        projection: Projection::Perspective,
    }
}
