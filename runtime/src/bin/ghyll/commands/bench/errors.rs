//! How far a picture and its distances are from the oracle's.

use crate::failure::Failure;
use ghyll_runtime::image::{self, Image, flip};
use image_compare::{Algorithm, rgb_similarity_structure};

/// What a pixel counts that is hit by one only, or that is farther off than this, in footprints.
pub const WORST: f64 = 100.0;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    pub max: f64,
    pub p99: f64,
    pub rms: f64,
}

/// Of the distances along the rays of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Distances {
    /// Pixels that one of both hits.
    pub disagreements: u32,
    /// Where both hit.
    pub metres: Spread,
    pub footprints: Spread,
    /// Root mean square over all pixels that either hits, in footprints, none more than [`WORST`].
    pub all: f64,
}

impl Distances {
    /// Distances of the machine and of the oracle, -1 for none; `width` is that of a pixel at a distance.
    pub fn of(found: &[f32], real: &[f64], width: impl Fn(f64) -> f64) -> Distances {
        let (mut metres, mut footprints, mut disagreements) = (Vec::new(), Vec::new(), 0);
        for (found, real) in found.iter().zip(real) {
            let found = f64::from(*found);
            match (found >= 0.0, *real >= 0.0) {
                (true, true) => {
                    let error = (found - real).abs();
                    metres.push(error);
                    footprints.push(error / width(*real).max(1e-30));
                }
                (false, false) => {}
                _ => disagreements += 1,
            }
        }
        let square = |x: f64| x.min(WORST).powi(2);
        let count = footprints.len() as f64 + f64::from(disagreements);
        let sum: f64 =
            footprints.iter().map(|x| square(*x)).sum::<f64>() + f64::from(disagreements) * square(WORST);
        Distances {
            disagreements,
            metres: spread(metres),
            footprints: spread(footprints),
            all: (sum / count.max(1.0)).sqrt(),
        }
    }
}

fn spread(mut errors: Vec<f64>) -> Spread {
    errors.sort_by(f64::total_cmp);
    let Some(max) = errors.last().copied() else { return Spread::default() };
    let p99 = errors[((errors.len() - 1) as f64 * 0.99) as usize];
    let square: f64 = errors.iter().map(|x| x * x).sum();
    Spread { max, p99, rms: (square / errors.len() as f64).sqrt() }
}

/// Of two pictures of RGB.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Apart {
    /// Decibels; infinite for equal pictures.
    pub psnr: f64,
    /// Structural similarity of the pictures in 8 bits, 1 for equal ones (Wang, Bovik, Sheikh, Simoncelli 2004).
    pub ssim: f64,
    pub flip: f64,
}

impl Apart {
    pub fn of(found: &Image, real: &Image) -> Result<Apart, Failure> {
        let fault = || Failure::Run("two pictures of one configuration differ in shape".into());
        let psnr = image::compare(found, real).ok_or_else(fault)?.psnr;
        let flip = flip(found, real).ok_or_else(fault)?;
        let [a, b] = [found, real].map(bytes);
        let (a, b) = (a.ok_or_else(fault)?, b.ok_or_else(fault)?);
        let ssim = rgb_similarity_structure(&Algorithm::MSSIMSimple, &a, &b).map_err(|_| fault())?.score;
        Ok(Apart { psnr, ssim, flip })
    }
}

fn bytes(image: &Image) -> Option<::image::RgbImage> {
    let byte = |x: &f32| (x.clamp(0.0, 1.0) * 255.0).round() as u8;
    ::image::RgbImage::from_raw(image.width, image.height, image.data.iter().map(byte).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planted_distances_are_found() {
        let real = [100.0, 200.0, -1.0, -1.0, 400.0];
        let width = |t: f64| 0.01 * t;
        let same = Distances::of(&[100.0, 200.0, -1.0, -1.0, 400.0], &real, width);
        assert_eq!((same.disagreements, same.metres.max, same.all), (0, 0.0, 0.0));
        let other = Distances::of(&[101.0, -1.0, 5.0, -1.0, 404.0], &real, width);
        assert_eq!(other.disagreements, 2);
        assert_eq!((other.metres.max, other.footprints.max), (4.0, 1.0));
        let all = ((1.0 + 1.0 + 2.0 * WORST * WORST) / 4.0f64).sqrt();
        assert!((other.all - all).abs() < 1e-9);
    }

    #[test]
    fn a_planted_pixel_is_apart() {
        let a = Image::new(16, 16, 3, vec![0.5; 768]).unwrap();
        let mut b = a.clone();
        let same = Apart::of(&a, &a).unwrap();
        assert_eq!((same.psnr, same.ssim, same.flip), (f64::INFINITY, 1.0, 0.0));
        b.data[3 * (8 * 16 + 8)] = 1.0;
        let found = Apart::of(&a, &b).unwrap();
        assert!(found.psnr < 40.0 && found.ssim < 1.0 && found.flip > 0.0, "{found:?}");
    }
}
