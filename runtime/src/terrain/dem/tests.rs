//! Formats against each other, damaged files, and a seeded fuzz of all readers.

use super::*;
use crate::terrain::field::Samples;
use std::path::PathBuf;

/// Real files beside the repository, where they exist.
fn extra(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/dem").join(name);
    path.exists().then_some(path)
}

fn spaced() -> DemOptions {
    DemOptions { spacing: Some([10.0, 10.0]), ..DemOptions::default() }
}

fn npy(descr: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    bytes
}

fn grey_png(width: u32, height: u32, values: &[u16]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let image = image::ImageBuffer::<image::Luma<u16>, _>::from_raw(width, height, values.to_vec()).unwrap();
    image.write_to(&mut std::io::Cursor::new(&mut bytes), image::ImageFormat::Png).unwrap();
    bytes
}

fn rgb_png(width: u32, height: u32, values: Vec<u8>) -> Vec<u8> {
    let mut bytes = Vec::new();
    let image = image::RgbImage::from_raw(width, height, values).unwrap();
    image.write_to(&mut std::io::Cursor::new(&mut bytes), image::ImageFormat::Png).unwrap();
    bytes
}

fn tiff_bytes() -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = tiff::encoder::TiffEncoder::new(std::io::Cursor::new(&mut bytes)).unwrap();
    let mut image = encoder.new_image::<tiff::encoder::colortype::GrayI16>(3, 2).unwrap();
    image.encoder().write_tag(tiff::tags::Tag::ModelPixelScaleTag, &[30.0, 20.0, 0.0][..]).unwrap();
    image
        .encoder()
        .write_tag(tiff::tags::Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, 500.0, 900.0, 0.0][..])
        .unwrap();
    image.encoder().write_tag(tiff::tags::Tag::Unknown(42113), "-99").unwrap();
    image.write_data(&[1i16, 2, 3, 4, -99, 6]).unwrap();
    bytes
}

fn heights(terrain: &Terrain) -> Vec<Option<f64>> {
    let rows = (0..terrain.height).rev();
    rows.flat_map(|r| (0..terrain.width).map(move |c| (c, r))).map(|(c, r)| terrain.sample(c, r)).collect()
}

#[test]
fn geotiff_with_nodata_and_projected_metres() {
    let terrain = read("a.tif", &tiff_bytes(), &DemOptions::default()).unwrap();
    assert_eq!(heights(&terrain), [Some(1.0), Some(2.0), Some(3.0), Some(4.0), None, Some(6.0)]);
    assert_eq!((terrain.spacing, terrain.voids), ([30.0, 20.0], 1));
    let place = terrain.crs.unwrap();
    assert_eq!((place.north_west, place.geographic), ([515.0, 890.0], false));
}

