//! Beams (paper, section 3.1, Figs. 2 and 3): the rays of a tile of pixels together, as a pyramid with the tile's corners for edges.
//! A beam goes along as long as the maximum mipmap shows that none of its rays can meet the samples, piece by piece: pieces
//! double after a proof and halve without one. Tiles are halved from coarse to fine, each part begins where the whole
//! one had to stop. Where a fine beam stops, its rays may start; where it leaves the field, they need not.

use super::field::{Samples, VOID_F32, VOID_I16};
use super::pyramid::{Bounds, Pyramid};
use super::scene::Scene;
use super::view::{Camera, Projection};
use glam::DVec3;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};

/// Pixels across and down of the tiles that rays start from.
pub const TILE: u32 = 8;
/// Halvings of the tiles that beams begin with.
const LEVELS: u32 = 3;
/// Stands for "nowhere": behind every terrain, so that such a ray is not walked at all.
pub const NOWHERE: f32 = 2e9;

/// Where the rays of each tile may start.
#[derive(Clone, Debug, PartialEq)]
pub struct Beams {
    /// Tiles across and down.
    pub width: u32,
    pub height: u32,
    /// Distances, tile by tile in rows; [`NOWHERE`] where a tile sees only sky.
    pub starts: Vec<f32>,
    /// Pieces of beams that were looked at.
    pub steps: u64,
}

impl Beams {
    /// The beams of a scene's picture. A panorama's rays are in no pyramid: they start at the camera.
    pub fn new(scene: &Scene) -> Beams {
        let size = scene.options().size;
        let (width, height) = (size.0.div_ceil(TILE), size.1.div_ceil(TILE));
        let mut starts = vec![scene.uniform().near; (width * height) as usize];
        let Some(field) = Field::new(scene) else { return Beams { width, height, starts, steps: 0 } };
        let side = TILE << LEVELS;
        let steps = AtomicU64::new(0);
        let coarse = (0..size.1.div_ceil(side)).into_par_iter();
        let rows: Vec<Vec<(u32, u32, f32)>> = coarse
            .map(|row| {
                let mut found = Vec::new();
                let mut count = 0;
                for column in 0..size.0.div_ceil(side) {
                    let start = (f64::from(scene.uniform().near), field.reach / 16.0);
                    let tile = Tile { x: column * side, y: row * side, side };
                    field.refine(tile, size, start, &mut found, &mut count);
                }
                steps.fetch_add(count, Ordering::Relaxed);
                found
            })
            .collect();
        for (x, y, start) in rows.into_iter().flatten() {
            starts[(y * width + x) as usize] = start;
        }
        Beams { width, height, starts, steps: steps.into_inner() }
    }

    /// Where the ray through pixel position (x, y) may start; `near` outside of the picture.
    pub fn start(&self, x: f32, y: f32, near: f32) -> f32 {
        let tile = |p: f32, tiles: u32| {
            let at = (p / TILE as f32).floor();
            (at >= 0.0 && at < tiles as f32).then_some(at as u32)
        };
        match (tile(x, self.width), tile(y, self.height)) {
            (Some(i), Some(j)) => self.starts[(j * self.width + i) as usize].max(near),
            _ => near,
        }
    }

    /// Tiles that see only sky.
    pub fn empty(&self) -> usize {
        self.starts.iter().filter(|start| **start >= NOWHERE).count()
    }
}

/// Pixels from (x, y) on.
#[derive(Clone, Copy)]
struct Tile {
    x: u32,
    y: u32,
    side: u32,
}

/// What beams meet.
struct Field<'a> {
    camera: &'a Camera,
    pyramid: &'a Pyramid,
    samples: &'a Samples,
    width: usize,
    cells: [f64; 2],
    spacing: [f64; 2],
    /// From raw units to metres, exaggeration included.
    scale: f64,
    offset: f64,
    /// Half the least distance between samples: finer steps are left to the rays.
    fine: f64,
    /// Farther than any point of the field is from the camera.
    reach: f64,
}

