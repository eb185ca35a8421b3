//! Portable grey maps (PGM, binary), 8 or 16 bits; the range is given as for other grey images.

use super::grid::{Grid, Values};
use super::{DemError, DemOptions, check_claim, grey_range};
use crate::terrain::field::Terrain;

pub(super) fn read(file: &str, bytes: &[u8], options: &DemOptions) -> Result<Terrain, DemError> {
    let (fields, start) = header(bytes).ok_or_else(|| DemError::truncated(file, "its header is cut off"))?;
    let [width, height, white] = fields;
    if !(1..=65535).contains(&white) {
        return Err(DemError::lying(file, format!("its white is {white}")));
    }
    let sample = if white > 255 { 2 } else { 1 };
    let data = &bytes[start..];
    check_claim(file, (width, height), sample, data.len() as u64, false)?;
    let data = &data[..(width * height * sample) as usize];
    let values: Vec<u16> = if sample == 2 {
        data.chunks_exact(2).map(|b| u16::from_be_bytes([b[0], b[1]])).collect()
    } else {
        data.iter().map(|b| u16::from(*b)).collect()
    };
    let (scale, offset) = grey_range(file, options, white as f64)?;
    Grid {
        width: width as u32,
        height: height as u32,
        values: Values::U16(values),
        nodata: options.nodata,
        scale,
        offset,
        spacing: options.spacing.unwrap_or([1.0, 1.0]),
        crs: None,
        format: "PGM grey".to_owned(),
        south_first: false,
    }
    .terrain(file)
}

/// Width, height and white behind the magic number, and where the samples begin.
fn header(bytes: &[u8]) -> Option<([u64; 3], usize)> {
    let mut at = 2;
    let mut fields = [0u64; 3];
    for field in &mut fields {
        loop {
            match bytes.get(at)? {
                b'#' => at += bytes[at..].iter().position(|b| *b == b'\n')?,
                c if c.is_ascii_whitespace() => at += 1,
                _ => break,
            }
        }
        let digits = bytes[at..].iter().take_while(|b| b.is_ascii_digit()).take(9).count();
        *field = std::str::from_utf8(&bytes[at..at + digits]).ok()?.parse().ok()?;
        at += digits;
    }
    bytes.get(at).filter(|b| b.is_ascii_whitespace())?;
    Some((fields, at + 1))
}
