//! Portable grey maps (PGM, binary), 8 or 16 bits; the range is given as for other grey images.

use super::grid::{Grid, Values};
use super::{DemError, DemOptions, check_claim, grey_range};
use crate::terrain::field::Terrain;

pub(super) fn read(file: &str, bytes: &[u8], options: &DemOptions) -> Result<Terrain, DemError> {
    let ([width, height, white], start) = header(file, bytes)?;
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
fn header(file: &str, bytes: &[u8]) -> Result<([u64; 3], usize), DemError> {
    let short = || DemError::truncated(file, "its header is cut off");
    let mut at = 2;
    let mut fields = [0u64; 3];
    for (field, name) in fields.iter_mut().zip(["width", "height", "white"]) {
        loop {
            match bytes.get(at).ok_or_else(short)? {
                b'#' => at += bytes[at..].iter().position(|b| *b == b'\n').ok_or_else(short)?,
                c if c.is_ascii_whitespace() => at += 1,
                _ => break,
            }
        }
        let digits = bytes[at..].iter().take_while(|b| b.is_ascii_digit()).count();
        let text = std::str::from_utf8(&bytes[at..at + digits]).unwrap_or_default();
        *field = match text.parse() {
            Ok(number) => number,
            Err(_) if digits > 0 => {
                let what = format!("its {name} has {digits} digits");
                return Err(DemError::TooLarge { file: file.to_owned(), what });
            }
            Err(_) => return Err(DemError::lying(file, format!("its header has no number for its {name}"))),
        };
        at += digits;
    }
    bytes.get(at).filter(|b| b.is_ascii_whitespace()).ok_or_else(short)?;
    Ok((fields, at + 1))
}
