//! A square of little-endian numbers and nothing else, rows from north to south.

use super::grid::{Grid, Values};
use super::{DemError, DemOptions, check_shape};
use crate::terrain::field::Terrain;
use std::path::Path;

/// What the numbers are, by the name's ending; other names hold 32-bit floats, or 16-bit integers where only these
/// make a square.
const KINDS: &[(&str, Kind)] = &[("f32", Kind::F32), ("i16", Kind::I16), ("u16", Kind::U16)];
const UNNAMED: &[Kind] = &[Kind::F32, Kind::I16];

#[derive(Clone, Copy)]
enum Kind {
    F32,
    I16,
    U16,
}

impl Kind {
    fn bytes(self) -> usize {
        match self {
            Kind::F32 => 4,
            Kind::I16 | Kind::U16 => 2,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Kind::F32 => "float32",
            Kind::I16 => "int16",
            Kind::U16 => "uint16",
        }
    }

    /// Samples in a row of the square that so many bytes make.
    fn side(self, bytes: usize) -> Option<u64> {
        let side = ((bytes / self.bytes()) as u64).isqrt();
        (side * side * self.bytes() as u64 == bytes as u64).then_some(side)
    }

    fn values(self, bytes: &[u8]) -> Values {
        let short = |b: &[u8]| [b[0], b[1]];
        match self {
            Kind::F32 => Values::F32(
                bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect(),
            ),
            Kind::I16 => Values::I16(bytes.chunks_exact(2).map(|b| i16::from_le_bytes(short(b))).collect()),
            Kind::U16 => Values::U16(bytes.chunks_exact(2).map(|b| u16::from_le_bytes(short(b))).collect()),
        }
    }
}

pub(super) fn read(file: &str, bytes: &[u8], options: &DemOptions) -> Result<Terrain, DemError> {
    let ending =
        Path::new(file).extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let named: Vec<Kind> = KINDS.iter().filter(|(e, _)| *e == ending).map(|(_, kind)| *kind).collect();
    let kinds = if named.is_empty() { UNNAMED } else { &named };
    let found = kinds.iter().find_map(|kind| Some((*kind, kind.side(bytes.len())?)));
    let Some((kind, side)) = found else {
        let names: Vec<&str> = kinds.iter().map(|kind| kind.name()).collect();
        let what = format!("{} bytes are no square of {} numbers", bytes.len(), names.join(" or "));
        return Err(DemError::unsupported(file, what, "save it as .npy, which states its shape"));
    };
    check_shape(file, side, side)?;
    let Some(spacing) = options.spacing else {
        let what = "raw numbers have no spacing";
        return Err(DemError::unsupported(file, what, "give --spacing dx,dy in metres"));
    };
    Grid {
        width: side as u32,
        height: side as u32,
        values: kind.values(bytes),
        nodata: options.nodata,
        scale: 1.0,
        offset: 0.0,
        spacing,
        crs: None,
        format: format!("raw {}", kind.name()),
        south_first: false,
    }
    .terrain(file)
}
