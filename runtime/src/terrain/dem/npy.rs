//! NumPy arrays of two dimensions, in C order, rows from north to south.

use super::grid::{Grid, Values};
use super::{DemError, DemOptions, check_claim};
use crate::terrain::field::Terrain;

const MEND: &str =
    "save it with numpy.save as a two-dimensional C-ordered array of i2, u2, i4, u4, i8, f4 or f8";

pub(in crate::terrain) const MAGIC: &[u8] = b"\x93NUMPY";

/// An array as its header describes it.
pub(in crate::terrain) struct Array<'a> {
    file: &'a str,
    pub shape: Vec<u64>,
    descr: String,
    pub data: &'a [u8],
}

impl Array<'_> {
    /// Bytes of a number.
    pub fn sample(&self) -> Result<u64, DemError> {
        let (order, kind) = self.descr.split_at_checked(1).unwrap_or(("", ""));
        let ordered = ["<", "=", ">"].contains(&order);
        match kind {
            "u1" => Ok(1),
            "i2" | "u2" if ordered => Ok(2),
            "i4" | "u4" | "f4" if ordered => Ok(4),
            "i8" | "f8" if ordered => Ok(8),
            _ => Err(DemError::unsupported(self.file, format!("its samples are `{}`", self.descr), MEND)),
        }
    }

    /// Refuses numbers behind those of the shape, which has been looked at.
    pub fn check_end(&self) -> Result<(), DemError> {
        let held = self.data.len() as u64 / self.sample()?;
        match held > self.shape.iter().product() {
            true => Err(DemError::too_many(self.file, held, &self.shape)),
            false => Ok(()),
        }
    }

    pub fn is_bytes(&self) -> bool {
        self.descr.ends_with("u1")
    }

    /// The first numbers.
    pub fn values(&self, count: usize) -> Result<Values, DemError> {
        let held = count * self.sample()? as usize;
        Ok(decode(&self.data[..held], &self.descr[1..], self.descr.starts_with('>')))
    }
}

pub(super) fn read(file: &str, bytes: &[u8], options: &DemOptions) -> Result<Terrain, DemError> {
    let array = parse(file, bytes)?;
    let &[height, width] = array.shape.as_slice() else {
        return Err(DemError::unsupported(file, format!("its shape is {:?}", array.shape), MEND));
    };
    check_claim(file, (width, height), array.sample()?, array.data.len() as u64, false)?;
    array.check_end()?;
    Grid {
        width: width as u32,
        height: height as u32,
        values: array.values((width * height) as usize)?,
        nodata: options.nodata,
        scale: 1.0,
        offset: 0.0,
        spacing: options.spacing.unwrap_or([1.0, 1.0]),
        crs: None,
        format: format!("NumPy {}", array.descr),
        south_first: false,
    }
    .terrain(file)
}

pub(in crate::terrain) fn parse<'a>(file: &'a str, bytes: &'a [u8]) -> Result<Array<'a>, DemError> {
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
    let Some(shape) = sides else {
        return Err(DemError::unsupported(file, format!("its shape is {shape}"), MEND));
    };
    Ok(Array { file, shape, descr, data: &bytes[end..] })
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
        "u1" => Values::U16(data.iter().copied().map(u16::from).collect()),
        "i2" => Values::I16(words(data, big).map(i16::from_le_bytes).collect()),
        "u2" => Values::U16(words(data, big).map(u16::from_le_bytes).collect()),
        "u4" => Values::U32(words(data, big).map(u32::from_le_bytes).collect()),
        "i4" => Values::I32(words(data, big).map(i32::from_le_bytes).collect()),
        "i8" => Values::I64(words(data, big).map(i64::from_le_bytes).collect()),
        "f4" => Values::F32(words(data, big).map(f32::from_le_bytes).collect()),
        _ => Values::F64(words(data, big).map(f64::from_le_bytes).collect()),
    }
}
