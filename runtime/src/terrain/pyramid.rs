//! The maximum mipmap: level k >= 1 bounds 2^k x 2^k cells from above, in raw units. Level 0, the cells themselves,
//! is bounded by their corners and not stored, so the pyramid of 16-bit data takes 2/3 of a byte per sample.
//!
//! A cell that touches a void cannot be hit and has the bound "void", below every height.

use super::field::{Samples, Terrain, VOID_F32, VOID_I16};

/// Enough for fields 2^17 samples wide.
pub const MAX_LEVELS: usize = 18;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Level {
    /// Index of its first node; even, so that two 16-bit nodes share a word of one level only.
    pub offset: u32,
    pub width: u32,
    pub height: u32,
}

/// Bounds of all levels, one after the other.
#[derive(Clone, Debug, PartialEq)]
pub enum Bounds {
    I16(Vec<i16>),
    F32(Vec<f32>),
}

#[derive(Clone, Debug, PartialEq)]
pub struct Pyramid {
    /// `levels[0]` is the grid of cells and owns no nodes; the last one has a single node.
    pub levels: Vec<Level>,
    pub bounds: Bounds,
}

/// Shapes of the levels and the number of nodes they need together.
pub fn levels(width: u32, height: u32) -> (Vec<Level>, u32) {
    let (cells_x, cells_y) = (width - 1, height - 1);
    let mut levels = vec![Level { offset: 0, width: cells_x, height: cells_y }];
    let mut next = 0;
    let mut k = 0;
    while levels[k as usize].width > 1 || levels[k as usize].height > 1 {
        k += 1;
        let level = Level { offset: next, width: ((cells_x - 1) >> k) + 1, height: ((cells_y - 1) >> k) + 1 };
        next += (level.width * level.height).next_multiple_of(2);
        levels.push(level);
    }
    (levels, next)
}

impl Pyramid {
    pub fn new(terrain: &Terrain) -> Pyramid {
        let (levels, nodes) = levels(terrain.width, terrain.height);
        let bounds = match &terrain.samples {
            Samples::I16(data) => Bounds::I16(build(data, terrain.width, &levels, nodes, VOID_I16)),
            Samples::F32(data) => Bounds::F32(build(data, terrain.width, &levels, nodes, VOID_F32)),
        };
        Pyramid { levels, bounds }
    }

    /// The level that is one node.
    pub fn top(&self) -> u32 {
        self.levels.len() as u32 - 1
    }

    /// Bytes of the stored bounds.
    pub fn bytes(&self) -> usize {
        match &self.bounds {
            Bounds::I16(data) => 2 * data.len(),
            Bounds::F32(data) => 4 * data.len(),
        }
    }
}

fn build<T: Copy + PartialOrd>(samples: &[T], width: u32, levels: &[Level], nodes: u32, void: T) -> Vec<T> {
    let mut bounds = vec![void; nodes as usize];
    for k in 1..levels.len() {
        let (below, level) = (levels[k - 1], levels[k]);
        for y in 0..level.height {
            for x in 0..level.width {
                let mut bound = void;
                for j in 2 * y..(2 * y + 2).min(below.height) {
                    for i in 2 * x..(2 * x + 2).min(below.width) {
                        let child = if k == 1 {
                            cell_bound(samples, width, i, j, void)
                        } else {
                            bounds[(below.offset + j * below.width + i) as usize]
                        };
                        bound = higher(bound, child);
                    }
                }
                bounds[(level.offset + y * level.width + x) as usize] = bound;
            }
        }
    }
    bounds
}

fn cell_bound<T: Copy + PartialOrd>(samples: &[T], width: u32, i: u32, j: u32, void: T) -> T {
    let at = j as usize * width as usize + i as usize;
    let corners =
        [samples[at], samples[at + 1], samples[at + width as usize], samples[at + width as usize + 1]];
    if corners.contains(&void) { void } else { corners.into_iter().fold(void, higher) }
}

fn higher<T: PartialOrd>(a: T, b: T) -> T {
    if b > a { b } else { a }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn brute(terrain: &Terrain, k: u32, x: u32, y: u32) -> f32 {
        let (w, h) = (terrain.width - 1, terrain.height - 1);
        let mut bound = VOID_F32;
        for j in y << k..((y + 1) << k).min(h) {
            for i in x << k..((x + 1) << k).min(w) {
                let corners =
                    [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)].map(|(c, r)| terrain.sample(c, r));
                if let [Some(a), Some(b), Some(c), Some(d)] = corners {
                    bound = bound.max(a.max(b).max(c).max(d) as f32);
                }
            }
        }
        bound
    }

    #[test]
    fn bounds_are_the_maxima_of_their_cells() {
        for (w, h) in [(2, 2), (3, 2), (2, 9), (17, 16), (33, 12), (64, 65)] {
            let mut state = 7u32;
            let heights = (0..w * h)
                .map(|_| {
                    state = state.wrapping_mul(747796405).wrapping_add(2891336453);
                    if state >> 28 == 0 { f32::NAN } else { (state >> 8) as f32 }
                })
                .collect();
            let terrain = Terrain::from_heights(w, h, [1.0, 1.0], heights).unwrap();
            let pyramid = Pyramid::new(&terrain);
            let Bounds::F32(bounds) = &pyramid.bounds else { panic!("float data has float bounds") };
            for (k, level) in pyramid.levels.iter().enumerate().skip(1) {
                for y in 0..level.height {
                    for x in 0..level.width {
                        let stored = bounds[(level.offset + y * level.width + x) as usize];
                        assert_eq!(stored, brute(&terrain, k as u32, x, y), "{w}x{h} level {k} node {x} {y}");
                    }
                }
            }
        }
    }

    #[test]
    fn sixteen_bit_data_stays_below_three_bytes_a_sample() {
        let terrain = Terrain::builtin();
        let bytes = 2 * terrain.samples.len() + Pyramid::new(&terrain).bytes();
        assert!(bytes <= 3 * terrain.samples.len(), "{bytes}");
    }
}
