//! The camera: free, or one of the named views that frame any field. Rays are set up in double precision and rounded
//! once.

use super::field::Terrain;
use super::framing::{frame, highest, outline, revolved};
use super::scene::SceneError;
use glam::{DQuat, DVec3};
use std::f64::consts::TAU;
use std::str::FromStr;

/// Vertical field of view of the named views, in degrees.
pub const NAMED_FOV: f64 = 35.0;
/// Metres above the ground from which a panorama is seen.
pub const STANDING: f64 = 3.0;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NamedView {
    /// From the south and above; from the south-west over a long field.
    Overview,
    /// Straight down, north up, a map.
    Topdown,
    /// Looking north, low; the others alike.
    North,
    South,
    East,
    West,
}

impl NamedView {
    pub const ALL: &'static [(&'static str, NamedView)] = &[
        ("overview", NamedView::Overview),
        ("topdown", NamedView::Topdown),
        ("north", NamedView::North),
        ("south", NamedView::South),
        ("east", NamedView::East),
        ("west", NamedView::West),
    ];

    /// Line of sight: azimuth clockwise from north and angle downwards, in degrees.
    pub(super) fn direction(self) -> (f64, f64) {
        match self {
            NamedView::Overview => (0.0, 30.0),
            NamedView::Topdown => (0.0, 90.0),
            NamedView::North => (0.0, 14.0),
            NamedView::South => (180.0, 14.0),
            NamedView::East => (90.0, 14.0),
            NamedView::West => (270.0, 14.0),
        }
    }

    /// The same for a field: one much longer than wide would be a thin line across the picture, or seen end on, but along the
    /// picture's diagonal it is as large as can be.
    fn direction_over(self, terrain: &Terrain) -> (f64, f64) {
        const LONG: f64 = 3.0;
        const ASIDE: f64 = 40.0;
        let (azimuth, dip) = self.direction();
        match (self, terrain.extent()) {
            (NamedView::Overview, [east, north]) if east > LONG * north => (90.0 - ASIDE, dip),
            (NamedView::Overview, [east, north]) if north > LONG * east => (ASIDE, dip),
            _ => (azimuth, dip),
        }
    }
}

impl FromStr for NamedView {
    type Err = SceneError;

    fn from_str(name: &str) -> Result<NamedView, SceneError> {
        let found = NamedView::ALL.iter().find(|(n, _)| *n == name);
        found.map(|(_, view)| *view).ok_or_else(|| SceneError::UnknownView(name.to_owned()))
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    /// `ortho` makes any named view orthographic; `topdown` always is. `fov` is vertical, in degrees; the camera stands
    /// where the field fills it.
    Named { view: NamedView, fov: f64, ortho: bool },
    /// A named view whose camera is turned about the field's middle, clockwise seen from above, by `turn` degrees. It
    /// stands as far away as every turn needs, so that the turns make a turntable.
    Turned { view: NamedView, fov: f64, ortho: bool, turn: f64 },
    /// World metres; `fov` is vertical, in degrees. With `ortho` the picture is as high as the field of view is at the
    /// target.
    LookAt { eye: [f64; 3], target: [f64; 3], up: [f64; 3], fov: f64, ortho: bool },
    /// All directions around a point (equirectangular): columns are azimuths, 360 degrees of them, with `azimuth`,
    /// clockwise from north, in the middle; rows are elevations, the horizon in the middle. `fov` is from the lowest to the
    /// highest row, at most 180 degrees; where none is given, as many as make pixels square on the horizon.
    Panorama { from: Stand, azimuth: f64, fov: Option<f64> },
}

/// Where a panorama is seen from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stand {
    /// [`STANDING`] above the highest sample.
    Summit,
    /// [`STANDING`] above the ground at a position.
    Ground([f64; 2]),
    At([f64; 3]),
}

impl View {
    pub fn overview() -> View {
        View::Named { view: NamedView::Overview, fov: NAMED_FOV, ortho: false }
    }

    pub fn topdown() -> View {
        View::Named { view: NamedView::Topdown, fov: NAMED_FOV, ortho: true }
    }

