//! Intersection with one cell. `f(s) = z(ray) - surface` on the ray's way through the cell; a hit is the first
//! s with f <= 0, so a ray that comes in under the surface hits at once: nothing slips between neighbouring cells.
//! Twin of `shaders/terrain/patch_*.wgsl`.

/// Raw heights of a cell's corners.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corners {
    pub sw: f32,
    pub se: f32,
    pub nw: f32,
    pub ne: f32,
}

impl Corners {
    pub fn lowest(&self) -> f32 {
        self.sw.min(self.se).min(self.nw.min(self.ne))
    }

    pub fn highest(&self) -> f32 {
        self.sw.max(self.se).max(self.nw.max(self.ne))
    }
}

/// The ray's way through a cell: local entry, z over the south-west corner there, direction and length in s. The entry
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

/// How a cell is interpolated.
pub(super) trait Patch {
    fn height(corners: &Corners, u: f32, v: f32) -> f32;
    /// Metres of s behind the entry, negative for a miss.
    fn intersect(corners: &Corners, way: &Way) -> f32;
}

pub(super) const MISS: f32 = -1.0;

pub(super) struct Bilinear;

impl Patch for Bilinear {
    fn height(c: &Corners, u: f32, v: f32) -> f32 {
        let south = c.sw * (1.0 - u) + c.se * u;
        let north = c.nw * (1.0 - u) + c.ne * u;
        south * (1.0 - v) + north * v
    }

    fn intersect(corners: &Corners, way: &Way) -> f32 {
        let east = corners.se - corners.sw;
        let north = corners.nw - corners.sw;
        let twist = (corners.ne - corners.nw) - east;
        let f_in = way.z - (east * way.u + (north + twist * way.u) * way.v);
        if f_in <= 0.0 {
            return 0.0;
        }

        // f(s) = a s^2 + b s + f_in
        let a = -(twist * way.du * way.dv);
        let b = way.dz - east * way.du - north * way.dv - twist * (way.u * way.dv + way.v * way.du);
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
pub(super) struct Triangulated;

impl Patch for Triangulated {
    fn height(c: &Corners, u: f32, v: f32) -> f32 {
        if u >= v {
            c.sw * (1.0 - u) + c.se * (u - v) + c.ne * v
        } else {
            c.sw * (1.0 - v) + c.nw * (v - u) + c.ne * u
        }
    }

    fn intersect(corners: &Corners, way: &Way) -> f32 {
        let side = way.u - way.v;
        let turn = way.du - way.dv;
        // The surface is linear up to the diagonal and behind it.
        let lower = side > 0.0 || (side == 0.0 && turn >= 0.0);
        let south_east = [corners.se - corners.sw, corners.ne - corners.se];
        let north_west = [corners.ne - corners.nw, corners.nw - corners.sw];
        let [first, second] = if lower { [south_east, north_west] } else { [north_west, south_east] };
        let f_in = way.z - (first[0] * way.u + first[1] * way.v);
        if f_in <= 0.0 {
            return 0.0;
        }
        let b = way.dz - first[0] * way.du - first[1] * way.dv;
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
