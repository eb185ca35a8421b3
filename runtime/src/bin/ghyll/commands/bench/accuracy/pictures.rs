//! Whole pictures: samples a pixel, lighting, presets and rewriters, against the oracle with many samples.

use super::super::reference::PATIENCE;
use super::super::{Spread, program_with};
use super::errors::Apart;
use super::{Method, Row, Setting, traced};
use crate::failure::Failure;
use ghyll_compiler::argument::parse_arguments;
use ghyll_compiler::compile::{Compiled, EntryKind, Options};
use ghyll_compiler::front::Checked;
use ghyll_runtime::config::{Config, Rewriter};
use ghyll_runtime::image::Image;
use ghyll_runtime::machine::{Job, Machine};
use ghyll_runtime::oracle::Precision;
use ghyll_runtime::presets::PRESETS;
use ghyll_runtime::renderer::Renderer;
use ghyll_runtime::terrain::Scene;
use std::time::Instant;

const FUJI: &str = include_str!("../../../../../../../lang-examples/fuji.ghyll");
const FIG9: &str = include_str!("../../../../../../../lang-examples/fig9.ghyll");

/// Samples of the oracle's pictures.
const FINE: u32 = 16;
const SAMPLES: &[u32] = &[1, 4, 16];

/// A program with how it is to be drawn.
struct Picture {
    program: &'static str,
    compiled: (Checked, Compiled),
    lighting: &'static str,
    preset: Option<&'static str>,
    /// With the depth that a lane may go to.
    rewriter: (&'static str, Rewriter, Option<u32>),
    samples: u32,
}

const AUTO: (&str, Rewriter, Option<u32>) = ("auto", Rewriter::Auto, None);
/// The paper's algorithm is the last.
const REWRITERS: &[(&str, Rewriter, Option<u32>)] =
    &[AUTO, ("lane", Rewriter::Lane, None), ("block", Rewriter::Block, Some(1))];

/// Pictures with one reference stand together.
fn groups() -> Result<Vec<Vec<Picture>>, Failure> {
    let mut groups = Vec::new();
    for (lighting, shadows) in [("facing", false), ("shadows", true)] {
        let picture = |samples: &u32| -> Result<Picture, Failure> {
            let compiled = traced("bilinear", "color", true, shadows)?;
            Ok(Picture {
                program: "terrain",
                compiled,
                lighting,
                preset: None,
                rewriter: AUTO,
                samples: *samples,
            })
        };
        groups.push(SAMPLES.iter().map(picture).collect::<Result<_, Failure>>()?);
    }
    for preset in PRESETS {
        let mut options =
            Options { want: Some(EntryKind::Image), no_bake: !preset.bake, ..Options::default() };
        let (checked, _) = program_with("fuji", FUJI, &options)?;
        for (name, value) in preset.set {
            let param = checked.module.params.iter().find(|param| param.name == *name);
            if param.is_some_and(|param| parse_arguments(&checked.module, value, &param.ty).is_ok()) {
                options.set.push((name.to_string(), value.to_string()));
            }
        }
        let compiled = program_with("fuji", FUJI, &options)?;
        let (preset, samples) = (Some(preset.name), preset.samples);
        let lighting = "own";
        groups.push(vec![Picture { program: "fuji", compiled, lighting, preset, rewriter: AUTO, samples }]);
    }
    let set = vec![("lighting".to_string(), "sunlit".to_string())];
    let options = Options { want: Some(EntryKind::Image), set, ..Options::default() };
    let picture = |rewriter: &(&'static str, Rewriter, Option<u32>)| -> Result<Picture, Failure> {
        let compiled = program_with("fig9", FIG9, &options)?;
        let (lighting, preset, samples) = ("shadows", None, 1);
        Ok(Picture { program: "fig9", compiled, lighting, preset, rewriter: *rewriter, samples })
    };
    groups.push(REWRITERS.iter().map(picture).collect::<Result<_, Failure>>()?);
    Ok(groups)
}

pub fn rows(
    scene: &Scene,
    terrain: &str,
    (machine, backend): (&Machine, &'static str),
    repeat: u32,
) -> Result<Vec<Row>, Failure> {
    let size = scene.options().size;
    let mut rows = Vec::new();
    for group in groups()? {
        let mut config = Config { timeout: PATIENCE, ..Config::default() };
        let mut renderers: Vec<Renderer> = group.iter().map(|_| Renderer::default()).collect();
        let mut draw = |at: usize, machine: &Machine, samples: u32, renderer: &mut Renderer| {
            let Picture { compiled: (checked, compiled), rewriter: (_, rewriter, depth), .. } = &group[at];
            let job = Job { checked, compiled, scene: Some(scene) };
            (config.rewriter, config.depth) = (*rewriter, *depth);
            let drawn = renderer.render_samples(&job, machine, size, &config, samples);
            drawn.map(|(image, _)| image).map_err(Failure::run)
        };
        let oracle = Machine::Oracle(Precision::F64);
        let reference = draw(0, &oracle, FINE, &mut Renderer::default())?;
        let mut times = vec![Vec::new(); group.len()];
        let mut images: Vec<Image> = Vec::new();
        for turn in 0..=repeat {
            for (at, (renderer, times)) in renderers.iter_mut().zip(&mut times).enumerate() {
                let started = Instant::now();
                let image = draw(at, machine, group[at].samples, renderer)?;
                match turn {
                    0 => images.push(image),
                    _ => times.push(1e3 * started.elapsed().as_secs_f64()),
                }
            }
        }
        for ((picture, times), image) in group.iter().zip(times).zip(images) {
            let surface = "bilinear".to_string();
            let spread = Spread::of(times);
            rows.push(Row {
                setting: Setting {
                    terrain: terrain.into(),
                    view: super::sites::VIEWS[0].name,
                    surface,
                    backend,
                },
                method: (picture.program == "terrain").then_some(Method::Trace),
                program: picture.program,
                lighting: picture.lighting,
                preset: picture.preset,
                rewriter: picture.rewriter.0,
                samples: picture.samples,
                ms: [spread.median, spread.least, spread.greatest],
                distances: None,
                apart: Apart::of(&image, &reference)?,
                front: false,
            });
        }
    }
    Ok(rows)
}
