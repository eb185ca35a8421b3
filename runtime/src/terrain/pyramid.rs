//! The maximum mipmap and its counterpart, the minimum mipmap: level k >= 1 bounds 2^k x 2^k cells from above or below,
//! in raw units. Level 0, the cells themselves, is bounded by their corners and not stored, so a pyramid of 16-bit data
//! takes 2/3 of a byte per sample.
//!
//! A void is below every height. So an upper bound is that of the samples that are there, and "void" where none is;
//! a lower bound is "void" where one is missing. Both hold for every sampler, also near holes.

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

/// Which side a pyramid bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    Above,
    Below,
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
    pub fn new(terrain: &Terrain, side: Side) -> Pyramid {
        let (levels, nodes) = levels(terrain.width, terrain.height);
        let bounds = match &terrain.samples {
            Samples::I16(data) => Bounds::I16(build(data, terrain.width, &levels, nodes, side, VOID_I16)),
            Samples::F32(data) => Bounds::F32(build(data, terrain.width, &levels, nodes, side, VOID_F32)),
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

fn build<T: Copy + PartialOrd>(
    samples: &[T],
    width: u32,
    levels: &[Level],
    nodes: u32,
    side: Side,
    void: T,
) -> Vec<T> {
    let outer = |a: T, b: T| if (b > a) == (side == Side::Above) { b } else { a };
    let cell = |i: u32, j: u32| {
        let at = j as usize * width as usize + i as usize;
        let north = at + width as usize;
        outer(outer(samples[at], samples[at + 1]), outer(samples[north], samples[north + 1]))
    };
    let mut bounds = vec![void; nodes as usize];
    for k in 1..levels.len() {
        let (below, level) = (levels[k - 1], levels[k]);
        for y in 0..level.height {
            for x in 0..level.width {
                let child = |i: u32, j: u32| match k {
                    1 => cell(i, j),
                    _ => bounds[(below.offset + j * below.width + i) as usize],
                };
                let mut bound = child(2 * x, 2 * y);
                for j in 2 * y..(2 * y + 2).min(below.height) {
                    for i in 2 * x..(2 * x + 2).min(below.width) {
                        bound = outer(bound, child(i, j));
                    }
                }
                bounds[(level.offset + y * level.width + x) as usize] = bound;
            }
        }
    }
    bounds
}

#[cfg(test)]
mod tests {
    use super::*;

    fn brute(terrain: &Terrain, side: Side, k: u32, x: u32, y: u32) -> f32 {
        let (w, h) = (terrain.width - 1, terrain.height - 1);
        let mut all = Vec::new();
        for j in y << k..=((y + 1) << k).min(h) {
            for i in x << k..=((x + 1) << k).min(w) {
                all.push(terrain.sample(i, j).map_or(VOID_F32, |z| z as f32));
            }
        }
        match side {
            Side::Above => all.into_iter().fold(VOID_F32, f32::max),
            Side::Below => all.into_iter().fold(f32::MAX, f32::min),
        }
    }

    #[test]
    fn bounds_are_those_of_the_samples_of_their_cells() {
        for (w, h) in [(2, 2), (3, 2), (2, 9), (17, 16), (33, 12), (64, 65)] {
            let mut state = 7u32;
            let heights = (0..w * h)
                .map(|_| {
                    state = state.wrapping_mul(747796405).wrapping_add(2891336453);
                    if state >> 28 == 0 { f32::NAN } else { (state >> 8) as f32 }
                })
                .collect();
            let terrain = Terrain::from_heights(w, h, [1.0, 1.0], heights).unwrap();
            for side in [Side::Above, Side::Below] {
                let pyramid = Pyramid::new(&terrain, side);
                let Bounds::F32(bounds) = &pyramid.bounds else { panic!("float data has float bounds") };
                for (k, level) in pyramid.levels.iter().enumerate().skip(1) {
                    for (y, x) in (0..level.height).flat_map(|y| (0..level.width).map(move |x| (y, x))) {
                        let stored = bounds[(level.offset + y * level.width + x) as usize];
                        let expected = brute(&terrain, side, k as u32, x, y);
                        assert_eq!(stored, expected, "{w}x{h} {side:?} level {k} node {x} {y}");
                    }
                }
            }
        }
    }

    #[test]
    fn sixteen_bit_data_stays_below_three_bytes_a_sample() {
        let terrain = Terrain::builtin();
        let bytes = 2 * terrain.samples.len() + Pyramid::new(&terrain, Side::Above).bytes();
        assert!(bytes <= 3 * terrain.samples.len(), "{bytes}");
    }
}
