//! One curve: a surface seen once, met by every method. Frames of all methods are taken in turn.

use super::super::Spread;
use super::super::reference::{PATIENCE, Seen, Sieve, reference};
use super::errors::{Apart, Distances};
use super::{Method, Row, Setting, traced};
use crate::failure::Failure;
use ghyll_compiler::compile::{Compiled, set_live};
use ghyll_compiler::front::Checked;
use ghyll_runtime::config::Config;
use ghyll_runtime::image::Image;
use ghyll_runtime::machine::{Job, Machine};
use ghyll_runtime::renderer::Renderer;
use ghyll_runtime::terrain::Scene;
use std::time::Instant;

/// Colours, and the fourth component of every pixel.
fn parted(data: &[f64]) -> (Vec<f32>, Vec<f64>) {
    let colors = data.chunks_exact(4).flat_map(|p| [p[0] as f32, p[1] as f32, p[2] as f32]).collect();
    (colors, data.chunks_exact(4).map(|p| p[3]).collect())
}

fn rgb((width, height): (u32, u32), colors: Vec<f32>) -> Result<Image, Failure> {
    Image::new(width, height, 3, colors).map_err(|e| Failure::Run(e.to_string()))
}

/// The oracle takes milliseconds for a ray of a spline.
const SIEVE: Sieve = Sieve(5);

/// Whole pictures are timed; errors are those of the pixels that the sieve leaves.
pub fn curve(
    scene: &Scene,
    setting: &Setting,
    methods: &[Method],
    machine: &Machine,
    repeat: u32,
) -> Result<Vec<Row>, Failure> {
    let size = scene.options().size;
    let config = Config { timeout: PATIENCE, ..Config::default() };
    let draw = |renderer: &mut Renderer, (checked, compiled): &(Checked, Compiled)| {
        let job = Job { checked, compiled, scene: Some(scene) };
        renderer.render(&job, machine, size, &config).map(|(image, _)| image).map_err(Failure::run)
    };
    let directions = draw(&mut Renderer::default(), &traced(&setting.surface, "direction", true, false)?)?;

    let mut exact = (Renderer::default(), traced(&setting.surface, "pixel", true, false)?);
    let mut search = (Renderer::default(), traced(&setting.surface, "pixel", false, false)?);
    let world = Seen { scene, directions: &directions };
    let (colors, real) = parted(&reference(&exact.1, &world, SIEVE)?);
    let few = SIEVE.size(size);
    let reference = rgb(few, colors)?;

    let mut times = vec![Vec::new(); methods.len()];
    let mut images = Vec::new();
    for turn in 0..=repeat {
        for (method, times) in methods.iter().zip(&mut times) {
            let (renderer, program) = if *method == Method::Trace { &mut exact } else { &mut search };
            if let Method::Search(pieces, halvings) = method {
                set(program, "steps", *pieces)?;
                set(program, "refinements", *halvings)?;
            }
            let started = Instant::now();
            let image = draw(renderer, program)?;
            match turn {
                // The first frame compiles.
                0 => images.push(image),
                _ => times.push(1e3 * started.elapsed().as_secs_f64()),
            }
        }
    }

    let [near, far] = scene.camera().pixel_width();
    let row = |((method, times), image): ((&Method, Vec<f64>), Image)| -> Result<Row, Failure> {
        let left = SIEVE.pick(size, 4, &image.data);
        let wide: Vec<f64> = left.iter().map(|x| f64::from(*x)).collect();
        let (colors, _) = parted(&wide);
        let found: Vec<f32> = left.chunks_exact(4).map(|p| p[3]).collect();
        let spread = Spread::of(times);
        Ok(Row {
            setting: setting.clone(),
            method: Some(*method),
            program: "terrain",
            lighting: "facing",
            preset: None,
            rewriter: "auto",
            samples: 1,
            ms: [spread.median, spread.least, spread.greatest],
            distances: Some(Distances::of(&found, &real, |t| near + far * t)),
            apart: Apart::of(&rgb(few, colors)?, &reference)?,
            front: false,
        })
    };
    methods.iter().zip(times).zip(images).map(row).collect()
}

fn set((checked, compiled): &mut (Checked, Compiled), name: &str, value: u32) -> Result<(), Failure> {
    set_live(checked, compiled, name, &value.to_string())
        .map_err(|_| Failure::Run(format!("the benchmark's program has no live parameter {name}")))
}
