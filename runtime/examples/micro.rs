//! Makes the tileable micro-heightfield that is shipped, `lang-examples/data/micro.png`:
//!
//!     cargo run -p ghyll-runtime --example micro -- lang-examples/data/micro.png
//!
//! Five octaves of gradient noise on lattices whose periods divide the tile, so it repeats without a seam; folded in part,
//! so that it has the edges of broken rock.

use image::{ImageBuffer, Luma};
use std::f64::consts::TAU;

const SIDE: u32 = 256;
/// Cells of the coarsest lattice along a side.
const COARSEST: u32 = 8;
const OCTAVES: u32 = 5;

fn hash(x: u32) -> u32 {
    let s = x.wrapping_mul(747796405).wrapping_add(2891336453);
    let word = ((s >> ((s >> 28) + 4)) ^ s).wrapping_mul(277803737);
    (word >> 22) ^ word
}

/// Gradient noise at (x, y) in cells, of a period in cells.
fn noise(x: f64, y: f64, period: u32) -> f64 {
    let (i, j) = (x.floor(), y.floor());
    let (u, v) = (x - i, y - j);
    let corner = |a: f64, b: f64| {
        let wrapped = |k: f64| (k as u32) % period;
        let angle = f64::from(hash(wrapped(i + a).wrapping_add(hash(wrapped(j + b) + 1000 * period))))
            / f64::from(u32::MAX)
            * TAU;
        angle.cos() * (u - a) + angle.sin() * (v - b)
    };
    let smooth = |t: f64| t * t * t * (t * (6.0 * t - 15.0) + 10.0);
    let mix = |a: f64, b: f64, t: f64| a + t * (b - a);
    let south = mix(corner(0.0, 0.0), corner(1.0, 0.0), smooth(u));
    let north = mix(corner(0.0, 1.0), corner(1.0, 1.0), smooth(u));
    1.4 * mix(south, north, smooth(v))
}

fn height(x: f64, y: f64) -> f64 {
    let octave = |k: u32| {
        let period = COARSEST << k;
        let scale = f64::from(period) / f64::from(SIDE);
        let n = noise(x * scale, y * scale, period);
        (0.6 * n + 0.4 * (0.5 - n.abs())) * 0.5f64.powi(k as i32)
    };
    (0..OCTAVES).map(octave).sum()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::env::args().nth(1).ok_or("name the file to write")?;
    let heights: Vec<f64> =
        (0..SIDE * SIDE).map(|i| height(f64::from(i % SIDE), f64::from(i / SIDE))).collect();
    let low = heights.iter().copied().fold(f64::INFINITY, f64::min);
    let high = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let texels = heights.iter().map(|z| ((z - low) / (high - low) * 65535.0).round() as u16).collect();
    let image = ImageBuffer::<Luma<u16>, Vec<u16>>::from_raw(SIDE, SIDE, texels).ok_or("256 x 256 texels")?;
    image.save(file)?;
    Ok(())
}
