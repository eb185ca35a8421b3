//! A height field in memory.

use super::dem::{self, DemError, DemOptions};
use super::geotags::GeoKeys;
use std::path::Path;

/// The raw value of a missing 16-bit sample; below every valid one.
pub const VOID_I16: i16 = i16::MIN;
/// The raw value of a missing float sample; finite, because shading languages may assume that NaN never occurs.
pub const VOID_F32: f32 = f32::MIN;

/// Raw samples, rows from south to north, each from west to east.
#[derive(Clone, Debug, PartialEq)]
pub enum Samples {
    I16(Vec<i16>),
    F32(Vec<f32>),
}

impl Samples {
    pub fn len(&self) -> usize {
        match self {
            Samples::I16(data) => data.len(),
            Samples::F32(data) => data.len(),
        }
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The raw value, or none for a void.
    pub fn get(&self, index: usize) -> Option<f64> {
        match self {
            Samples::I16(data) => data.get(index).filter(|v| **v != VOID_I16).map(|v| f64::from(*v)),
            Samples::F32(data) => data.get(index).filter(|v| **v != VOID_F32).map(|v| f64::from(*v)),
        }
    }
}

/// Where the field lies on the Earth.
#[derive(Clone, Debug, PartialEq)]
pub struct Georeference {
    /// EPSG code of the coordinate reference system, where the file names one.
    pub epsg: Option<u32>,
    /// Degrees rather than metres.
    pub geographic: bool,
    /// Centre of the north-west sample in the reference system: easting or longitude, northing or latitude.
    pub north_west: [f64; 2],
    /// Distance of samples eastwards and southwards in the reference system, both positive.
    pub step: [f64; 2],
    /// The reference system as a GeoTIFF describes it.
    pub keys: Option<GeoKeys>,
}

impl std::fmt::Display for Georeference {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self.epsg {
            Some(code) => write!(f, "EPSG:{code}"),
            None if self.geographic => f.write_str("an unnamed geographic system"),
            None => f.write_str("an unnamed projected system"),
        }
    }
}

/// A height field of at least 2 x 2 samples.
#[derive(Clone, Debug)]
pub struct Terrain {
    /// Samples in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Metres between samples, eastwards and northwards.
    pub spacing: [f64; 2],
    pub samples: Samples,
    /// Height in metres is `raw * scale + offset`.
    pub scale: f64,
    pub offset: f64,
    /// Missing samples; rays pass through the cells that touch one.
    pub voids: usize,
    /// Lowest and highest height in metres; 0 where every sample is missing.
    pub min: f64,
    pub max: f64,
    pub crs: Option<Georeference>,
    /// The number that stands for a missing sample in the file, if it names one.
    pub nodata: Option<f64>,
    /// What the data was read from, such as `GeoTIFF int16`.
    pub format: String,
}

static BUILTIN: &[u8] = include_bytes!("../../../lang-examples/data/fuji.tif");

impl Terrain {
    /// Reads a DEM; the format follows from the name's ending and the content.
    pub fn open(path: impl AsRef<Path>, options: &DemOptions) -> Result<Terrain, DemError> {
        dem::open(path.as_ref(), options)
    }

    /// Mount Fuji, 512 x 512 samples (`lang-examples/data/README.md`).
    pub fn builtin() -> Terrain {
        Terrain::builtin_as(&DemOptions::default()).expect("the embedded file is read by a test")
    }

    /// The built-in field read as the options say.
    pub fn builtin_as(options: &DemOptions) -> Result<Terrain, DemError> {
        dem::read("the built-in field", BUILTIN, options)
    }

    /// A field of the given heights in metres, rows from south to north; what is not finite is a void.
    pub fn from_heights(
        width: u32,
        height: u32,
        spacing: [f64; 2],
        heights: Vec<f32>,
    ) -> Result<Terrain, DemError> {
        let mut data = heights;
        for value in &mut data {
            if !value.is_finite() {
                *value = VOID_F32;
            }
        }
        Terrain::new(
            "heights",
            width,
            height,
            spacing,
            Samples::F32(data),
            (1.0, 0.0),
            None,
            "heights float32",
        )
    }

    /// Checks the shape and takes stock of the samples.
    #[allow(clippy::too_many_arguments)]
    pub(super) fn new(
        file: &str,
        width: u32,
        height: u32,
        spacing: [f64; 2],
        samples: Samples,
        (scale, offset): (f64, f64),
        crs: Option<Georeference>,
        format: impl Into<String>,
    ) -> Result<Terrain, DemError> {
        dem::check_shape(file, u64::from(width), u64::from(height))?;
        dem::check_spacing(file, spacing)?;
        if samples.len() as u64 != u64::from(width) * u64::from(height) {
            return Err(DemError::lying(
                file,
                format!("it has {} samples where {width} x {height} are declared", samples.len()),
            ));
        }
        let (mut lo, mut hi, mut valid) = (f64::INFINITY, f64::NEG_INFINITY, 0usize);
        for raw in (0..samples.len()).filter_map(|i| samples.get(i)) {
            lo = lo.min(raw);
            hi = hi.max(raw);
            valid += 1;
        }
        if valid == 0 {
            (lo, hi) = (0.0, 0.0);
        }
        Ok(Terrain {
            width,
            height,
            spacing,
            voids: samples.len() - valid,
            min: lo * scale + offset,
            max: hi * scale + offset,
            samples,
            scale,
            offset,
            crs,
            nodata: None,
            format: format.into(),
        })
    }

