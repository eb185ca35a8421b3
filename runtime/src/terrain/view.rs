//! The camera: free, or one of the named views that frame any field. Rays are set up in double precision and rounded
//! once.

use super::field::Terrain;
use super::scene::SceneError;
use glam::DVec3;
use std::str::FromStr;

/// Vertical field of view of the named views, in degrees.
pub const NAMED_FOV: f64 = 35.0;
/// Part of the picture that a framed field may fill.
const FRAME: f64 = 0.94;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NamedView {
    /// From the south and above.
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
    fn direction(self) -> (f64, f64) {
        match self {
            NamedView::Overview => (0.0, 30.0),
            NamedView::Topdown => (0.0, 90.0),
            NamedView::North => (0.0, 14.0),
            NamedView::South => (180.0, 14.0),
            NamedView::East => (90.0, 14.0),
            NamedView::West => (270.0, 14.0),
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
    /// World metres; `fov` is vertical, in degrees. With `ortho` the picture is as high as the field of view is at the
    /// target.
    LookAt { eye: [f64; 3], target: [f64; 3], up: [f64; 3], fov: f64, ortho: bool },
}

impl View {
    pub fn overview() -> View {
        View::Named { view: NamedView::Overview, fov: NAMED_FOV, ortho: false }
    }

    pub fn topdown() -> View {
        View::Named { view: NamedView::Topdown, fov: NAMED_FOV, ortho: true }
    }
}

impl Default for View {
    fn default() -> View {
        View::overview()
    }
}

/// A view made definite for a field and a picture size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    pub eye: DVec3,
    /// Unit.
    pub forward: DVec3,
    /// From one pixel to the next, rightwards and downwards; at distance 1 if perspective.
    pub across: DVec3,
    pub down: DVec3,
    /// The picture's middle in pixels.
    pub middle: [f64; 2],
    pub orthographic: bool,
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
                Ok(frame(*view, *fov, *ortho || *view == NamedView::Topdown, &points, size))
            }
            View::LookAt { eye, target, up, fov, ortho } => look_at(*eye, *target, *up, *fov, *ortho, size),
        }
    }

    /// Origin and unit direction of the ray through pixel position (x, y).
    pub fn ray(&self, x: f64, y: f64) -> (DVec3, DVec3) {
        let offset = (x - self.middle[0]) * self.across + (y - self.middle[1]) * self.down;
        if self.orthographic {
            (self.eye + offset, self.forward)
        } else {
            (self.eye, (self.forward + offset).normalize())
        }
    }

    /// A pixel's width at distance t is x + y t.
    pub fn pixel_width(&self) -> [f64; 2] {
        let width = self.down.length();
        if self.orthographic { [width, 0.0] } else { [0.0, width] }
    }
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
        orthographic,
    })
}

fn check_fov(fov: f64) -> Result<(), SceneError> {
    if fov > 0.0 && fov < 180.0 { Ok(()) } else { Err(SceneError::FieldOfView(fov)) }
}

fn middle(size: (u32, u32)) -> [f64; 2] {
    [f64::from(size.0) / 2.0, f64::from(size.1) / 2.0]
}

/// Points whose hull is nearly that of the field: a coarse grid of samples, and the corners at the lowest height.
fn outline(terrain: &Terrain, exaggerate: f64) -> Vec<DVec3> {
    const GRID: u32 = 48;
    let picks = |n: u32| (0..=GRID).map(move |k| (u64::from(n - 1) * u64::from(k) / u64::from(GRID)) as u32);
    let place = |c: u32, r: u32, z: f64| {
        DVec3::new(f64::from(c) * terrain.spacing[0], f64::from(r) * terrain.spacing[1], z * exaggerate)
    };
    let mut points = Vec::new();
    for r in picks(terrain.height) {
        for c in picks(terrain.width) {
            let rim = (c == 0 || c + 1 == terrain.width) && (r == 0 || r + 1 == terrain.height);
            if rim {
                points.push(place(c, r, terrain.min));
            }
            if let Some(z) = terrain.sample(c, r) {
                points.push(place(c, r, z));
            }
        }
    }
    points
}

/// The nearest camera in the view's direction that sees all points.
fn frame(view: NamedView, fov: f64, orthographic: bool, points: &[DVec3], size: (u32, u32)) -> Camera {
    let (azimuth, dip) = view.direction();
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
        return Camera {
            eye: right * (east + west) / 2.0 + up * (top + bottom) / 2.0 + forward * back,
            forward,
            across: right * pixel,
            down: -up * pixel,
            middle: middle(size),
            orthographic,
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
        orthographic,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn project(camera: &Camera, p: DVec3) -> (f64, f64) {
        let q = p - camera.eye;
        let pixel2 = camera.across.length_squared();
        let depth = if camera.orthographic { 1.0 } else { q.dot(camera.forward) };
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
}
