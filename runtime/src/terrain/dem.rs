//! Elevation data from files. One format a file in `dem/`; this one finds the format, and holds the limits that are
//! checked before memory is asked for.

mod bil;
mod error;
mod geo;
pub(in crate::terrain) mod geotiff;
mod grid;
mod hgt;
pub(in crate::terrain) mod npy;
mod pgm;
mod png;
mod prj;
mod raw;
mod text;
mod usgs;
mod zip;

pub use error::DemError;
pub(in crate::terrain) use grid::Values;

use super::field::Terrain;
use std::io::Read;
use std::path::Path;

/// More samples than this are refused.
pub const MAX_SAMPLES: u64 = 1 << 29;
/// Larger files are refused.
const MAX_FILE: u64 = 1 << 32;
/// No supported compression packs tighter than this.
const MAX_RATIO: u64 = 2048;

/// How an image holds heights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    Grey,
    /// `R * 256 + G + B / 256 - 32768` metres.
    Terrarium,
    /// `-10000 + (R * 65536 + G * 256 + B) / 10` metres.
    TerrainRgb,
}

impl Encoding {
    pub const ALL: &'static [(&'static str, Encoding)] = &[
        ("grey", Encoding::Grey),
        ("terrarium", Encoding::Terrarium),
        ("terrain-rgb", Encoding::TerrainRgb),
    ];
}

/// What becomes of missing samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Voids {
    /// Rays pass through.
    #[default]
    Hole,
    /// Filled from the rim inwards.
    Fill,
}

/// What a file may leave open.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DemOptions {
    /// Metres between samples, eastwards and northwards; overrides the file's. Images and arrays without units have 1.
    pub spacing: Option<[f64; 2]>,
    /// Heights in metres that black and white stand for in a grey image; without it the stored numbers are metres.
    pub heights: Option<[f64; 2]>,
    /// How a PNG holds heights; grey images need none.
    pub encoding: Option<Encoding>,
    pub voids: Voids,
    /// The number that stands for a missing sample, as it is stored (in metres where heights are packed in colours);
    /// overrides the file's.
    pub nodata: Option<f64>,
}

/// Reads a file's content; the name's ending may say how.
type Reader = fn(&str, &[u8], &DemOptions) -> Result<Terrain, DemError>;

/// Formats by their first bytes, then by the name's ending.
const MAGIC: &[(&[u8], Reader)] = &[
    (b"II*\0", geotiff::read),
    (b"MM\0*", geotiff::read),
    (b"II+\0", geotiff::read),
    (b"MM\0+", geotiff::read),
    (b"\x89PNG\r\n\x1a\n", png::read),
    (b"\x93NUMPY", npy::read),
    (b"P5", pgm::read),
];
const ENDINGS: &[(&str, Reader)] = &[
    ("tif", geotiff::read),
    ("tiff", geotiff::read),
    ("png", png::read),
    ("npy", npy::read),
    ("hgt", hgt::read),
    ("asc", text::read),
    ("bil", bil::read),
    ("pgm", pgm::read),
    ("f32", raw::read),
    ("i16", raw::read),
    ("u16", raw::read),
    ("raw", raw::read),
    ("bin", raw::read),
    ("dem", usgs::read),
];

const GZIP: &[u8] = &[0x1f, 0x8b];

pub(super) fn open(path: &Path, options: &DemOptions) -> Result<Terrain, DemError> {
    let file = path.display().to_string();
    known(&file, path)?;
    let mut terrain = read(&file, &bytes_of(path)?, options)?;
    prj::place(&mut terrain, path, options);
    Ok(terrain)
}

/// Looks at the first bytes and the name, so that a large file of another kind is refused before it is read.
fn known(file: &str, path: &Path) -> Result<(), DemError> {
    let mut head = Vec::new();
    let unreadable = |source| DemError::Unreadable { file: file.to_owned(), source };
    if !std::fs::metadata(path).map_err(unreadable)?.is_file() {
        return Ok(());
    }
    std::fs::File::open(path).and_then(|f| f.take(16).read_to_end(&mut head)).map_err(unreadable)?;
    let packed = head.starts_with(GZIP) || zip::is_zip(&head);
    match head.is_empty() || packed || reader(file, &head).is_some() {
        true => Ok(()),
        false => Err(unknown(file)),
    }
}

/// A file of no known format, unless it belongs to one.
fn unknown(file: &str) -> DemError {
    if !has_ending(file, "hdr") {
        return DemError::UnknownFormat { file: file.to_owned() };
    }
    let grid = Path::new(file).with_extension("bil");
    DemError::unsupported(
        file,
        "it is the header of a grid",
        format!("name the grid itself, {}", grid.display()),
    )
}

fn has_ending(file: &str, ending: &str) -> bool {
    Path::new(file).extension().is_some_and(|e| e.eq_ignore_ascii_case(ending))
}

/// What reads a file, by its first bytes or its name.
fn reader(file: &str, head: &[u8]) -> Option<Reader> {
    let ending =
        Path::new(file).extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let by_magic = MAGIC.iter().find(|(magic, _)| head.starts_with(magic)).map(|(_, read)| read);
    let by_name = || ENDINGS.iter().find(|(e, _)| *e == ending).map(|(_, read)| read);
    by_magic.or_else(by_name).copied()
}

/// A file's content, unless it is too large to be one of ours.
pub(super) fn bytes_of(path: &Path) -> Result<Vec<u8>, DemError> {
    let file = path.display().to_string();
    let unreadable = |source| DemError::Unreadable { file: file.clone(), source };
    let about = std::fs::metadata(path).map_err(unreadable)?;
    if !about.is_file() {
        return Err(DemError::unsupported(&file, "it is not a regular file", "name a file of data"));
    }
    if about.len() > MAX_FILE {
        return Err(DemError::TooLarge { file, what: format!("it has {} bytes", about.len()) });
    }
    std::fs::read(path).map_err(unreadable)
}

