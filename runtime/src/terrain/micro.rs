//! The tileable micro-heightfield (paper, section 3.2). Twin of `shaders/terrain/micro_row.wgsl`.

use super::dem::DemError;
use super::raster::{Raster, Texels};
use std::sync::{Arc, OnceLock};

/// Made by `cargo run -p ghyll-runtime --example micro`.
static SHIPPED: &[u8] = include_bytes!("../../../lang-examples/data/micro.png");
const ONE: f32 = 32767.0;

/// Heights in [-1, 1] that repeat, a metre apart; rows from south to north.
#[derive(Debug)]
pub struct Micro {
    width: u32,
    height: u32,
    texels: Vec<i16>,
}

impl Micro {
    /// Takes a raster of one number for each texel; its lowest becomes -1, its highest 1.
    pub fn new(raster: &Raster) -> Result<Micro, DemError> {
        let file = "the micro-heightfield";
        if raster.components != 1 {
            let what = format!("it has {} channels", raster.components);
            return Err(DemError::unsupported(file, what, "give a grey image or a single band"));
        }
        let floats: Vec<f32> = match &raster.texels {
            Texels::Bytes(data) => data.iter().copied().map(f32::from).collect(),
            Texels::Floats(data) => data.clone(),
            Texels::Reserved => Vec::new(),
        };
        let low = floats.iter().copied().fold(f32::INFINITY, f32::min);
        let high = floats.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let half = 0.5 * (f64::from(high) - f64::from(low));
        let middle = f64::from(low) + half;
        let scaled = |z: &f32| match half > 0.0 {
            true => ((f64::from(*z) - middle) / half * f64::from(ONE)).round() as i16,
            false => 0,
        };
        let rows = floats.chunks_exact(raster.width as usize).rev();
        let texels = rows.flat_map(|row| row.iter().map(scaled)).collect();
        Ok(Micro { width: raster.width, height: raster.height, texels })
    }

    /// 256 x 256 texels of rock and gravel (`lang-examples/data/README.md`).
    pub fn shipped() -> &'static Arc<Micro> {
        static TILE: OnceLock<Arc<Micro>> = OnceLock::new();
        TILE.get_or_init(|| {
            let raster = Raster::read("micro.png", SHIPPED).expect("the embedded file is read by a test");
            Arc::new(Micro::new(&raster).expect("it is grey"))
        })
    }

    /// Texels (i - 1, j) to (i + 2, j).
    pub(super) fn row(&self, i: f32, j: f32) -> [f32; 4] {
        let wrapped = |x: f32, n: u32| (x as i32).rem_euclid(n as i32) as usize;
        let (width, row) = (self.width as usize, wrapped(j, self.height));
        let first = wrapped(i - 1.0, self.width);
        [0, 1, 2, 3].map(|k| f32::from(self.texels[row * width + (first + k) % width]) / ONE)
    }

    /// Width, height and texels as the shaders read them.
    pub fn words(&self) -> Vec<u32> {
        let mut words = vec![self.width, self.height];
        words.extend(super::scene::pack(&self.texels));
        words
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn small() -> Micro {
        let raster = Raster::from_floats(3, 2, 1, vec![10.0, 20.0, 30.0, 12.0, 14.0, 16.0]).unwrap();
        Micro::new(&raster).unwrap()
    }

    #[test]
    fn the_tile_repeats_and_spans_one_to_one() {
        let tile = small();
        let near = |a: [f32; 4], b: [f32; 4]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-4);
        assert!(near(tile.row(1.0, 1.0), [-1.0, 0.0, 1.0, -1.0]));
        assert!(near(tile.row(-2.0, -1.0), [-1.0, 0.0, 1.0, -1.0]));
        assert!(near(tile.row(300.0, 2.0), [-0.4, -0.8, -0.6, -0.4]));
    }

    #[test]
    fn the_shipped_tile_has_no_seam() {
        let tile = Micro::shipped();
        assert_eq!((tile.width, tile.height), (256, 256));
        let range = |texels: &[i16]| (texels.iter().min().copied(), texels.iter().max().copied());
        assert_eq!(range(&tile.texels), (Some(-32767), Some(32767)));
        // Steps across the seam are no greater than elsewhere.
        let step = |i: f32, j: f32| {
            let [a, b, ..] = tile.row(i, j);
            (a - b).abs()
        };
        let greatest = |i: f32| (0..256).map(|j| step(i, j as f32)).fold(0.0, f32::max);
        let inside = (1..256).map(|i| greatest(i as f32)).fold(0.0, f32::max);
        assert!(greatest(0.0) <= inside && inside < 0.5, "{} {inside}", greatest(0.0));
    }

    #[test]
    fn colours_are_no_heights() {
        let raster = Raster::from_floats(1, 1, 3, vec![0.0; 3]).unwrap();
        assert!(Micro::new(&raster).unwrap_err().to_string().contains("3 channels"));
    }
}
