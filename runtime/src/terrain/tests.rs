//! The walk against the oracle's brute intersection, over fields and rays made to break it.
//!
//! A hit is right if the true first hit lies between those of the ray lifted and lowered by a tolerance: of two answers
//! that differ, that tells a rounding at a silhouette from a fault.

use super::field::Terrain;
use super::scene::{Scene, SceneOptions};
use super::view::View;
use ghyll_compiler::intrinsics::Intrinsic;
use std::sync::Arc;

const SURFACES: [Intrinsic; 4] = [
    Intrinsic::TraceBilinear,
    Intrinsic::TraceTriangulated,
    Intrinsic::TraceBicubic,
    Intrinsic::TraceSubdivided,
];
/// Parts along a cell's side, of the last of them.
const PARTS: f32 = 4.0;

struct Random(u64);

impl Random {
    fn next(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 33) as u32 ^ (self.0 >> 20) as u32
    }

    /// In [0, 1).
    fn unit(&mut self) -> f64 {
        f64::from(self.next() >> 8) / f64::from(1u32 << 24)
    }

    fn within(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * self.unit()
    }

    fn one_in(&mut self, n: u32) -> bool {
        self.next().is_multiple_of(n)
    }

    fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.next() as usize % from.len()]
    }
}

fn field(width: u32, height: u32, spacing: [f64; 2], z: impl FnMut(u32, u32) -> f32) -> Terrain {
    let mut z = z;
    let heights = (0..height).flat_map(|r| (0..width).map(move |c| (c, r))).map(|(c, r)| z(c, r)).collect();
    Terrain::from_heights(width, height, spacing, heights).unwrap()
}

fn scene(terrain: Terrain) -> Scene {
    let options = SceneOptions { view: View::overview(), size: (64, 64), ..SceneOptions::default() };
    Scene::new(Arc::new(terrain), &options).unwrap()
}

pub(super) fn fields() -> Vec<(&'static str, Scene)> {
    let mut random = Random(1);
    let mut list = vec![
        ("noise", field(33, 29, [30.0, 20.0], |_, _| random.within(0.0, 90.0) as f32)),
        ("flat", field(20, 37, [1.0, 1.0], |_, _| 5.0)),
        (
            "smooth",
            field(65, 65, [25.0, 25.0], |c, r| 300.0 * ((c as f32 * 0.1).sin() + (r as f32 * 0.13).cos())),
        ),
        ("spikes", field(40, 40, [1.0, 1.0], |c, r| if c % 7 == 3 && r % 5 == 2 { 1e3 } else { 0.0 })),
        ("smallest", field(2, 2, [10.0, 10.0], |c, r| (c * 7 + r * 3) as f32)),
        ("strip", field(2, 40, [10.0, 1.0], |c, r| ((c + r) % 3) as f32)),
        ("row", field(40, 2, [1.0, 100.0], |c, r| ((c * r) % 5) as f32)),
        ("stairs", field(17, 17, [2.0, 2.0], |c, _| (c / 4) as f32 * 3.0)),
        ("high", field(33, 33, [30.0, 30.0], |c, r| 8848.0 + 0.001 * ((c * 31 + r * 17) % 11) as f32)),
    ];
    let waves = |c, r| 40.0 * (c as f32 * 0.7).sin() + r as f32;
    list.push(("wide", field(16_384, 3, [30.0, 30.0], waves)));
    list.push(("fine", field(50, 50, [1e-3, 2e-3], |c, r| ((c * r) % 7) as f32 * 1e-3)));
    list.push(("towers", field(30, 30, [1.0, 1.0], |c, r| if (c + 2 * r) % 11 == 0 { 1e5 } else { 0.0 })));
    let mut random = Random(2);
    let holes = |_, _| if random.one_in(9) { f32::NAN } else { random.within(0.0, 50.0) as f32 };
    list.push(("voids", field(31, 31, [10.0, 10.0], holes)));
    let mut list: Vec<_> = list.into_iter().map(|(name, t)| (name, scene(t))).collect();
    list.push(("fuji", scene(Terrain::builtin())));
    list
}

type Ray = [f32; 8];