/// Reads a DEM from memory; `file` names it in messages, and its ending and base name count as a file's.
pub fn read(file: &str, bytes: &[u8], options: &DemOptions) -> Result<Terrain, DemError> {
    let mut terrain = if bytes.starts_with(GZIP) {
        let plain = inflate(file, bytes)?;
        let inner = file.strip_suffix(".gz").unwrap_or(file);
        read_plain(inner, &plain, options).map_err(|e| e.about(file))?
    } else if zip::is_zip(bytes) {
        let archive = zip::Archive::open(file, bytes)?;
        let (name, plain) = archive.grid()?;
        let inner = format!("{file}/{name}");
        if has_ending(name, "bil") {
            let header = archive.beside(name, "hdr")?;
            applied(&inner, bil::parse(&inner, &plain, &header, options)?, options)?
        } else {
            read_plain(&inner, &plain, options)?
        }
    } else {
        read_plain(file, bytes, options)?
    };
    if options.voids == Voids::Fill {
        terrain.fill_voids();
    }
    Ok(terrain)
}

fn read_plain(file: &str, bytes: &[u8], options: &DemOptions) -> Result<Terrain, DemError> {
    if bytes.is_empty() {
        return Err(DemError::truncated(file, "it is empty"));
    }
    match reader(file, bytes) {
        Some(read) => applied(file, read(file, bytes, options)?, options),
        None => Err(unknown(file)),
    }
}

/// Refuses options that say something about another kind of file.
fn applied(file: &str, terrain: Terrain, options: &DemOptions) -> Result<Terrain, DemError> {
    let format = &terrain.format;
    let unused = if options.heights.is_some() && !format.ends_with("grey") {
        Some(("its numbers have a meaning of their own", "leave --heights out; it is for grey images"))
    } else if options.encoding.is_some() && !format.starts_with("PNG") {
        Some(("it packs no heights in colours", "leave --encoding out; it is for PNG images"))
    } else {
        None
    };
    match unused {
        Some((what, mend)) => Err(DemError::unsupported(file, format!("it is {format}: {what}"), mend)),
        None => Ok(terrain),
    }
}

fn inflate(file: &str, bytes: &[u8]) -> Result<Vec<u8>, DemError> {
    let limit = (bytes.len() as u64).saturating_mul(MAX_RATIO).min(MAX_FILE);
    let mut plain = Vec::new();
    let mut reader = flate2::read::MultiGzDecoder::new(bytes).take(limit + 1);
    reader.read_to_end(&mut plain).map_err(|e| DemError::damaged(file, "gzip", &e))?;
    if plain.len() as u64 > limit {
        return Err(DemError::TooLarge { file: file.to_owned(), what: "it unpacks to too much".to_owned() });
    }
    Ok(plain)
}

/// A field needs a cell, and has to fit in memory.
pub(super) fn check_shape(file: &str, width: u64, height: u64) -> Result<(), DemError> {
    if width < 2 || height < 2 {
        let what = format!("it has {width} x {height} samples");
        return Err(DemError::unsupported(file, what, "a surface needs at least 2 x 2 samples"));
    }
    check_size(file, width, height)
}

/// Anything has to be there, and to fit in memory.
pub(super) fn check_size(file: &str, width: u64, height: u64) -> Result<(), DemError> {
    if width == 0 || height == 0 {
        return Err(DemError::truncated(file, format!("it has {width} x {height} samples")));
    }
    if width > 1 << 17 || height > 1 << 17 || width * height > MAX_SAMPLES {
        let what = format!("it has {width} x {height} samples");
        return Err(DemError::TooLarge { file: file.to_owned(), what });
    }
    Ok(())
}

pub(super) fn check_spacing(file: &str, spacing: [f64; 2]) -> Result<(), DemError> {
    let fits = |d: f64| d.is_finite() && (1e-6..=1e7).contains(&d);
    if spacing.into_iter().all(fits) {
        return Ok(());
    }
    let what = format!("its samples are {} x {} m apart", spacing[0], spacing[1]);
    Err(DemError::unsupported(file, what, "give --spacing dx,dy in metres"))
}

/// Checks a declared shape against the bytes that have to hold it.
fn check_claim(file: &str, shape: (u64, u64), sample: u64, held: u64, packed: bool) -> Result<(), DemError> {
    check_shape(file, shape.0, shape.1)?;
    check_held(file, shape, sample, held, packed)
}

/// As [`check_claim`], for data that need not make a surface.
pub(super) fn check_held(
    file: &str,
    shape: (u64, u64),
    sample: u64,
    held: u64,
    packed: bool,
) -> Result<(), DemError> {
    check_size(file, shape.0, shape.1)?;
    let needed = shape.0 * shape.1 * sample;
    let most = if packed { held.saturating_mul(MAX_RATIO) } else { held };
    if needed > most {
        let what = format!("{} x {} samples do not fit in its {held} bytes", shape.0, shape.1);
        return Err(DemError::truncated(file, what));
    }
    Ok(())
}

/// Scale and offset of grey values, of which the highest is white.
fn grey_range(file: &str, options: &DemOptions, white: f64) -> Result<(f64, f64), DemError> {
    let [lo, hi] = options.heights.unwrap_or([0.0, white]);
    if !(lo.is_finite() && hi.is_finite() && lo < hi) {
        let what = format!("--heights {lo},{hi} is no range");
        return Err(DemError::unsupported(file, what, "give the heights of black and white, lower first"));
    }
    Ok(((hi - lo) / white, lo))
}

#[cfg(test)]
mod tests;
