//! FLIP: how different two pictures look when one is flipped to the other in place. P. Andersson, J. Nilsson,
//! T. Akenine-Möller, M. Oskarsson, K. Åström, M. D. Fairchild, *FLIP: A Difference Evaluator for Alternating Images*
//! (HPG 2020), for display colours, with the constants of its reference code.

use super::Image;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Pixels to a degree of the observer's view: 0.7 m from a screen 0.7 m and 3840 pixels wide.
const PIXELS_PER_DEGREE: f64 = 67.020_64;
/// Gaussians of the contrast sensitivity of Y, Cx and Cz: weights and widths.
const SENSITIVITY: [[f64; 4]; 3] =
    [[1.0, 0.0047, 0.0, 1e-5], [1.0, 0.0053, 0.0, 1e-5], [34.1, 0.04, 13.5, 0.025]];
/// Width of what is seen as an edge or a point, in degrees.
const FEATURE: f64 = 0.082;
const COLOR_POWER: f64 = 0.7;
const KNEE: f64 = 0.4;
const KNEE_VALUE: f64 = 0.95;
const FEATURE_POWER: f64 = 0.5;

type Color = [f64; 3];

/// The mean over all pixels, 0 for equal pictures and at most 1; none if the pictures differ in shape or are not RGB.
pub fn flip(a: &Image, b: &Image) -> Option<f64> {
    if (a.width, a.height) != (b.width, b.height) || a.components != 3 || b.components != 3 {
        return None;
    }
    let [a, b] = [a, b].map(Picture::new);
    let (color_a, color_b) = (a.seen(), b.seen());
    let (features_a, features_b) = (a.features(), b.features());
    let most = hyab(hunted(lab([0.0, 1.0, 0.0])), hunted(lab([0.0, 0.0, 1.0]))).powf(COLOR_POWER);
    let errors = color_a.iter().zip(&color_b).zip(features_a.iter().zip(&features_b));
    let sum: f64 = errors
        .map(|((x, y), (f, g))| {
            let color = spread(hyab(*x, *y).powf(COLOR_POWER), most);
            let feature = (f[0] - g[0]).abs().max((f[1] - g[1]).abs());
            let feature = (std::f64::consts::FRAC_1_SQRT_2 * feature).powf(FEATURE_POWER);
            color.powf(1.0 - feature)
        })
        .sum();
    Some(sum / color_a.len() as f64)
}

/// Differences up to the knee take most of the range.
fn spread(color: f64, most: f64) -> f64 {
    let knee = KNEE * most;
    if color < knee {
        KNEE_VALUE / knee * color
    } else {
        KNEE_VALUE + (color - knee) / (most - knee) * (1.0 - KNEE_VALUE)
    }
}

/// Pixels in Y, Cx, Cz.
struct Picture {
    width: usize,
    height: usize,
    pixels: Vec<Color>,
}

impl Picture {
    fn new(image: &Image) -> Picture {
        let opponent =
            |p: &[f32]| opponent(to_xyz([0, 1, 2].map(|k| linear(f64::from(p[k]).clamp(0.0, 1.0)))));
        let pixels = image.data.chunks_exact(3).map(opponent).collect();
        Picture { width: image.width as usize, height: image.height as usize, pixels }
    }