    pub fn panorama() -> View {
        View::Panorama { from: Stand::Summit, azimuth: 0.0, fov: None }
    }

    /// The view of a camera that has a place, so that it can be kept while the field changes.
    pub fn of(camera: &Camera) -> Option<View> {
        let eye = camera.eye.to_array();
        let fov = |pixel: f64| 2.0 * (pixel * camera.middle[1]).atan().to_degrees();
        match camera.projection {
            Projection::Orthographic => None,
            Projection::Perspective => Some(View::LookAt {
                eye,
                target: (camera.eye + camera.forward * camera.eye.length().max(1.0)).to_array(),
                up: (-camera.down).normalize().to_array(),
                fov: fov(camera.down.length()),
                ortho: false,
            }),
            Projection::Panorama => Some(View::Panorama {
                from: Stand::At(eye),
                azimuth: camera.forward.x.atan2(camera.forward.y).to_degrees(),
                fov: Some(camera.down.x * 360.0 * 2.0 * camera.middle[1]),
            }),
        }
    }

    /// The same turned clockwise by degrees: about the field's middle, about the target, or on the spot.
    #[must_use]
    pub fn turned(self, degrees: f64) -> View {
        match self {
            View::Named { view, fov, ortho } => View::Turned { view, fov, ortho, turn: degrees },
            View::Turned { view, fov, ortho, turn } => {
                View::Turned { view, fov, ortho, turn: turn + degrees }
            }
            View::LookAt { eye, target, up, fov, ortho } => {
                let turn = DQuat::from_rotation_z(-degrees.to_radians());
                let (eye, to) = (DVec3::from(eye), DVec3::from(target));
                let eye = (to + turn * (eye - to)).to_array();
                View::LookAt { eye, target, up: (turn * DVec3::from(up)).to_array(), fov, ortho }
            }
            View::Panorama { from, azimuth, fov } => View::Panorama { from, azimuth: azimuth + degrees, fov },
        }
    }
}

impl Default for View {
    fn default() -> View {
        View::overview()
    }
}

/// How pixels become rays; the shaders know it by its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Projection {
    Perspective = 0,
    Orthographic = 1,
    Panorama = 2,
}

/// A view made definite for a field and a picture size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    pub eye: DVec3,
    /// Unit; level in a panorama.
    pub forward: DVec3,
    /// From one pixel to the next, rightwards and downwards; at distance 1 if perspective. A panorama has its pixels' width
    /// and height here as parts of a full turn, in x.
    pub across: DVec3,
    pub down: DVec3,
    /// The picture's middle in pixels.
    pub middle: [f64; 2],
    pub projection: Projection,
}

impl Camera {
    pub fn new(
        view: &View,
        terrain: &Terrain,
        exaggerate: f64,
        size: (u32, u32),
    ) -> Result<Camera, SceneError> {
        if size.0 == 0 || size.1 == 0 {
            return Err(SceneError::EmptyPicture);
        }
        match view {
            View::Named { view, fov, ortho } => {
                check_fov(*fov)?;
                let points = outline(terrain, exaggerate);
                let direction = view.direction_over(terrain);
                Ok(frame(direction, *fov, *ortho || *view == NamedView::Topdown, &points, size))
            }
            View::Turned { view, fov, ortho, turn } => {
                check_fov(*fov)?;
                if !turn.is_finite() {
                    return Err(SceneError::NotFinite);
                }
                let points = revolved(terrain, &outline(terrain, exaggerate));
                let (azimuth, dip) = view.direction();
                let flat = *ortho || *view == NamedView::Topdown;
                Ok(frame((azimuth + turn, dip), *fov, flat, &points, size))
            }
            View::Panorama { from, azimuth, fov } => {
                around(stand(*from, terrain, exaggerate)?, *azimuth, *fov, size)
            }
            View::LookAt { eye, target, up, fov, ortho } => look_at(*eye, *target, *up, *fov, *ortho, size),
        }
    }

