//! How far two pictures of one shape lie apart.

use super::Image;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Greatest absolute difference of two components; infinite where only one of them is a number.
    pub max: f64,
    /// Root of the mean square.
    pub rms: f64,
    /// Peak signal to noise ratio in decibels for a peak of 1; infinite for equal pictures.
    pub psnr: f64,
    /// Pixels with any component off by more than half a step of 8 bits.
    pub pixels: usize,
}

/// None if the shapes differ.
pub fn compare(a: &Image, b: &Image) -> Option<Difference> {
    if (a.width, a.height, a.components) != (b.width, b.height, b.components) {
        return None;
    }
    let apart = |(x, y): (&f32, &f32)| {
        if x.to_bits() == y.to_bits() || (x.is_nan() && y.is_nan()) {
            0.0
        } else if x.is_nan() || y.is_nan() {
            f64::INFINITY
        } else {
            (f64::from(*x) - f64::from(*y)).abs()
        }
    };
    let components = a.components as usize;
    let (mut max, mut square, mut pixels) = (0.0f64, 0.0f64, 0);
    for (p, q) in a.data.chunks_exact(components).zip(b.data.chunks_exact(components)) {
        let worst = p.iter().zip(q).map(apart).fold(0.0, f64::max);
        square += p.iter().zip(q).map(|pair| apart(pair).powi(2)).sum::<f64>();
        max = max.max(worst);
        pixels += usize::from(worst > 0.5 / 255.0);
    }
    let mean = square / a.data.len() as f64;
    Some(Difference { max, rms: mean.sqrt(), psnr: -10.0 * mean.log10(), pixels })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_pictures_and_one_planted_difference() {
        let a = Image::new(2, 2, 1, vec![0.0, 0.25, 0.5, 1.0]).unwrap();
        let same = compare(&a, &a).unwrap();
        assert_eq!((same.max, same.psnr, same.pixels), (0.0, f64::INFINITY, 0));

        let mut b = a.clone();
        b.data[3] = 0.8;
        let found = compare(&a, &b).unwrap();
        assert!((found.max - 0.2).abs() < 1e-6 && found.pixels == 1);
        assert!((found.psnr - 20.0).abs() < 0.01, "{}", found.psnr);
        b.data[0] = f32::NAN;
        assert_eq!(compare(&a, &b).unwrap().max, f64::INFINITY);
    }

    #[test]
    fn other_shapes_do_not_compare() {
        let a = Image::new(2, 1, 1, vec![0.0; 2]).unwrap();
        let b = Image::new(1, 2, 1, vec![0.0; 2]).unwrap();
        assert_eq!(compare(&a, &b), None);
    }
}
