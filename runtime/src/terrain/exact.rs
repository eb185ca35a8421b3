//! The oracle's terrain: double precision, no pyramid, nothing shared with the walk. A ray is cut at every grid plane
//! it crosses, the pieces are sorted, and each is intersected with the patch of its cell.

mod bicubic;

use super::field::{Terrain, VOID_F32};
use super::layout::SceneUniform;
use super::ray::WorldRay;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Surface {
    Nearest,
    Triangulated,
    Bilinear,
    Bicubic,
    /// By the parts along a cell's side.
    Subdivided(f64),
}

/// The field as the scene has rounded it.
pub(super) struct Field<'a> {
    terrain: &'a Terrain,
    spacing: [f64; 2],
    exaggerate: f64,
    low: f64,
    high: f64,
}

/// Heights of a cell's corners in metres.
struct Corners {
    sw: f64,
    se: f64,
    nw: f64,
    ne: f64,
}

/// A part of a ray that lies over a cell: its ends as distances, as places in the cell, as heights.
struct Piece {
    cell: (u32, u32),
    ends: [f64; 2],
    u: [f64; 2],
    v: [f64; 2],
    z: [f64; 2],
}

impl Corners {
    fn highest(&self) -> f64 {
        self.sw.max(self.se).max(self.nw).max(self.ne)
    }
}