    /// Origin and unit direction of the ray through pixel position (x, y).
    pub fn ray(&self, x: f64, y: f64) -> (DVec3, DVec3) {
        let (i, j) = (x - self.middle[0], y - self.middle[1]);
        let offset = i * self.across + j * self.down;
        match self.projection {
            Projection::Perspective => (self.eye, (self.forward + offset).normalize()),
            Projection::Orthographic => (self.eye + offset, self.forward),
            Projection::Panorama => {
                let (sin_a, cos_a) = (i * self.across.x * TAU).sin_cos();
                let (sin_e, cos_e) = (-j * self.down.x * TAU).sin_cos();
                let right = DVec3::new(self.forward.y, -self.forward.x, 0.0);
                (self.eye, cos_e * (cos_a * self.forward + sin_a * right) + sin_e * DVec3::Z)
            }
        }
    }

    /// A pixel's width at distance t is x + y t.
    pub fn pixel_width(&self) -> [f64; 2] {
        let width = self.down.length();
        match self.projection {
            Projection::Perspective => [0.0, width],
            Projection::Orthographic => [width, 0.0],
            Projection::Panorama => [0.0, width * TAU],
        }
    }
}

impl Camera {
    /// How far the eye is below the ground, and the height of the ground there, in metres; none above it, beside the field, and
    /// for parallel rays, which begin anywhere.
    pub fn buried(&self, terrain: &Terrain, exaggerate: f64) -> Option<(f64, f64)> {
        let ground = exaggerate * ground(terrain, self.eye.x, self.eye.y)?;
        let depth = ground - self.eye.z;
        (depth > 0.0 && self.projection != Projection::Orthographic).then_some((depth, ground))
    }
}

/// The place that a panorama is seen from.
fn stand(from: Stand, terrain: &Terrain, exaggerate: f64) -> Result<DVec3, SceneError> {
    let (x, y, z) = match from {
        Stand::At(at) => return Ok(DVec3::from(at)),
        Stand::Summit => highest(terrain),
        Stand::Ground([x, y]) => {
            let ground = ground(terrain, x, y).ok_or(SceneError::NoGround(x, y))?;
            (x, y, ground)
        }
    };
    Ok(DVec3::new(x, y, z * exaggerate + STANDING))
}

/// Bilinear height over a position on the field; none outside and in a hole.
fn ground(terrain: &Terrain, x: f64, y: f64) -> Option<f64> {
    let (gx, gy) = (x / terrain.spacing[0], y / terrain.spacing[1]);
    let inside = |g: f64, n: u32| (0.0..=f64::from(n - 1)).contains(&g);
    if !inside(gx, terrain.width) || !inside(gy, terrain.height) {
        return None;
    }
    let (i, j) = ((gx as u32).min(terrain.width - 2), (gy as u32).min(terrain.height - 2));
    let (u, v) = (gx - f64::from(i), gy - f64::from(j));
    let row = |j: u32| Some(terrain.sample(i, j)? * (1.0 - u) + terrain.sample(i + 1, j)? * u);
    Some(row(j)? * (1.0 - v) + row(j + 1)? * v)
}

fn around(eye: DVec3, azimuth: f64, fov: Option<f64>, size: (u32, u32)) -> Result<Camera, SceneError> {
    if !eye.is_finite() || !azimuth.is_finite() {
        return Err(SceneError::NotFinite);
    }
    let across = 1.0 / f64::from(size.0);
    let down = match fov {
        Some(fov) if fov > 0.0 && fov <= 180.0 => fov / 360.0 / f64::from(size.1),
        Some(fov) => return Err(SceneError::FieldOfView(fov)),
        None => across.min(0.5 / f64::from(size.1)),
    };
    let (sin, cos) = azimuth.to_radians().sin_cos();
    Ok(Camera {
        eye,
        forward: DVec3::new(sin, cos, 0.0),
        across: DVec3::X * across,
        down: DVec3::X * down,
        middle: middle(size),
        projection: Projection::Panorama,
    })
}

