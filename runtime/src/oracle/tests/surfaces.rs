//! Rays against surfaces whose intersections are known: planes, saddles and paraboloids that a field reproduces exactly, for every
//! kind of surface; thin things; and random expressions, whose ranges must hold all values.

use super::check;
use crate::oracle::{OracleOptions, components, evaluate};
use crate::terrain::{Scene, SceneOptions, Terrain};
use crate::value::Value;
use ghyll_compiler::core::Intrinsic;
use std::sync::Arc;

const SIDE: u32 = 33;
const SPACING: f64 = 10.0;

/// Numbers by a kept seed.
struct Random(u64);

impl Random {
    fn within(&mut self, lo: f64, hi: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        lo + (hi - lo) * ((self.0 >> 11) as f64 / (1u64 << 53) as f64)
    }
}

fn scene(z: impl Fn(f64, f64) -> f64) -> Scene {
    let at = |i: u32| f64::from(i) * SPACING;
    let heights = (0..SIDE * SIDE).map(|i| z(at(i % SIDE), at(i / SIDE)) as f32).collect();
    let terrain = Terrain::from_heights(SIDE, SIDE, [SPACING; 2], heights).unwrap();
    Scene::new(Arc::new(terrain), &SceneOptions::default()).unwrap()
}

type Ray = [f64; 6];

fn traced(scene: &Scene, surface: &str, rays: &[Ray]) -> Vec<Option<f64>> {
    let text = format!(
        "use terrain; fn shape(p: vec2) -> f32 = {surface};
        fn main(o: vec3, d: vec3) -> f32 = match trace(shape, Ray(o, d, 0.0, FAR)) {{ Some(t) => t, None => -1.0 }};"
    );
    let checked = check(&text);
    let entry = checked.module.function("main").expect("main is there");
    let one = |ray: &Ray| {
        let args = [Value::Vec(ray[..3].to_vec()), Value::Vec(ray[3..].to_vec())];
        let found = evaluate(&checked.module, entry, &args, &OracleOptions::default(), Some(scene));
        match found.unwrap_or_else(|e| panic!("{surface}: {e}")) {
            Value::F32(t) => (t >= 0.0).then_some(t),
            other => panic!("{other}"),
        }
    };
    rays.iter().map(one).collect()
}

/// Rays over the middle of the field from one height down to another.
fn rays(count: usize, top: f64, bottom: f64) -> Vec<Ray> {
    let mut random = Random(11);
    let mut ray = || {
        let mut point = |z: f64| [random.within(130.0, 190.0), random.within(130.0, 190.0), z];
        let (from, to) = (point(top), point(bottom));
        let way = [0, 1, 2].map(|k| to[k] - from[k]);
        let length = way.iter().map(|w| w * w).sum::<f64>().sqrt();
        [from[0], from[1], from[2], way[0] / length, way[1] / length, way[2] / length]
    };
    (0..count).map(|_| ray()).collect()
}

/// z = c + a x + b y + k x y + q (x^2 + y^2), about the middle.
#[derive(Clone, Copy)]
struct Quadric {
    c: f64,
    a: f64,
    b: f64,
    k: f64,
    q: f64,
}

const MIDDLE: f64 = 160.0;

impl Quadric {
    fn height(&self, x: f64, y: f64) -> f64 {
        let (x, y) = (x - MIDDLE, y - MIDDLE);
        self.c + self.a * x + self.b * y + self.k * x * y + self.q * (x * x + y * y)
    }

    /// The first positive root of the ray's height over it.
    fn meets(&self, [ox, oy, oz, dx, dy, dz]: Ray) -> f64 {
        let (x, y) = (ox - MIDDLE, oy - MIDDLE);
        let f = oz - self.height(ox, oy);
        let slope =
            dz - (self.a * dx + self.b * dy + self.k * (x * dy + y * dx) + 2.0 * self.q * (x * dx + y * dy));
        let bend = -(self.k * dx * dy + self.q * (dx * dx + dy * dy));
        let root = (slope * slope - 4.0 * bend * f).sqrt();
        // The two roots without cancellation.
        let far = -0.5 * (slope + slope.signum() * root);
        let roots = [f / far, far / bend];
        roots.into_iter().filter(|t| *t > 0.0).fold(f64::INFINITY, f64::min)
    }
}