/// Random rays, and rays along and through everything that is exact in the grid.
fn ray(scene: &Scene, random: &mut Random) -> Ray {
    let terrain = scene.terrain();
    let [width, height] = terrain.extent();
    let (lo, hi) = (terrain.min, terrain.max.max(terrain.min + 1.0));
    let tall = hi - lo;
    let snap = |random: &mut Random, axis: usize| {
        let n = [terrain.width, terrain.height][axis];
        let at = f64::from(random.next() % n) * terrain.spacing[axis];
        at + random.pick(&[0.0, 0.0, 0.5]) * terrain.spacing[axis]
    };
    let outside = |random: &mut Random, size: f64| random.within(-0.5 * size, 1.5 * size);
    let exact = random.one_in(2);
    let point = |random: &mut Random, z: f64| {
        if exact {
            [snap(random, 0), snap(random, 1), z]
        } else {
            [outside(random, width), outside(random, height), z]
        }
    };
    let z_from = match random.next() % 5 {
        0 => random.pick(&[lo, hi, lo - tall, hi + tall]),
        1 => lo + (random.next() % 8) as f64,
        _ => random.within(lo - 0.3 * tall, hi + 1.5 * tall),
    };
    let z_to = if random.one_in(4) { z_from } else { random.within(lo - 0.2 * tall, hi) };
    let from = point(random, z_from);
    let to = point(random, z_to);
    let mut dir = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
    match random.next() % 10 {
        0 => dir[0] = 0.0,
        1 => dir[1] = -0.0,
        2 => dir = [0.0, 0.0, random.pick(&[-1.0, 1.0])],
        3 => dir[0] = 1e-40,
        4 => dir[1] = dir[0] * terrain.spacing[1] / terrain.spacing[0],
        5 => dir[2] = 0.0,
        _ => {}
    }
    let length = (dir[0] * dir[0] + dir[1] * dir[1] + dir[2] * dir[2]).sqrt().max(1e-9);
    let unit = dir.map(|d| (d / length) as f32);
    let near = if random.one_in(4) { random.within(0.0, 0.5 * length) } else { 0.0 };
    let far = if random.one_in(4) { random.within(0.0, 2.0 * length) } else { 1e9 };
    [from[0] as f32, from[1] as f32, from[2] as f32, unit[0], unit[1], unit[2], near as f32, far as f32]
}

/// The ray, and what else the intrinsic takes.
fn args(surface: Intrinsic, ray: &Ray) -> impl Iterator<Item = f32> {
    ray.iter().copied().chain((surface.params().len() > 8).then_some(PARTS))
}

fn single(scene: &Scene, surface: Intrinsic, ray: &Ray) -> Option<f64> {
    let mut out = [0; 2];
    scene.eval_f32(surface, &args(surface, ray).map(f32::to_bits).collect::<Vec<_>>(), &mut out);
    (out[0] != 0).then(|| f64::from(f32::from_bits(out[1])))
}

fn double(scene: &Scene, surface: Intrinsic, ray: &Ray, lift: f64) -> Option<f64> {
    let mut args: Vec<f64> = args(surface, ray).map(f64::from).collect();
    args[2] += lift;
    let mut out = [0.0; 2];
    scene.eval_f64(surface, &args, &mut out);
    (out[0] != 0.0).then_some(out[1])
}

/// Metres by which heights may be off: rounding of the coordinates times the steepest slope, and of z.
fn tolerance(scene: &Scene) -> f64 {
    let terrain = scene.terrain();
    let size = terrain.extent().into_iter().fold(0.0, f64::max);
    let tall = terrain.max - terrain.min;
    let steep = 2.0 * tall / terrain.spacing[0].min(terrain.spacing[1]);
    let high = terrain.max.abs().max(terrain.min.abs()) + tall;
    4e-7 * (size * (1.0 + steep) + 4.0 * high) + 1e-6
}

