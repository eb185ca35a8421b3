//! The oracle's answer for the very rays that a machine computed, so that errors of rays are none of tracing.

use crate::failure::Failure;
use ghyll_compiler::compile::Compiled;
use ghyll_compiler::core::Intrinsic;
use ghyll_compiler::front::Checked;
use ghyll_runtime::image::Image;
use ghyll_runtime::oracle::{self, OracleOptions};
use ghyll_runtime::terrain::Scene;
use ghyll_runtime::world::World;
use std::time::Duration;

/// For who waits for an answer rather than for an end.
pub const PATIENCE: Duration = Duration::from_secs(3600);

/// A scene with rays of these directions.
pub struct Seen<'a> {
    pub scene: &'a Scene,
    pub directions: &'a Image,
}

impl World for Seen<'_> {
    fn eval_f64(&self, intrinsic: Intrinsic, args: &[f64], out: &mut [f64]) {
        if intrinsic != Intrinsic::Camera {
            return self.scene.eval_f64(intrinsic, args, out);
        }
        let (at, last) =
            ([args[0] as u32, args[1] as u32], [self.directions.width - 1, self.directions.height - 1]);
        let dir = self.directions.pixel(at[0].min(last[0]), at[1].min(last[1]));
        let scene = self.scene.uniform();
        let ray = [&scene.eye[..], dir, &[scene.near, scene.far]].concat();
        out.iter_mut().zip(ray).for_each(|(out, x)| *out = f64::from(x));
    }

    fn eval_f32(&self, intrinsic: Intrinsic, args: &[u32], out: &mut [u32]) {
        self.scene.eval_f32(intrinsic, args, out);
    }
}

/// Components of the program's picture, pixel by pixel.
pub fn reference((checked, compiled): &(Checked, Compiled), world: &Seen) -> Result<Vec<f64>, Failure> {
    let set = compiled.settings.set.iter().map(|(id, setting)| (*id, setting.clone())).collect();
    let options = OracleOptions { timeout: PATIENCE, set, ..OracleOptions::default() };
    let place = |column: u32, row: u32| [f64::from(column) + 0.5, f64::from(row) + 0.5];
    let size = (world.directions.width, world.directions.height);
    oracle::components(&checked.module, compiled.entry, size, &place, &options, Some(world))
        .map_err(Failure::run)
}
