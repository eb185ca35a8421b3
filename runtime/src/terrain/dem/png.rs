//! PNG: grey images, whose range `--heights` gives, and the RGB packings of map tiles.

use super::grid::{Grid, Values};
use super::{DemError, DemOptions, Encoding, check_claim, grey_range};
use crate::terrain::field::Terrain;
use image::{ColorType, DynamicImage, ImageDecoder, codecs::png::PngDecoder};
use std::io::Cursor;

pub(super) fn read(file: &str, bytes: &[u8], options: &DemOptions) -> Result<Terrain, DemError> {
    let bad = |e: image::ImageError| DemError::damaged(file, "PNG", &e);
    let decoder = PngDecoder::new(Cursor::new(bytes)).map_err(bad)?;
    let (width, height) = decoder.dimensions();
    let color = decoder.color_type();
    let pixel = u64::from(color.bytes_per_pixel());
    check_claim(file, (width.into(), height.into()), pixel, bytes.len() as u64, true)?;
    let grey = matches!(color, ColorType::L8 | ColorType::L16 | ColorType::La8 | ColorType::La16);
    let encoding = match options.encoding {
        Some(encoding) => encoding,
        None if grey => Encoding::Grey,
        None => {
            let mend = "say how it holds heights: --encoding grey, terrarium or terrain-rgb";
            return Err(DemError::unsupported(file, "it is a colour image", mend));
        }
    };
    if grey && encoding != Encoding::Grey {
        let mend = "leave --encoding out, or give a colour image";
        return Err(DemError::unsupported(file, "it is a grey image, which packs no colours", mend));
    }
    let image = DynamicImage::from_decoder(decoder).map_err(bad)?;
    let (values, scale, offset, kind) = match encoding {
        Encoding::Grey => {
            let deep =
                matches!(color, ColorType::L16 | ColorType::La16 | ColorType::Rgb16 | ColorType::Rgba16);
            let (values, white) = if deep {
                (image.into_luma16().into_raw(), 65535.0)
            } else {
                (image.into_luma8().into_raw().into_iter().map(u16::from).collect(), 255.0)
            };
            let (scale, offset) = grey_range(file, options, white)?;
            (Values::U16(values), scale, offset, "grey")
        }
        Encoding::Terrarium => (unpack(image, 32768 * 256), 1.0 / 256.0, 0.0, "terrarium"),
        Encoding::TerrainRgb => (unpack(image, 100_000), 0.1, 0.0, "terrain-rgb"),
    };
    Grid {
        width,
        height,
        values,
        nodata: match encoding {
            Encoding::Grey => options.nodata,
            // Of packed heights the metres are given.
            Encoding::Terrarium | Encoding::TerrainRgb => options.nodata.map(|z| (z / scale).round()),
        },
        scale,
        offset,
        spacing: options.spacing.unwrap_or([1.0, 1.0]),
        crs: None,
        format: format!("PNG {kind}"),
        south_first: false,
    }
    .terrain(file)
}

/// The 24 bits of each pixel, less those of height 0.
fn unpack(image: DynamicImage, zero: i32) -> Values {
    let rgb = image.into_rgb8().into_raw();
    let packed = |p: &[u8]| i32::from(p[0]) << 16 | i32::from(p[1]) << 8 | i32::from(p[2]);
    Values::I32(rgb.chunks_exact(3).map(|p| packed(p) - zero).collect())
}