/// What is wrong with an answer, if anything.
fn fault(scene: &Scene, surface: Intrinsic, ray: &Ray, answer: Option<f64>) -> Option<String> {
    let truth = double(scene, surface, ray, 0.0);
    let slack = |t: f64| 1e-3 * scene.terrain().spacing[0].min(scene.terrain().spacing[1]) + 1e-6 * t.abs();
    if let (Some(t), Some(u)) = (answer, truth)
        && (t - u).abs() <= 0.01 * slack(u)
    {
        return None;
    }
    let tolerance = tolerance(scene);
    let lowered = double(scene, surface, ray, -tolerance);
    let raised = double(scene, surface, ray, tolerance);
    let early = |t: f64| lowered.is_none_or(|l| t < l - slack(l));
    let late = |t: f64| raised.is_some_and(|r| t > r + slack(r));
    match answer {
        None => raised.map(|r| format!("missed a hit at {truth:?}, {r} when raised")),
        Some(t) if early(t) => Some(format!("hit at {t}, truth {truth:?}, lowered {lowered:?}")),
        Some(t) if late(t) => Some(format!("hit at {t}, truth {truth:?}, raised {raised:?}")),
        Some(_) => None,
    }
}

/// At the field's rim a ray may or may not enter, by rounding: shifting it decides.
fn at_the_rim(scene: &Scene, surface: Intrinsic, ray: &Ray, answer: Option<f64>) -> bool {
    let [w, h] = scene.terrain().extent();
    let step = 4e-7 * w.max(h) + 1e-6;
    [[step, 0.0], [-step, 0.0], [0.0, step], [0.0, -step]].into_iter().any(|[dx, dy]| {
        let mut moved: Vec<f64> = args(surface, ray).map(f64::from).collect();
        moved[0] += dx;
        moved[1] += dy;
        let mut out = [0.0; 2];
        scene.eval_f64(surface, &moved, &mut out);
        match answer {
            None => out[0] == 0.0,
            Some(t) => out[0] != 0.0 && (t - out[1]).abs() < 1e-2 * (1.0 + t.abs()),
        }
    })
}

#[test]
fn the_walk_agrees_with_brute_intersection() {
    let mut faults = Vec::new();
    let mut hits = 0;
    let mut errors = Vec::new();
    let mut rays = 0;
    for (name, scene) in fields() {
        let mut random = Random(42);
        // The oracle visits every cell of the way.
        let count = match name {
            "wide" => 300,
            "fuji" => 3_000,
            _ => 6_000,
        };
        for i in 0..count {
            let ray = ray(&scene, &mut random);
            for surface in SURFACES {
                let answer = single(&scene, surface, &ray);
                if let (Some(t), Some(u)) = (answer, double(&scene, surface, &ray, 0.0)) {
                    let [w, h] = scene.terrain().extent();
                    errors.push((t - u).abs() / (1e-7 * (w + h + scene.terrain().max.abs() + u.abs())));
                }
                hits += u32::from(answer.is_some());
                rays += 1;
                if let Some(what) = fault(&scene, surface, &ray, answer)
                    && !at_the_rim(&scene, surface, &ray, answer)
                {
                    faults.push(format!("{name} ray {i} {} {ray:?}: {what}", surface.name()));
                }
            }
        }
    }
    errors.sort_by(f64::total_cmp);
    // In units of 1e-7 of the coordinates; the tail are rays that graze.
    let within = |share: f64| errors[(errors.len() as f64 * share) as usize];
    assert!(within(0.9) < 1.0 && within(0.98) < 100.0, "{} {}", within(0.9), within(0.98));
    assert!(hits > rays / 5 && hits < rays * 4 / 5, "{hits} of {rays} rays hit");
    assert!(faults.is_empty(), "{} of {rays}:\n{}", faults.len(), faults[..faults.len().min(12)].join("\n"));
}

#[test]
fn a_planted_difference_is_found() {
    let scene = scene(field(9, 9, [10.0, 10.0], |c, r| (c + r) as f32));
    let ray = [40.0, 40.0, 100.0, 0.0, 0.0, -1.0, 0.0, 1e9];
    let truth = double(&scene, Intrinsic::TraceBilinear, &ray, 0.0).unwrap();
    let wrong = |answer| fault(&scene, Intrinsic::TraceBilinear, &ray, answer).is_some();
    assert!(!wrong(Some(truth)) && wrong(Some(truth + 0.1)) && wrong(Some(truth - 0.1)) && wrong(None));
    let up = [40.0, 40.0, 100.0, 0.0, 0.0, 1.0, 0.0, 1e9];
    assert!(fault(&scene, Intrinsic::TraceBilinear, &up, Some(1.0)).is_some());
}