/// Heights are powers of two and small whole numbers, so single precision samples hold them.
const PLANE: Quadric = Quadric { c: -100.0, a: 0.25, b: -0.125, k: 0.0, q: 0.0 };
const SADDLE: Quadric = Quadric { k: 1.0 / 256.0, ..PLANE };
const BOWL: Quadric = Quadric { q: 1.0 / 512.0, ..PLANE };

/// Surfaces with what they reproduce.
const EXACT: &[(&str, &[Quadric])] = &[
    ("bilinear(p)", &[PLANE, SADDLE]),
    ("bilinear(p) + 0.0", &[PLANE, SADDLE]),
    ("triangulated(p)", &[PLANE]),
    ("triangulated(p) + 0.0", &[PLANE]),
    ("bicubic(p)", &[PLANE, SADDLE, BOWL]),
    ("subdivided(p)", &[PLANE, SADDLE]),
    ("subdivided_by(p, 3)", &[PLANE, SADDLE]),
    ("0.5 * bicubic(p) + 0.5 * bilinear(p)", &[PLANE, SADDLE]),
    ("bicubic(p) + 0.001 * clamp(micro(p), 0.0, 0.0)", &[BOWL]),
];

fn worst(surface: &str, sampled: Quadric, real: Quadric) -> f64 {
    let scene = scene(|x, y| sampled.height(x, y));
    let rays = rays(40, 150.0, 0.0);
    let error = |(ray, found): (&Ray, Option<f64>)| match found {
        Some(t) => (t - real.meets(*ray)).abs(),
        None => f64::INFINITY,
    };
    rays.iter().zip(traced(&scene, surface, &rays)).map(error).fold(0.0, f64::max)
}

#[test]
fn closed_forms_are_met_by_every_surface() {
    for (surface, quadrics) in EXACT {
        for quadric in *quadrics {
            let error = worst(surface, *quadric, *quadric);
            assert!(error < 1e-8, "{surface}: {error}");
        }
    }
}

#[test]
fn closed_forms_are_met_by_expressions() {
    let text = "0.001 * dot(p - vec2(160.0, 160.0), p - vec2(160.0, 160.0)) - 100.0";
    let real = Quadric { c: -100.0, a: 0.0, b: 0.0, k: 0.0, q: 0.001 };
    assert!(worst(text, PLANE, real) < 1e-8);
}

#[test]
fn a_planted_difference_is_seen() {
    let planted = Quadric { q: BOWL.q * 1.0001, ..BOWL };
    assert!(worst("bicubic(p)", BOWL, planted) > 1e-4);
    assert!(worst("bicubic(p) + 1e-4", BOWL, BOWL) > 5e-5);
    // A bowl is not what bilinear makes of it.
    assert!(worst("bilinear(p)", BOWL, BOWL) > 1e-3);
}

/// A cell's far sides are its neighbour's near ones, which is a hole here.
#[test]
fn cells_beside_a_hole_are_met_where_they_are() {
    let scene = scene(|x, y| if (x, y) == (200.0, 160.0) { f64::NAN } else { PLANE.height(x, y) });
    let rays: Vec<Ray> = (0..20)
        .map(|i| {
            let (x, y) = (180.3 + 0.48 * f64::from(i), 150.2 + 0.49 * f64::from(i));
            let z = PLANE.height(x, y);
            [x - 6.0, y - 3.0, z + 8.0, 0.6, 0.3, -0.8]
        })
        .collect();
    for surface in ["bilinear(p) + 0.0", "triangulated(p) + 0.0"] {
        for (ray, found) in rays.iter().zip(traced(&scene, surface, &rays)) {
            assert!((found.unwrap() - PLANE.meets(*ray)).abs() < 1e-8, "{surface}: {ray:?} {found:?}");
        }
    }
    for (ray, found) in rays.iter().zip(traced(&scene, "bicubic(p)", &rays)) {
        let t = found.unwrap();
        let mut z = [0.0];
        scene.eval_f64(Intrinsic::Bicubic, &[ray[0] + t * ray[3], ray[1] + t * ray[4]], &mut z);
        assert!((ray[2] + t * ray[5] - z[0]).abs() < 1e-8, "{ray:?} {found:?} {z:?}");
    }
}

