//! The average mipmap (paper, section 3.2): level k holds the means of squares of 2^k x 2^k samples, voids left out.
//! Twin of `shaders/terrain/means.wgsl`; the shader reads the same words.
//!
//! Means are summed exactly and rounded once, when they are stored: 16-bit data as 16-bit fractions of its range, so
//! within 1/131068 of it, float data as floats.

use super::field::{Samples, Terrain, VOID_F32};
use super::layout::SceneUniform;
use super::walk::Heights;

/// Words before the record of level 1.
const HEAD: usize = 3;
/// Code of a mean of nothing.
const VOID_CODE: u16 = u16::MAX;

/// Means of all levels from 1 in raw units, NaN where every sample is missing.
#[derive(Debug)]
pub struct Means {
    levels: Vec<Level>,
}

#[derive(Debug)]
struct Level {
    width: u32,
    height: u32,
    means: Vec<f64>,
}

impl Means {
    pub fn new(terrain: &Terrain) -> Means {
        let mut levels = Vec::new();
        let (mut width, mut height) = (terrain.width, terrain.height);
        // Sums with the number of samples in them; those of the samples themselves are not kept.
        let mut below: Vec<(f64, u32)> = Vec::new();
        while width > 1 || height > 1 {
            let (w, h) = (width.div_ceil(2), height.div_ceil(2));
            let child = |i: u32, j: u32| {
                let at = j as usize * width as usize + i as usize;
                match below.is_empty() {
                    true => terrain.samples.get(at).map_or((0.0, 0), |z| (z, 1)),
                    false => below[at],
                }
            };
            let mut sums = Vec::with_capacity(w as usize * h as usize);
            for (j, i) in (0..h).flat_map(|j| (0..w).map(move |i| (j, i))) {
                let mut sum = (0.0, 0);
                for y in 2 * j..(2 * j + 2).min(height) {
                    for x in 2 * i..(2 * i + 2).min(width) {
                        let (z, n) = child(x, y);
                        sum = (sum.0 + z, sum.1 + n);
                    }
                }
                sums.push(sum);
            }
            let means = sums.iter().map(|(z, n)| if *n > 0 { z / f64::from(*n) } else { f64::NAN }).collect();
            levels.push(Level { width: w, height: h, means });
            (width, height, below) = (w, h, sums);
        }
        Means { levels }
    }

    /// The words that shaders and their twin read.
    pub fn words(&self, terrain: &Terrain) -> Vec<u32> {
        let raw = |z: f64| (z - terrain.offset) / terrain.scale;
        let (low, high) = (raw(terrain.min) as f32, raw(terrain.max) as f32);
        let step = (high - low) / f32::from(VOID_CODE - 1);
        let mut words = vec![self.levels.len() as u32, low.to_bits(), step.to_bits()];
        words.resize(HEAD + 3 * self.levels.len(), 0);
        for (k, level) in self.levels.iter().enumerate() {
            let offset = words.len() as u32;
            let record = [offset, level.width, level.height];
            words[HEAD + 3 * k..HEAD + 3 * k + 3].copy_from_slice(&record);
            match terrain.samples {
                Samples::I16(_) => {
                    let code = |mean: Option<&f64>| match mean.filter(|m| !m.is_nan()) {
                        Some(m) if step > 0.0 => ((m - f64::from(low)) / f64::from(step)).round() as u16,
                        Some(_) => 0,
                        None => VOID_CODE,
                    };
                    let pair =
                        |pair: &[f64]| u32::from(code(pair.first())) | u32::from(code(pair.get(1))) << 16;
                    words.extend(level.means.chunks(2).map(pair));
                }
                Samples::F32(_) => {
                    let stored = |m: &f64| if m.is_nan() { VOID_F32 } else { *m as f32 };
                    words.extend(level.means.iter().map(|m| stored(m).to_bits()));
                }
            }
        }
        words
    }

