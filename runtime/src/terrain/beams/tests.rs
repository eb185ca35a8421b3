use super::super::view::{NamedView, Stand, View};
use super::super::{SceneOptions, Terrain, steps::Steps};
use super::*;
use ghyll_compiler::intrinsics::Intrinsic;
use std::sync::Arc;

/// Random numbers in [0, 1).
fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
    (*state >> 33) as f64 / (1u64 << 31) as f64
}

fn made(z: impl Fn(u32, u32) -> f32) -> Terrain {
    let heights = (0..96 * 70).map(|i| z(i % 96, i / 96)).collect();
    Terrain::from_heights(96, 70, [30.0, 50.0], heights).unwrap()
}

fn terrains() -> Vec<(&'static str, Terrain)> {
    let noise = |x: u32, y: u32| {
        let mut state = u64::from(x) << 32 | u64::from(y) | 1 << 60;
        random(&mut state);
        random(&mut state) as f32
    };
    vec![
        ("Fuji", Terrain::builtin()),
        ("spikes", made(|x, y| if noise(x, y) > 0.99 { 3e4 } else { noise(y, x) })),
        ("plateau", made(|x, _| if x > 40 { 500.0 } else { 0.0 })),
        ("holes", made(|x, y| if noise(x, y) > 0.8 { f32::NAN } else { 900.0 * noise(x / 9, y / 9) })),
        ("offset", made(|x, y| 8848.0 + 1e-3 * noise(x, y))),
    ]
}

/// The usual ones, and those that lie along the ground, beside it, in it and far away.
fn views(terrain: &Terrain) -> Vec<View> {
    let [width, height] = terrain.extent();
    let top = terrain.max;
    let look = |eye: [f64; 3], target: [f64; 3], fov: f64, ortho: bool| View::LookAt {
        eye,
        target,
        up: [0.1, 0.0, 1.0],
        fov,
        ortho,
    };
    let middle = [0.5 * width, 0.5 * height, 0.5 * (terrain.min + top)];
    let mut all: Vec<View> = NamedView::ALL
        .iter()
        .flat_map(|(_, view)| [false, true].map(|ortho| View::Named { view: *view, fov: 40.0, ortho }))
        .collect();
    all.extend([
        look([0.3 * width, -10.0, top], [0.4 * width, height, top], 60.0, false),
        look([0.3 * width, 0.2 * height, top + 1.0], [0.4 * width, height, top], 100.0, false),
        look([0.5 * width, 0.5 * height, terrain.min - 50.0], middle, 90.0, false),
        look([-1e6, 2e5, 4e5], middle, 0.05, false),
        look(
            [0.5 * width, 0.5 * height, top + 500.0],
            [0.5 * width + 1.0, 0.5 * height, top + 900.0],
            170.0,
            false,
        ),
        look([-3.0 * width, 0.1 * height, top + 10.0], middle, 3.0, true),
        View::Panorama { from: Stand::Summit, azimuth: 20.0, fov: None },
    ]);
    all
}

/// How far the oracle's hit along the ray through (x, y) lies before the start of its beam; none without a hit.
fn before(scene: &Scene, beams: &Beams, x: f64, y: f64) -> Option<f64> {
    let (o, d) = scene.camera().ray(x, y);
    let ray = [o.x, o.y, o.z, d.x, d.y, d.z, 0.0, 1e9];
    let start = f64::from(beams.start(x as f32, y as f32, 0.0));
    let found = [Intrinsic::TraceBilinear, Intrinsic::TraceTriangulated].map(|surface| {
        let mut out = [0.0; 2];
        scene.eval_f64(surface, &ray, &mut out);
        (out[0] != 0.0).then_some(start - out[1])
    });
    found.into_iter().flatten().reduce(f64::max)
}

#[test]
fn no_beam_starts_behind_a_hit() {
    let mut state = 11;
    let (mut hits, mut caught) = (0, 0);
    for (name, terrain) in terrains() {
        let terrain = Arc::new(terrain);
        for view in views(&terrain) {
            let size = (83, 61);
            let options = SceneOptions { view, size, ..SceneOptions::default() };
            let scene = Scene::new(terrain.clone(), &options).unwrap();
            let beams = scene.beams();
            assert_eq!(beams.starts.len(), 11 * 8);
            let late =
                Beams { starts: beams.starts.iter().map(|s| 1.2 * s + 20.0).collect(), ..beams.clone() };
            for _ in 0..400 {
                let pixel = [size.0, size.1].map(|n| (random(&mut state) * f64::from(n)).floor());
                // The corners and edges of pixels too: those of the tiles are among them.
                let part = [0, 1].map(|_| (random(&mut state) * 5.0).floor() / 4.0);
                let (x, y) = (pixel[0] + part[0].min(0.999), pixel[1] + part[1].min(0.999));
                if let Some(distance) = before(&scene, beams, x, y) {
                    assert!(distance <= 0.0, "{name}, {view:?}: {distance} m behind the hit at {x}, {y}");
                    hits += 1;
                    caught += u32::from(before(&scene, &late, x, y) > Some(0.0));
                }
            }
        }
    }
    // Beams that are planted to start late are caught where they are near to what they meet.
    assert!(hits > 10_000 && caught > hits / 4, "{caught} of {hits}");
}

#[test]
fn beams_save_steps_and_lose_no_hit() {
    let size = (512, 512);
    let scene =
        Scene::new(Arc::new(Terrain::builtin()), &SceneOptions { size, ..SceneOptions::default() }).unwrap();
    let steps = Steps::of(&scene);
    eprintln!("{steps:?}, saved {:.3}", steps.saved());
    assert_eq!((steps.rays, steps.disagreements, steps.tiles), (512 * 512, 0, 64 * 64));
    assert!(steps.saved() > 0.3, "{}", steps.saved());
    assert!(steps.empty > 0);
}

#[test]
fn a_tile_of_sky_is_not_walked() {
    let terrain = Arc::new(made(|_, _| 100.0));
    let view = View::LookAt {
        eye: [1000.0, 1000.0, 500.0],
        target: [1000.0, 1001.0, 2000.0],
        up: [0.0, 0.0, 1.0],
        fov: 30.0,
        ortho: false,
    };
    let scene =
        Scene::new(terrain, &SceneOptions { view, size: (64, 64), ..SceneOptions::default() }).unwrap();
    assert_eq!(scene.beams().empty(), 64);
    assert_eq!(Steps::of(&scene).started, 0);
}
