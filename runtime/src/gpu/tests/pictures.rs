//! Images.

use super::super::*;
use super::programs::{gpu, picture, picture_value};
use crate::machine::{Job, Machine};
use crate::progress::{Step, recorded};
use crate::terrain::{Scene as View, SceneOptions, Terrain};
use ghyll_compiler::compile::{self, Options, compile};
use ghyll_compiler::source::Source;
use std::sync::Arc;

fn check(frame: &Frame, width: u32, height: u32, deep: u32) {
    assert_eq!(frame.words.len(), (width * height * 3) as usize);
    for (index, pixel) in frame.words.chunks_exact(3).enumerate() {
        let (x, y) = (index as u32 % width, index as u32 / width);
        assert_eq!(pixel, picture_value(x, y, deep), "at {x}, {y}");
    }
}

#[test]
fn three_tasks_a_pixel_by_every_rewriter() {
    let Some(gpu) = gpu() else { return };
    // 3000 calls outgrow the window, 50000 also the fuel.
    for (rewriter, deep) in [
        (Rewriter::Auto, 3),
        (Rewriter::Lane, 3),
        (Rewriter::Block, 3),
        (Rewriter::Auto, 3000),
        (Rewriter::Auto, 50_000),
    ] {
        let config = Config { rewriter, ..Config::default() };
        let mut engine = Engine::with_components(&gpu, picture(deep), config, None, 3).unwrap();
        for (width, height) in [(61, 43), (128, 96)] {
            let frame = engine.render(width, height, 0).unwrap();
            eprintln!("{rewriter:?} {deep}: {:?}", frame.stats);
            check(&frame, width, height, deep);
        }
    }
}

#[test]
#[should_panic(expected = "at 5, 3")]
fn a_planted_difference_is_seen() {
    let mut words = Vec::new();
    for y in 0..8 {
        for x in 0..8 {
            words.extend(picture_value(x, y, 3));
        }
    }
    words[(3 * 8 + 5) * 3 + 1] += 1.0;
    check(&Frame { words, stats: Stats::default() }, 8, 8, 3);
}

#[test]
fn images_in_a_tiny_arena() {
    let Some(gpu) = gpu() else { return };
    for rewriter in [Rewriter::Auto, Rewriter::Block] {
        let config = Config { rewriter, max_memory: 128 << 10, ..Config::default() };
        let mut engine = Engine::with_components(&gpu, picture(100), config, None, 3).unwrap();
        check(&engine.render(64, 40, 0).unwrap(), 64, 40, 100);
    }
}

#[test]
fn progress_is_told_between_submissions() {
    let Some(gpu) = gpu() else { return };
    let shade = "fn shade(x: f32, y: f32) -> vec4<f32> { return vec4<f32>(x, y, 0.0, 1.0); }";
    for (rewriter, code) in
        [(Rewriter::Auto, shaded(shade)), (Rewriter::Lane, picture(3)), (Rewriter::Block, picture(3))]
    {
        let (progress, steps) = recorded();
        let config = Config { rewriter, progress, max_memory: 1 << 20, ..Config::default() };
        Engine::with_components(&gpu, code, config, None, 3).unwrap().render(90, 95, 0).unwrap();
        let told = steps.lock().unwrap();
        crate::progress::check(&told, 90 * 95, 2).unwrap_or_else(|e| panic!("{rewriter:?}: {e}"));
        let rounds = told.iter().any(|step| matches!(step, Step::Rewrites(n) if *n > 0));
        assert_eq!(rounds, rewriter == Rewriter::Block);
    }
}

/// All buffers count, and what an error says is needed is enough.
#[test]
fn an_image_counts_as_memory() {
    let Some(gpu) = gpu() else { return };
    let render = |max_memory| {
        let config = Config { max_memory, ..Config::default() };
        Engine::with_components(&gpu, picture(100), config, None, 3)?.render(64, 40, 0)
    };
    for limit in [1 << 10, 90 << 10] {
        let Err(RunError::TooLittleMemory { needed, limit: told }) = render(limit) else {
            panic!("{limit} bytes are too few")
        };
        assert!(told == limit && needed.total() > limit && needed.stream > 0 && needed.records > 0);
        assert_eq!(needed.image, if limit == 1 << 10 { 0 } else { 64 * 40 * 3 * 4 });
        if limit > 1 << 10 {
            let frame = render(needed.total()).unwrap();
            assert!(frame.stats.memory.total() <= needed.total(), "{:?}", frame.stats.memory);
            check(&frame, 64, 40, 100);
        }
    }
}

fn shaded(functions: &str) -> Code {
    let mut code = picture(1);
    code.functions += functions;
    (code.has_shade, code.fused) = (true, true);
    code
}

#[test]
fn fused_entries_are_computed_directly() {
    let Some(gpu) = gpu() else { return };
    let code = shaded("fn shade(x: f32, y: f32) -> vec4<f32> { return vec4<f32>(x, y, x * y, 1.0); }");
    let mut engine = Engine::with_components(&gpu, code, Config::default(), None, 3).unwrap();
    let frame = engine.render(50, 30, 0).unwrap();
    for (index, pixel) in frame.words.chunks_exact(3).enumerate() {
        let (x, y) = ((index % 50) as f32 + 0.5, (index / 50) as f32 + 0.5);
        assert_eq!(pixel, [x, y, x * y]);
    }
}

#[test]
fn endless_loops_in_a_pixel_are_an_error() {
    let Some(gpu) = gpu() else { return };
    let code = shaded(
        "fn shade(x: f32, y: f32) -> vec4<f32> {
            var a = x;
            loop {
                if (fuel <= 0) { exhausted = true; break; }
                fuel = fuel - 1;
                a = a * 0.999 + 1.0;
                if (a < 0.0) { break; }
            }
            return vec4<f32>(a);
        }",
    );
    let mut engine = Engine::with_components(&gpu, code, Config::default(), None, 3).unwrap();
    match engine.render(16, 16, 0) {
        Err(RunError::LoopTooLong { function, .. }) => assert_eq!(function, "pixel"),
        other => panic!("{:?}", other.map(|frame| frame.stats)),
    }
}

/// Kernels of equal text are shared, but not where their programs bind other parts of the scene.
#[test]
fn equal_bakes_of_programs_that_look_at_more() {
    let Some(gpu) = gpu() else { return };
    let machine = Machine::Gpu(Box::new(gpu));
    let options = SceneOptions { size: (8, 8), ..SceneOptions::default() };
    let heights = (0..64).map(|i| (i * i % 17) as f32).collect();
    let terrain = Terrain::from_heights(8, 8, [1.0, 1.0], heights).unwrap();
    let view = View::new(Arc::new(terrain), &options).unwrap();
    for more in ["", " + micro(p)"] {
        let text = format!(
            "use terrain; @bake fn twice(p: vec2) -> f32 = 2.0 * bilinear(p);
             fn pixel(p: vec2) -> f32 = twice(p){more};"
        );
        let checked = compile::check(Source::new("test", text)).unwrap();
        let compiled = compile(&checked, &Options::default()).unwrap();
        let job = Job { checked: &checked, compiled: &compiled, scene: Some(&view) };
        let (found, _) = job.render(&machine, (8, 8), &Config::default()).unwrap();
        let (wanted, _) = job.render(&Machine::Cpu, (8, 8), &Config::default()).unwrap();
        for (found, wanted) in found.data.iter().zip(&wanted.data) {
            assert!((found - wanted).abs() < 1e-4, "{found} {wanted}");
        }
    }
}