impl<'a> Field<'a> {
    pub fn new(terrain: &'a Terrain, scene: &SceneUniform, exaggerate: f64) -> Field<'a> {
        Field {
            terrain,
            spacing: scene.spacing.map(f64::from),
            exaggerate,
            low: terrain.min * exaggerate,
            high: terrain.max * exaggerate,
        }
    }

    fn cells(&self) -> [f64; 2] {
        [f64::from(self.terrain.width - 1), f64::from(self.terrain.height - 1)]
    }

    fn sample(&self, c: u32, r: u32) -> Option<f64> {
        Some(self.terrain.sample(c, r)? * self.exaggerate)
    }

    fn corners(&self, i: u32, j: u32) -> Option<Corners> {
        Some(Corners {
            sw: self.sample(i, j)?,
            se: self.sample(i + 1, j)?,
            nw: self.sample(i, j + 1)?,
            ne: self.sample(i + 1, j + 1)?,
        })
    }

    /// Cell under grid position (x, y).
    fn cell(&self, x: f64, y: f64) -> (u32, u32) {
        let index = |g: f64, n: u32| (g.floor().max(0.0) as u32).min(n - 2);
        (index(x, self.terrain.width), index(y, self.terrain.height))
    }

    /// Corners of the cell under world position (x, y) and the position in it.
    fn locate(&self, x: f64, y: f64) -> (Corners, f64, f64) {
        let gx = (x / self.spacing[0]).max(0.0).min(self.cells()[0]);
        let gy = (y / self.spacing[1]).max(0.0).min(self.cells()[1]);
        let (i, j) = self.cell(gx, gy);
        let flat = |z| Corners { sw: z, se: z, nw: z, ne: z };
        (
            self.corners(i, j).unwrap_or_else(|| flat(self.at_rim(gx, gy))),
            gx - f64::from(i),
            gy - f64::from(j),
        )
    }

    /// Height at a grid position in a cell that touches a void: that of the sample on which it stands, else the field's lowest.
    fn at_rim(&self, gx: f64, gy: f64) -> f64 {
        let stands = [gx, gy].iter().all(|g| (g - g.round()).abs() <= 2.4e-7 * g.round().max(1.0));
        let sample = if stands { self.sample(gx.round() as u32, gy.round() as u32) } else { None };
        sample.unwrap_or(self.low)
    }

    pub fn height(&self, surface: Surface, x: f64, y: f64) -> f64 {
        let (c, u, v) = self.locate(x, y);
        match surface {
            Surface::Bicubic => self.bicubic(x, y, [0, 0]),
            Surface::Subdivided(n) => self.subdivided(x, y, n, [0, 0]),
            Surface::Bilinear => bilinear(&c, u, v),
            Surface::Triangulated => triangulated(&c, u, v),
            Surface::Nearest => {
                let column = |g: f64, n: f64| (g + 0.5).floor().max(0.0).min(n) as u32;
                let [nx, ny] = self.cells();
                let at = (column(x / self.spacing[0], nx), column(y / self.spacing[1], ny));
                self.sample(at.0, at.1).unwrap_or(self.low)
            }
        }
    }

    /// Lowest and highest corner of the cells that a box `[x0, y0, x1, y1]` touches; a void has the field's lowest height.
    pub fn bounds(&self, ends: &[f64]) -> [f64; 2] {
        let grid = |axis: usize, w: f64| (w / self.spacing[axis]).max(0.0).min(self.cells()[axis]);
        let low = self.cell(grid(0, ends[0]), grid(1, ends[1]));
        let high = self.cell(grid(0, ends[2]), grid(1, ends[3]));
        let rows = low.1..=high.1.max(low.1) + 1;
        let all = rows.flat_map(|r| (low.0..=high.0.max(low.0) + 1).map(move |c| (c, r)));
        all.map(|(c, r)| self.sample(c, r).unwrap_or(self.low))
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], z| [lo.min(z), hi.max(z)])
    }

    /// Least and greatest step between neighbouring samples of a box's cells by x and by y, metres a metre; a void counts as the
    /// field's lowest height.
    pub fn inclines(&self, ends: &[f64]) -> [f64; 4] {
        let grid = |axis: usize, w: f64| (w / self.spacing[axis]).max(0.0).min(self.cells()[axis]);
        let low = self.cell(grid(0, ends[0]), grid(1, ends[1]));
        let high = self.cell(grid(0, ends[2]), grid(1, ends[3]));
        let height = |c: u32, r: u32| self.sample(c, r).unwrap_or(self.low);
        let mut found = [f64::MAX, f64::MIN, f64::MAX, f64::MIN];
        for (i, j) in (low.0..=high.0 + 1).flat_map(|i| (low.1..=high.1 + 1).map(move |j| (i, j))) {
            let mut note = |axis: usize, step: f64| {
                let step = step / self.spacing[axis];
                found[2 * axis] = found[2 * axis].min(step);
                found[2 * axis + 1] = found[2 * axis + 1].max(step);
            };
            if i <= high.0 {
                note(0, height(i + 1, j) - height(i, j));
            }
            if j <= high.1 {
                note(1, height(i, j + 1) - height(i, j));
            }
        }
        found
    }

    /// The same box with a cell on each side.
    fn ring(&self, ends: &[f64]) -> [f64; 4] {
        let [dx, dy] = self.spacing;
        [ends[0] - dx, ends[1] - dy, ends[2] + dx, ends[3] + dy]
    }

    /// What the bicubic surface does not pass over a box: weights below 0 add up to at most 9/32.
    pub fn crest(&self, ends: &[f64]) -> f64 {
        let [low, high] = self.bounds(&self.ring(ends));
        high + 9.0 / 32.0 * (high - low)
    }

    /// Bounds of its slopes: sums of steps with weights of which those below 0 add up to at most 7/16.
    pub fn inclines_bicubic(&self, ends: &[f64]) -> [f64; 4] {
        let [x0, x1, y0, y1] = self.inclines(&self.ring(ends));
        let [x, y] = [x1 - x0, y1 - y0].map(|between| 7.0 / 16.0 * between);
        [x0 - x, x1 + x, y0 - y, y1 + y]
    }

    /// Whether a cell that a box touches has a void among its corners.
    pub fn holed(&self, ends: &[f64]) -> bool {
        let grid = |axis: usize, w: f64| (w / self.spacing[axis]).max(0.0).min(self.cells()[axis]);
        let low = self.cell(grid(0, ends[0]), grid(1, ends[1]));
        let high = self.cell(grid(0, ends[2]), grid(1, ends[3]));
        let mut cells = (low.0..=high.0).flat_map(|i| (low.1..=high.1).map(move |j| (i, j)));
        cells.any(|(i, j)| self.corners(i, j).is_none())
    }

    /// 1 where the surface follows the position along the axis, 0 beyond the rim.
    fn inside(&self, x: f64, y: f64) -> [f64; 2] {
        let within = |axis: usize, w: f64| (0.0..=self.cells()[axis] * self.spacing[axis]).contains(&w);
        [within(0, x), within(1, y)].map(|inside| f64::from(u8::from(inside)))
    }

    /// Metres per metre.
    pub fn gradient(&self, surface: Surface, x: f64, y: f64) -> [f64; 2] {
        let (c, u, v) = self.locate(x, y);
        let [east, north] = match surface {
            Surface::Nearest => [0.0, 0.0],
            Surface::Bicubic => return [[1, 0], [0, 1]].map(|order| self.bicubic(x, y, order)),
            Surface::Subdivided(n) => return [[1, 0], [0, 1]].map(|order| self.subdivided(x, y, n, order)),
            Surface::Bilinear => {
                [(1.0 - v) * (c.se - c.sw) + v * (c.ne - c.nw), (1.0 - u) * (c.nw - c.sw) + u * (c.ne - c.se)]
            }
            Surface::Triangulated if u >= v => [c.se - c.sw, c.ne - c.se],
            Surface::Triangulated => [c.ne - c.nw, c.nw - c.sw],
        };
        let [inside_x, inside_y] = self.inside(x, y);
        [inside_x * east / self.spacing[0], inside_y * north / self.spacing[1]]
    }

    /// The bilinear surface's second derivative by x and y.
    pub fn twist(&self, x: f64, y: f64) -> f64 {
        let (c, ..) = self.locate(x, y);
        let [inside_x, inside_y] = self.inside(x, y);
        inside_x * inside_y * (c.sw - c.se - c.nw + c.ne) / (self.spacing[0] * self.spacing[1])
    }

    /// First t in [near, far] where the ray is over the field and on or under the surface.
    pub fn trace(&self, surface: Surface, ray: &WorldRay<f64>) -> Option<f64> {
        let curved = matches!(surface, Surface::Bicubic | Surface::Subdivided(_));
        self.first(ray, curved, |piece| {
            let Piece { cell: (i, j), ends: [a, b], u, v, z } = *piece;
            let corners = self.corners(i, j)?;
            let least = z[0].min(z[1]);
            let share = match surface {
                Surface::Bilinear | Surface::Triangulated if least > corners.highest() => None,
                Surface::Bilinear => meet_bilinear(&corners, u, v, z),
                Surface::Triangulated => meet_triangulated(&corners, u, v, z),
                Surface::Bicubic | Surface::Subdivided(_) => {
                    let around = self.around(i, j);
                    match surface {
                        _ if least > bicubic::summit(&around) => None,
                        Surface::Subdivided(n) => bicubic::meet_subdivided(around, n, u, v, z),
                        _ => bicubic::meet_bicubic(around, u, v, z),
                    }
                }
                Surface::Nearest => None,
            }?;
            Some(a + share * (b - a))
        })
    }

    /// The first cell in which the ray may be no more than `raise` over the bicubic surface: where the ray comes into it, and the
    /// cell.
    pub fn next_cell(&self, ray: &WorldRay<f64>, raise: f64) -> Option<[f64; 3]> {
        let [x, y, z] = ray.origin;
        let lowered = WorldRay { origin: [x, y, z - raise], ..*ray };
        self.first(&lowered, true, |piece| {
            let (i, j) = piece.cell;
            let near = piece.z[0].min(piece.z[1]) <= bicubic::summit(&self.around(i, j));
            near.then_some([piece.ends[0], f64::from(i), f64::from(j)])
        })
    }

    /// Height of a cell's south-western sample, and the 4 x 4 samples around the cell less that one.
    pub fn patch_around(&self, at: [f64; 2]) -> [f64; 17] {
        let (i, j) = self.cell(at[0], at[1]);
        let mut words = [0.0; 17];
        words[0] = f64::from(VOID_F32);
        if self.corners(i, j).is_some() {
            let around = self.around(i, j);
            words[0] = around[1][1];
            words[1..].iter_mut().zip(around.as_flattened()).for_each(|(word, z)| *word = z - around[1][1]);
        }
        words
    }

    /// The first answer to a piece of the ray that lies over a cell, in their order. `curved` surfaces may pass the highest sample.
    fn first<T>(
        &self,
        ray: &WorldRay<f64>,
        curved: bool,
        look: impl FnMut(&Piece) -> Option<T>,
    ) -> Option<T> {
        let mut look = look;
        let WorldRay { origin, dir, near, far } = *ray;
        // Across the field such a component takes longer than any ray is.
        let level = |axis: usize| (dir[axis] / self.spacing[axis]).abs() <= 1e-18;
        let dir = [if level(0) { 0.0 } else { dir[0] }, if level(1) { 0.0 } else { dir[1] }, dir[2]];
        if origin.iter().chain(&dir).any(|x| !x.is_finite()) || near.is_nan() || far.is_nan() {
            return None;
        }
        // Nothing lies above the highest sample, or above what a spline passes it by; bounding an endless ray keeps the arithmetic finite.
        let (mut from, mut to) = (near.max(-1e30), far.min(1e30));
        let grid = |axis: usize, t: f64| (origin[axis] + t * dir[axis]) / self.spacing[axis];
        for axis in 0..2 {
            let size = self.cells()[axis] * self.spacing[axis];
            if dir[axis] == 0.0 {
                if origin[axis] < 0.0 || origin[axis] > size {
                    return None;
                }
            } else {
                let a = (0.0 - origin[axis]) / dir[axis];
                let b = (size - origin[axis]) / dir[axis];
                from = from.max(a.min(b));
                to = to.min(a.max(b));
            }
        }
        let over = if curved { 0.3 * (self.high - self.low) } else { 0.0 };
        let roof = (self.high + over + 1e-6 - origin[2]) / dir[2];
        if dir[2] > 0.0 {
            to = to.min(roof);
        } else if dir[2] < 0.0 {
            from = from.max(roof);
        }
        if from > to {
            return None;
        }

        // Cut at the planes.
        let mut cuts = vec![from, to];
        for axis in 0..2 {
            if dir[axis] != 0.0 {
                let (a, b) = (grid(axis, from), grid(axis, to));
                let first = (a.min(b).floor().max(0.0)) as u64;
                let last = (a.max(b).ceil().max(0.0)).min(self.cells()[axis]) as u64;
                let plane = |i: u64| (i as f64 * self.spacing[axis] - origin[axis]) / dir[axis];
                cuts.extend((first..=last).map(plane).filter(|t| *t > from && *t < to));
            }
        }
        cuts.sort_by(f64::total_cmp);
        let pieces = cuts.windows(2).map(|w| (w[0], w[1]));
        pieces.into_iter().find_map(|(a, b)| {
            let middle = 0.5 * (a + b);
            let (i, j) = self.cell(grid(0, middle), grid(1, middle));
            let u = [grid(0, a) - f64::from(i), grid(0, b) - f64::from(i)];
            let v = [grid(1, a) - f64::from(j), grid(1, b) - f64::from(j)];
            let z = [origin[2] + a * dir[2], origin[2] + b * dir[2]];
            look(&Piece { cell: (i, j), ends: [a, b], u, v, z })
        })
    }
}