/// The rays of a tile: points `origin + s * way`, s a distance divided by a length between two bounds.
struct Beam {
    origins: [DVec3; 4],
    ways: [DVec3; 4],
    lengths: [f64; 2],
    /// Width at a distance of 0, and what each metre adds.
    width: [f64; 2],
}

impl<'a> Field<'a> {
    fn new(scene: &'a Scene) -> Option<Field<'a>> {
        let (camera, terrain) = (scene.camera(), scene.terrain());
        if camera.projection == Projection::Panorama {
            return None;
        }
        let exaggerate = scene.options().exaggerate;
        let [width, height] = terrain.extent();
        let corner = |i: usize| {
            let pick = |bit: usize, lo: f64, hi: f64| if i >> bit & 1 == 0 { lo } else { hi };
            let z = pick(2, terrain.min, terrain.max) * exaggerate;
            DVec3::new(pick(0, 0.0, width), pick(1, 0.0, height), z)
        };
        let far = |p: DVec3| match camera.projection {
            Projection::Orthographic => (p - camera.eye).dot(camera.forward),
            _ => p.distance(camera.eye),
        };
        let reach = (0..8).map(|i| far(corner(i))).fold(0.0, f64::max);
        Some(Field {
            camera,
            pyramid: scene.pyramid(),
            samples: &terrain.samples,
            width: terrain.width as usize,
            cells: [f64::from(terrain.width - 1), f64::from(terrain.height - 1)],
            spacing: terrain.spacing,
            scale: terrain.scale * exaggerate,
            offset: terrain.offset * exaggerate,
            fine: 0.5 * terrain.spacing[0].min(terrain.spacing[1]),
            reach: reach * 1.000_01 + 1.0,
        })
    }

    fn refine(
        &self,
        tile: Tile,
        size: (u32, u32),
        (start, step): (f64, f64),
        found: &mut Vec<(u32, u32, f32)>,
        count: &mut u64,
    ) {
        if tile.x >= size.0 || tile.y >= size.1 {
            return;
        }
        let (stop, step) = match start > self.reach {
            true => (start, step),
            false => self.march(&self.beam(tile), start, step, count),
        };
        if tile.side == TILE {
            // Single precision rounds to the nearest; a ray must not start behind.
            let before = if stop > self.reach { NOWHERE } else { (stop * (1.0 - 1e-6)) as f32 };
            found.push((tile.x / TILE, tile.y / TILE, before));
            return;
        }
        let half = tile.side / 2;
        for (x, y) in [(0, 0), (half, 0), (0, half), (half, half)] {
            let part = Tile { x: tile.x + x, y: tile.y + y, side: half };
            self.refine(part, size, (stop, step), found, count);
        }
    }

    fn beam(&self, tile: Tile) -> Beam {
        let camera = self.camera;
        let [x, y] = [tile.x, tile.y].map(f64::from);
        let side = f64::from(tile.side);
        let corners = [(x, y), (x + side, y), (x, y + side), (x + side, y + side)];
        let offsets = corners
            .map(|(x, y)| (x - camera.middle[0]) * camera.across + (y - camera.middle[1]) * camera.down);
        let pixel = camera.pixel_width();
        let width = pixel.map(|w| w * side);
        if camera.projection == Projection::Orthographic {
            let origins = offsets.map(|offset| camera.eye + offset);
            return Beam { origins, ways: [camera.forward; 4], lengths: [1.0; 2], width };
        }
        let ways = offsets.map(|offset| camera.forward + offset);
        // The shortest way is that of the point nearest to the picture's middle.
        let nearest = |from: f64, middle: f64| middle.clamp(from, from + side) - middle;
        let least = camera.forward
            + nearest(x, camera.middle[0]) * camera.across
            + nearest(y, camera.middle[1]) * camera.down;
        let most = ways.iter().map(|way| way.length()).fold(0.0, f64::max);
        Beam { origins: [camera.eye; 4], ways, lengths: [least.length(), most], width }
    }

    /// How far all rays of a beam are clear, and the piece that was tried last.
    fn march(&self, beam: &Beam, start: f64, step: f64, count: &mut u64) -> (f64, f64) {
        let (mut at, mut step) = (start, step);
        while at <= self.reach {
            *count += 1;
            let least = (beam.width[0] + beam.width[1] * at).max(self.fine);
            if self.is_clear(beam, at, at + step) {
                at += step;
                step *= 2.0;
            } else if step > least {
                step *= 0.5;
            } else {
                break;
            }
        }
        (at, step.max(self.fine))
    }

    /// Whether no ray of the beam can meet a sample's height between two distances.
    fn is_clear(&self, beam: &Beam, from: f64, to: f64) -> bool {
        let ends = [from / beam.lengths[1], to / beam.lengths[0]];
        let points = ends
            .iter()
            .flat_map(|s| beam.origins.iter().zip(&beam.ways).map(move |(origin, way)| *origin + *s * *way));
        let none = (DVec3::splat(f64::INFINITY), DVec3::splat(f64::NEG_INFINITY));
        let (low, high) = points.fold(none, |(low, high), p| (low.min(p), high.max(p)));
        // Machines round their rays to single precision.
        let slack = 1e-6 * (low.abs().max(high.abs()).max_element() + to);
        match self.highest([low.x - slack, low.y - slack], [high.x + slack, high.y + slack]) {
            Some(top) => low.z - slack > top,
            None => true,
        }
    }

    /// The highest sample of the cells that a box of ground touches; none where there is none.
    fn highest(&self, low: [f64; 2], high: [f64; 2]) -> Option<f64> {
        let mut first = [0u32; 2];
        let mut last = [0u32; 2];
        for axis in 0..2 {
            let (a, b) = (low[axis] / self.spacing[axis] - 1e-3, high[axis] / self.spacing[axis] + 1e-3);
            if !(b >= 0.0 && a <= self.cells[axis]) {
                return None;
            }
            let most = self.cells[axis] - 1.0;
            first[axis] = a.floor().clamp(0.0, most) as u32;
            last[axis] = b.floor().clamp(0.0, most) as u32;
        }
        let apart = |k: u32| (0..2).all(|axis| (last[axis] >> k) - (first[axis] >> k) <= 1);
        let level = (0..self.pyramid.top()).find(|k| apart(*k)).unwrap_or(self.pyramid.top());
        let nodes = |axis: usize| first[axis] >> level..=last[axis] >> level;
        let raw = nodes(1)
            .flat_map(|j| nodes(0).map(move |i| (i, j)))
            .map(|(i, j)| if level == 0 { self.cell(i, j) } else { self.node(level, i, j) })
            .fold(VOID_F32, f32::max);
        (raw > VOID_F32).then(|| f64::from(raw) * self.scale + self.offset)
    }

    fn node(&self, level: u32, i: u32, j: u32) -> f32 {
        let shape = self.pyramid.levels[level as usize];
        let at = (shape.offset + j * shape.width + i) as usize;
        match &self.pyramid.bounds {
            Bounds::I16(data) => raw16(data[at]),
            Bounds::F32(data) => data[at],
        }
    }

    fn cell(&self, i: u32, j: u32) -> f32 {
        let at = j as usize * self.width + i as usize;
        let corners = [at, at + 1, at + self.width, at + self.width + 1];
        let sample = |at: usize| match self.samples {
            Samples::I16(data) => raw16(data[at]),
            Samples::F32(data) => data[at],
        };
        corners.into_iter().map(sample).fold(VOID_F32, f32::max)
    }
}

fn raw16(raw: i16) -> f32 {
    if raw == VOID_I16 { VOID_F32 } else { f32::from(raw) }
}

#[cfg(test)]
mod tests;
