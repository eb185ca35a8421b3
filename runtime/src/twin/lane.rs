//! Lane mode: a window takes the program, or a pixel, and rewrites it to nothing but its value.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use rayon::prelude::*;

use super::machine::{Machine, Stop};
use super::pool::Pool;
use super::tokens::Tokens;
use crate::config::Config;
use crate::error::RunError;

/// Pixels along a tile's side.
const TILE: u32 = 8;

/// Rewrites a whole stream in one window.
pub fn value(pool: &Pool, stream: &Tokens) -> Result<Vec<u32>, RunError> {
    pool.with(|machine| {
        machine.leave_free(0);
        machine.begin_stream(stream);
        match machine.run(u64::MAX)? {
            Stop::Normal => Ok(machine.literals().to_vec()),
            stop => Err(RunError::Internal(format!("the stream of a value stopped as {stop:?}"))),
        }
    })
}

/// Lanes draw tiles of pixels; none of the image's stream is ever written to memory.
pub fn image(
    pool: &Pool,
    (width, height): (u32, u32),
    components: u32,
    entry: u32,
    config: &Config,
) -> Result<Vec<f32>, RunError> {
    let mut image = vec![0.0; width as usize * height as usize * components as usize];
    // Strips of tiles, lower where there would be too few for all threads.
    let threads = rayon::current_num_threads() as u32;
    let rows = (height / (8 * threads)).clamp(1, TILE);
    let strip = (width * rows * components) as usize;
    if strip == 0 {
        return Ok(image);
    }
    let done = AtomicU64::new(0);
    let draw = |(at, pixels): (usize, &mut [f32])| {
        let first = at as u32 * rows;
        let strip = Strip { first, rows: rows.min(height - first), width, components, point: config.point };
        pool.with(|machine| strip.draw(machine, entry, pixels))?;
        let drawn = u64::from(strip.rows);
        config.progress.part((width, height), done.fetch_add(drawn, Relaxed) + drawn, height.into());
        Ok(())
    };
    image.par_chunks_mut(strip).enumerate().try_for_each(draw)?;
    Ok(image)
}

struct Strip {
    first: u32,
    rows: u32,
    width: u32,
    components: u32,
    point: [f32; 2],
}

impl Strip {
    fn draw(&self, machine: &mut Machine, entry: u32, pixels: &mut [f32]) -> Result<(), RunError> {
        for left in (0..self.width).step_by(TILE as usize) {
            for row in 0..self.rows {
                for x in left..(left + TILE).min(self.width) {
                    let at = ((row * self.width + x) * self.components) as usize;
                    let to = &mut pixels[at..at + self.components as usize];
                    self.pixel(machine, entry, [x, self.first + row], to)?;
                }
            }
        }
        Ok(())
    }

    fn pixel(
        &self,
        machine: &mut Machine,
        entry: u32,
        [x, y]: [u32; 2],
        to: &mut [f32],
    ) -> Result<(), RunError> {
        machine.begin_pixel(y.wrapping_mul(self.width).wrapping_add(x), within([x, y], self.point), entry);
        let stop = machine.run(u64::MAX)?;
        match (stop, machine.literals()) {
            (Stop::Store, [_, words @ ..]) if words.len() == to.len() => {
                for (to, word) in to.iter_mut().zip(words) {
                    *to = f32::from_bits(*word);
                }
                Ok(())
            }
            (stop, words) => {
                let what = format!("a pixel ended as {stop:?} with {} words", words.len());
                Err(RunError::Internal(what))
            }
        }
    }
}

/// Position of a point in a pixel.
pub fn within([x, y]: [u32; 2], [dx, dy]: [f32; 2]) -> [f32; 2] {
    [x as f32 + dx, y as f32 + dy]
}
