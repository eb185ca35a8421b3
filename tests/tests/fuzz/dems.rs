//! Small files of every format of elevation data, damaged.

use flate2::{Compression, Crc, write::DeflateEncoder, write::GzEncoder};
use ghyll_compiler::random::Random;
use ghyll_runtime::terrain::dem::{self, DemOptions, Encoding, Voids};
use ghyll_tests::hunt::Input;
use image::{ImageBuffer, ImageFormat, Luma, RgbImage};
use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};
use tiff::encoder::{Compression as Packing, TiffEncoder, colortype};
use tiff::tags::Tag;

const FUJI: &[u8] = include_bytes!("../../../lang-examples/data/fuji.tif");
/// The header of a .bil lies beside it; both are one input, with this between them.
const BESIDE: &[u8] = b"\n#samples\n";
/// Numbers at the ends of their types.
const EDGES: &[u64] = &[
    0,
    1,
    2,
    0x7f,
    0x80,
    0xff,
    0x7fff,
    0x8000,
    0xffff,
    0x10000,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    0x1_0000_0000,
    u64::MAX >> 1,
    u64::MAX,
    0x7fc0_0000,
    0x7f80_0000,
];
const WORDS: &[&str] = &[
    "0",
    "1",
    "-1",
    "2",
    "65536",
    "131072",
    "4294967295",
    "1e9",
    "1e308",
    "-1e308",
    "nan",
    "inf",
    "-9999",
    "0.5",
    "1e-300",
    "ncols",
    "nrows",
    "cellsize",
    "dx",
    "dy",
    "nodata_value",
    "xllcenter",
    "'<i2'",
    "'>f8'",
    "'=i4'",
    "True",
    "(",
    ")",
    ",",
    "{",
    "}",
    "NBITS",
    "FLOAT",
    "32",
    "ä",
];

/// A sound file.
pub struct File {
    name: &'static str,
    bytes: Vec<u8>,
}

pub fn corpus() -> Vec<File> {
    let samples: Vec<i16> = (0..25).map(|i| (i * 37 % 100) as i16 - 20).collect();
    let floats: Vec<f32> = samples.iter().map(|v| f32::from(*v) / 3.0).collect();
    let big: Vec<u8> = samples.iter().flat_map(|v| v.to_be_bytes()).collect();
    let raw: Vec<u8> = floats.iter().flat_map(|v| v.to_le_bytes()).collect();
    let text: Vec<String> = samples.iter().map(i16::to_string).collect();
    let asc = format!(
        "ncols 5\nnrows 5\nxllcorner 8\nyllcorner 46\ncellsize 0.01\nnodata_value -9999\n{}\n",
        text.join(" ")
    );
    let bil = "BYTEORDER M\nNROWS 5\nNCOLS 5\nNBANDS 1\nNBITS 16\nPIXELTYPE SIGNEDINT\nXDIM 30\nYDIM 20\nULXMAP 8\nULYMAP 46\nNODATA -5\n";
    let grey = ImageBuffer::<Luma<u16>, _>::from_raw(5, 5, (0..25).map(|i| i * 900).collect::<Vec<u16>>());
    let rgb = RgbImage::from_raw(5, 5, (0..75).collect());
    let mut pgm = b"P5 # heights\n5 5 65535\n".to_vec();
    pgm.extend(&big);
    let mut files = vec![
        file("fuji.tif", FUJI.to_vec()),
        file("zstd.tif", include_bytes!("../../data/dem/i16_tiles_big_endian_zstd.tif").to_vec()),
        file("predicted.tif", include_bytes!("../../data/dem/f32_tiles_lzw_p3_nan.tif").to_vec()),
        file("plain.tif", tiff(false, Packing::Uncompressed)),
        file("deflate.tif", tiff(false, Packing::Deflate(Default::default()))),
        file("lzw.tif", tiff(false, Packing::Lzw)),
        file("packbits.tif", tiff(false, Packing::Packbits)),
        file("big.tif", tiff(true, Packing::Uncompressed)),
        file("N35E138.hgt", big.clone()),
        file("grey.png", png(|to| grey.expect("25 pixels").write_to(to, ImageFormat::Png))),
        file("colour.png", png(|to| rgb.expect("25 pixels").write_to(to, ImageFormat::Png))),
        file(
            "ints.npy",
            npy("<i2", "(5, 5)", &samples.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>()),
        ),
        file("floats.npy", npy("<f4", "(5, 5)", &raw)),
        file(
            "doubles.npy",
            npy(
                ">f8",
                "(5, 5)",
                &floats.iter().flat_map(|v| f64::from(*v).to_be_bytes()).collect::<Vec<_>>(),
            ),
        ),
        file("floats.f32", raw),
        file("grid.asc", asc.into_bytes()),
        file("grey.pgm", pgm),
        file("field.bil", [bil.as_bytes(), BESIDE, &big].concat()),
    ];
    files.push(file("N35E138.hgt.gz", gzip(&big)));
    files.push(file("tile.zip", zip("N35E138.hgt", &big)));
    files
}

