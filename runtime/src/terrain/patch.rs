//! Intersection with one cell. `f(s) = z(ray) - surface` on the ray's way through the cell; a hit is the first
//! s with f <= 0, so a ray that comes in under the surface hits at once: nothing slips between neighbouring cells.
//! Twin of `shaders/terrain/patch_*.wgsl`.

mod curved;
mod sextic;

pub(super) use curved::{Bicubic, Subdivided};

use super::field::VOID_F32;
use super::layout::SceneUniform;
use super::walk::Heights;

/// Raw heights of a cell's corners.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corners {
    pub sw: f32,
    pub se: f32,
    pub nw: f32,
    pub ne: f32,
}

impl Corners {
    pub fn new<H: Heights>(scene: &SceneUniform, heights: &H, cell: [i32; 2]) -> Corners {
        let width = scene.size[0] as usize;
        let at = cell[1] as usize * width + cell[0] as usize;
        Corners {
            sw: heights.sample(at),
            se: heights.sample(at + 1),
            nw: heights.sample(at + width),
            ne: heights.sample(at + width + 1),
        }
    }

    pub fn lowest(&self) -> f32 {
        self.sw.min(self.se).min(self.nw.min(self.ne))
    }

    /// In the east, in the north.
    pub fn at(&self, [east, north]: [bool; 2]) -> f32 {
        match (east, north) {
            (false, false) => self.sw,
            (true, false) => self.se,
            (false, true) => self.nw,
            (true, true) => self.ne,
        }
    }

    pub fn highest(&self) -> f32 {
        self.sw.max(self.se).max(self.nw.max(self.ne))
    }
}

/// The ray's way through a cell: local entry, z over the corner that it is seen from, direction and length in s. The entry
/// may lie outside the cell by a rounding; the surface goes on there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    pub u: f32,
    pub v: f32,
    pub z: f32,
    pub du: f32,
    pub dv: f32,
    pub dz: f32,
    pub length: f32,
}

/// How heights between a cell's corners are interpolated.
pub(super) trait Interpolation {
    fn height(corners: &Corners, u: f32, v: f32) -> f32;
}

/// A surface that a walk can meet, cell by cell.
pub(super) trait Patch {
    /// What a cell's surface is made of.
    type Samples;
    /// By which part of the field's relief it may rise above the highest sample.
    const OVERSHOOT: f32;
    /// Rounding of its heights, as a part of the relief of the cell's samples.
    const ROUNDED: f32;

    /// None if the cell touches a void.
    fn samples<H: Heights>(&self, scene: &SceneUniform, heights: &H, cell: [i32; 2])
    -> Option<Self::Samples>;
    /// Upper bound over a node of the pyramid.
    fn bound<H: Heights>(heights: &H, index: usize) -> f32;
    /// Bounds over the cell.
    fn range(samples: &Self::Samples) -> [f32; 2];
    /// Height of a corner: in the east, in the north.
    fn corner(samples: &Self::Samples, at: [bool; 2]) -> f32;
    /// Height over the surface at the way's entry, and its change by s; the way is seen from one of the corners.
    fn over(&self, samples: &Self::Samples, way: &Way, from: [bool; 2]) -> [f32; 2];
    /// Metres of s behind the entry, negative for a miss; the way is seen from the south-western corner.
    fn intersect(&self, samples: &Self::Samples, way: &Way) -> f32;
}

/// The part of [`Patch`] that surfaces share which depend on the corners alone.
macro_rules! corners {
    () => {
        type Samples = Corners;
        const OVERSHOOT: f32 = 0.0;
        const ROUNDED: f32 = 2.4e-7;

        fn samples<H: Heights>(&self, scene: &SceneUniform, heights: &H, cell: [i32; 2]) -> Option<Corners> {
            let corners = Corners::new(scene, heights, cell);
            (corners.lowest() != VOID_F32).then_some(corners)
        }

        fn bound<H: Heights>(heights: &H, index: usize) -> f32 {
            heights.bound(index)
        }

        fn range(corners: &Corners) -> [f32; 2] {
            [corners.lowest(), corners.highest()]
        }

        fn corner(corners: &Corners, at: [bool; 2]) -> f32 {
            corners.at(at)
        }
    };
}

pub(super) const MISS: f32 = -1.0;

#[derive(Clone, Copy)]
pub(super) struct Bilinear;