#[test]
fn what_is_thin_is_not_missed() {
    let scene = scene(|_, _| -100.0);
    // A wall a thousandth of a cell thick, met at a right angle; steps of a 64th of a cell pass it.
    let wall = "bilinear(p) + 300.0 * max(0.0, 1.0 - abs(p.x - 163.7031) * 200.0)";
    let level = [20.0, 150.0, 50.0, 1.0, 0.0, 0.0];
    let found = traced(&scene, wall, &[level])[0].expect("the wall");
    assert!((found - 143.7).abs() < 0.01, "{found}");
    // Just over its top is nothing.
    assert_eq!(traced(&scene, wall, &[[20.0, 150.0, 200.001, 1.0, 0.0, 0.0]]), [None]);
    // A jump is a wall too.
    let jump = "if p.x > 163.7 && p.x < 163.70001 { 100.0 } else { bilinear(p) }";
    assert!((traced(&scene, jump, &[level])[0].expect("the jump") - 143.7).abs() < 1e-4);
    // A ray that touches a ridge within a hair.
    let ridge = "bilinear(p) - 0.01 * (p.x - 160.0) * (p.x - 160.0)";
    let over = |z: f64| [20.0, 150.0, z, 1.0, 0.0, 0.0];
    let found = traced(&scene, ridge, &[over(-100.0 - 1e-9), over(-100.0 + 1e-9)]);
    assert!(found[0].is_some() && found[1].is_none(), "{found:?}");
}

/// Every answer of the range search is that of a walk in tiny steps, or before it.
#[test]
fn rough_surfaces_agree_with_tiny_steps() {
    let mut random = Random(5);
    let z: Vec<f64> = (0..SIDE * SIDE).map(|_| random.within(-120.0, -60.0)).collect();
    let scene = scene(|x, y| z[(y / SPACING) as usize * SIDE as usize + (x / SPACING) as usize]);
    for surface in [
        "bicubic(p)",
        "subdivided(p)",
        "bicubic(p) + 4.0 * fbm(p / 17.0, 3)",
        "averaged(p, 25.0)",
        "bilinear(p) + 3.0 * micro(p / 5.0)",
        "max(bilinear(p), -95.0 + 2.0 * sin(0.3 * p.x) * cos(0.2 * p.y))",
        "nearest(p)",
    ] {
        let rays = rays(12, 0.0, -90.0);
        for (ray, found) in rays.iter().zip(traced(&scene, surface, &rays)) {
            let found = found.unwrap_or_else(|| panic!("{surface}: {ray:?} hits nothing"));
            let step = 0.02;
            let height = format!(
                "use terrain; fn shape(p: vec2) -> f32 = {surface}; fn pixel(p: vec2) -> f32 = shape(p);"
            );
            let checked = check(&height);
            let entry = checked.module.function("pixel").expect("it is there");
            let count = (found / step) as u32 + 1;
            let place = |i: u32, _: u32| {
                let t = (f64::from(i) * step).min(found * (1.0 - 1e-9));
                [ray[0] + t * ray[3], ray[1] + t * ray[4]]
            };
            let all = components(
                &checked.module,
                entry,
                (count, 1),
                &place,
                &OracleOptions::default(),
                Some(&scene),
            );
            for (i, z) in all.unwrap().into_iter().enumerate() {
                let t = (i as f64 * step).min(found * (1.0 - 1e-9));
                assert!(
                    ray[2] + t * ray[5] >= z - 1e-6,
                    "{surface}: {ray:?} is under at {t}, hit at {found}"
                );
            }
        }
    }
}