fn file(name: &'static str, bytes: Vec<u8>) -> File {
    File { name, bytes }
}

fn tiff(large: bool, packing: Packing) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let samples: Vec<i16> = (0..25).collect();
    macro_rules! write {
        ($encoder:expr) => {{
            let mut encoder = $encoder.expect("an encoder").with_compression(packing);
            let mut image = encoder.new_image::<colortype::GrayI16>(5, 5).expect("a small image");
            let tags = image.encoder();
            tags.write_tag(Tag::ModelPixelScaleTag, &[0.01, 0.01, 0.0][..]).expect("a tag");
            tags.write_tag(Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, 8.0, 46.0, 0.0][..]).expect("a tag");
            let keys: &[u16] = &[1, 1, 0, 2, 1024, 0, 1, 2, 2048, 0, 1, 4326];
            tags.write_tag(Tag::GeoKeyDirectoryTag, keys).expect("a tag");
            tags.write_tag(Tag::Unknown(42113), "-99").expect("a tag");
            image.write_data(&samples).expect("25 samples");
        }};
    }
    match large {
        true => write!(TiffEncoder::new_big(&mut bytes)),
        false => write!(TiffEncoder::new(&mut bytes)),
    }
    bytes.into_inner()
}

fn png(write: impl FnOnce(&mut Cursor<Vec<u8>>) -> image::ImageResult<()>) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    write(&mut bytes).expect("memory takes every picture");
    bytes.into_inner()
}

fn npy(descr: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}\n");
    [b"\x93NUMPY\x01\x00", &(header.len() as u16).to_le_bytes()[..], header.as_bytes(), data].concat()
}

fn gzip(plain: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(plain).and_then(|()| encoder.finish()).expect("memory takes all")
}

fn zip(name: &str, plain: &[u8]) -> Vec<u8> {
    let mut encoder = DeflateEncoder::new(Vec::new(), Compression::fast());
    let packed = encoder.write_all(plain).and_then(|()| encoder.finish()).expect("memory takes all");
    let mut bytes = b"PK\x03\x04\x14\0\0\0\x08\0\0\0\0\0\0\0\0\0".to_vec();
    bytes.extend((packed.len() as u32).to_le_bytes());
    bytes.extend((plain.len() as u32).to_le_bytes());
    bytes.extend((name.len() as u16).to_le_bytes());
    bytes.extend([0, 0]);
    bytes.extend(name.as_bytes());
    bytes.extend(packed);
    bytes
}

/// The corpus itself is read; what is damaged is then known to have been sound.
pub fn accept(file: &File) {
    let encoding = file.name.starts_with("colour").then_some(Encoding::Terrarium);
    let options = DemOptions { spacing: Some([10.0, 10.0]), encoding, ..DemOptions::default() };
    let read = read(file.name, &file.bytes, &options);
    assert!(read.is_ok(), "{}: {read:?}", file.name);
}

/// A file of the corpus with a few changes; some are packed afterwards.
pub fn damaged(random: &mut Random, corpus: &[File]) -> Input {
    // The largest file is the slowest: seldom.
    let largest = usize::from(random.below(8) != 0);
    let chosen = &corpus[largest + random.below(corpus.len() - largest)];
    let (mut name, mut bytes) = (chosen.name.to_owned(), chosen.bytes.clone());
    for _ in 0..=random.below(5) {
        mutate(random, &mut bytes, corpus);
    }
    if bytes.starts_with(b"\x89PNG") && random.below(4) != 0 {
        mend_sums(&mut bytes);
    }
    match random.below(20) {
        0 => (name, bytes) = (format!("{name}.gz"), gzip(&bytes)),
        1 => (name, bytes) = ("a.zip".to_owned(), zip(&name, &bytes)),
        2 => name = corpus[random.below(corpus.len())].name.to_owned(),
        _ => {}
    }
    Input { name, bytes, seed: random.word() }
}

