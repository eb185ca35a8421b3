//! A camera that turns about a point, for people who look around.

use super::scene::Scene;
use super::view::{Projection, View};
use glam::DVec3;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orbit {
    /// What stays in the middle of the picture, in world metres.
    pub target: DVec3,
    /// From the camera to the target, in metres.
    pub distance: f64,
    /// Of the line of sight, in degrees: clockwise from north, and downwards.
    pub azimuth: f64,
    pub dip: f64,
    /// Vertical, in degrees.
    pub fov: f64,
    pub ortho: bool,
}

/// The camera stays on this side of the zenith, where left and right would change places.
const STEEPEST: f64 = 90.0;
/// Nearest and farthest, in parts of the field's size.
const RANGE: (f64, f64) = (1e-6, 100.0);

impl Orbit {
    /// The camera of a scene, turning about the point of its line of sight that is as far away as the middle of the field.
    /// None for a panorama, which looks everywhere.
    pub fn of(scene: &Scene) -> Option<Orbit> {
        let camera = scene.camera();
        let height = 2.0 * camera.middle[1];
        let [width, depth] = scene.terrain().extent();
        let [low, high] = scene.uniform().relief.map(f64::from);
        let middle = DVec3::new(width / 2.0, depth / 2.0, (low + high) / 2.0);
        let along = (middle - camera.eye).dot(camera.forward);
        // A field behind the camera is nothing to turn about.
        let distance = if along > 0.0 { along } else { 0.1 * width.hypot(depth) };
        let azimuth = match camera.forward.truncate().length() > 1e-9 {
            true => camera.forward.x.atan2(camera.forward.y),
            // Straight down, what is up in the picture tells.
            false => (-camera.down.x).atan2(-camera.down.y),
        };
        let half = camera.down.length() * height / 2.0;
        let (fov, ortho) = match camera.projection {
            Projection::Perspective => (2.0 * half.atan(), false),
            Projection::Orthographic => (2.0 * (half / distance).atan(), true),
            Projection::Panorama => return None,
        };
        Some(Orbit {
            target: camera.eye + camera.forward * distance,
            distance,
            azimuth: azimuth.to_degrees(),
            dip: (-camera.forward.z).clamp(-1.0, 1.0).asin().to_degrees(),
            fov: fov.to_degrees(),
            ortho,
        })
    }

    /// Unit vectors: forwards, to the right, up in the picture.
    fn axes(&self) -> [DVec3; 3] {
        let (sin_a, cos_a) = self.azimuth.to_radians().sin_cos();
        let (sin_d, cos_d) = self.dip.to_radians().sin_cos();
        let forward = DVec3::new(sin_a * cos_d, cos_a * cos_d, -sin_d);
        let right = DVec3::new(cos_a, -sin_a, 0.0);
        [forward, right, right.cross(forward)]
    }

    pub fn eye(&self) -> DVec3 {
        self.target - self.axes()[0] * self.distance
    }

    pub fn view(&self) -> View {
        let [_, _, up] = self.axes();
        View::LookAt {
            eye: self.eye().to_array(),
            target: self.target.to_array(),
            up: up.to_array(),
            fov: self.fov,
            ortho: self.ortho,
        }
    }

    /// Turns the line of sight by degrees, clockwise and downwards; the target stays.
    pub fn turn(&mut self, clockwise: f64, down: f64) {
        self.azimuth = (self.azimuth + clockwise).rem_euclid(360.0);
        self.dip = (self.dip + down).clamp(-STEEPEST, STEEPEST);
    }

    /// Multiplies the distance; `size` is that of the field, in metres.
    pub fn zoom(&mut self, factor: f64, size: f64) {
        let (nearest, farthest) = RANGE;
        self.distance = (self.distance * factor).clamp(nearest * size, farthest * size);
    }

    /// Moves camera and target in the picture's plane, by parts of its height.
    pub fn shift(&mut self, right: f64, up: f64) {
        let height = 2.0 * (self.fov.to_radians() / 2.0).tan() * self.distance;
        let [_, across, upwards] = self.axes();
        self.target += (across * right + upwards * up) * height;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terrain::{NamedView, SceneOptions, Terrain};
    use std::sync::Arc;

    fn scene(view: View) -> Scene {
        let heights = (0..30 * 20).map(|i| (i % 7) as f32 * 40.0).collect();
        let terrain = Terrain::from_heights(30, 20, [30.0, 20.0], heights).unwrap();
        Scene::new(Arc::new(terrain), &SceneOptions { view, size: (64, 48), ..SceneOptions::default() })
            .unwrap()
    }

    #[test]
    fn it_begins_as_the_camera_stands() {
        let named = NamedView::ALL
            .iter()
            .flat_map(|(_, view)| [false, true].map(|ortho| View::Named { view: *view, fov: 35.0, ortho }));
        let free = View::LookAt {
            eye: [10.0, -300.0, 900.0],
            target: [200.0, 100.0, 0.0],
            up: [0.0, 0.0, 1.0],
            fov: 50.0,
            ortho: false,
        };
        for view in named.chain([free]) {
            let scene = scene(view);
            let orbit = Orbit::of(&scene).unwrap();
            let again = scene.with_options(&SceneOptions { view: orbit.view(), ..*scene.options() }).unwrap();
            for (x, y) in [(0.0, 0.0), (32.0, 24.0), (64.0, 10.0)] {
                let (a, b) = (scene.camera().ray(x, y), again.camera().ray(x, y));
                assert!(a.1.distance(b.1) < 1e-9, "{view:?} at {x} {y}: {a:?} {b:?}");
                assert!(a.0.distance(b.0) < 1e-6, "{view:?} at {x} {y}: {a:?} {b:?}");
            }
        }
        assert!(Orbit::of(&self::scene(View::panorama())).is_none());
    }

    #[test]
    fn turning_keeps_the_target_and_zooming_the_direction() {
        let mut orbit = Orbit::of(&scene(View::overview())).unwrap();
        let begin = orbit;
        orbit.turn(90.0, 20.0);
        assert!((orbit.eye().distance(orbit.target) - begin.distance).abs() < 1e-9);
        // The camera of the overview stands in the south; a quarter clockwise it looks east.
        let sight = (orbit.target - orbit.eye()).normalize();
        assert!(
            sight.x > 0.5 && sight.y.abs() < 1e-9 && sight.z < (begin.target - begin.eye()).normalize().z,
            "{sight}"
        );
        orbit.zoom(0.5, 1000.0);
        assert!((orbit.distance - begin.distance / 2.0).abs() < 1e-9);
        assert!((orbit.target - orbit.eye()).normalize().distance(sight) < 1e-12);
        orbit.turn(360.0, 500.0);
        assert_eq!(orbit.dip, 90.0);
        // Straight down there is a picture too.
        assert!(scene(orbit.view()).camera().forward.is_finite());
        (0..100).for_each(|_| orbit.zoom(0.01, 1000.0));
        assert!(orbit.distance > 0.0);
    }

    #[test]
    fn shifting_moves_by_parts_of_the_picture() {
        let mut orbit = Orbit::of(&scene(View::topdown())).unwrap();
        let before = scene(orbit.view());
        orbit.shift(0.5, 0.25);
        let after = scene(orbit.view());
        // What was half a height to the right of the middle, and a quarter above it, is in the middle.
        let (from, _) = before.camera().ray(32.0 + 24.0, 24.0 - 12.0);
        let (to, _) = after.camera().ray(32.0, 24.0);
        assert!(from.truncate().distance(to.truncate()) < 1e-6, "{from} {to}");
    }
}
