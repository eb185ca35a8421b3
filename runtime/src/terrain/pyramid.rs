//! The maximum mipmap and its counterpart, the minimum mipmap: level k >= 1 bounds 2^k x 2^k cells from above or below,
//! in raw units. Level 0, the cells themselves, is bounded by their corners and not stored, so a pyramid of 16-bit data
//! takes 2/3 of a byte per sample.
//!
//! A void is below every height. So an upper bound is that of the samples that are there, and "void" where none is;
//! a lower bound is "void" where one is missing. Both hold for every sampler that is no higher than the samples around, also near holes.
//! The bicubic surface, which is, has upper bounds of its own.

use super::bicubic::Around;
use super::field::{Samples, Terrain, VOID_F32, VOID_I16};
use super::scene::pack;
use rayon::prelude::*;

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

impl Bounds {
    /// None of them if they are floats.
    pub fn i16s(&self) -> &[i16] {
        if let Bounds::I16(bounds) = self { bounds } else { &[] }
    }

    /// None of them if they are integers.
    pub fn f32s(&self) -> &[f32] {
        if let Bounds::F32(bounds) = self { bounds } else { &[] }
    }
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
        let outer = side == Side::Above;
        match &terrain.samples {
            Samples::I16(data) => Pyramid::i16s(terrain, outer, corner(data, terrain.width, outer)),
            Samples::F32(data) => Pyramid::f32s(terrain, outer, corner(data, terrain.width, outer)),
        }
    }

    /// Upper bounds of the bicubic surface, and of what lies between its points; beside a void those of the samples that are there. In
    /// 16 bits the highest number stands for all above it.
    pub fn crests(terrain: &Terrain) -> Pyramid {
        let at = |i: u32, j: u32| (j * terrain.width + i) as usize;
        match &terrain.samples {
            Samples::I16(data) => {
                let corners = corner(data, terrain.width, true);
                let sample = |i: u32, j: u32| match data[at(i, j)] {
                    VOID_I16 => VOID_F32,
                    raw => f32::from(raw),
                };
                Pyramid::i16s(terrain, true, |i, j| match crest(terrain, sample, [i, j]) {
                    Some((base, over)) => (base + over.ceil()) as i16,
                    None => corners(i, j),
                })
            }
            Samples::F32(data) => {
                let corners = corner(data, terrain.width, true);
                let sample = |i: u32, j: u32| data[at(i, j)];
                Pyramid::f32s(terrain, true, |i, j| match crest(terrain, sample, [i, j]) {
                    Some((base, over)) => (base + over) + 1.2e-7 * (base + over).abs(),
                    None => corners(i, j),
                })
            }
        }
    }

    fn i16s(terrain: &Terrain, upper: bool, leaf: impl Fn(u32, u32) -> i16 + Sync) -> Pyramid {
        let (levels, nodes) = levels(terrain.width, terrain.height);
        let bounds = Bounds::I16(build(&levels, nodes, VOID_I16, upper, leaf));
        Pyramid { levels, bounds }
    }

    fn f32s(terrain: &Terrain, upper: bool, leaf: impl Fn(u32, u32) -> f32 + Sync) -> Pyramid {
        let (levels, nodes) = levels(terrain.width, terrain.height);
        let bounds = Bounds::F32(build(&levels, nodes, VOID_F32, upper, leaf));
        Pyramid { levels, bounds }
    }

    /// The level that is one node.
    pub fn top(&self) -> u32 {
        self.levels.len() as u32 - 1
    }

    /// Bounds as the shaders read them, at least one word.
    pub fn words(&self) -> Vec<u32> {
        let mut words = match &self.bounds {
            Bounds::I16(data) => pack(data),
            Bounds::F32(data) => data.iter().map(|v| v.to_bits()).collect(),
        };
        if words.is_empty() {
            words.push(0);
        }
        words
    }

    /// Bytes of the stored bounds.
    pub fn bytes(&self) -> usize {
        match &self.bounds {
            Bounds::I16(data) => 2 * data.len(),
            Bounds::F32(data) => 4 * data.len(),
        }
    }
}

/// A cell's corner, and how far the patch rises above it at most, with more than rounding can cost; none if it touches a void.
fn crest(terrain: &Terrain, sample: impl Fn(u32, u32) -> f32, cell: [u32; 2]) -> Option<(f32, f32)> {
    let around = Around::of([terrain.width, terrain.height], sample, cell)?;
    let [low, high] = around.range();
    Some((around.base, around.crest() + 1e-6 * (high - low)))
}

/// Of two bounds the outer one.
fn outer<T: Copy + PartialOrd>(a: T, b: T, upper: bool) -> T {
    if (b > a) == upper { b } else { a }
}