impl Interpolation for Bilinear {
    fn height(c: &Corners, u: f32, v: f32) -> f32 {
        let south = c.sw * (1.0 - u) + c.se * u;
        let north = c.nw * (1.0 - u) + c.ne * u;
        south * (1.0 - v) + north * v
    }
}

impl Patch for Bilinear {
    corners!();

    fn over(&self, corners: &Corners, way: &Way, from: [bool; 2]) -> [f32; 2] {
        let [south_edge, north_edge] = [corners.se - corners.sw, corners.ne - corners.nw];
        let east = if from[1] { north_edge } else { south_edge };
        let north = if from[0] { corners.ne - corners.se } else { corners.nw - corners.sw };
        let twist = north_edge - south_edge;
        [
            way.z - (east * way.u + (north + twist * way.u) * way.v),
            way.dz - east * way.du - north * way.dv - twist * (way.u * way.dv + way.v * way.du),
        ]
    }

    fn intersect(&self, corners: &Corners, way: &Way) -> f32 {
        let [f_in, b] = self.over(corners, way, [false; 2]);
        if f_in <= 0.0 {
            return 0.0;
        }

        // f(s) = a s^2 + b s + f_in
        let a = -(((corners.ne - corners.nw) - (corners.se - corners.sw)) * way.du * way.dv);
        let f_out = f_in + way.length * (b + way.length * a);
        // Both ends above: only a dip below the surface in between can hit.
        if f_out > 0.0 && !(a > 0.0 && b < 0.0 && -b < 2.0 * a * way.length) {
            return MISS;
        }
        let discriminant = b * b - 4.0 * a * f_in;
        if f_out > 0.0 && discriminant < 0.0 {
            return MISS;
        }
        let root = discriminant.max(0.0).sqrt();
        // The root without cancellation.
        let s = if b < 0.0 { 2.0 * f_in / (root - b) } else { (b + root) / (-2.0 * a) };
        s.clamp(0.0, way.length)
    }
}

/// Split along the diagonal from the north-east to the south-west corner.
#[derive(Clone, Copy)]
pub(super) struct Triangulated;

impl Triangulated {
    /// Slopes of the half that the way enters by, and of the other; the surface is linear in each. `side` is how far the entry is
    /// from the diagonal.
    fn halves(c: &Corners, way: &Way, side: f32) -> [[f32; 2]; 2] {
        let lower = side > 0.0 || (side == 0.0 && way.du - way.dv >= 0.0);
        let south_east = [c.se - c.sw, c.ne - c.se];
        let north_west = [c.ne - c.nw, c.nw - c.sw];
        if lower { [south_east, north_west] } else { [north_west, south_east] }
    }
}

impl Interpolation for Triangulated {
    fn height(c: &Corners, u: f32, v: f32) -> f32 {
        if u >= v {
            c.sw * (1.0 - u) + c.se * (u - v) + c.ne * v
        } else {
            c.sw * (1.0 - v) + c.nw * (v - u) + c.ne * u
        }
    }
}

impl Patch for Triangulated {
    corners!();

    fn over(&self, corners: &Corners, way: &Way, from: [bool; 2]) -> [f32; 2] {
        let [first, _] = Triangulated::halves(corners, way, way.u - way.v + aside(from));
        [way.z - (first[0] * way.u + first[1] * way.v), way.dz - first[0] * way.du - first[1] * way.dv]
    }

    fn intersect(&self, corners: &Corners, way: &Way) -> f32 {
        let [f_in, b] = self.over(corners, way, [false; 2]);
        if f_in <= 0.0 {
            return 0.0;
        }
        let side = way.u - way.v;
        let turn = way.du - way.dv;
        let [_, second] = Triangulated::halves(corners, way, side);
        if side * (side + turn * way.length) < 0.0 {
            let s = (-side / turn).min(way.length);
            let f_mid = f_in + s * b;
            if f_mid <= 0.0 {
                return s * (f_in / (f_in - f_mid));
            }
            let rest = way.length - s;
            let f_out = f_mid + rest * (way.dz - second[0] * way.du - second[1] * way.dv);
            return if f_out <= 0.0 { s + rest * (f_mid / (f_mid - f_out)) } else { MISS };
        }
        let f_out = f_in + way.length * b;
        if f_out > 0.0 { MISS } else { way.length * (f_in / (f_in - f_out)) }
    }
}

/// How far a corner is from the diagonal.
fn aside(from: [bool; 2]) -> f32 {
    f32::from(u8::from(from[0])) - f32::from(u8::from(from[1]))
}
