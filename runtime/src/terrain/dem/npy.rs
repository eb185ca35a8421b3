//! NumPy arrays of two dimensions, in C order, rows from north to south.

use super::grid::{Grid, Values};
use super::{DemError, DemOptions, check_claim};
use crate::terrain::field::Terrain;

const MEND: &str = "save it with numpy.save as a two-dimensional C-ordered array of i2, u2, i4, f4 or f8";

pub(super) fn read(file: &str, bytes: &[u8], options: &DemOptions) -> Result<Terrain, DemError> {
    let short = || DemError::truncated(file, "its header is cut off");
    let major = *bytes.get(6).ok_or_else(short)?;
    let (start, length) = if major == 1 {
        let b = bytes.get(8..10).ok_or_else(short)?;
        (10, usize::from(u16::from_le_bytes([b[0], b[1]])))
    } else {
        let b = bytes.get(8..12).ok_or_else(short)?;
        (12, u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize)
    };
    let end = start + length;
    let header = bytes.get(start..end).ok_or_else(short)?;
    let header = std::str::from_utf8(header).map_err(|_| DemError::lying(file, "its header is not text"))?;
    let data = &bytes[end..];

    let absent = |key: &str| DemError::lying(file, format!("its header has no `{key}`"));
    let descr = value(header, "descr").ok_or_else(|| absent("descr"))?.trim_matches(['\'', '"']).to_owned();
    if value(header, "fortran_order").ok_or_else(|| absent("fortran_order"))? != "False" {
        return Err(DemError::unsupported(file, "its array is in Fortran order", MEND));
    }
    let shape = value(header, "shape").ok_or_else(|| absent("shape"))?;
    let sides: Option<Vec<u64>> = shape
        .trim_matches(['(', ')'])
        .split(',')
        .map(str::trim)
        .filter(|s| !s.is_empty())
        .map(|s| s.parse().ok())
        .collect();
    let Some(&[height, width]) = sides.as_deref() else {
        return Err(DemError::unsupported(file, format!("its shape is {shape}"), MEND));
    };
    let (order, kind) = descr.split_at_checked(1).unwrap_or(("", ""));
    let sample = match kind {
        "i2" | "u2" => 2,
        "i4" | "f4" => 4,
        "f8" => 8,
        _ => return Err(DemError::unsupported(file, format!("its samples are `{descr}`"), MEND)),
    };
    let big = match order {
        "<" | "=" => false,
        ">" => true,
        _ => return Err(DemError::unsupported(file, format!("its samples are `{descr}`"), MEND)),
    };
    check_claim(file, (width, height), sample, data.len() as u64, false)?;
    let count = (width * height * sample) as usize;
    Grid {
        width: width as u32,
        height: height as u32,
        values: decode(&data[..count], kind, big),
        nodata: None,
        scale: 1.0,
        offset: 0.0,
        spacing: options.spacing.unwrap_or([1.0, 1.0]),
        crs: None,
        format: format!("NumPy {descr}"),
        south_first: false,
    }
    .terrain(file)
}

/// The text behind `'key':` in the header's Python dictionary, up to the comma that ends it.
fn value<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    let at = header.find(&format!("'{key}'"))?;
    let rest = header[at..].split_once(':')?.1.trim_start();
    let end = if rest.starts_with('(') { rest.find(')')? + 1 } else { rest.find([',', '}'])? };
    Some(rest[..end].trim())
}

fn decode(data: &[u8], kind: &str, big: bool) -> Values {
    /// The array's chunks as N bytes in little-endian order.
    fn words<const N: usize>(data: &[u8], big: bool) -> impl Iterator<Item = [u8; N]> {
        data.chunks_exact(N).map(move |chunk| {
            let mut word = [0; N];
            word.copy_from_slice(chunk);
            if big {
                word.reverse();
            }
            word
        })
    }
    match kind {
        "i2" => Values::I16(words(data, big).map(i16::from_le_bytes).collect()),
        "u2" => Values::U16(words(data, big).map(u16::from_le_bytes).collect()),
        "i4" => Values::Int(words(data, big).map(|w| i64::from(i32::from_le_bytes(w))).collect()),
        "f4" => Values::F32(words(data, big).map(f32::from_le_bytes).collect()),
        _ => Values::F64(words(data, big).map(f64::from_le_bytes).collect()),
    }
}
