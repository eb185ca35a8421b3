//! Data layers over the field: rasters that a host binds, and what baked functions were evaluated to. A layer is
//! read between its texels' centres bilinearly; beyond the outermost ones the nearest counts.
//!
//! Twin of `shaders/terrain/rasters.wgsl`.

mod slope;

use super::field::Terrain;
use super::layout::SceneUniform;
use super::raster::{Raster, Texels};
use ghyll_compiler::intrinsics::Reading;
use std::sync::Arc;

/// Words of a slot's record.
pub(crate) const RECORD: usize = 8;
/// A product this near to a whole number, in units of itself, is that number.
const ROUNDING: f32 = 2.384_185_8e-7;

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlaceError {
    #[error("its data is in {raster}, but the field is in {field}; reproject one of them")]
    OtherSystem { raster: String, field: String },
    #[error("its data lies elsewhere and does not overlap the field; cut it from the same area")]
    Elsewhere,
}

/// A raster with its place: column and row are `position * scale + shift`, rows from north to south.
#[derive(Clone, Debug)]
pub struct Layer {
    raster: Arc<Raster>,
    scale: [f64; 2],
    shift: [f64; 2],
}

impl Layer {
    /// Puts a raster over the field: by georeference where both have one, else stretched so that its outermost
    /// texels' centres lie on the field's rim.
    pub fn placed(raster: Arc<Raster>, terrain: &Terrain) -> Result<Layer, PlaceError> {
        let [east, north] = terrain.extent();
        let most = [f64::from(raster.width - 1), f64::from(raster.height - 1)];
        let (Some(there), Some(here)) = (&raster.place, &terrain.crs) else {
            let (scale, shift) = ([most[0] / east, -most[1] / north], [0.0, most[1]]);
            return Ok(Layer { raster, scale, shift });
        };
        if (there.epsg, there.geographic) != (here.epsg, here.geographic) {
            let (raster, field) = (there.to_string(), here.to_string());
            return Err(PlaceError::OtherSystem { raster, field });
        }
        let scale = [
            here.step[0] / (terrain.spacing[0] * there.step[0]),
            -here.step[1] / (terrain.spacing[1] * there.step[1]),
        ];
        let south = here.north_west[1] - f64::from(terrain.height - 1) * here.step[1];
        let shift = [
            (here.north_west[0] - there.north_west[0]) / there.step[0],
            (there.north_west[1] - south) / there.step[1],
        ];
        let far = [shift[0] + scale[0] * east, shift[1] + scale[1] * north];
        let apart = |axis: usize| {
            let (lo, hi) = (shift[axis].min(far[axis]), shift[axis].max(far[axis]));
            hi < -0.5 || lo > most[axis] + 0.5
        };
        if apart(0) || apart(1) {
            return Err(PlaceError::Elsewhere);
        }
        Ok(Layer { raster, scale, shift })
    }

    /// One texel for each sample of the field, with the arithmetic that the shaders use for it.
    pub fn of_samples(raster: Arc<Raster>, scene: &SceneUniform) -> Layer {
        let [x, y] = scene.inverse_spacing.map(f64::from);
        Layer { raster, scale: [x, -y], shift: [0.0, f64::from(scene.size[1] - 1)] }
    }

    pub fn raster(&self) -> &Arc<Raster> {
        &self.raster
    }

    /// Column (axis 0) or row (axis 1) of a position in metres.
    fn unbounded_f32(&self, x: f32, axis: usize) -> f32 {
        let product = x * self.scale[axis] as f32;
        let whole = product.round_ties_even();
        let near = (product - whole).abs() <= product.abs() * ROUNDING;
        (if near { whole } else { product }) + self.shift[axis] as f32
    }

    /// Components at a position in metres, in single precision.
    fn sample_f32(&self, x: f32, y: f32, out: &mut [u32]) {
        let raster = &self.raster;
        let grid =
            |x: f32, axis: usize, size: u32| self.unbounded_f32(x, axis).max(0.0).min((size - 1) as f32);
        let (gx, gy) = (grid(x, 0, raster.width), grid(y, 1, raster.height));
        let (i, j) = ((gx as u32).min(raster.width - 1), (gy as u32).min(raster.height - 1));
        let (u, v) = (gx - i as f32, gy - j as f32);
        let between = |a: f32, b: f32, t: f32| if t == 0.0 { a } else { a * (1.0 - t) + b * t };
        for (c, word) in (0..raster.components).zip(out) {
            let [nw, ne, sw, se] = raster.around(i, j, c);
            *word = between(between(nw, ne, u), between(sw, se, u), v).to_bits();
        }
    }