    /// Means (i, j), (i + 1, j), (i, j + 1) and (i + 1, j + 1) of a level in metres, in double precision.
    pub fn around(
        &self,
        terrain: &Terrain,
        [level, i, j]: [f64; 3],
        (low, exaggerate): (f64, f64),
    ) -> [f64; 4] {
        let k = (level.max(0.0) as usize).min(self.levels.len());
        let (width, height) = match k {
            0 => (terrain.width, terrain.height),
            _ => (self.levels[k - 1].width, self.levels[k - 1].height),
        };
        let at = |i: f64, j: f64| {
            let [i, j] = [(i.max(0.0) as u32).min(width - 1), (j.max(0.0) as u32).min(height - 1)];
            let node = j as usize * width as usize + i as usize;
            let raw = match k {
                0 => terrain.samples.get(node),
                _ => Some(self.levels[k - 1].means[node]).filter(|m| !m.is_nan()),
            };
            raw.map(|raw| (raw * terrain.scale + terrain.offset) * exaggerate)
        };
        let (i, j) = (i.max(0.0), j.max(0.0));
        let all = [at(i, j), at(i + 1.0, j), at(i, j + 1.0), at(i + 1.0, j + 1.0)];
        let known: Vec<f64> = all.into_iter().flatten().collect();
        let other = if known.is_empty() { low } else { known.iter().sum::<f64>() / known.len() as f64 };
        all.map(|z| z.unwrap_or(other))
    }
}

/// The same from the stored words, in single precision.
pub(super) fn means<H: Heights>(
    scene: &SceneUniform,
    heights: &H,
    words: &[u32],
    half: bool,
    [level, i, j]: [f32; 3],
) -> [f32; 4] {
    let k = (level.max(0.0) as u32).min(words[0]);
    let record = 3 * k as usize;
    let [width, height] = if k == 0 { scene.size } else { [words[record + 1], words[record + 2]] };
    let [west, south] = [(i.max(0.0) as u32).min(width - 1), (j.max(0.0) as u32).min(height - 1)];
    let [east, north] = [(west + 1).min(width - 1), (south + 1).min(height - 1)];
    let at = |i: u32, j: u32| {
        let node = (j * width + i) as usize;
        if k == 0 {
            return heights.sample(node);
        }
        let offset = words[record] as usize;
        if !half {
            return f32::from_bits(words[offset + node]);
        }
        let code = (words[offset + node / 2] >> (16 * (node & 1))) as u16;
        let (low, step) = (f32::from_bits(words[1]), f32::from_bits(words[2]));
        if code == VOID_CODE { VOID_F32 } else { low + f32::from(code) * step }
    };
    let z = [at(west, south), at(east, south), at(west, north), at(east, north)];
    let known = z.map(|z| if z == VOID_F32 { 0.0 } else { z });
    let number = z.iter().filter(|z| **z != VOID_F32).count() as f32;
    let sum = (known[0] + known[1]) + (known[2] + known[3]);
    let other = if number > 0.0 { sum / number } else { scene.raw_relief[0] };
    z.map(|z| (if z == VOID_F32 { other } else { z }) * scene.z_scale + scene.z_offset)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn uneven() -> Terrain {
        let heights = (0..15).map(|i| if i == 4 { f32::NAN } else { (i * i) as f32 }).collect();
        Terrain::from_heights(5, 3, [1.0, 1.0], heights).unwrap()
    }

    #[test]
    fn a_level_holds_the_means_of_its_squares_without_voids() {
        let means = Means::new(&uneven());
        let level = |k: usize| (means.levels[k].width, means.levels[k].height, means.levels[k].means.clone());
        let (w, h, first) = level(0);
        assert_eq!((w, h), (3, 2));
        // Rows 0 4 9 .., 25 36 49 ..: the south-western square is 0, 1, 25 and 36; the south-eastern one is 81 and a void.
        assert_eq!((first[0], first[2]), (15.5, 81.0));
        assert_eq!(means.levels.len(), 3);
        let all: f64 = (0..15).filter(|i| *i != 4).map(|i| f64::from(i * i)).sum();
        assert_eq!(means.levels[2].means, [all / 14.0]);
    }

    #[test]
    fn stored_means_of_integers_are_near() {
        let terrain = Terrain::builtin();
        let means = Means::new(&terrain);
        let words = means.words(&terrain);
        assert!(2 * words.len() < terrain.samples.len() / 2, "{}", words.len());
        let step = f64::from(f32::from_bits(words[2]));
        let record = &words[3 * 2..3 * 2 + 3];
        for (node, mean) in means.levels[1].means.iter().enumerate() {
            let code = words[record[0] as usize + node / 2] >> (16 * (node & 1)) & 0xffff;
            let stored = f64::from(f32::from_bits(words[1])) + f64::from(code) * step;
            assert!((stored - mean).abs() <= 0.51 * step, "{node}: {stored} {mean}");
        }
    }
}
