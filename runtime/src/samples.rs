//! Several samples a pixel: where they lie, and their mean.

use crate::image::Image;

/// The most samples of a pixel.
pub const MOST: u32 = 1024;

/// Points in the unit square with the origin at the top left: a lattice, so that every column and every row of `count`
/// equal ones holds one point and the mean is the centre; of these the one whose points lie farthest apart.
pub fn points(count: u32) -> Vec<[f32; 2]> {
    let n = i64::from(count.clamp(1, MOST));
    let apart = |step: i64| {
        let round = |d: i64| d.min(n - d);
        (1..n).map(|i| round(i).pow(2) + round(i * step % n).pow(2)).min().unwrap_or(0)
    };
    let steps = (1..n.max(2)).filter(|step| coprime(*step, n));
    let step = steps.rev().max_by_key(|step| apart(*step)).unwrap_or(1);
    let place = |i: i64| ((i as f64 + 0.5) / n as f64) as f32;
    (0..n).map(|i| [place(i), place(i * step % n)]).collect()
}

fn coprime(a: i64, b: i64) -> bool {
    if b == 0 { a == 1 } else { coprime(b, a % b) }
}

/// A sum of pictures in double precision: the mean is rounded once.
#[derive(Default)]
pub struct Sum {
    count: u32,
    data: Vec<f64>,
}

impl Sum {
    pub fn add(&mut self, picture: &Image) {
        self.data.resize(picture.data.len(), 0.0);
        for (sum, x) in self.data.iter_mut().zip(&picture.data) {
            *sum += f64::from(*x);
        }
        self.count += 1;
    }

    pub fn mean(&self) -> Vec<f32> {
        self.data.iter().map(|sum| (sum / f64::from(self.count.max(1))) as f32).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_sample_is_the_centre() {
        assert_eq!(points(1), [[0.5, 0.5]]);
    }

    #[test]
    fn every_row_and_column_has_one_point() {
        for count in [2, 3, 4, 5, 8, 16, 61, 64] {
            let points = points(count);
            for axis in 0..2 {
                let mut cells: Vec<u32> = points.iter().map(|p| (p[axis] * count as f32) as u32).collect();
                cells.sort_unstable();
                assert_eq!(cells, (0..count).collect::<Vec<_>>());
                let mean = points.iter().map(|p| f64::from(p[axis])).sum::<f64>() / f64::from(count);
                assert!((mean - 0.5).abs() < 1e-7);
            }
        }
        // Not all on a diagonal.
        let diagonal = |points: &[[f32; 2]]| points.iter().all(|p| p[0] == p[1] || p[0] == 1.0 - p[1]);
        assert!(!diagonal(&points(5)) && diagonal(&points(2)));
    }

    #[test]
    fn a_mean_is_rounded_once() {
        let picture = |x: f32| Image::new(1, 1, 1, vec![x]).unwrap();
        let mut sum = Sum::default();
        for x in [1e8, 1.0, -1e8, 1.0] {
            sum.add(&picture(x));
        }
        assert_eq!(sum.mean(), [0.5]);
    }
}
