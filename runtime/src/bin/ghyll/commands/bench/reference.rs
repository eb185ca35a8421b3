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

/// Every so many columns and rows a pixel, each in the middle of its square.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sieve(pub u32);

impl Sieve {
    pub fn size(self, (width, height): (u32, u32)) -> (u32, u32) {
        ((width / self.0).max(1), (height / self.0).max(1))
    }

    fn at(self, place: u32, side: u32) -> u32 {
        (place * self.0 + self.0 / 2).min(side - 1)
    }

    /// What is left of a picture of so many floats a pixel.
    pub fn pick<T: Copy>(self, (width, height): (u32, u32), components: usize, data: &[T]) -> Vec<T> {
        let (columns, rows) = self.size((width, height));
        let places = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        let pixel = |(column, row)| {
            let at = self.at(row, height) as usize * width as usize + self.at(column, width) as usize;
            data[components * at..][..components].iter().copied()
        };
        places.flat_map(pixel).collect()
    }
}

/// Components of the program's picture at the pixels that a sieve leaves.
pub fn reference(
    (checked, compiled): &(Checked, Compiled),
    world: &Seen,
    sieve: Sieve,
) -> Result<Vec<f64>, Failure> {
    let set = compiled.settings.set.iter().map(|(id, setting)| (*id, setting.clone())).collect();
    let options = OracleOptions { timeout: PATIENCE, set, ..OracleOptions::default() };
    let (width, height) = (world.directions.width, world.directions.height);
    let middle = |place: u32, side: u32| f64::from(sieve.at(place, side)) + 0.5;
    let place = |column: u32, row: u32| [middle(column, width), middle(row, height)];
    let size = sieve.size((width, height));
    oracle::components(&checked.module, compiled.entry, size, &place, &options, Some(world))
        .map_err(Failure::run)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sieve_leaves_the_middles() {
        let data: Vec<u32> = (0..8 * 5).flat_map(|i| [i, 100 + i]).collect();
        assert_eq!(Sieve(3).size((8, 5)), (2, 1));
        assert_eq!(Sieve(3).pick((8, 5), 2, &data), [9, 109, 12, 112]);
        assert_eq!(Sieve(1).pick((8, 5), 2, &data), data);
    }
}