fn bilinear(c: &Corners, u: f64, v: f64) -> f64 {
    (1.0 - v) * ((1.0 - u) * c.sw + u * c.se) + v * ((1.0 - u) * c.nw + u * c.ne)
}

fn triangulated(c: &Corners, u: f64, v: f64) -> f64 {
    if u >= v {
        c.sw + u * (c.se - c.sw) + v * (c.ne - c.se)
    } else {
        c.sw + v * (c.nw - c.sw) + u * (c.ne - c.nw)
    }
}

/// First share in [0, 1] of the way where z is on or under the surface: f = z - h is a quadratic of the share.
fn meet_bilinear(c: &Corners, u: [f64; 2], v: [f64; 2], z: [f64; 2]) -> Option<f64> {
    let f0 = z[0] - bilinear(c, u[0], v[0]);
    let f1 = z[1] - bilinear(c, u[1], v[1]);
    if f0 <= 0.0 {
        return Some(0.0);
    }
    let (du, dv) = (u[1] - u[0], v[1] - v[0]);
    let a = -(c.sw - c.se - c.nw + c.ne) * du * dv;
    let b = f1 - f0 - a;
    if f1 > 0.0 && (a <= 0.0 || b >= 0.0 || b * b < 4.0 * a * f0 || -b > 2.0 * a) {
        return None;
    }
    let root = (b * b - 4.0 * a * f0).max(0.0).sqrt();
    let share = if b < 0.0 { 2.0 * f0 / (root - b) } else { (b + root) / (-2.0 * a) };
    Some(share.clamp(0.0, 1.0))
}

fn meet_triangulated(c: &Corners, u: [f64; 2], v: [f64; 2], z: [f64; 2]) -> Option<f64> {
    let at = |s: f64| (u[0] + s * (u[1] - u[0]), v[0] + s * (v[1] - v[0]), z[0] + s * (z[1] - z[0]));
    let f = |s: f64| {
        let (u, v, z) = at(s);
        z - triangulated(c, u, v)
    };
    let side = [u[0] - v[0], u[1] - v[1]];
    let mut stops = vec![0.0, 1.0];
    if side[0] * side[1] < 0.0 {
        stops.insert(1, side[0] / (side[0] - side[1]));
    }
    if f(0.0) <= 0.0 {
        return Some(0.0);
    }
    stops.windows(2).find_map(|w| {
        let (f0, f1) = (f(w[0]), f(w[1]));
        (f1 <= 0.0).then(|| w[0] + (w[1] - w[0]) * if f0 > 0.0 { f0 / (f0 - f1) } else { 0.0 })
    })
}