    /// The same in double precision.
    fn sample_f64(&self, x: f64, y: f64, out: &mut [f64]) {
        let raster = &self.raster;
        let grid = |x: f64, axis: usize, size: u32| {
            (x * self.scale[axis] + self.shift[axis]).max(0.0).min(f64::from(size - 1))
        };
        let (gx, gy) = (grid(x, 0, raster.width), grid(y, 1, raster.height));
        let (i, j) = (gx as u32, gy as u32);
        let (u, v) = (gx - f64::from(i), gy - f64::from(j));
        let between = |a: f64, b: f64, t: f64| if t == 0.0 { a } else { a * (1.0 - t) + b * t };
        for (c, value) in (0..raster.components).zip(out) {
            let [nw, ne, sw, se] = raster.around(i, j, c).map(f64::from);
            *value = between(between(nw, ne, u), between(sw, se, u), v);
        }
    }

    /// The record that shaders read, for texels that begin at word `first`.
    fn record(&self, first: u32) -> [u32; RECORD] {
        let bits = |v: [f64; 2]| v.map(|x| (x as f32).to_bits());
        let ([sx, sy], [hx, hy]) = (bits(self.scale), bits(self.shift));
        let bytes = u32::from(matches!(self.raster.texels, Texels::Bytes(_)));
        [first, self.raster.width, self.raster.height, bytes, sx, sy, hx, hy]
    }
}

/// The layers of a program by slot; what it does not reach is not there.
#[derive(Clone, Debug, Default)]
pub struct Layers(Vec<Option<Layer>>);

impl Layers {
    pub fn is_empty(&self) -> bool {
        self.0.iter().all(Option::is_none)
    }

    pub fn set(&mut self, slot: u32, layer: Layer) {
        let slot = slot as usize;
        if self.0.len() <= slot {
            self.0.resize(slot + 1, None);
        }
        self.0[slot] = Some(layer);
    }

    pub fn get(&self, slot: u32) -> Option<&Layer> {
        self.0.get(slot as usize)?.as_ref()
    }

    /// Results of the intrinsic for a position, 0 where the slot is empty: what a program does not need may be read
    /// all the same by an evaluator that does not look ahead.
    pub fn read_f32(&self, reading: Reading, slot: u32, x: f32, y: f32, out: &mut [u32]) {
        match (self.get(slot), reading) {
            (Some(layer), Reading::Value) => layer.sample_f32(x, y, out),
            (Some(layer), Reading::Gradient) => layer.gradient_f32(x, y, out),
            (Some(layer), Reading::Twist) => layer.twist_f32(x, y, out),
            (None, _) => out.fill(0),
        }
    }

    pub fn read_f64(&self, reading: Reading, slot: u32, x: f64, y: f64, out: &mut [f64]) {
        match (self.get(slot), reading) {
            (Some(layer), Reading::Value) => layer.sample_f64(x, y, out),
            (Some(layer), Reading::Gradient) => layer.gradient_f64(x, y, out),
            (Some(layer), Reading::Twist) => layer.twist_f64(x, y, out),
            (None, _) => out.fill(0.0),
        }
    }

    /// Words that all records and texels take.
    pub fn size(&self) -> u64 {
        let texels = self.0.iter().flatten().map(|layer| layer.raster.words());
        (self.0.len() * RECORD) as u64 + texels.sum::<u64>()
    }

    /// Word at which a slot's texels begin.
    pub fn first(&self, slot: u32) -> u64 {
        let before = self.0.iter().take(slot as usize).flatten().map(|layer| layer.raster.words());
        (self.0.len() * RECORD) as u64 + before.sum::<u64>()
    }

    /// Records of all slots.
    pub fn records(&self) -> Vec<u32> {
        let record = |(slot, layer): (usize, &Option<Layer>)| match layer {
            Some(layer) => layer.record(self.first(slot as u32) as u32),
            None => [0; RECORD],
        };
        self.0.iter().enumerate().flat_map(record).collect()
    }

    /// Slots with their layers.
    pub fn iter(&self) -> impl Iterator<Item = (u32, &Layer)> {
        self.0.iter().enumerate().filter_map(|(slot, layer)| Some((slot as u32, layer.as_ref()?)))
    }
}