#[test]
fn no_ray_straight_down_slips_through() {
    for (name, scene) in fields().into_iter().filter(|(name, _)| *name != "voids") {
        let [w, h] = scene.terrain().extent();
        for i in 0..=64 {
            for j in 0..=64 {
                let (x, y) = ((w * f64::from(i) / 64.0) as f32, (h * f64::from(j) / 64.0) as f32);
                let (x, y) = (x.min(w as f32), y.min(h as f32));
                let top = scene.terrain().max as f32 + 100.0;
                let ray = [x, y, top, 0.0, 0.0, -1.0, 0.0, 1e9];
                for surface in SURFACES {
                    let Some(t) = single(&scene, surface, &ray) else {
                        // One rounding can put the far rim outside.
                        assert!(i == 64 || j == 64, "{name} {x} {y}");
                        continue;
                    };
                    let eval = match surface {
                        Intrinsic::TraceBilinear => Intrinsic::Bilinear,
                        Intrinsic::TraceTriangulated => Intrinsic::Triangulated,
                        Intrinsic::TraceBicubic => Intrinsic::Bicubic,
                        _ => Intrinsic::Subdivided,
                    };
                    let mut out = [0.0];
                    scene.eval_f64(eval, &[x, y, PARTS].map(f64::from), &mut out);
                    let z = f64::from(top) - t;
                    assert!((z - out[0]).abs() <= tolerance(&scene) + 2e-3, "{name} {x} {y}: {z} {}", out[0]);
                }
            }
        }
    }
}

#[test]
fn a_plane_under_a_grazing_sun_does_not_shade_itself() {
    let slope = |c: u32, r: u32| 1000.0 + 0.37 * c as f32 * 30.0 - 0.21 * r as f32 * 30.0;
    for (name, scene) in [
        ("level", scene(field(512, 512, [30.0, 30.0], |_, _| 1234.5))),
        ("tilted", scene(field(512, 512, [30.0, 30.0], slope))),
    ] {
        let mut random = Random(5);
        let mut gradient = [0; 2];
        scene.eval_f32(Intrinsic::GradientBilinear, &[0f32.to_bits(); 2], &mut gradient);
        let [gx, gy] = gradient.map(|g| f64::from(f32::from_bits(g)));
        let size = (gx * gx + gy * gy + 1.0).sqrt();
        let normal = [-gx / size, -gy / size, 1.0 / size];
        for _ in 0..20_000 {
            // A direction 0.1 degrees above the plane.
            let azimuth = random.within(0.0, std::f64::consts::TAU);
            let (a, b) = (azimuth.cos(), azimuth.sin());
            let along = [a, b, gx * a + gy * b];
            let length = (a * a + b * b + along[2] * along[2]).sqrt();
            let up = 0.1f64.to_radians().sin();
            let dir = [0, 1, 2].map(|k| (along[k] / length + up * normal[k]) as f32);
            // The library's `lift`.
            let [x, y] = [random.within(0.0, 15_330.0) as f32, random.within(0.0, 15_330.0) as f32];
            let mut z = [0];
            scene.eval_f32(Intrinsic::Bilinear, &[x.to_bits(), y.to_bits()], &mut z);
            let z = f32::from_bits(z[0]);
            let gap = 4e-7 * (x.abs() + y.abs() + z.abs()) + 1e-5 * 60.0;
            let at = [x, y, z];
            let from = [0, 1, 2].map(|k| at[k] + gap * normal[k] as f32);
            let ray = [from[0], from[1], from[2], dir[0], dir[1], dir[2], 0.0, 1e9];
            // A spline is no plane at the rim, where it repeats a sample: a height of up to 2/27 of a cell's rise.
            let inside = [x, y].iter().all(|at| (1000.0..14_330.0).contains(at));
            for surface in &SURFACES[..if inside { 4 } else { 2 }] {
                assert_eq!(single(&scene, *surface, &ray), None, "{name} {surface:?} {ray:?}");
            }
        }
        // A ray that does start in the ground is found.
        let under = [7000.0, 7000.0, -9e3, 0.0, 0.0, 1.0, 0.0, 1e9];
        assert_eq!(single(&scene, SURFACES[0], &under), Some(0.0), "{name}");
    }
}