    /// The field as it lies below the horizon of a point over (x, y): the Earth's curvature lets a height at distance d
    /// fall by d^2 (1 - k) / (2 R), where the air bends sight by the part k of the curvature, about 0.13. Between samples
    /// the fall is that of the surface, which is off by less than (dx^2 + dy^2) / (8 R): 0.04 mm for samples 30 m apart.
    pub fn curved(&self, [x, y]: [f64; 2], k: f64) -> Terrain {
        const RADIUS: f64 = 6_371_000.0;
        let fall = (1.0 - k) / (2.0 * RADIUS);
        let height = |index: usize| {
            let (c, r) = (index % self.width as usize, index / self.width as usize);
            let (dx, dy) = (c as f64 * self.spacing[0] - x, r as f64 * self.spacing[1] - y);
            let z = self.samples.get(index)? * self.scale + self.offset;
            Some(z - (dx * dx + dy * dy) * fall)
        };
        let (mut min, mut max) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut data = Vec::with_capacity(self.samples.len());
        for index in 0..self.samples.len() {
            let z = height(index).map(|z| z as f32);
            if let Some(z) = z {
                (min, max) = (min.min(f64::from(z)), max.max(f64::from(z)));
            }
            data.push(z.unwrap_or(VOID_F32));
        }
        if min > max {
            (min, max) = (0.0, 0.0);
        }
        let samples = Samples::F32(data);
        Terrain { samples, scale: 1.0, offset: 0.0, min, max, ..self.clone() }
    }

    /// Height in metres of column c, row r from the south; none for a void or outside.
    pub fn sample(&self, c: u32, r: u32) -> Option<f64> {
        if c >= self.width || r >= self.height {
            return None;
        }
        let index = r as usize * self.width as usize + c as usize;
        Some(self.samples.get(index)? * self.scale + self.offset)
    }

    /// Size in metres, eastwards and northwards.
    pub fn extent(&self) -> [f64; 2] {
        [f64::from(self.width - 1) * self.spacing[0], f64::from(self.height - 1) * self.spacing[1]]
    }

    /// Fills every void by the mean of its neighbours, ring after ring from the rim of the hole inwards.
    pub fn fill_voids(&mut self) {
        if self.voids == 0 || self.voids == self.samples.len() {
            return;
        }
        let (w, h) = (self.width as i64, self.height as i64);
        let mut open: Vec<usize> =
            (0..self.samples.len()).filter(|i| self.samples.get(*i).is_none()).collect();
        while !open.is_empty() {
            let mut filled = Vec::new();
            for &index in &open {
                let (c, r) = (index as i64 % w, index as i64 / w);
                let around = (-1..=1).flat_map(|j| (-1..=1).map(move |i| (c + i, r + j)));
                let known: Vec<f64> = around
                    .filter(|(i, j)| (0..w).contains(i) && (0..h).contains(j))
                    .filter_map(|(i, j)| self.samples.get((j * w + i) as usize))
                    .collect();
                if !known.is_empty() {
                    filled.push((index, known.iter().sum::<f64>() / known.len() as f64));
                }
            }
            for (index, raw) in filled {
                match &mut self.samples {
                    Samples::I16(data) => data[index] = raw.round() as i16,
                    Samples::F32(data) => data[index] = raw as f32,
                }
            }
            open.retain(|index| self.samples.get(*index).is_none());
        }
        self.voids = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn infinities_and_nan_are_voids() {
        let heights = vec![1.0, f32::NAN, 3.0, f32::INFINITY, 5.0, f32::NEG_INFINITY];
        let terrain = Terrain::from_heights(3, 2, [1.0, 1.0], heights).unwrap();
        assert_eq!((terrain.voids, terrain.min, terrain.max), (3, 1.0, 5.0));
        assert_eq!(terrain.sample(1, 0), None);
        assert_eq!(terrain.sample(1, 1), Some(5.0));
    }

    #[test]
    fn too_small_a_field_is_refused() {
        for (w, h) in [(1, 1), (1, 5), (5, 1), (0, 0)] {
            let error = Terrain::from_heights(w, h, [1.0, 1.0], vec![0.0; (w * h) as usize]).unwrap_err();
            assert!(error.to_string().contains("2 x 2"), "{error}");
        }
    }

    #[test]
    fn far_samples_fall_and_holes_stay() {
        let mut heights = vec![100.0; 101 * 2];
        heights[7] = f32::NAN;
        let field = Terrain::from_heights(101, 2, [1000.0, 1.0], heights).unwrap();
        let curved = field.curved([0.0, 0.0], 0.0);
        assert_eq!((curved.sample(0, 0), curved.sample(7, 0)), (Some(100.0), None));
        // 100 km: 785 m without the air.
        let fall = |t: &Terrain| 100.0 - t.sample(100, 0).unwrap();
        assert!((fall(&curved) - 784.8).abs() < 0.1, "{}", fall(&curved));
        assert!((fall(&field.curved([0.0, 0.0], 0.13)) - 0.87 * 784.8).abs() < 0.1);
        assert!((curved.min - curved.sample(100, 1).unwrap()).abs() < 1e-6);
    }

    #[test]
    fn filling_leaves_no_void() {
        let mut heights = vec![7.0; 25];
        heights[6..19].fill(f32::NAN);
        let mut terrain = Terrain::from_heights(5, 5, [1.0, 1.0], heights).unwrap();
        terrain.fill_voids();
        assert_eq!(terrain.voids, 0);
        assert!((0..25).all(|i| terrain.samples.get(i) == Some(7.0)));
    }

    #[test]
    fn the_builtin_field_is_fuji() {
        let terrain = Terrain::builtin();
        assert_eq!((terrain.width, terrain.height, terrain.voids), (512, 512, 0));
        assert!(terrain.max > 3700.0 && terrain.max < 3777.0, "{}", terrain.max);
        assert!(matches!(terrain.samples, Samples::I16(_)));
        assert!((terrain.spacing[1] - 61.6).abs() < 0.3, "{:?}", terrain.spacing);
    }
}
