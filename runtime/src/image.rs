//! Pictures: rows from top to bottom of 1 to 4 floats a pixel, written by the file name's ending, and measures of how
//! two of them differ.
//!
//! A program's colours are display colours: PNG and JPEG take them as they are, clamped to [0, 1], with no tone mapping
//! and no change of encoding. EXR, TIFF and NPY keep the numbers.

mod compare;
mod film;
mod flip;
mod npy;
mod tiff;
mod write;

pub use compare::{Difference, compare};
pub use film::{Film, FilmFormat};
pub use flip::flip;
pub use write::{Format, encode};

use crate::terrain::geotags::GeoTags;
use std::path::{Path, PathBuf};

#[derive(Debug, thiserror::Error)]
pub enum ImageError {
    #[error("cannot write {}: the ending names no picture format; use .png, .jpg, .exr, .tif or .npy (.apng and .gif are films, for --frames)", file.display())]
    UnknownEnding { file: PathBuf },
    #[error("cannot write {}: {source}", file.display())]
    Unwritable { file: PathBuf, source: std::io::Error },
    #[error("cannot encode the picture: {0}")]
    Encoding(#[from] image::ImageError),
    #[error("cannot encode the picture: {0}")]
    Tiff(String),
    #[error("cannot encode the film: {0}")]
    Film(String),
    #[error("a picture of {width} x {height} pixels and {components} components does not have {len} numbers")]
    Shape { width: u32, height: u32, components: u32, len: usize },
}

/// Floats of one picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    pub width: u32,
    pub height: u32,
    /// Floats a pixel: grey, grey with alpha, RGB or RGBA.
    pub components: u32,
    /// The first row is the top one.
    pub data: Vec<f32>,
}

impl Image {
    pub fn new(width: u32, height: u32, components: u32, data: Vec<f32>) -> Result<Image, ImageError> {
        let len = data.len();
        let pixels = u64::from(width) * u64::from(height);
        let fits = (1..=4).contains(&components) && pixels * u64::from(components) == len as u64;
        if !fits || pixels == 0 {
            return Err(ImageError::Shape { width, height, components, len });
        }
        Ok(Image { width, height, components, data })
    }

    /// The components of a pixel.
    pub fn pixel(&self, x: u32, y: u32) -> &[f32] {
        let n = self.components as usize;
        let at = (y as usize * self.width as usize + x as usize) * n;
        &self.data[at..at + n]
    }

    /// Four bytes a pixel, as a PNG of the picture has them; opaque where it has no alpha.
    pub fn rgba8(&self) -> Vec<u8> {
        write::eight_bit_rgba(self)
    }

    /// Writes the picture in the format that the name's ending names.
    pub fn save(&self, file: impl AsRef<Path>) -> Result<(), ImageError> {
        self.save_with(file.as_ref(), None)
    }

    /// As [`Image::save`]; a TIFF gets these tags.
    pub(crate) fn save_with(&self, file: &Path, tags: Option<&GeoTags>) -> Result<(), ImageError> {
        let bytes = match Format::of(file)? {
            Format::Tiff => tiff::encode(self, tags)?,
            format => encode(self, format)?,
        };
        std::fs::write(file, bytes).map_err(|source| ImageError::Unwritable { file: file.to_owned(), source })
    }
}