#[test]
fn what_is_no_ray_hits_nothing_and_ends() {
    let scene = scene(field(9, 9, [1.0, 1.0], |c, _| c as f32));
    let down = [4.0, 4.0, 50.0, 0.0, 0.0, -1.0, 0.0, 1e9];
    assert!(single(&scene, SURFACES[0], &down).is_some());
    for at in 0..8 {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let endless = (at == 6 && bad == f32::NEG_INFINITY) || (at == 7 && bad == f32::INFINITY);
            let mut ray = down;
            ray[at] = bad;
            for surface in SURFACES {
                assert_eq!(single(&scene, surface, &ray).is_some(), endless, "{ray:?}");
            }
        }
    }
    let backwards = [4.0, 4.0, 50.0, 0.0, 0.0, -1.0, 60.0, 10.0];
    let still = [4.0, 4.0, 50.0, 0.0, 0.0, 0.0, 0.0, 1e9];
    for ray in [backwards, still] {
        assert_eq!(single(&scene, SURFACES[1], &ray), None);
    }
}

#[test]
fn a_far_camera_hits_as_exactly_as_a_near_one() {
    let scene = scene(Terrain::builtin());
    let [w, h] = scene.terrain().extent();
    let mut random = Random(9);
    for distance in [1e5, 1e6, 1e7] {
        for _ in 0..500 {
            let (x, y) = (random.within(0.1 * w, 0.9 * w), random.within(0.1 * h, 0.9 * h));
            let dir = [0.3f64, 0.5, -(1.0f64 - 0.34).sqrt()].map(|d| d as f32);
            let from = [x, y, 2000.0].into_iter().zip(dir).map(|(p, d)| (p - distance * f64::from(d)) as f32);
            let o: Vec<f32> = from.collect();
            let ray = [o[0], o[1], o[2], dir[0], dir[1], dir[2], 0.0, 1e9];
            let t = single(&scene, SURFACES[0], &ray).unwrap();
            let truth = double(&scene, SURFACES[0], &ray, 0.0).unwrap();
            let next = f32::from_bits((t as f32).to_bits() + 1);
            let rounding = 0.5 * (f64::from(next) - t);
            assert!((t - truth).abs() <= rounding + 1e-5 * 61.0, "{distance}: {t} {truth}");
        }
    }
}

/// The base's height is rounded by a quarter of a metre there: the walk must know of that too, or it begins below the surface.
#[test]
fn a_ray_from_10000_km_does_not_begin_below_the_surface() {
    let scene = scene(Terrain::builtin());
    let ray = [724859.8, -8315319.0, 5474773.0, -0.071396045, 0.8340069, -0.5471152, 0.0, 1e9];
    for surface in SURFACES {
        let (t, truth) =
            (single(&scene, surface, &ray).unwrap(), double(&scene, surface, &ray, 0.0).unwrap());
        assert!((t - truth).abs() <= 0.5, "{surface:?}: {t} {truth}");
    }
}

/// Cells from the oracle's distance, beyond what rounding it costs.
fn off(scene: &Scene, surface: Intrinsic, ray: &Ray) -> f64 {
    let (t, truth) = (single(scene, surface, ray).unwrap(), double(scene, surface, ray, 0.0).unwrap());
    let rounding = 0.5 * (f64::from(f32::from_bits((t as f32).to_bits() + 1)) - t);
    let [dx, dy] = scene.terrain().spacing;
    ((t - truth).abs() - rounding).max(0.0) / dx.min(dy)
}

/// Cells as long as a hundred of their widths, where a root is only as exact as the way through a cell is long; walls along the
/// rim, which were as exact as their distance from the base; and a place beside a peak, whose height was that of the peak.
#[test]
fn the_last_step_makes_distances_exact() {
    let row = scene(field(40, 2, [1.0, 100.0], |c, r| ((c * r) % 5) as f32));
    let wall = [-16.063786, 103.48774, 9.882727, 0.9507578, -0.11638567, -0.28725237, 0.0, 1e9];
    let slope = [-6.25, 31.0, 2.5, 0.8, 0.59999, -0.0125, 0.0, 1e9];
    for surface in SURFACES {
        for ray in [wall, slope] {
            assert!(off(&row, surface, &ray) < 1e-6, "{surface:?} {ray:?}: {}", off(&row, surface, &ray));
        }
    }
    let spikes = scene(field(101, 90, [1.0, 1.0], |c, r| if c % 7 == 3 && r % 5 == 2 { 1e5 } else { 0.0 }));
    let beside = [88.03069, 106.98782, 122566.57, -5.736225e-5, -0.00068524235, -0.99999976, 0.0, 1e9];
    assert!(off(&spikes, SURFACES[0], &beside) < 1e-6, "{}", off(&spikes, SURFACES[0], &beside));
}

