//! Rasters from files: what a picture holds, what a georeferenced file holds, what NumPy wrote. Every other format is
//! one of elevation data, read by its own reader.

use super::{Raster, Texels};
use crate::terrain::dem::{self, DemError, DemOptions, Values, geotiff, npy};
use crate::terrain::field::{Georeference, Terrain};
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader};
use std::io::Cursor;

/// Formats that the `image` crate reads.
const PICTURES: &[ImageFormat] = &[ImageFormat::Png, ImageFormat::Jpeg, ImageFormat::OpenExr];

pub(super) fn read(file: &str, bytes: &[u8]) -> Result<Raster, DemError> {
    if image::guess_format(bytes).is_ok_and(|format| PICTURES.contains(&format)) {
        picture(file, bytes)
    } else if geotiff::MAGIC.iter().any(|magic| bytes.starts_with(magic)) {
        tiff(file, bytes)
    } else if bytes.starts_with(npy::MAGIC) {
        array(file, bytes)
    } else {
        let options = DemOptions { spacing: Some([1.0, 1.0]), ..DemOptions::default() };
        heights(file, &dem::read(file, bytes, &options)?)
    }
}

fn picture(file: &str, bytes: &[u8]) -> Result<Raster, DemError> {
    let bad = |e: image::ImageError| DemError::damaged(file, "image", &e);
    let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format();
    let reader = reader.map_err(|e| DemError::damaged(file, "image", &e))?;
    let decoder = reader.into_decoder().map_err(bad)?;
    let (width, height) = decoder.dimensions();
    let texel = u64::from(decoder.color_type().bytes_per_pixel());
    dem::check_held(file, (width.into(), height.into()), texel, bytes.len() as u64, true)?;
    let image = DynamicImage::from_decoder(decoder).map_err(bad)?;
    let components = u32::from(image.color().channel_count());
    let deep = |data: Vec<u16>| data.into_iter().map(|v| f32::from(v) / 65535.0).collect();
    let floats: Vec<f32> = match image {
        DynamicImage::ImageLuma16(data) => deep(data.into_raw()),
        DynamicImage::ImageLumaA16(data) => deep(data.into_raw()),
        DynamicImage::ImageRgb16(data) => deep(data.into_raw()),
        DynamicImage::ImageRgba16(data) => deep(data.into_raw()),
        DynamicImage::ImageRgb32F(data) => data.into_raw(),
        DynamicImage::ImageRgba32F(data) => data.into_raw(),
        shallow => {
            let texels = Texels::Bytes(shallow.into_bytes());
            return Raster::new(file, width, height, components, texels, None, 0);
        }
    };
    Numbers { width, height, components, place: None, nodata: None }.floats(file, floats)
}

fn tiff(file: &str, bytes: &[u8]) -> Result<Raster, DemError> {
    let decoded = geotiff::decode(file, bytes)?;
    let (width, height, components) = (decoded.width, decoded.height, decoded.bands);
    let place = decoded.place.as_ref().and_then(|place| place.georeference(height));
    let numbers = Numbers { width, height, components, place, nodata: decoded.nodata };
    let row = width as usize * components as usize;
    let turned = decoded.place.is_some_and(|place| place.south_first);
    match decoded.values {
        geotiff::Samples::Bytes(data) => {
            numbers.bytes(file, if turned { upside_down(&data, row) } else { data })
        }
        geotiff::Samples::Numbers(values) => {
            let data = singles(values);
            numbers.floats(file, if turned { upside_down(&data, row) } else { data })
        }
    }
}

fn array(file: &str, bytes: &[u8]) -> Result<Raster, DemError> {
    let array = npy::parse(file, bytes)?;
    let (height, width, components) = match *array.shape.as_slice() {
        [height, width] => (height, width, 1),
        [height, width, components @ 1..=4] => (height, width, components),
        _ => {
            let mend = "its shape must be (rows, columns) or (rows, columns, 1 to 4)";
            return Err(DemError::unsupported(file, format!("its shape is {:?}", array.shape), mend));
        }
    };
    dem::check_held(file, (width, height), array.sample()? * components, array.data.len() as u64, false)?;
    array.check_end()?;
    let count = (width * height * components) as usize;
    let (width, height, components) = (width as u32, height as u32, components as u32);
    let numbers = Numbers { width, height, components, place: None, nodata: None };
    match array.is_bytes() {
        true => numbers.bytes(file, array.data[..count].to_vec()),
        false => numbers.floats(file, singles(array.values(count)?)),
    }
}

/// Elevation data as a layer of heights in metres.
fn heights(file: &str, terrain: &Terrain) -> Result<Raster, DemError> {
    let rows = (0..terrain.height).rev();
    let texels = rows.flat_map(|r| (0..terrain.width).map(move |c| terrain.sample(c, r)));
    let data = texels.map(|z| z.map_or(f32::NAN, |z| z as f32)).collect();
    let place = terrain.crs.clone();
    Numbers { width: terrain.width, height: terrain.height, components: 1, place, nodata: None }
        .floats(file, data)
}

/// What is known of a raster before its numbers are stored.
struct Numbers {
    width: u32,
    height: u32,
    components: u32,
    place: Option<Georeference>,
    nodata: Option<f64>,
}

impl Numbers {
    fn bytes(self, file: &str, mut data: Vec<u8>) -> Result<Raster, DemError> {
        let mut missing = 0;
        if let Some(nodata) = self.nodata {
            for value in data.iter_mut().filter(|v| f64::from(**v) == nodata) {
                *value = 0;
                missing += 1;
            }
        }
        self.raster(file, Texels::Bytes(data), missing)
    }

    fn floats(self, file: &str, mut data: Vec<f32>) -> Result<Raster, DemError> {
        let nodata = self.nodata.map(|n| n as f32);
        let mut missing = 0;
        for value in data.iter_mut().filter(|v| !v.is_finite() || Some(**v) == nodata) {
            *value = 0.0;
            missing += 1;
        }
        self.raster(file, Texels::Floats(data), missing)
    }

    fn raster(self, file: &str, texels: Texels, missing: usize) -> Result<Raster, DemError> {
        Raster::new(file, self.width, self.height, self.components, texels, self.place, missing)
    }
}

fn singles(values: Values) -> Vec<f32> {
    match values {
        Values::I16(data) => data.into_iter().map(f32::from).collect(),
        Values::I32(data) => data.into_iter().map(|v| v as f32).collect(),
        Values::U32(data) => data.into_iter().map(|v| v as f32).collect(),
        Values::I64(data) => data.into_iter().map(|v| v as f32).collect(),
        Values::U16(data) => data.into_iter().map(f32::from).collect(),
        Values::F32(data) => data,
        Values::F64(data) => data.into_iter().map(|v| v as f32).collect(),
    }
}

fn upside_down<T: Copy>(data: &[T], row: usize) -> Vec<T> {
    data.chunks_exact(row).rev().flatten().copied().collect()
}

#[cfg(test)]
mod tests;