fn look_at(
    eye: [f64; 3],
    target: [f64; 3],
    up: [f64; 3],
    fov: f64,
    orthographic: bool,
    size: (u32, u32),
) -> Result<Camera, SceneError> {
    let all = eye.iter().chain(&target).chain(&up);
    if all.into_iter().any(|x| !x.is_finite()) {
        return Err(SceneError::NotFinite);
    }
    check_fov(fov)?;
    let (eye, target) = (DVec3::from(eye), DVec3::from(target));
    let sight = target - eye;
    let forward = sight.try_normalize().ok_or(SceneError::SamePlace)?;
    // Straight up or down, north is up in the picture.
    let side =
        [DVec3::from(up), DVec3::Y, DVec3::X].into_iter().map(|up| forward.cross(up.normalize_or_zero()));
    let right = side.into_iter().find(|r| r.length() > 1e-9).unwrap_or(DVec3::X).normalize();
    let scale = if orthographic { sight.length() } else { 1.0 };
    let pixel = 2.0 * (fov.to_radians() / 2.0).tan() * scale / f64::from(size.1);
    Ok(Camera {
        eye,
        forward,
        across: right * pixel,
        down: forward.cross(right) * pixel,
        middle: middle(size),
        projection: if orthographic { Projection::Orthographic } else { Projection::Perspective },
    })
}

fn check_fov(fov: f64) -> Result<(), SceneError> {
    if fov > 0.0 && fov < 180.0 { Ok(()) } else { Err(SceneError::FieldOfView(fov)) }
}

