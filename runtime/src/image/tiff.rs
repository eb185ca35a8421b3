//! Float TIFF: 32 bits, components as bands, deflated; with the tags of a GeoTIFF if there are any.

use super::{Image, ImageError};
use crate::terrain::geotags::GeoTags;
use std::io::Cursor;
use tiff::TiffResult;
use tiff::encoder::{Compression, DeflateLevel, TiffEncoder, TiffKind, colortype::Gray32Float};
use tiff::tags::{ExtraSamples, Tag};

const GDAL_NODATA: Tag = Tag::Unknown(42113);
/// Larger files need 64-bit offsets; the compressed ones may be a little larger than the numbers.
const MOST_CLASSIC: u64 = 3_500_000_000;

pub(super) fn encode(image: &Image, tags: Option<&GeoTags>) -> Result<Vec<u8>, ImageError> {
    let mut bytes = Cursor::new(Vec::new());
    let compression = Compression::Deflate(DeflateLevel::default());
    let written = if 4 * image.data.len() as u64 > MOST_CLASSIC {
        TiffEncoder::new_big(&mut bytes)
            .and_then(|tiff| write(tiff.with_compression(compression), image, tags))
    } else {
        TiffEncoder::new(&mut bytes).and_then(|tiff| write(tiff.with_compression(compression), image, tags))
    };
    written.map_err(|e| ImageError::Tiff(e.to_string()))?;
    Ok(bytes.into_inner())
}

fn write<K: TiffKind>(
    mut tiff: TiffEncoder<&mut Cursor<Vec<u8>>, K>,
    image: &Image,
    tags: Option<&GeoTags>,
) -> TiffResult<()> {
    let mut picture = tiff.new_image::<Gray32Float>(image.width, image.height)?;
    let further = vec![ExtraSamples::Unspecified; image.components as usize - 1];
    if !further.is_empty() {
        picture.extra_samples(&further)?;
    }
    let mut missing = f32::NAN;
    if let Some(tags) = tags {
        let directory = picture.encoder();
        directory.write_tag(Tag::ModelPixelScaleTag, &[tags.scale[0], tags.scale[1], 0.0][..])?;
        directory
            .write_tag(Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, tags.corner[0], tags.corner[1], 0.0][..])?;
        if let Some(keys) = &tags.keys {
            directory.write_tag(Tag::GeoKeyDirectoryTag, &keys.directory[..])?;
            if !keys.doubles.is_empty() {
                directory.write_tag(Tag::GeoDoubleParamsTag, &keys.doubles[..])?;
            }
            if !keys.text.is_empty() {
                directory.write_tag(Tag::GeoAsciiParamsTag, keys.text.as_str())?;
            }
        }
        missing = nodata(image, tags.nodata);
        let text = if missing.is_nan() { "nan".to_owned() } else { missing.to_string() };
        directory.write_tag(GDAL_NODATA, text.as_str())?;
    }
    match missing.is_nan() {
        true => picture.write_data(&image.data),
        false => {
            let known = |x: &f32| if x.is_nan() { missing } else { *x };
            picture.write_data(&image.data.iter().map(known).collect::<Vec<f32>>())
        }
    }
}

/// The file's own number for what is missing, unless a value happens to be the same.
fn nodata(image: &Image, wanted: Option<f64>) -> f32 {
    let wanted = wanted.map_or(f32::NAN, |n| n as f32);
    if image.data.contains(&wanted) { f32::NAN } else { wanted }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terrain::geotags::GeoKeys;
    use crate::terrain::raster::Texels;
    use crate::terrain::{DemOptions, Raster, dem};

    fn keys() -> GeoKeys {
        // A projected system described in numbers and words, as files without a code have it.
        let directory = vec![1, 1, 0, 4, 1024, 0, 1, 1, 1025, 0, 1, 1, 1026, 34737, 5, 0, 3080, 34736, 1, 0];
        GeoKeys { directory, doubles: vec![-71.5], text: "here|".into() }
    }

    fn tags(nodata: Option<f64>) -> GeoTags {
        GeoTags { scale: [30.0, 20.0], corner: [500.0, 900.0], keys: Some(keys()), nodata }
    }

    #[test]
    fn bands_are_read_back() {
        for components in 1..=4 {
            let data: Vec<f32> = (0..6 * components).map(|i| i as f32 * 1.25 - 3.0).collect();
            let image = Image::new(3, 2, components, data.clone()).unwrap();
            let raster = Raster::read("a.tif", &encode(&image, Some(&tags(None))).unwrap()).unwrap();
            assert_eq!((raster.width, raster.height, raster.components), (3, 2, components));
            assert_eq!(raster.texels, Texels::Floats(data));
            let place = raster.place.unwrap();
            assert_eq!((place.north_west, place.step), ([515.0, 890.0], [30.0, 20.0]));
            assert_eq!(place.keys, Some(keys()));
        }
    }

    #[test]
    fn what_is_missing_stays_missing() {
        let image = Image::new(2, 2, 1, vec![1.0, f32::NAN, -9.0, 4.0]).unwrap();
        for (nodata, kept) in [(None, None), (Some(-32768.0), Some(-32768.0)), (Some(-9.0), None)] {
            let bytes = encode(&image, Some(&tags(nodata))).unwrap();
            let terrain = dem::read("a.tif", &bytes, &DemOptions::default()).unwrap();
            let found: Vec<_> = [(0, 1), (1, 1), (0, 0), (1, 0)].map(|(c, r)| terrain.sample(c, r)).into();
            assert_eq!(found, [Some(1.0), None, Some(-9.0), Some(4.0)], "{nodata:?}");
            assert_eq!(terrain.nodata.filter(|n| !n.is_nan()), kept);
        }
    }

    #[test]
    fn a_picture_has_no_place() {
        let image = Image::new(2, 2, 3, vec![0.5; 12]).unwrap();
        assert_eq!(Raster::read("a.tif", &encode(&image, None).unwrap()).unwrap().place, None);
    }
}