fn mutate(random: &mut Random, bytes: &mut Vec<u8>, corpus: &[File]) {
    // Headers and directories lie at the ends.
    let near = random.below(2) == 0;
    let reach = if near { bytes.len().min(400) } else { bytes.len() };
    let at = match random.below(2) {
        0 => random.below(reach + 1),
        _ => bytes.len() - random.below(reach + 1),
    };
    let end = (at + random.below(16)).min(bytes.len());
    match random.below(10) {
        0 => bytes.truncate(at),
        1 => drop(bytes.drain(at..end)),
        2 => {
            let chunk = bytes[at..end].to_vec();
            bytes.splice(at..at, chunk);
        }
        3 => {
            let other = &corpus[random.below(corpus.len())].bytes;
            let from = random.below(other.len());
            let to = (from + random.below(100)).min(other.len());
            bytes.splice(at..end, other[from..to].iter().copied());
        }
        4 | 5 => {
            if let Some(byte) = bytes.get_mut(at) {
                *byte ^= 1 << random.below(8);
            }
        }
        6 => {
            let word = WORDS[random.below(WORDS.len())];
            let is_part = |b: &u8| !b.is_ascii_whitespace() && !b",:=".contains(b);
            let length = bytes[at..].iter().take_while(|b| is_part(b)).take(12).count();
            bytes.splice(at..at + length, word.bytes());
        }
        _ => {
            let edge = EDGES[random.below(EDGES.len())].wrapping_add(random.below(3) as u64).wrapping_sub(1);
            let size = [1, 2, 4, 8][random.below(4)];
            let word = match random.below(2) {
                0 => edge.to_le_bytes()[..size].to_vec(),
                _ => edge.to_be_bytes()[8 - size..].to_vec(),
            };
            let end = (at + size).min(bytes.len());
            bytes.splice(at..end, word);
        }
    }
}

/// A reader that checks sums would see nothing else.
fn mend_sums(bytes: &mut [u8]) {
    let mut at = 8;
    while let Some(length) = bytes.get(at..at + 4) {
        let length = u32::from_be_bytes([length[0], length[1], length[2], length[3]]) as usize;
        let Some(end) = (at + 8).checked_add(length).filter(|end| end + 4 <= bytes.len()) else { break };
        let mut sum = Crc::new();
        sum.update(&bytes[at + 4..end]);
        bytes[end..end + 4].copy_from_slice(&sum.sum().to_be_bytes());
        at = end + 4;
    }
}

pub fn survive(input: &Input) {
    let mut random = Random::new(input.seed);
    let options = DemOptions {
        spacing: [None, Some([10.0, 10.0]), Some([f64::NAN, -1.0])][random.below(3)],
        heights: [None, Some([0.0, 100.0]), Some([5.0, f64::INFINITY])][random.below(3)],
        encoding: [None, Some(Encoding::Grey), Some(Encoding::Terrarium), Some(Encoding::TerrainRgb)]
            [random.below(4)],
        voids: [Voids::Hole, Voids::Fill][random.below(2)],
        nodata: [None, Some(0.0), Some(f64::NAN)][random.below(3)],
    };
    match read(&input.name, &input.bytes, &options) {
        Ok(terrain) => {
            assert!(terrain.width >= 2 && terrain.height >= 2);
            assert_eq!(terrain.samples.len() as u64, u64::from(terrain.width) * u64::from(terrain.height));
            assert!(terrain.min.is_finite() && terrain.max.is_finite() && terrain.min <= terrain.max);
            assert!(terrain.spacing.iter().all(|d| d.is_finite() && *d > 0.0));
        }
        Err(why) => assert!(!why.to_string().is_empty()),
    }
}

fn read(
    name: &str,
    bytes: &[u8],
    options: &DemOptions,
) -> Result<ghyll_runtime::terrain::Terrain, dem::DemError> {
    let split = bytes.windows(BESIDE.len()).position(|window| window == BESIDE);
    let Some(at) = split.filter(|_| name.ends_with(".bil")) else { return dem::read(name, bytes, options) };
    let folder: PathBuf = Path::new(env!("CARGO_TARGET_TMPDIR")).join(std::process::id().to_string());
    let _ = std::fs::create_dir_all(&folder);
    let _ = std::fs::write(folder.join("field.hdr"), &bytes[..at]);
    let name = folder.join("field.bil").display().to_string();
    let read = dem::read(&name, &bytes[at + BESIDE.len()..], options);
    let _ = std::fs::remove_dir_all(&folder);
    read
}
