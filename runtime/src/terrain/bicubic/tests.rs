//! Single precision against the oracle's polynomials, over fields made to break them.

use super::super::scene::Scene;
use super::super::tests::fields;
use ghyll_compiler::intrinsics::Intrinsic;

const SAMPLERS: [Intrinsic; 6] = [
    Intrinsic::Bicubic,
    Intrinsic::GradientBicubic,
    Intrinsic::BendBicubic,
    Intrinsic::Subdivided,
    Intrinsic::GradientSubdivided,
    Intrinsic::TwistSubdivided,
];

/// Seeded positions in and around the field, many of them exactly on samples and grid lines.
fn positions(scene: &Scene, count: u32) -> impl Iterator<Item = [f32; 2]> {
    let terrain = scene.terrain().clone();
    let mut state = 5u32;
    let mut random = move || {
        state = state.wrapping_mul(747796405).wrapping_add(2891336453);
        f64::from(state >> 8) / f64::from(1u32 << 24)
    };
    (0..count).map(move |i| {
        [0, 1].map(|axis| {
            let size = terrain.extent()[axis];
            let at = (random() * 1.1 - 0.05) * size;
            let snapped = (at / terrain.spacing[axis]).round() * terrain.spacing[axis];
            (if (i >> axis) % 4 == 0 { snapped } else { at }) as f32
        })
    })
}

fn both(scene: &Scene, sampler: Intrinsic, [x, y]: [f32; 2], n: f32) -> (Vec<f64>, Vec<f64>) {
    let args = [x, y, n];
    let args = &args[..sampler.params().len()];
    let mut words = vec![0; sampler.results().len()];
    let mut exact = vec![0.0; words.len()];
    scene.eval_f32(sampler, &args.iter().map(|a| a.to_bits()).collect::<Vec<_>>(), &mut words);
    scene.eval_f64(sampler, &args.iter().map(|a| f64::from(*a)).collect::<Vec<_>>(), &mut exact);
    (words.into_iter().map(|w| f64::from(f32::from_bits(w))).collect(), exact)
}

/// A place where rounding of the position decides about the cell, and with it about slopes.
fn on_a_line(scene: &Scene, p: [f32; 2], n: f32) -> bool {
    (0..2).any(|axis| {
        let grid = f64::from(p[axis]) / f64::from(scene.uniform().spacing[axis]) * f64::from(n);
        (grid - grid.round()).abs() < 1e-6 * grid.abs() + 1e-4
    })
}

#[test]
fn samplers_agree_with_the_oracle() {
    for (name, scene) in fields() {
        let spacing = scene.terrain().spacing;
        let tall = scene.terrain().max - scene.terrain().min + 1e-6;
        let offset = scene.terrain().max.abs().max(scene.terrain().min.abs());
        // Positions round to this share of a cell.
        let cells = f64::from(scene.terrain().width.max(scene.terrain().height));
        let place = 3e-7 * cells + 1e-6;
        for sampler in SAMPLERS {
            let order = match sampler {
                Intrinsic::Bicubic | Intrinsic::Subdivided => 0,
                Intrinsic::GradientBicubic | Intrinsic::GradientSubdivided => 1,
                _ => 2,
            };
            let unit = spacing[0].min(spacing[1]).powi(order);
            let mut compared = 0;
            for (i, p) in positions(&scene, 2_000).enumerate() {
                let n = 1.0 + (i % 8) as f32;
                if order > 0 && on_a_line(&scene, p, if sampler.params().len() == 3 { n } else { 1.0 }) {
                    continue;
                }
                let (single, exact) = both(&scene, sampler, p, n);
                let slack = 30.0 * tall * place / unit + if order == 0 { 3e-7 * offset } else { 0.0 };
                for (a, b) in single.iter().zip(&exact) {
                    assert!((a - b).abs() <= slack, "{name} {} {p:?} {n}: {a} {b} {slack}", sampler.name());
                    // A difference of a tenth of the relief in a cell would be seen.
                    assert!(cells > 1e3 || slack < 0.1 * tall.max(0.1) / unit + 0.01, "{name} {slack}");
                }
                compared += 1;
            }
            assert!(compared > 500, "{name} {} {compared}", sampler.name());
        }
    }
}

#[test]
fn the_surface_leaves_its_samples_by_at_most_nine_parts_of_32() {
    for (name, scene) in fields() {
        let (low, high) = (scene.terrain().min, scene.terrain().max);
        let beyond = 9.0 / 32.0 * (high - low) + 1e-6 * (high.abs() + low.abs());
        for p in positions(&scene, 5_000) {
            for sampler in [Intrinsic::Bicubic, Intrinsic::Subdivided] {
                let (single, _) = both(&scene, sampler, p, 4.0);
                assert!((low - beyond..=high + beyond).contains(&single[0]), "{name} {p:?}: {}", single[0]);
            }
        }
    }
}
