//! Frames of all forms of the network in turn, so that what else the machine does falls on all of them.

use super::super::errors::Distances;
use super::super::network::Form;
use super::super::reference::{PATIENCE, Seen, Sieve, reference};
use super::{Cell, Way};
use crate::failure::Failure;
use ghyll_compiler::compile::Compiled;
use ghyll_compiler::front::Checked;
use ghyll_runtime::config::{Config, Stats};
use ghyll_runtime::image::Image;
use ghyll_runtime::machine::{Job, Machine};
use ghyll_runtime::renderer::Renderer;
use ghyll_runtime::terrain::{Scene, SceneOptions};
use std::time::Instant;

/// Pixels whose distances are judged.
const JUDGED: (u32, u32) = (32, 24);
/// Pieces and halvings of the search that helps to judge detailed geometry.
const FINEST: &[(&str, &str)] = &[("steps", "4096"), ("refinements", "20")];

/// Where it is measured.
pub struct Seat<'a> {
    pub terrain: usize,
    pub terrain_name: &'a str,
    pub scene: &'a Scene,
    pub machine: &'a Machine,
    pub backend: &'static str,
}

impl Seat<'_> {
    fn draw(
        &self,
        scene: &Scene,
        renderer: &mut Renderer,
        (checked, compiled): &(Checked, Compiled),
        config: &Config,
    ) -> Result<(Image, Stats), Failure> {
        let job = Job { checked, compiled, scene: Some(scene) };
        renderer.render(&job, self.machine, scene.options().size, config).map_err(Failure::run)
    }
}

/// A form with its frames.
struct Subject {
    program: (Checked, Compiled),
    renderer: Renderer,
    ms: Vec<f64>,
    stats: Stats,
}

impl Subject {
    fn new(form: Form) -> Result<Subject, Failure> {
        let (renderer, stats) = (Renderer::default(), Stats::default());
        Ok(Subject { program: form.compiled("pixel")?, renderer, ms: Vec::new(), stats })
    }

    fn frame(&mut self, seat: &Seat, config: &Config, measured: bool) -> Result<(), Failure> {
        let started = Instant::now();
        (_, self.stats) = seat.draw(seat.scene, &mut self.renderer, &self.program, config)?;
        if measured {
            self.ms.push(1e3 * started.elapsed().as_secs_f64());
        }
        Ok(())
    }
}

fn average(ms: &[f64]) -> f64 {
    ms.iter().sum::<f64>() / ms.len() as f64
}

pub fn cells(seat: &Seat, wanted: &[(Way, Form)], repeat: u32) -> Result<Vec<Cell>, Failure> {
    let pair =
        |(_, form): &(Way, Form)| Ok([Subject::new(*form)?, Subject::new(Form { work: false, ..*form })?]);
    let mut subjects: Vec<[Subject; 2]> = wanted.iter().map(pair).collect::<Result<_, Failure>>()?;
    // The first frame compiles and bakes.
    for turn in 0..=repeat {
        for ((way, _), pair) in wanted.iter().zip(&mut subjects) {
            let config =
                Config { rewriter: way.rewriter, depth: way.depth, timeout: PATIENCE, ..Config::default() };
            pair.iter_mut().try_for_each(|subject| subject.frame(seat, &config, turn > 0))?;
        }
    }
    let mut judged: Vec<(Form, Distances)> = Vec::new();
    let mut cells = Vec::new();
    for ((way, form), [full, idle]) in wanted.iter().zip(subjects) {
        let same = |f: &Form| (f.detail, f.exact) == (form.detail, form.exact);
        let known = judged.iter().find(|(f, _)| same(f)).map(|(_, distances)| distances.clone());
        let distances = match known {
            Some(distances) => distances,
            None => {
                judged.push((*form, distances(seat, *form)?));
                judged[judged.len() - 1].1.clone()
            }
        };
        let least = full.ms.iter().copied().fold(f64::MAX, f64::min);
        let greatest = full.ms.iter().copied().fold(0.0, f64::max);
        cells.push(Cell {
            terrain: seat.terrain,
            terrain_name: seat.terrain_name.into(),
            way: *way,
            form: *form,
            backend: seat.backend,
            ms: [average(&full.ms), least, greatest],
            overhead: average(&idle.ms),
            rewrites: (!full.stats.direct).then_some(full.stats.rewrites),
            distances,
        });
    }
    Ok(cells)
}

/// How far off the form's geometry is along some rays: from what the oracle finds along the same ones. On the detailed surface,
/// where the oracle takes a second for a ray, from the earliest hit that tracing or a fine search finds, as neither
/// finds one where there is none.
fn distances(seat: &Seat, form: Form) -> Result<Distances, Failure> {
    let options = SceneOptions { size: JUDGED, ..*seat.scene.options() };
    let scene = seat.scene.with_options(&options).map_err(|e| Failure::Run(e.to_string()))?;
    let config = Config { timeout: PATIENCE, ..Config::default() };
    let draw = |program: &(Checked, Compiled)| {
        Ok::<_, Failure>(seat.draw(&scene, &mut Renderer::default(), program, &config)?.0)
    };
    let [traced, searched] = [true, false].map(|exact| Form { exact, ..form });
    let real: Vec<f64> = if form.detail {
        let exact = draw(&traced.compiled("distance_found")?)?;
        let fine = draw(&searched.compiled_with("distance_found", FINEST)?)?;
        exact.data.iter().zip(&fine.data).map(|(a, b)| f64::from(first(*a, *b))).collect()
    } else {
        let directions = draw(&traced.compiled("direction")?)?;
        let seen = Seen { scene: &scene, directions: &directions };
        reference(&traced.compiled("distance_found")?, &seen, Sieve(1))?
    };
    let found = draw(&form.compiled("distance_found")?)?;
    // Pixels are those of the picture that is measured.
    let [near, far] = seat.scene.camera().pixel_width();
    Ok(Distances::of(&found.data, &real, |t| near + far * t))
}

/// The nearer of two distances, -1 for none.
fn first(a: f32, b: f32) -> f32 {
    if a < 0.0 || (b >= 0.0 && b < a) { b } else { a }
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_first_hit_is_the_nearer_one() {
        let found = [(3.0, 2.0), (2.0, 3.0), (-1.0, 3.0), (3.0, -1.0), (-1.0, -1.0)];
        assert_eq!(found.map(|(a, b)| super::first(a, b)), [2.0, 2.0, 3.0, 3.0, -1.0]);
    }
}
