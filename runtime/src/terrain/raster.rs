//! Rasters in memory: 1 to 4 numbers for each texel, rows from north to south.

mod read;

use super::dem::DemError;
use super::field::Georeference;
use std::path::Path;

/// Components of all texels, one texel after the other.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// Fractions of 255.
    Bytes(Vec<u8>),
    /// Finite unless a program has computed them.
    Floats(Vec<f32>),
    /// On the device only.
    Reserved,
}

#[derive(Clone, Debug)]
pub struct Raster {
    pub width: u32,
    pub height: u32,
    pub components: u32,
    pub texels: Texels,
    /// Where it lies, if its file says so.
    pub place: Option<Georeference>,
    /// Components that were missing (nodata, NaN, infinite) and are 0 now.
    pub missing: usize,
}

impl Raster {
    /// Reads a raster: GeoTIFF, PNG, JPEG, EXR or NPY of up to 4 channels, or any elevation format.
    ///
    /// 8-bit samples, and the 16-bit ones of PNG, become fractions of their greatest value; no colour encoding is undone.
    /// All other numbers stay as they are.
    pub fn open(path: impl AsRef<Path>) -> Result<Raster, DemError> {
        let path = path.as_ref();
        let bytes = super::dem::bytes_of(path)?;
        read::read(&path.display().to_string(), &bytes)
    }

    /// Reads a raster from memory; `file` names it in messages and tells its format by its ending.
    pub fn read(file: &str, bytes: &[u8]) -> Result<Raster, DemError> {
        read::read(file, bytes)
    }

    /// A raster of the given numbers, rows from north to south, components of a texel side by side.
    pub fn from_floats(
        width: u32,
        height: u32,
        components: u32,
        mut data: Vec<f32>,
    ) -> Result<Raster, DemError> {
        let mut missing = 0;
        for value in data.iter_mut().filter(|v| !v.is_finite()) {
            *value = 0.0;
            missing += 1;
        }
        Raster::new("the raster", width, height, components, Texels::Floats(data), None, missing)
    }

    fn new(
        file: &str,
        width: u32,
        height: u32,
        components: u32,
        texels: Texels,
        place: Option<Georeference>,
        missing: usize,
    ) -> Result<Raster, DemError> {
        let held = match &texels {
            Texels::Bytes(data) => data.len(),
            Texels::Floats(data) => data.len(),
            Texels::Reserved => 0,
        } as u64;
        super::dem::check_size(file, u64::from(width), u64::from(height))?;
        if !(1..=4).contains(&components) {
            let what = format!("it has {components} channels");
            return Err(DemError::unsupported(file, what, "a raster has 1 to 4; pick some of them"));
        }
        if held != u64::from(width) * u64::from(height) * u64::from(components) {
            let what = format!("{held} numbers are not {width} x {height} texels of {components}");
            return Err(DemError::lying(file, what));
        }
        Ok(Raster { width, height, components, texels, place, missing })
    }

    /// What a program has computed, as it is.
    pub fn computed(width: u32, height: u32, components: u32, texels: Texels) -> Raster {
        Raster { width, height, components, texels, place: None, missing: 0 }
    }

    /// Words that the texels take on the device.
    pub fn words(&self) -> u64 {
        let numbers = u64::from(self.width) * u64::from(self.height) * u64::from(self.components);
        match self.texels {
            Texels::Bytes(_) => numbers.div_ceil(4),
            Texels::Floats(_) | Texels::Reserved => numbers,
        }
    }

    /// A component of column i, row j and of its neighbours to the east, south and south-east, as (nw, ne, sw, se).
    pub(super) fn around(&self, i: u32, j: u32, component: u32) -> [f32; 4] {
        let (east, south) = ((i + 1).min(self.width - 1), (j + 1).min(self.height - 1));
        [(i, j), (east, j), (i, south), (east, south)].map(|(i, j)| self.number(i, j, component))
    }

    fn number(&self, i: u32, j: u32, component: u32) -> f32 {
        let texel = j as usize * self.width as usize + i as usize;
        let at = texel * self.components as usize + component as usize;
        match &self.texels {
            Texels::Bytes(data) => f32::from(data[at]) / 255.0,
            Texels::Floats(data) => data[at],
            Texels::Reserved => 0.0,
        }
    }
}