    /// What an eye makes of it: colours blurred by its contrast sensitivity, in L*a*b* with Hunt's effect.
    fn seen(&self) -> Vec<Color> {
        let radius = (3.0 * (0.04 / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE).ceil() as isize;
        let kernels = SENSITIVITY.map(|[a1, b1, a2, b2]| {
            let gauss = |a: f64, b: f64, z: f64| a * (PI / b).sqrt() * (-PI * PI * z / b).exp();
            let weight = |x: isize, y: isize| {
                let z = ((x * x + y * y) as f64) / PIXELS_PER_DEGREE.powi(2);
                gauss(a1, b1, z) + gauss(a2, b2, z)
            };
            let weights = square(radius, weight);
            let sum: f64 = weights.iter().sum();
            weights.into_iter().map(|w| w / sum).collect::<Vec<f64>>()
        });
        self.filtered(radius, |sum: &mut Color, pixel, at| {
            for k in 0..3 {
                sum[k] += kernels[k][at] * pixel[k];
            }
        })
        .into_iter()
        .map(|color| hunted(lab(to_rgb(from_opponent(color)).map(|x| x.clamp(0.0, 1.0)))))
        .collect()
    }

    /// Strength of edges and of points.
    fn features(&self) -> Vec<[f64; 2]> {
        let sd = 0.5 * FEATURE * PIXELS_PER_DEGREE;
        let radius = (3.0 * sd).ceil() as isize;
        let gauss = |x: isize, y: isize| (-((x * x + y * y) as f64) / (2.0 * sd * sd)).exp();
        let edge = balanced(square(radius, |x, y| -(x as f64) * gauss(x, y)));
        let point = balanced(square(radius, |x, y| ((x * x) as f64 / (sd * sd) - 1.0) * gauss(x, y)));
        let side = 2 * radius as usize + 1;
        self.filtered(radius, |sum: &mut [f64; 4], pixel, at| {
            let y = (pixel[0] + 16.0) / 116.0;
            let turned = (at % side) * side + at / side;
            for (sum, weight) in sum.iter_mut().zip([edge[at], edge[turned], point[at], point[turned]]) {
                *sum += weight * y;
            }
        })
        .into_iter()
        .map(|[ex, ey, px, py]| [ex.hypot(ey), px.hypot(py)])
        .collect()
    }

    /// A sum over the square around each pixel, rows and columns at the rim repeated.
    fn filtered<T: Default + Send>(
        &self,
        radius: isize,
        add: impl Fn(&mut T, &Color, usize) + Sync,
    ) -> Vec<T> {
        let inside = |at: isize, n: usize| at.clamp(0, n as isize - 1) as usize;
        let one = |i: usize| {
            let (x, y) = ((i % self.width) as isize, (i / self.width) as isize);
            let mut sum = T::default();
            let mut at = 0;
            for row in y - radius..=y + radius {
                let row = inside(row, self.height) * self.width;
                for column in x - radius..=x + radius {
                    add(&mut sum, &self.pixels[row + inside(column, self.width)], at);
                    at += 1;
                }
            }
            sum
        };
        (0..self.pixels.len()).into_par_iter().map(one).collect()
    }
}

/// Weights of a square, row by row.
fn square(radius: isize, weight: impl Fn(isize, isize) -> f64) -> Vec<f64> {
    (-radius..=radius)
        .flat_map(|y| (-radius..=radius).map(move |x| (x, y)))
        .map(|(x, y)| weight(x, y))
        .collect()
}

/// Positive weights sum to 1, negative ones to -1.
fn balanced(weights: Vec<f64>) -> Vec<f64> {
    let up: f64 = weights.iter().filter(|w| **w > 0.0).sum();
    let down: f64 = -weights.iter().filter(|w| **w < 0.0).sum::<f64>();
    weights.into_iter().map(|w| if w > 0.0 { w / up } else { w / down }).collect()
}

fn linear(x: f64) -> f64 {
    if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

/// sRGB's primaries under D65.
const XYZ: [[f64; 3]; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];

fn to_xyz(c: Color) -> Color {
    XYZ.map(|row| row[0] * c[0] + row[1] * c[1] + row[2] * c[2])
}

fn to_rgb(c: Color) -> Color {
    let matrix = glam::DMat3::from_cols_array_2d(&XYZ).transpose().inverse();
    (matrix * glam::DVec3::from(c)).into()
}

fn white() -> Color {
    to_xyz([1.0; 3])
}

fn opponent(c: Color) -> Color {
    let w = white();
    let [x, y, z] = [0, 1, 2].map(|k| c[k] / w[k]);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn from_opponent(c: Color) -> Color {
    let w = white();
    let y = (c[0] + 16.0) / 116.0;
    [(c[1] / 500.0 + y) * w[0], y * w[1], (y - c[2] / 200.0) * w[2]]
}

/// L*a*b* of linear RGB.
fn lab(rgb: Color) -> Color {
    let (c, w) = (to_xyz(rgb), white());
    let root = |t: f64| {
        let d: f64 = 6.0 / 29.0;
        if t > d.powi(3) { t.cbrt() } else { t / (3.0 * d * d) + 4.0 / 29.0 }
    };
    let [x, y, z] = [0, 1, 2].map(|k| root(c[k] / w[k]));
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Bright colours look more colourful.
fn hunted([l, a, b]: Color) -> Color {
    [l, 0.01 * l * a, 0.01 * l * b]
}

fn hyab(a: Color, b: Color) -> f64 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(color: impl Fn(u32, u32) -> [f32; 3]) -> Image {
        let data = (0..32 * 32).flat_map(|i| color(i % 32, i / 32)).collect();
        Image::new(32, 32, 3, data).unwrap()
    }

    #[test]
    fn equal_pictures_do_not_flip_and_opposite_ones_do() {
        let [green, blue] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|c| picture(|_, _| c));
        assert_eq!(flip(&green, &green), Some(0.0));
        // The metric's scale: these two colours are 1 apart.
        assert!((flip(&green, &blue).unwrap() - 1.0).abs() < 1e-9);
        let small = Image::new(1, 1, 3, vec![0.0; 3]).unwrap();
        assert_eq!(flip(&green, &small), None);
    }

    #[test]
    fn colours_go_there_and_back() {
        let color = [0.2, 0.5, 0.8];
        let back = to_rgb(from_opponent(opponent(to_xyz(color))));
        assert!(color.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-12), "{back:?}");
    }

    #[test]
    fn one_planted_pixel_counts_and_a_brighter_one_counts_more() {
        let grey = picture(|_, _| [0.5; 3]);
        let planted = |x: f32| picture(|c, r| if (c, r) == (16, 16) { [x; 3] } else { [0.5; 3] });
        let [little, much] = [0.6, 1.0].map(|x| flip(&grey, &planted(x)).unwrap());
        assert!(0.0 < little && little < much && much < 0.05, "{little} {much}");
    }
}
