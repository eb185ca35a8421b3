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

/// An archive with its directory, nothing packed.
fn archive(files: &[(&str, &[u8])]) -> Vec<u8> {
    let (mut bytes, mut directory) = (Vec::new(), Vec::new());
    for (name, data) in files {
        let at = bytes.len() as u32;
        let sizes = [(data.len() as u32).to_le_bytes(), (data.len() as u32).to_le_bytes()].concat();
        let about =
            [&[20u8, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0], &sizes[..], &[name.len() as u8, 0, 0, 0]]
                .concat();
        bytes.extend([&b"PK\x03\x04"[..], &about, name.as_bytes(), data].concat());
        let entry = [&b"PK\x01\x02\x14\0"[..], &about, &[0; 10], &at.to_le_bytes(), name.as_bytes()].concat();
        directory.extend(entry);
    }
    let count = files.len() as u8;
    let (size, at) = (directory.len() as u32, bytes.len() as u32);
    let end = [
        &b"PK\x05\x06"[..],
        &[0, 0, 0, 0, count, 0, count, 0],
        &size.to_le_bytes(),
        &at.to_le_bytes(),
        &[0, 0],
    ];
    bytes.extend(directory);
    bytes.extend(end.concat());
    bytes
}

#[test]
fn an_archive_gives_its_grid_wherever_it_stands() {
    let grid = b"ncols 2\nnrows 2\ncellsize 5\n1 2\n3 4\n".as_slice();
    let expected = [Some(1.0), Some(2.0), Some(3.0), Some(4.0)];
    let bytes = archive(&[("about.txt", b"hello"), ("a/", b""), ("a/g.asc", grid)]);
    assert_eq!(heights(&read("a.zip", &bytes, &spaced()).unwrap()), expected);
    let header = b"NROWS 2\nNCOLS 2\nNBITS 16\nPIXELTYPE SIGNEDINT\n".as_slice();
    let shorts = [1, 0, 2, 0, 3, 0, 4, 0];
    let bytes = archive(&[("a/g.bil", &shorts), ("a/g.HDR", header)]);
    assert_eq!(heights(&read("a.zip", &bytes, &spaced()).unwrap()), expected);
    let refused =
        |files: &[(&str, &[u8])]| read("a.zip", &archive(files), &spaced()).unwrap_err().to_string();
    for (files, parts) in [
        (&[("g.asc", grid), ("h.asc", grid)][..], ["several", "g.asc, h.asc"]),
        (&[("about.txt", b"hello"), ("b.xml", b"")], ["no grid", "about.txt, b.xml"]),
        (&[("a/g.bil", &shorts), ("c.txt", b"")], ["a/g.bil without", "a/g.hdr"]),
        (&[("g.asc", &grid[..grid.len() - 3]), ("c.txt", b"")], ["a.zip/g.asc", "3 of 4"]),
        (&[], ["a.zip", "is not elevation data"]),
    ] {
        let error = refused(files);
        assert!(parts.iter().all(|part| error.contains(part)), "{error}");
    }
}