/// Over a sample 17 km down the way, where the planes between cells are known to 2 mm: the ray is in the next cell before it is there.
#[test]
fn a_cell_that_is_entered_below_its_surface_by_a_rounding_is_left_backwards() {
    let fuji = scene(Terrain::builtin());
    let over = [
        [-10650.8955, 18052.158, 6296.972, 0.83872753, 0.5038274, -0.20662557, 0.0, 1e9],
        [10981.205, 31527.848, 6753.122, 0.5101243, -0.8290983, -0.22884317, 0.0, 1e9],
    ];
    for ray in over {
        assert!(off(&fuji, SURFACES[3], &ray) < 1e-5, "{ray:?}: {}", off(&fuji, SURFACES[3], &ray));
    }
}

/// Where the ray hardly sinks a step is as far as its height's rounding is high over that.
#[test]
fn the_last_step_is_short() {
    let fuji = scene(Terrain::builtin());
    let level = [151.47545, -859.91077, 516.0, 0.0, 1.0, 0.0, 0.0, 1e9];
    assert!(off(&fuji, SURFACES[0], &level) < 1e-4, "{}", off(&fuji, SURFACES[0], &level));
}

/// Dips of the patch below a grazing ray, some of many in a row.
#[test]
fn grazing_rays_over_curved_patches_miss_no_dip() {
    let mut random = Random(17);
    let scene = scene(field(64, 64, [30.0, 30.0], |_, _| random.within(0.0, 90.0) as f32));
    let mut met = 0;
    let mut faults = Vec::new();
    for k in 0..20_000 {
        let angle = random.within(0.0, std::f64::consts::TAU);
        let [x, y] = [random.within(200.0, 1700.0), random.within(200.0, 1700.0)];
        let sinks = random.pick(&[0.0, -1e-6, -1e-3, 2e-3]);
        let back = 900.0;
        let ray = [
            (x - back * angle.cos()) as f32,
            (y - back * angle.sin()) as f32,
            random.within(50.0, 100.0) as f32,
            angle.cos() as f32,
            angle.sin() as f32,
            sinks as f32,
            0.0,
            1e9,
        ];
        for surface in [Intrinsic::TraceBicubic, Intrinsic::TraceSubdivided] {
            let answer = single(&scene, surface, &ray);
            met += u32::from(answer.is_some());
            faults.extend(fault(&scene, surface, &ray, answer).map(|what| format!("{k} {ray:?}: {what}")));
        }
    }
    assert!(met > 10_000, "{met}");
    assert!(faults.is_empty(), "{}:\n{}", faults.len(), faults[..faults.len().min(9)].join("\n"));
}

/// A step that is right at a slope would be none at a wall: it would lead out of the field.
#[test]
fn a_wall_is_where_it_stands() {
    let scene = scene(field(9, 9, [10.0, 10.0], |c, _| 5.0 + c as f32));
    for surface in SURFACES {
        for depth in [1e-5, 1e-3, 1.0, 4.0] {
            let ray = [-20.0, 33.0, 5.0 - depth, 1.0, 0.0, 0.0, 0.0, 1e9];
            assert_eq!(single(&scene, surface, &ray), Some(20.0), "{surface:?} {depth}");
        }
    }
}

/// Through the corner of two cells with holes the ray meets the edge of the two solid ones beside it.
#[test]
fn a_ray_through_a_corner_meets_the_cells_beside_it() {
    let holes = [(1, 3), (3, 1)];
    let terrain = field(4, 4, [10.0, 10.0], |c, r| if holes.contains(&(c, r)) { f32::NAN } else { 50.0 });
    let scene = scene(terrain);
    let d = 0.5f32.sqrt();
    for surface in SURFACES {
        let ray = [15.0, 25.0, 40.0, d, -d, 0.0, 0.0, 1e9];
        let found = single(&scene, surface, &ray);
        assert!(found.is_some_and(|t| (t - 7.0710678).abs() < 1e-5), "{}: {found:?}", surface.name());
        // Over the edge nothing is in its way.
        let ray = [15.0, 25.0, 60.0, d, -d, 0.0, 0.0, 1e9];
        assert_eq!(single(&scene, surface, &ray), None, "{}", surface.name());
    }
}

