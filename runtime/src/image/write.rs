//! Encoders of the picture formats.

use super::{Image, ImageError, npy, tiff};
use image::{ExtendedColorType, ImageEncoder, codecs};
use std::io::Cursor;
use std::path::Path;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    Png,
    Jpeg,
    Exr,
    Tiff,
    Npy,
}

const ENDINGS: &[(&str, Format)] = &[
    ("png", Format::Png),
    ("jpg", Format::Jpeg),
    ("jpeg", Format::Jpeg),
    ("exr", Format::Exr),
    ("tif", Format::Tiff),
    ("tiff", Format::Tiff),
    ("npy", Format::Npy),
];

const JPEG_QUALITY: u8 = 92;

impl Format {
    /// The format that a file's name asks for; worth asking before the picture is computed.
    pub fn of(file: &Path) -> Result<Format, ImageError> {
        let ending = file.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        let found = ENDINGS.iter().find(|(e, _)| *e == ending);
        found.map(|(_, format)| *format).ok_or_else(|| ImageError::UnknownEnding { file: file.to_owned() })
    }

    /// Whether components are kept as they are.
    pub fn holds_floats(self) -> bool {
        matches!(self, Format::Exr | Format::Tiff | Format::Npy)
    }
}

/// The file's bytes.
pub fn encode(image: &Image, format: Format) -> Result<Vec<u8>, ImageError> {
    let (width, height) = (image.width, image.height);
    let filled =
        (image.components == 2 && !matches!(format, Format::Npy | Format::Tiff)).then(|| with_blue(image));
    let image = filled.as_ref().unwrap_or(image);
    let mut bytes = Vec::new();
    match format {
        Format::Npy => bytes = npy::encode(image),
        Format::Tiff => bytes = tiff::encode(image, None)?,
        Format::Png => {
            let color = match image.components {
                1 => ExtendedColorType::L8,
                3 => ExtendedColorType::Rgb8,
                _ => ExtendedColorType::Rgba8,
            };
            let encoder = codecs::png::PngEncoder::new(&mut bytes);
            encoder.write_image(&eight_bit(&image.data), width, height, color)?;
        }
        Format::Jpeg => {
            let (data, color) = match image.components {
                1 => (select(image, &[0]), ExtendedColorType::L8),
                _ => (select(image, &[0, 1, 2]), ExtendedColorType::Rgb8),
            };
            let encoder = codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY);
            encoder.write_image(&eight_bit(&data), width, height, color)?;
        }
        Format::Exr => {
            // The encoder knows colours only.
            let (channels, color): (&[usize], _) = match image.components {
                1 => (&[0, 0, 0], ExtendedColorType::Rgb32F),
                3 => (&[0, 1, 2], ExtendedColorType::Rgb32F),
                _ => (&[0, 1, 2, 3], ExtendedColorType::Rgba32F),
            };
            let data = select(image, channels);
            let encoder = codecs::openexr::OpenExrEncoder::new(Cursor::new(&mut bytes));
            encoder.write_image(bytemuck::cast_slice(&data), width, height, color)?;
        }
    }
    Ok(bytes)
}

/// Two components are red and green; picture formats want blue too.
fn with_blue(image: &Image) -> Image {
    let data = image.data.chunks_exact(2).flat_map(|pixel| [pixel[0], pixel[1], 0.0]).collect();
    Image { components: 3, data, ..*image }
}

/// The named components of every pixel.
fn select(image: &Image, channels: &[usize]) -> Vec<f32> {
    let pixels = image.data.chunks_exact(image.components as usize);
    pixels.flat_map(|pixel| channels.iter().map(move |c| pixel[*c])).collect()
}

/// Four bytes a pixel, opaque where the picture has no alpha.
pub(super) fn eight_bit_rgba(image: &Image) -> Vec<u8> {
    let pixels = eight_bit(&image.data);
    let pixel = |p: &[u8]| match *p {
        [grey] => [grey, grey, grey, 255],
        [red, green] => [red, green, 0, 255],
        [red, green, blue] => [red, green, blue, 255],
        _ => [p[0], p[1], p[2], p[3]],
    };
    pixels.chunks_exact(image.components as usize).flat_map(pixel).collect()
}

/// Clamped to [0, 1] and rounded; what is not a number is black.
fn eight_bit(data: &[f32]) -> Vec<u8> {
    data.iter().map(|x| (x.clamp(0.0, 1.0) * 255.0).round() as u8).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gradient(components: u32) -> Image {
        let data = (0..6 * components).map(|i| i as f32 / 10.0 - 0.2).collect();
        Image::new(3, 2, components, data).unwrap()
    }

    #[test]
    fn png_is_clamped_and_kept_in_order() {
        for components in [1, 3, 4] {
            let image = gradient(components);
            let bytes = encode(&image, Format::Png).unwrap();
            let read = image::load_from_memory(&bytes).unwrap();
            assert_eq!((read.width(), read.height()), (3, 2));
            assert_eq!(u32::from(read.color().channel_count()), components);
            assert_eq!(read.as_bytes(), eight_bit(&image.data));
        }
        let two = image::load_from_memory(&encode(&gradient(2), Format::Png).unwrap()).unwrap();
        assert_eq!(two.as_bytes(), eight_bit(&with_blue(&gradient(2)).data));
        assert_eq!(eight_bit(&[-1.0, 0.5, 2.0, f32::NAN]), [0, 128, 255, 0]);
    }

    #[test]
    fn exr_keeps_the_numbers() {
        for components in 1..=4 {
            let image = gradient(components);
            let read = image::load_from_memory(&encode(&image, Format::Exr).unwrap()).unwrap().into_rgba32f();
            for (x, y, pixel) in read.enumerate_pixels() {
                assert_eq!(pixel[0], image.pixel(x, y)[0]);
            }
        }
    }

    #[test]
    fn jpeg_of_every_kind_can_be_read() {
        for components in 1..=4 {
            let bytes = encode(&gradient(components), Format::Jpeg).unwrap();
            assert_eq!(image::load_from_memory(&bytes).unwrap().width(), 3);
        }
    }

    #[test]
    fn the_ending_decides() {
        assert_eq!(Format::of(Path::new("a/b.PNG")).unwrap(), Format::Png);
        let error = Format::of(Path::new("a/b.gif")).unwrap_err().to_string();
        assert!(error.contains("a/b.gif") && error.contains(".png"), "{error}");
    }

    #[test]
    fn a_wrong_shape_is_refused() {
        assert!(Image::new(3, 2, 5, vec![0.0; 30]).is_err());
        assert!(Image::new(3, 2, 1, vec![0.0; 5]).is_err());
    }
}