/// Each names the file and says in the user's words what is wrong and what to do.
#[test]
fn faults_are_told_in_words_of_their_own() {
    let grid =
        |size: &str, numbers: &str| format!("ncols 2\nnrows 2\ncellsize {size}\n{numbers}\n").into_bytes();
    let header = "NROWS 2\nNCOLS 2\nNBITS 16\nPIXELTYPE SIGNEDINT\n";
    let png = grey_png(40, 40, &(0..1600).collect::<Vec<u16>>());
    let mut flipped = png.clone();
    flipped[png.len() / 2] ^= 0x55;
    let mut complex = tiff_bytes();
    // The entry of the sample format: tag, type, count.
    let entry = [339u16, 3, 1, 0].map(u16::to_le_bytes).concat();
    let at = complex.windows(8).position(|w| w == entry).unwrap();
    complex[at + 8] = 6;
    let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    std::io::Write::write_all(&mut gzip, &png).unwrap();
    let gzip = gzip.finish().unwrap();
    let cases: &[(&str, Vec<u8>, &[&str])] = &[
        ("a.asc", grid("5", "1 2 3 4 5 6"), &["6 numbers", "2 x 2 = 4"]),
        ("a.npy", npy("<i2", "(2, 2)", &[0; 14]), &["7 numbers", "2 x 2 = 4"]),
        ("a.asc", grid("-5", "1 2 3 4"), &["-5 apart", "`cellsize`"]),
        ("a.asc", grid("0", "1 2 3 4"), &["0 apart", "`cellsize`"]),
        ("a.asc", grid("nan", "1 2 3 4"), &["NaN apart", "`cellsize`"]),
        ("a.pgm", b"P5 99999999999999999999999 2 255\n1234".to_vec(), &["too large", "width has 23 digits"]),
        ("a.pgm", b"P5 -3 2 255\n1234".to_vec(), &["no number for its width"]),
        ("a.png", png[..png.len() / 2].to_vec(), &["PNG data ends too early", "get the file again"]),
        ("a.png", flipped, &["PNG data does not fit", "get the file again"]),
        ("a.tif", complex, &["complex numbers", "float32"]),
        ("a.png.gz", gzip[..gzip.len() / 2].to_vec(), &["gzip data ends too early", "get the file again"]),
        ("a.hdr", header.into(), &["header of a grid", "a.bil"]),
    ];
    for (name, bytes, parts) in cases {
        let error = read(name, bytes, &spaced()).unwrap_err().to_string();
        assert!(parts.iter().chain([name]).all(|part| error.contains(part)), "{error}");
        let raw = ["failed to fill", "CRC", "Sample format", "sample format", "[Unknown", "unexpected end"];
        assert!(raw.iter().all(|words| !error.contains(words)), "{error}");
    }
    let error = bil::parse("a.bil", &[0; 10], header, &spaced()).unwrap_err().to_string();
    assert!(error.contains("5 numbers") && error.contains("a.bil"), "{error}");
    // What a packed file holds is told under the name that was given.
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    std::io::Write::write_all(&mut packed, &grid("5", "1 2 3")).unwrap();
    let error = read("a.asc.gz", &packed.finish().unwrap(), &spaced()).unwrap_err().to_string();
    assert!(error.contains("a.asc.gz") && error.contains("3 of 4"), "{error}");
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
        ("a.zip", archive(&[("about.txt", b"hello"), ("a.pgm", b"P5 2 2 255\n1234")])),
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
    let known = |terrain: &Terrain, tolerance: f64, name: &str| {
        for (a, b) in heights(terrain).into_iter().zip(heights(&expected)) {
            let Some(b) = b else { continue };
            assert!((a.unwrap() - b).abs() <= tolerance, "{name}");
        }
    };
    let grey = DemOptions { heights: Some([676.0 - 3497.0 / 65534.0, 4173.0]), ..DemOptions::default() };
    for (name, options, tolerance) in [
        ("i16_zstd.tif", DemOptions::default(), 0.0),
        ("u16.pgm", spaced(), 0.0),
        ("u16norm.png", grey, 0.03),
        ("terrarium.png", DemOptions { encoding: Some(Encoding::Terrarium), ..spaced() }, 0.0),
        ("terrainrgb.png", DemOptions { encoding: Some(Encoding::TerrainRgb), ..spaced() }, 1e-9),
    ] {
        known(
            &Terrain::open(extra(&format!("derived/alps256_{name}")).unwrap(), &options).unwrap(),
            tolerance,
            name,
        );
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

/// The files of `tests/data/dem`, which GDAL and others have written.
fn written(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/dem").join(name)
}

fn opened(name: &str, options: &DemOptions) -> Terrain {
    Terrain::open(written(name), options).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn what_others_have_written_loads_alike() {
    let plain = DemOptions::default();
    let expected = opened("i16.tif", &plain);
    assert_eq!((expected.width, expected.height, expected.voids), (37, 23, 4));
    assert_eq!((expected.min, expected.max), (-12.0, 4173.0));
    let mut files = 0;
    for entry in std::fs::read_dir(written("")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        let kind = &name[..3];
        if !name.ends_with(".tif") || !["i16", "u16", "i32", "u32", "f32", "f64"].contains(&kind) {
            continue;
        }
        let terrain = opened(&name, &plain);
        let unsigned = kind.starts_with('u');
        // Unsigned numbers cannot hold what lies below the sea.
        let same = |(a, b): (Option<f64>, Option<f64>)| a == b || (unsigned && b == Some(-12.0));
        assert!(heights(&terrain).into_iter().zip(heights(&expected)).all(same), "{name}");
        assert_eq!((terrain.spacing, &terrain.crs), (expected.spacing, &expected.crs), "{name}");
        files += 1;
    }
    assert!(files >= 15, "{files}");
    for name in ["grid.asc", "grid.bil"] {
        let terrain = opened(name, &plain);
        assert_eq!(heights(&terrain), heights(&expected), "{name}");
        for axis in 0..2 {
            assert!((terrain.spacing[axis] / expected.spacing[axis] - 1.0).abs() < 1e-9, "{name}");
        }
    }
    assert_eq!(heights(&opened("f32.npy", &plain)), heights(&expected));
}

#[test]
fn images_that_others_have_written_load_alike() {
    let expected = heights(&opened("i16.tif", &DemOptions::default()));
    let near = |name: &str, options: DemOptions, tolerance: f64| {
        let found = heights(&opened(name, &options));
        for (a, b) in found.into_iter().zip(&expected) {
            // The map of greys holds nothing below 0.
            let same = match (a, b) {
                (Some(a), Some(b)) => (a - b).abs() <= tolerance || name == "grid.pgm" && *b < 0.0,
                (a, b) => a.is_none() == b.is_none() || name == "grid.pgm" && *b == Some(-12.0),
            };
            assert!(same, "{name}: {a:?} {b:?}");
        }
    };
    let step = 4185.0 / 65534.0;
    let with = |nodata| DemOptions { nodata: Some(nodata), ..DemOptions::default() };
    near("grey.png", DemOptions { heights: Some([-12.0 - step, 4173.0]), ..with(0.0) }, step);
    near("grid.pgm", with(0.0), 0.0);
    near("terrarium.png", DemOptions { encoding: Some(Encoding::Terrarium), ..with(0.0) }, 0.0);
    near("terrain_rgb.png", DemOptions { encoding: Some(Encoding::TerrainRgb), ..with(0.0) }, 1e-9);
}

#[test]
fn bytes_squares_and_other_units() {
    let plain = DemOptions::default();
    let expected = opened("i16.tif", &plain);
    for name in ["i8.tif", "u8.tif"] {
        let terrain = opened(name, &plain);
        assert_eq!((terrain.voids, terrain.max), (4, 104.0), "{name}");
    }
    for name in ["N46E008.hgt.gz", "N46E008.zip"] {
        let terrain = opened(name, &plain);
        assert_eq!((terrain.width, terrain.height, terrain.voids), (23, 23, 4), "{name}");
        let same = |(c, r)| terrain.sample(c, r) == expected.sample(c, r);
        assert!((0..23).all(|c| (0..23).all(|r| same((c, r)))), "{name}");
        assert_eq!(terrain.crs.unwrap().to_string(), "EPSG:4326");
    }
    let utm = opened("utm.tif", &plain);
    assert_eq!((utm.spacing, utm.crs.unwrap().to_string()), ([90.0, 90.0], "EPSG:32632".into()));
    let feet = opened("feet.tif", &plain);
    assert!((feet.spacing[0] - 100.0 * 1200.0 / 3937.0).abs() < 1e-9, "{:?}", feet.spacing);
}

#[test]
fn a_tag_longer_than_any_text_is_left_unread() {
    let mut bytes = tiff_bytes();
    // The entry of GDAL's nodata tag: tag, type, count.
    let entry = [42113u16.to_le_bytes(), 2u16.to_le_bytes()].concat();
    let at = bytes.windows(4).position(|w| w == entry).unwrap();
    bytes[at + 4..at + 8].copy_from_slice(&0x7fff_ffffu32.to_le_bytes());
    assert_eq!(read("a.tif", &bytes, &DemOptions::default()).unwrap().voids, 0);
}

#[test]
fn raw_numbers_say_what_they_are_by_ending_or_length() {
    let shorts: Vec<u8> = [1i16, -2, 3, 4].iter().flat_map(|v| v.to_le_bytes()).collect();
    for name in ["a.i16", "a.raw", "a.bin"] {
        let terrain = read(name, &shorts, &spaced()).unwrap();
        assert_eq!(heights(&terrain), [Some(1.0), Some(-2.0), Some(3.0), Some(4.0)], "{name}");
    }
    assert_eq!(heights(&read("a.u16", &shorts, &spaced()).unwrap())[1], Some(65534.0));
    let options = DemOptions { nodata: Some(-2.0), ..spaced() };
    assert_eq!(heights(&read("a.i16", &shorts, &options).unwrap())[1], None);
    assert!(read("a.f32", &shorts, &spaced()).unwrap_err().to_string().contains("no square of float32"));
}

#[test]
fn real_files_have_their_known_figures() {
    for (name, width, height, min, max, voids) in [
        ("fuji_srtm1.tif", 1712, 1425, -12.0, 3759.0, 80331),
        ("N46E008.tif", 1201, 1201, 187.0, 4173.0, 103743),
        ("S33W071.tif", 1201, 1201, 250.0, 6929.0, 0),
        ("N43E007.hgt", 1201, 1201, -16.0, 2060.0, 4),
        ("S46W066.hgt.gz", 3601, 3601, -3.0, 146.0, 0),
        ("rockies_srtmgl3.asc", 240, 144, 1943.0, 3286.0, 0),
        ("sthelens_usgs.dem", 327, 468, 682.0, 2543.0, 4151),
        ("derived/N46E008.hgt.gz", 1201, 1201, 187.0, 4173.0, 103743),
        ("derived/everest_150.asc", 150, 150, 5000.0, 8840.0, 0),
    ] {
        let Some(path) = extra(name) else { continue };
        let terrain = Terrain::open(path, &DemOptions::default()).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(
            (terrain.width, terrain.height, terrain.min, terrain.max, terrain.voids),
            (width, height, min, max, voids),
            "{name}"
        );
    }
}