/// A box that spans places of every size, some of them beyond the rim or along grid lines.
fn ends(scene: &Scene, random: &mut Random) -> [f32; 4] {
    let terrain = scene.terrain();
    let mut along = |axis: usize| {
        let size = terrain.extent()[axis];
        let at = match random.next() % 3 {
            0 => f64::from(random.next() % terrain.width.max(terrain.height)) * terrain.spacing[axis],
            _ => random.within(-0.1 * size, 1.1 * size),
        };
        let wide = random.pick(&[0.0, 0.5, 1.0, 3.0, 0.3 * size / terrain.spacing[axis]]);
        [at as f32, (at + random.unit() * wide * terrain.spacing[axis]) as f32]
    };
    let ([x0, x1], [y0, y1]) = (along(0), along(1));
    [x0, y0, x1, y1]
}

/// Bounds of the bicubic surface over boxes hold, and are not wider than what samples allow.
#[test]
fn boxes_of_curved_patches_are_bounded() {
    let ask = |scene: &Scene, intrinsic: Intrinsic, args: &[f32]| {
        let mut out = vec![0; intrinsic.results().len()];
        scene.eval_f32(intrinsic, &args.iter().map(|x| x.to_bits()).collect::<Vec<_>>(), &mut out);
        out.into_iter().map(|word| f64::from(f32::from_bits(word))).collect::<Vec<_>>()
    };
    for (name, scene) in fields() {
        let mut random = Random(4);
        let slack = tolerance(&scene);
        let relief = scene.terrain().max - scene.terrain().min;
        for i in 0..if name == "fuji" { 500 } else { 3_000 } {
            let ends = ends(&scene, &mut random);
            let crest = ask(&scene, Intrinsic::Crest, &ends)[0];
            let inclines = ask(&scene, Intrinsic::InclinesBicubic, &ends);
            assert!(crest <= scene.terrain().max + 0.3 * relief + slack, "{name} box {i}");
            for _ in 0..4 {
                let at = [0, 1].map(|a| ends[a] + (ends[a + 2] - ends[a]) * random.unit() as f32);
                for surface in [Intrinsic::Bicubic, Intrinsic::Subdivided] {
                    let args = [at[0], at[1], PARTS];
                    let z = ask(&scene, surface, &args[..surface.params().len()])[0];
                    assert!(z <= crest + slack, "{name} box {i} {ends:?}: {z} over {crest}");
                }
                // Slopes are asked for where there is no hole.
                let grown = [ends[0], ends[1], ends[2], ends[3]].map(f64::from);
                let mut holed = [0.0];
                scene.eval_f64(Intrinsic::Holed, &grown, &mut holed);
                // A box may leave its cell by a rounding: there they are nearly the same.
                let cell = |axis: usize, at: f32| (at / scene.uniform().spacing[axis]).floor();
                let middle = |axis: usize| cell(axis, 0.5 * (ends[axis] + ends[axis + 2]));
                let beside = |axis: usize| {
                    let away = (at[axis] / scene.uniform().spacing[axis] - middle(axis) - 0.5).abs() - 0.5;
                    away > 0.0 && away < 4e-6 * scene.uniform().size[axis] as f32
                };
                if holed[0] != 0.0 || beside(0) || beside(1) {
                    continue;
                }
                let slopes = ask(&scene, Intrinsic::GradientBicubic, &at);
                for axis in 0..2 {
                    let most = slack / scene.terrain().spacing[axis] + 1e-5 * slopes[axis].abs();
                    let [low, high] = [inclines[2 * axis], inclines[2 * axis + 1]];
                    let holds = low - most <= slopes[axis] && slopes[axis] <= high + most;
                    assert!(holds, "{name} box {i} {ends:?} at {at:?}: {slopes:?} {inclines:?}");
                }
            }
        }
        // In a cell they are the patch's own: halved they do not hold.
        let [dx, dy] = scene.uniform().spacing;
        let cell = [0.0, 0.0, dx, dy];
        let inclines = ask(&scene, Intrinsic::InclinesBicubic, &cell);
        let places = (0..81).map(|k| {
            ask(&scene, Intrinsic::GradientBicubic, &[dx * (k % 9) as f32 / 8.0, dy * (k / 9) as f32 / 8.0])
        });
        let steepest = places.map(|slope| slope[0].abs()).fold(0.0, f64::max);
        let bound = inclines[0].abs().max(inclines[1].abs());
        assert!(
            name == "voids" || steepest == 0.0 || 0.5 * bound < steepest,
            "{name}: {bound} for {steepest}"
        );
    }
}