/// A cell's bound: that of its corners.
fn corner<T: Copy + PartialOrd + Sync>(
    samples: &[T],
    width: u32,
    upper: bool,
) -> impl Fn(u32, u32) -> T + Sync {
    move |i, j| {
        let at = j as usize * width as usize + i as usize;
        let north = at + width as usize;
        let of = |a: usize| outer(samples[a], samples[a + 1], upper);
        outer(of(at), of(north), upper)
    }
}

/// Level by level, from the cells' bounds.
fn build<T: Copy + PartialOrd + Send + Sync>(
    levels: &[Level],
    nodes: u32,
    void: T,
    upper: bool,
    leaf: impl Fn(u32, u32) -> T + Sync,
) -> Vec<T> {
    let mut bounds = vec![void; nodes as usize];
    for k in 1..levels.len() {
        let (below, level) = (levels[k - 1], levels[k]);
        let (done, open) = bounds.split_at_mut(level.offset as usize);
        let child = |i: u32, j: u32| match k {
            1 => leaf(i, j),
            _ => done[(below.offset + j * below.width + i) as usize],
        };
        let width = level.width as usize;
        let rows = open[..width * level.height as usize].par_chunks_mut(width).enumerate();
        rows.for_each(|(y, row)| {
            for (x, node) in row.iter_mut().enumerate() {
                let [x, y] = [2 * x as u32, 2 * y as u32];
                let columns = x..(x + 2).min(below.width);
                let all = (y..(y + 2).min(below.height)).flat_map(|j| columns.clone().map(move |i| (i, j)));
                *node = all.map(|(i, j)| child(i, j)).reduce(|a, b| outer(a, b, upper)).unwrap_or(void);
            }
        });
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

    /// Places of each cell against the bound of each node over it.
    #[test]
    fn the_bicubic_surface_stays_below_its_crests() {
        let mut state = 11u32;
        let mut heights = |count: u32, whole: bool| -> Vec<f32> {
            let mut next = || {
                state = state.wrapping_mul(747796405).wrapping_add(2891336453);
                if state >> 28 == 0 {
                    f32::NAN
                } else {
                    (state >> 16) as f32 * if whole { 1.0 } else { 0.37 } - 33000.0
                }
            };
            (0..count).map(|_| next()).collect()
        };
        let field = |w, h, z| Terrain::from_heights(w, h, [1.0, 1.0], z).unwrap();
        let mut fields = vec![field(9, 9, vec![5.0; 81])];
        for (w, h) in [(2, 2), (3, 9), (17, 12)] {
            let random = heights(w * h, false);
            fields.push(field(w, h, random));
            // 16 bits, up to the highest number.
            let samples = heights(w * h, true)
                .into_iter()
                .map(|z| if z.is_nan() { VOID_I16 } else { z.clamp(-32767.0, 32767.0) as i16 });
            let mut terrain = field(w, h, vec![0.0; (w * h) as usize]);
            terrain.samples = Samples::I16(samples.collect());
            fields.push(terrain);
        }
        for terrain in fields {
            let pyramid = Pyramid::crests(&terrain);
            let bound = |k: usize, x: u32, y: u32| {
                let level = pyramid.levels[k];
                let at = (level.offset + y * level.width + x) as usize;
                match &pyramid.bounds {
                    Bounds::F32(bounds) => bounds[at],
                    Bounds::I16(bounds) if bounds[at] == i16::MAX => f32::MAX,
                    Bounds::I16(bounds) => f32::from(bounds[at]),
                }
            };
            let sample = |i: u32, j: u32| match &terrain.samples {
                Samples::F32(data) => data[(j * terrain.width + i) as usize],
                Samples::I16(data) => match data[(j * terrain.width + i) as usize] {
                    VOID_I16 => VOID_F32,
                    raw => f32::from(raw),
                },
            };
            let mut closest = f32::MAX;
            for (j, i) in (0..terrain.height - 1).flat_map(|j| (0..terrain.width - 1).map(move |i| (j, i))) {
                let Some(around) = Around::of([terrain.width, terrain.height], sample, [i, j]) else {
                    continue;
                };
                for (v, u) in (0..=8).flat_map(|v| (0..=8).map(move |u| (v, u))) {
                    let [u, v] = [u, v].map(|at| super::super::bicubic::weights(at as f32 / 8.0));
                    let z = around.base + around.blend(u, v);
                    for k in 1..pyramid.levels.len() {
                        assert!(z <= bound(k, i >> k, j >> k), "{z} above level {k} at {i} {j}");
                    }
                    closest = closest.min(bound(1.min(pyramid.levels.len() - 1), i >> 1, j >> 1) - z);
                }
            }
            assert!(
                pyramid.levels.len() == 1 || closest < 20_000.0,
                "a bound that is far above all: {closest}"
            );
        }
    }

    #[test]
    fn sixteen_bit_data_stays_below_three_bytes_a_sample() {
        let terrain = Terrain::builtin();
        let bytes = 2 * terrain.samples.len() + Pyramid::new(&terrain, Side::Above).bytes();
        assert!(bytes <= 3 * terrain.samples.len(), "{bytes}");
    }
}