#[test]
fn arrays_of_both_byte_orders() {
    let little: Vec<u8> = [1.0f32, 2.0, f32::NAN, 4.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    let big: Vec<u8> = [1.0f64, 2.0, f64::NAN, 4.0].iter().flat_map(|v| v.to_be_bytes()).collect();
    for bytes in [npy("<f4", "(2, 2)", &little), npy(">f8", "(2, 2)", &big)] {
        let terrain = read("a.npy", &bytes, &spaced()).unwrap();
        assert_eq!(heights(&terrain), [Some(1.0), Some(2.0), None, Some(4.0)]);
    }
    let raw = read("a.f32", &little, &spaced()).unwrap();
    assert_eq!(heights(&raw), [Some(1.0), Some(2.0), None, Some(4.0)]);
    assert!(read("a.f32", &little, &DemOptions::default()).unwrap_err().to_string().contains("--spacing"));
}

#[test]
fn grey_images_take_their_range_from_the_options() {
    let png = grey_png(2, 2, &[0, 65535, 13107, 26214]);
    let options = DemOptions { heights: Some([100.0, 600.0]), ..spaced() };
    let found: Vec<f64> = heights(&read("a.png", &png, &options).unwrap()).into_iter().flatten().collect();
    for (z, expected) in found.iter().zip([100.0, 600.0, 200.0, 300.0]) {
        assert!((z - expected).abs() < 1e-9, "{found:?}");
    }
    let smaller = grey_png(2, 2, &[0, 65534, 5, 6]);
    assert!(matches!(read("a.png", &smaller, &spaced()).unwrap().samples, Samples::I16(_)));
}

#[test]
fn a_colour_image_needs_an_encoding() {
    let sea = [128, 0, 0];
    let png = rgb_png(2, 2, [sea, sea, sea, [131, 232, 128]].concat());
    let error = read("a.png", &png, &spaced()).unwrap_err().to_string();
    assert!(["grey", "terrarium", "terrain-rgb"].iter().all(|e| error.contains(e)), "{error}");
    let options = DemOptions { encoding: Some(Encoding::Terrarium), ..spaced() };
    let terrain = read("a.png", &png, &options).unwrap();
    assert_eq!(heights(&terrain), [Some(0.0), Some(0.0), Some(0.0), Some(1000.5)]);
}

#[test]
fn text_grids() {
    let text =
        "ncols 2\nnrows 2\nxllcorner 10\nyllcorner 20\ncellsize 5\nNODATA_value -9999\n1.5 2\n-9999 4\n";
    let terrain = read("a.asc", text.as_bytes(), &DemOptions::default()).unwrap();
    assert_eq!(heights(&terrain), [Some(1.5), Some(2.0), None, Some(4.0)]);
    assert_eq!(terrain.spacing, [5.0, 5.0]);
    let short = read("a.asc", &text.as_bytes()[..text.len() - 3], &DemOptions::default()).unwrap_err();
    assert!(short.to_string().contains("3 of 4"), "{short}");
}

#[test]
fn grey_maps_and_archives() {
    let pgm = [b"P5 # made by hand\n2 2\n1000\n".as_slice(), &[0, 1, 0, 2, 0, 3, 0, 4]].concat();
    let expected = [Some(1.0), Some(2.0), Some(3.0), Some(4.0)];
    assert_eq!(heights(&read("a.pgm", &pgm, &spaced()).unwrap()), expected);
    assert!(matches!(read("a.pgm", &pgm[..pgm.len() - 1], &spaced()), Err(DemError::Truncated { .. })));

    let mut packed = flate2::write::DeflateEncoder::new(Vec::new(), flate2::Compression::best());
    std::io::Write::write_all(&mut packed, &pgm).unwrap();
    let packed = packed.finish().unwrap();
    for (method, data) in [(0u8, &pgm), (8, &packed)] {
        let mut zip = b"PK\x03\x04\x14\0\0\0".to_vec();
        zip.extend([method, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
        zip.extend((data.len() as u32).to_le_bytes());
        zip.extend((pgm.len() as u32).to_le_bytes());
        zip.extend([5, 0, 0, 0]);
        zip.extend(b"a.pgm");
        zip.extend(data.as_slice());
        assert_eq!(heights(&read("a.zip", &zip, &spaced()).unwrap()), expected);
        assert!(read("a.zip", &zip[..zip.len() - 3], &spaced()).is_err());
    }

    let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    std::io::Write::write_all(&mut gzip, &pgm).unwrap();
    assert_eq!(heights(&read("a.pgm.gz", &gzip.finish().unwrap(), &spaced()).unwrap()), expected);
}

#[test]
fn a_lying_header_is_refused_before_memory_is_asked_for() {
    let error = read("a.npy", &npy("<f4", "(16384, 16384)", &[0; 64]), &spaced()).unwrap_err();
    assert!(matches!(error, DemError::Truncated { .. }), "{error}");
    let error = read("a.npy", &npy("<f4", "(4000000000, 4000000000)", &[0; 64]), &spaced()).unwrap_err();
    assert!(matches!(error, DemError::TooLarge { .. }), "{error}");
    let mut png = grey_png(2, 2, &[1, 2, 3, 4]);
    png[16..20].copy_from_slice(&100_000u32.to_be_bytes());
    assert!(read("a.png", &png, &spaced()).is_err());
}

#[test]
fn unknown_and_empty_files_say_so() {
    assert!(matches!(read("a.xyz", b"hello", &spaced()), Err(DemError::UnknownFormat { .. })));
    assert!(matches!(read("a.tif", b"", &spaced()), Err(DemError::Truncated { .. })));
    assert!(matches!(open(Path::new("no/such.tif"), &spaced()), Err(DemError::Unreadable { .. })));
    assert!(matches!(open(Path::new("/"), &spaced()), Err(DemError::Unsupported { .. })));
}

/// Damages copies of small files of every format; each must be read or refused, whatever it holds.
#[test]
fn damaged_files_never_panic() {
    let floats: Vec<u8> = (0..16).flat_map(|i| (i as f32).to_le_bytes()).collect();
    let mut seeds = vec![
        ("a.tif", tiff_bytes()),
        ("a.tif", include_bytes!("../../../../lang-examples/data/fuji.tif").to_vec()),
        ("a.npy", npy("<f4", "(4, 4)", &floats)),
        ("a.png", grey_png(4, 4, &(0..16).collect::<Vec<u16>>())),
        ("N01E002.hgt", vec![7; 32]),
        ("a.asc", b"ncols 2\nnrows 2\ncellsize 5\nNODATA_value -9999\n1 2\n3 4\n".to_vec()),
        ("a.f32", floats),
        ("a.pgm", b"P5 2 2 1000\n12345678".to_vec()),
    ];
    for name in [
        "derived/alps256_i16_tile64_deflate_p2.tif",
        "derived/alps256_f32_nan_lzw_p3_tile128.tif",
        "derived/alps256_i16_packbits.tif",
        "derived/alps256_i16_bigtiff_deflate.tif",
    ] {
        if let Some(path) = extra(name) {
            seeds.push(("a.tif", std::fs::read(path).unwrap()));
        }
    }
    let mut state = 12345u32;
    let mut random = move |n: usize| {
        state = state.wrapping_mul(747796405).wrapping_add(2891336453);
        ((state >> 4) as usize) % n.max(1)
    };
    for (name, bytes) in &seeds {
        let rounds = if bytes.len() > 10_000 { 300 } else { 3000 };
        for _ in 0..rounds {
            let mut damaged = bytes.clone();
            for _ in 0..1 + random(4) {
                // Headers and directories are where the lies are.
                let reach = if random(2) == 0 { damaged.len().min(400) } else { damaged.len() };
                let at = random(reach);
                match random(4) {
                    0 => damaged[at] = random(256) as u8,
                    1 => damaged[at] ^= 1 << random(8),
                    2 => damaged[at] = 0xff,
                    _ => damaged.truncate(at.max(1)),
                }
            }
            let _ = read(name, &damaged, &spaced());
        }
    }
}

#[test]
fn one_grid_in_many_encodings_loads_alike() {
    let Some(reference) = extra("derived/alps256_i16_strip_none.tif") else { return };
    let expected = Terrain::open(reference, &DemOptions::default()).unwrap();
    assert_eq!((expected.voids, expected.min, expected.max), (2502, 676.0, 4173.0));
    for name in [
        "i16_bigendian.tif",
        "i16_packbits.tif",
        "i16_strip_lzw_p2.tif",
        "i16_tile64_deflate_p2.tif",
        "i16_bigtiff_deflate.tif",
        "u16_deflate.tif",
        "i32_deflate.tif",
        "f64_deflate.tif",
        "f32_nodata_deflate_p3.tif",
        "f32_nan_lzw_p3_tile128.tif",
        "f32.npy",
    ] {
        let Some(path) = extra(&format!("derived/alps256_{name}")) else { panic!("no {name}") };
        let terrain = Terrain::open(path, &DemOptions::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(heights(&terrain), heights(&expected), "{name}");
        if name.ends_with("tif") {
            assert_eq!((terrain.spacing, &terrain.crs), (expected.spacing, &expected.crs), "{name}");
        }
    }
    for name in ["asc", "bil"] {
        let path = extra(&format!("derived/alps256.{name}")).unwrap();
        let terrain = Terrain::open(path, &DemOptions::default()).unwrap();
        assert_eq!(heights(&terrain), heights(&expected), "{name}");
        for axis in 0..2 {
            assert!((terrain.spacing[axis] / expected.spacing[axis] - 1.0).abs() < 1e-3, "{name}");
        }
    }
}

#[test]
fn real_files_have_their_known_figures() {
    for (name, width, min, max, voids) in [
        ("fuji_srtm1.tif", 1712, -12.0, 3759.0, 80331),
        ("N46E008.tif", 1201, 187.0, 4173.0, 103743),
        ("S33W071.tif", 1201, 250.0, 6929.0, 0),
        ("N43E007.hgt", 1201, -16.0, 2060.0, 4),
        ("S46W066.hgt.gz", 3601, -3.0, 146.0, 0),
        ("rockies_srtmgl3.asc", 240, 1943.0, 3286.0, 0),
    ] {
        let Some(path) = extra(name) else { continue };
        let terrain = Terrain::open(path, &DemOptions::default()).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(
            (terrain.width, terrain.min, terrain.max, terrain.voids),
            (width, min, max, voids),
            "{name}"
        );
    }
}