#[test]
fn boxes_are_bounded() {
    let ask = |scene: &Scene, intrinsic, args: &[f32]| {
        let mut out = [0];
        scene.eval_f32(intrinsic, &args.iter().map(|x| x.to_bits()).collect::<Vec<_>>(), &mut out);
        f32::from_bits(out[0])
    };
    for (name, scene) in fields() {
        let mut random = Random(3);
        for i in 0..if name == "fuji" { 500 } else { 3_000 } {
            let ends = ends(&scene, &mut random);
            let [low, high] = [Intrinsic::Lowest, Intrinsic::Highest].map(|side| ask(&scene, side, &ends));
            // Rounding decides to which cell a grid line belongs.
            let exact = |grow: f64| {
                let [w, h] = scene.terrain().extent();
                let by = [w, h].map(|size| grow * (1e-6 * size));
                let [x0, y0, x1, y1] = ends.map(f64::from);
                let [x, y] = [(x0 + x1) / 2.0, (y0 + y1) / 2.0];
                let grown =
                    [(x0 - by[0]).min(x), (y0 - by[1]).min(y), (x1 + by[0]).max(x), (y1 + by[1]).max(y)];
                let mut out = [0.0; 2];
                scene.eval_f64(Intrinsic::Lowest, &grown, &mut out[..1]);
                scene.eval_f64(Intrinsic::Highest, &grown, &mut out[1..]);
                out
            };
            let slack = tolerance(&scene);
            let sound = |[lo, hi]: [f64; 2], lift: f64| {
                f64::from(low) + lift <= lo + slack && f64::from(high) - lift >= hi - slack
            };
            let inner = exact(-1.0);
            let size = scene.terrain().extent().into_iter().fold(0.0, f64::max) as f32;
            let clear = (ends[2] - ends[0]).min(ends[3] - ends[1]) > 3e-6 * size;
            assert!(!clear || sound(inner, 0.0), "{name} box {i} {ends:?}: {low}..{high} {inner:?}");
            // Nodes of 2 x 2 cells are exact, so a bound that is drawn in by more than the rounding would be seen.
            let spacing = scene.terrain().spacing;
            let narrow = (0..2).all(|axis| f64::from(ends[axis + 2] - ends[axis]) < spacing[axis]);
            let nodes = {
                let [w, h] = scene.terrain().extent();
                let side = |axis: usize, size: f64| {
                    let (node, by) = (2.0 * spacing[axis], 1e-6 * size);
                    let start = |end: f64| (end.clamp(0.0, size - 0.25 * node) / node).floor() * node;
                    let [first, last] =
                        [start(f64::from(ends[axis]) - by), start(f64::from(ends[axis + 2]) + by)];
                    [first + by, (last + node).min(size) - by]
                };
                let ([x0, x1], [y0, y1]) = (side(0, w), side(1, h));
                let mut out = [0.0; 2];
                scene.eval_f64(Intrinsic::Lowest, &[x0, y0, x1, y1], &mut out[..1]);
                scene.eval_f64(Intrinsic::Highest, &[x0, y0, x1, y1], &mut out[1..]);
                out
            };
            assert!(!narrow || !sound(nodes, 2.1 * slack + 1e-3), "{name} box {i} {ends:?}");
            for sampler in [Intrinsic::Nearest, Intrinsic::Bilinear, Intrinsic::Triangulated] {
                for _ in 0..4 {
                    let [x, y] = [0, 1].map(|a| ends[a] + (ends[a + 2] - ends[a]) * random.unit() as f32);
                    let z = f64::from(ask(&scene, sampler, &[x, y]));
                    let inside = f64::from(low) - slack <= z && z <= f64::from(high) + slack;
                    assert!(inside, "{name} box {i} {ends:?} {}: {z} {low}..{high}", sampler.name());
                }
            }
        }
    }
}