pub(super) fn middle(size: (u32, u32)) -> [f64; 2] {
    [f64::from(size.0) / 2.0, f64::from(size.1) / 2.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn project(camera: &Camera, p: DVec3) -> (f64, f64) {
        let q = p - camera.eye;
        let pixel2 = camera.across.length_squared();
        let depth = if camera.projection == Projection::Orthographic { 1.0 } else { q.dot(camera.forward) };
        let x = camera.middle[0] + q.dot(camera.across) / pixel2 / depth;
        let y = camera.middle[1] + q.dot(camera.down) / pixel2 / depth;
        (x, y)
    }

    #[test]
    fn named_views_frame_any_field() {
        for (w, h, dx, dy, peak) in
            [(9, 9, 30.0, 30.0, 50.0), (2, 300, 1.0, 1.0, 0.0), (40, 5, 1e4, 3.0, 1e5)]
        {
            let heights = (0..w * h).map(|i| if i == w + 1 { peak } else { 0.0 }).collect();
            let terrain = Terrain::from_heights(w, h, [dx, dy], heights).unwrap();
            for (name, view) in NamedView::ALL {
                for (ortho, size) in [(false, (640, 480)), (true, (100, 900))] {
                    let view = View::Named { view: *view, fov: if ortho { NAMED_FOV } else { 70.0 }, ortho };
                    let camera = Camera::new(&view, &terrain, 1.0, size).unwrap();
                    for p in outline(&terrain, 1.0) {
                        let (x, y) = project(&camera, p);
                        let inside =
                            (0.0..=f64::from(size.0)).contains(&x) && (0.0..=f64::from(size.1)).contains(&y);
                        assert!(inside, "{name} {ortho} {w}x{h}: {p} falls on {x} {y}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_model_is_framed_down_to_its_underside_and_up_to_any_spike() {
        // The spike stands between the samples of the coarse grid.
        let heights = (0..500 * 500).map(|i| if i == 301 * 500 + 217 { 40_000.0 } else { 100.0 }).collect();
        let terrain = Terrain::from_heights(500, 500, [10.0, 10.0], heights).unwrap();
        let low = 2.0 * 100.0 - 0.12 * 2.0 * 39_900.0;
        let spike = DVec3::new(2170.0, 3010.0, 80_000.0);
        for (name, view) in NamedView::ALL {
            for ortho in [false, true] {
                let view = View::Named { view: *view, fov: NAMED_FOV, ortho };
                let camera = Camera::new(&view, &terrain, 2.0, (64, 48)).unwrap();
                for p in [DVec3::new(0.0, 0.0, low), DVec3::new(4990.0, 4990.0, low), spike] {
                    let (x, y) = project(&camera, p);
                    assert!(
                        (1.0..63.0).contains(&x) && (1.0..47.0).contains(&y),
                        "{name} {ortho}: {p} {x} {y}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_long_field_lies_along_the_diagonal() {
        for (w, h) in [(500, 10), (10, 500)] {
            let terrain = Terrain::from_heights(w, h, [10.0, 10.0], vec![0.0; (w * h) as usize]).unwrap();
            let camera = Camera::new(&View::overview(), &terrain, 1.0, (300, 200)).unwrap();
            let [east, north] = terrain.extent();
            let (a, b) = (project(&camera, DVec3::ZERO), project(&camera, DVec3::new(east, north, 0.0)));
            assert!((a.0 - b.0).hypot(a.1 - b.1) > 200.0, "{a:?} {b:?}");
            assert!((a.1 - b.1).abs() > 60.0, "{a:?} {b:?}");
        }
    }

    #[test]
    fn parallel_rays_begin_above_the_model() {
        let terrain = Terrain::from_heights(64, 64, [30.0, 30.0], vec![120.0; 64 * 64]).unwrap();
        for (name, view) in NamedView::ALL {
            for size in [(64, 48), (20, 200)] {
                let view = View::Named { view: *view, fov: NAMED_FOV, ortho: true };
                let camera = Camera::new(&view, &terrain, 1.0, size).unwrap();
                let lowest = camera.ray(0.0, f64::from(size.1)).0.z;
                assert!(lowest > 120.0 - 0.02 * 1890.0 * 2f64.sqrt(), "{name} {size:?}: {lowest}");
            }
        }
    }

    #[test]
    fn an_eye_in_the_ground_is_known() {
        let terrain = Terrain::from_heights(3, 3, [10.0, 10.0], vec![50.0; 9]).unwrap();
        let at = |eye, ortho| {
            let view = View::LookAt { eye, target: [0.0, 0.0, 0.0], up: [0.0, 0.0, 1.0], fov: 40.0, ortho };
            Camera::new(&view, &terrain, 2.0, (4, 4)).unwrap().buried(&terrain, 2.0)
        };
        assert_eq!(at([10.0, 5.0, 70.0], false), Some((30.0, 100.0)));
        assert_eq!(at([10.0, 5.0, 101.0], false), None);
        assert_eq!(at([10.0, 5.0, 70.0], true), None);
        assert_eq!(at([-1.0, 5.0, 70.0], false), None);
    }

    #[test]
    fn north_is_up_and_east_is_right_in_the_map_view() {
        let terrain = Terrain::from_heights(5, 5, [10.0, 10.0], vec![0.0; 25]).unwrap();
        let camera = Camera::new(&View::topdown(), &terrain, 1.0, (100, 100)).unwrap();
        let (x0, y0) = project(&camera, DVec3::new(20.0, 20.0, 0.0));
        let (x1, y1) = project(&camera, DVec3::new(30.0, 40.0, 0.0));
        assert!((x0 - 50.0).abs() < 1e-9 && (y0 - 50.0).abs() < 1e-9);
        assert!(x1 > x0 && y1 < y0);
    }

    #[test]
    fn a_ray_through_the_middle_meets_the_target() {
        let terrain = Terrain::from_heights(2, 2, [1.0, 1.0], vec![0.0; 4]).unwrap();
        let view = |eye, up| View::LookAt { eye, target: [4.0, 5.0, 6.0], up, fov: 40.0, ortho: false };
        for (eye, up) in [([1.0, 1.0, 1.0], [0.0, 0.0, 1.0]), ([4.0, 5.0, 90.0], [0.0, 0.0, 1.0])] {
            let camera = Camera::new(&view(eye, up), &terrain, 1.0, (64, 32)).unwrap();
            let (origin, dir) = camera.ray(32.0, 16.0);
            let to = (DVec3::new(4.0, 5.0, 6.0) - origin).normalize();
            assert!((to - dir).length() < 1e-12);
        }
        let same = view([4.0, 5.0, 6.0], [0.0, 0.0, 1.0]);
        assert!(matches!(Camera::new(&same, &terrain, 1.0, (64, 32)), Err(SceneError::SamePlace)));
    }
    #[test]
    fn a_camera_gives_its_view_back() {
        let terrain = Terrain::builtin();
        for view in [View::overview(), View::panorama().turned(40.0), View::overview().turned(70.0)] {
            let camera = Camera::new(&view, &terrain, 1.0, (300, 200)).unwrap();
            let again = Camera::new(&View::of(&camera).unwrap(), &terrain, 1.0, (300, 200)).unwrap();
            for (x, y) in [(0.0, 0.0), (150.0, 100.0), (300.0, 20.0)] {
                let ((o, d), (p, e)) = (camera.ray(x, y), again.ray(x, y));
                assert!((o - p).length() < 1e-6 && (d - e).length() < 1e-9, "{view:?}");
            }
        }
        let flat = Camera::new(&View::topdown(), &terrain, 1.0, (300, 200)).unwrap();
        assert_eq!(View::of(&flat), None);
    }

    #[test]
    fn a_turntable_frames_the_field_at_every_turn() {
        let heights = (0..40 * 9).map(|i| if i == 41 { 900.0 } else { 0.0 }).collect();
        let terrain = Terrain::from_heights(40, 9, [30.0, 20.0], heights).unwrap();
        let mut eyes = Vec::new();
        for turn in 0..12 {
            let view = View::overview().turned(30.0 * f64::from(turn));
            let camera = Camera::new(&view, &terrain, 1.0, (320, 200)).unwrap();
            for p in outline(&terrain, 1.0) {
                let (x, y) = project(&camera, p);
                assert!((0.0..=320.0).contains(&x) && (0.0..=200.0).contains(&y), "{turn}: {p} on {x} {y}");
            }
            eyes.push(camera.eye);
        }
        let middle = DVec3::new(39.0 * 15.0, 80.0, 0.0);
        let away = |eye: &DVec3| (*eye - middle).truncate().length();
        for eye in &eyes {
            assert!((away(eye) - away(&eyes[0])).abs() < 1e-3 * away(&eyes[0]), "{eyes:?}");
            assert!((eye.z - eyes[0].z).abs() < 1e-3 * away(&eyes[0]));
        }
        // A quarter turn clockwise of a camera in the south is one in the west.
        assert!(eyes[0].y < 0.0 && eyes[3].x < 0.0);
    }

    #[test]
    fn a_panorama_looks_everywhere() {
        let heights = (0..25).map(|i| if i == 7 { 50.0 } else { 0.0 }).collect();
        let terrain = Terrain::from_heights(5, 5, [10.0, 10.0], heights).unwrap();
        let camera = Camera::new(&View::panorama(), &terrain, 2.0, (360, 180)).unwrap();
        assert_eq!(camera.eye, DVec3::new(20.0, 10.0, 103.0));
        let flat = Terrain::from_heights(7, 5, [10.0, 20.0], vec![4.0; 35]).unwrap();
        let middle = Camera::new(&View::panorama(), &flat, 1.0, (36, 18)).unwrap();
        assert_eq!(middle.eye, DVec3::new(30.0, 40.0, 7.0));
        let towards = |x, y| camera.ray(x, y).1;
        let near = |a: DVec3, b: DVec3| assert!((a - b).length() < 1e-12, "{a} {b}");
        near(towards(180.0, 90.0), DVec3::Y);
        near(towards(270.0, 90.0), DVec3::X);
        near(towards(0.0, 90.0), -DVec3::Y);
        near(towards(77.0, 0.0), DVec3::Z);
        let turned = Camera::new(&View::panorama().turned(90.0), &terrain, 1.0, (360, 360)).unwrap();
        near(turned.ray(180.0, 180.0).1, DVec3::X);
        near(turned.ray(180.0, 360.0).1, -DVec3::Z);
        let at = |from| View::Panorama { from, azimuth: 0.0, fov: Some(60.0) };
        let ground = Camera::new(&at(Stand::Ground([15.0, 10.0])), &terrain, 1.0, (36, 60)).unwrap();
        assert_eq!(ground.eye.z, 28.0);
        assert!((ground.ray(0.0, 0.0).1.z - 0.5).abs() < 1e-12);
        let outside = Camera::new(&at(Stand::Ground([-1.0, 10.0])), &terrain, 1.0, (36, 60));
        assert!(matches!(outside, Err(SceneError::NoGround(..))));
    }
}
