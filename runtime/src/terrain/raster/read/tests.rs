use super::*;
use crate::image::{Format, Image, encode};
use std::io::Write;

fn numbers(raster: &Raster) -> Vec<f32> {
    match &raster.texels {
        Texels::Bytes(data) => data.iter().map(|b| f32::from(*b) / 255.0).collect(),
        Texels::Floats(data) => data.clone(),
        Texels::Reserved => Vec::new(),
    }
}

fn npy(descr: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.write_all(header.as_bytes()).unwrap();
    bytes.extend(data);
    bytes
}

#[test]
fn pictures_of_every_number_of_channels() {
    for components in [1, 3, 4] {
        let data: Vec<f32> = (0..6 * components).map(|i| i as f32 * 9.0 / 255.0).collect();
        let image = Image::new(3, 2, components, data.clone()).unwrap();
        let raster = read("a.png", &encode(&image, Format::Png).unwrap()).unwrap();
        assert_eq!((raster.width, raster.height, raster.components), (3, 2, components));
        for (found, wanted) in numbers(&raster).iter().zip(&data) {
            assert!((found - wanted).abs() < 1e-6);
        }
    }
    let image = Image::new(8, 8, 3, vec![0.5; 192]).unwrap();
    let jpeg = read("a.jpg", &encode(&image, Format::Jpeg).unwrap()).unwrap();
    assert!(numbers(&jpeg).iter().all(|v| (v - 0.5).abs() < 0.01));
    let exr = Image::new(1, 2, 3, vec![-4.0, 1e6, 0.25, 0.0, 2.0, 3.0]).unwrap();
    let found = read("a.exr", &encode(&exr, Format::Exr).unwrap()).unwrap();
    assert_eq!(numbers(&found), exr.data);
}

#[test]
fn deep_pictures_are_fractions_too() {
    let mut bytes = Vec::new();
    let encoder = image::codecs::png::PngEncoder::new(&mut bytes);
    let data: Vec<u8> = [0u16, 65535].iter().flat_map(|v| v.to_ne_bytes()).collect();
    image::ImageEncoder::write_image(encoder, &data, 2, 1, image::ExtendedColorType::L16).unwrap();
    assert_eq!(numbers(&read("a.png", &bytes).unwrap()), [0.0, 1.0]);
}

#[test]
fn arrays_keep_their_numbers_and_bytes_are_fractions() {
    let floats: Vec<u8> =
        [1.5f32, f32::NAN, -3.0, 4.0, 5.0, f32::INFINITY].iter().flat_map(|v| v.to_le_bytes()).collect();
    let raster = read("a.npy", &npy("<f4", "(1, 3, 2)", &floats)).unwrap();
    assert_eq!((raster.width, raster.height, raster.components, raster.missing), (3, 1, 2, 2));
    assert_eq!(numbers(&raster), [1.5, 0.0, -3.0, 4.0, 5.0, 0.0]);
    let bytes = read("a.npy", &npy("|u1", "(1, 2)", &[0, 255])).unwrap();
    assert_eq!(numbers(&bytes), [0.0, 1.0]);
    let counts: Vec<u8> = [7i16, -9].iter().flat_map(|v| v.to_le_bytes()).collect();
    assert_eq!(numbers(&read("a.npy", &npy("<i2", "(2, 1)", &counts)).unwrap()), [7.0, -9.0]);
    let wide = read("a.npy", &npy("|u1", "(1, 1, 5)", &[0; 5])).unwrap_err();
    assert!(wide.to_string().contains("1 to 4"), "{wide}");
    let short = read("a.npy", &npy("<f4", "(4, 4)", &floats)).unwrap_err();
    assert!(short.to_string().contains("4 x 4"), "{short}");
    let long = read("a.npy", &npy("|u1", "(1, 2, 3)", &[0; 8])).unwrap_err();
    assert!(long.to_string().contains("8 numbers") && long.to_string().contains("1 x 2 x 3 = 6"), "{long}");
}

/// Two texels of three bands, with a georeference and a nodata value.
fn rgb_tiff() -> Vec<u8> {
    use tiff::encoder::{TiffEncoder, colortype::RGB8};
    use tiff::tags::Tag;
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    let mut image = encoder.new_image::<RGB8>(1, 2).unwrap();
    let tags = image.encoder();
    tags.write_tag(Tag::ModelPixelScaleTag, &[10.0, 10.0, 0.0][..]).unwrap();
    tags.write_tag(Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, 500.0, 900.0, 0.0][..]).unwrap();
    tags.write_tag(Tag::GeoKeyDirectoryTag, &[1u16, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, 32654][..]).unwrap();
    tags.write_tag(Tag::Unknown(42113), "255").unwrap();
    image.write_data(&[51, 102, 153, 255, 0, 51]).unwrap();
    bytes.into_inner()
}

#[test]
fn a_colour_tiff_has_its_place() {
    let raster = read("a.tif", &rgb_tiff()).unwrap();
    assert_eq!((raster.width, raster.height, raster.components, raster.missing), (1, 2, 3, 1));
    assert_eq!(numbers(&raster), [0.2, 0.4, 0.6, 0.0, 0.0, 0.2]);
    let place = raster.place.unwrap();
    assert_eq!((place.epsg, place.north_west, place.step), (Some(32654), [505.0, 895.0], [10.0, 10.0]));
}

#[test]
fn elevation_data_is_a_layer_of_heights() {
    let text = "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 30\nNODATA_value -1\n7 8\n-1 10\n";
    let raster = read("a.asc", text.as_bytes()).unwrap();
    assert_eq!(numbers(&raster), [7.0, 8.0, 0.0, 10.0]);
    assert_eq!(raster.missing, 1);
}

#[test]
fn damaged_files_are_errors() {
    let tiff = rgb_tiff();
    for bytes in [&tiff[..tiff.len() / 2], b"\x89PNG\r\n\x1a\nxx", b"", b"\xff\xd8\xff\xe0"] {
        assert!(read("a.tif", bytes).is_err());
    }
}
