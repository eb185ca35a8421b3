//! What primary rays cost: nodes and cells of the walk over the maximum mipmap, with and without beams.

use super::intrinsics::camera;
use super::scene::Scene;
use rayon::prelude::*;

/// Counts of a picture's primary rays, one through the middle of each pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Steps {
    pub rays: u64,
    /// Nodes and cells that rays are tested against from the camera on.
    pub plain: u64,
    /// The same from where their beams end.
    pub started: u64,
    /// Pieces of beams that were looked at for all tiles.
    pub beams: u64,
    /// Tiles, and those that see only sky.
    pub tiles: u64,
    pub empty: u64,
    /// Rays for which both ways do not agree whether there is a hit: none, or something is wrong.
    pub disagreements: u64,
}

impl Steps {
    /// Of the rays on the bilinear surface, which the triangulated one's are like.
    pub fn of(scene: &Scene) -> Steps {
        let (uniform, beams) = (scene.uniform(), scene.beams());
        let (width, height) = scene.options().size;
        let row = |y: u32| {
            let mut sum = Steps::default();
            for x in 0..width {
                let [x, y] = [x, y].map(|i| i as f32 + 0.5);
                let mut ray = camera(uniform, x, y);
                let (plain, first) = scene.metered(&ray);
                ray[6] = beams.start(x, y, uniform.near);
                let (started, second) = scene.metered(&ray);
                sum.rays += 1;
                sum.plain += plain;
                sum.started += started;
                sum.disagreements += u64::from(first.is_some() != second.is_some());
            }
            sum
        };
        let sum = (0..height).into_par_iter().map(row).reduce(Steps::default, |a, b| Steps {
            rays: a.rays + b.rays,
            plain: a.plain + b.plain,
            started: a.started + b.started,
            disagreements: a.disagreements + b.disagreements,
            ..a
        });
        let (tiles, empty) = (beams.starts.len() as u64, beams.empty() as u64);
        Steps { beams: beams.steps, tiles, empty, ..sum }
    }

    /// The part of the steps that beams save, their own counted.
    pub fn saved(&self) -> f64 {
        1.0 - (self.started + self.beams) as f64 / (self.plain as f64).max(1.0)
    }
}
