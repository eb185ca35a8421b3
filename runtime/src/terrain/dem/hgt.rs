//! SRTM .hgt: a square of big-endian 16-bit metres; the name says which degree square it covers.

use super::geo::metres_per_degree;
use super::grid::{Grid, Values};
use super::{DemError, DemOptions, check_shape};
use crate::terrain::field::{Georeference, Terrain};
use std::path::Path;

const WGS84: u32 = 4326;

pub(super) fn read(file: &str, bytes: &[u8], options: &DemOptions) -> Result<Terrain, DemError> {
    let side = ((bytes.len() / 2) as f64).sqrt() as u64;
    if side * side * 2 != bytes.len() as u64 {
        let what = format!("{} bytes are no square of 16-bit samples", bytes.len());
        return Err(DemError::truncated(file, what));
    }
    check_shape(file, side, side)?;
    let corner = south_west(file);
    let step = 1.0 / (side - 1) as f64;
    let spacing = match (options.spacing, corner) {
        (Some(spacing), _) => spacing,
        (None, Some([_, latitude])) => metres_per_degree(latitude + 0.5).map(|m| m * step),
        (None, None) => {
            let mend = "name it by its south-west corner as in N35E138.hgt, or give --spacing dx,dy";
            return Err(DemError::unsupported(file, "its name does not say where it lies", mend));
        }
    };
    let values = bytes.chunks_exact(2).map(|b| i16::from_be_bytes([b[0], b[1]])).collect();
    Grid {
        width: side as u32,
        height: side as u32,
        values: Values::I16(values),
        nodata: options.nodata,
        scale: 1.0,
        offset: 0.0,
        spacing,
        crs: corner.map(|[longitude, latitude]| Georeference {
            epsg: Some(WGS84),
            geographic: true,
            north_west: [longitude, latitude + 1.0],
            step: [step, step],
            keys: None,
        }),
        format: "SRTM hgt int16".to_owned(),
        south_first: false,
    }
    .terrain(file)
}

/// Longitude and latitude in the base name, such as `S33W071`.
fn south_west(file: &str) -> Option<[f64; 2]> {
    let name = Path::new(file).file_name()?.to_str()?.as_bytes();
    let number = |range: std::ops::Range<usize>| -> Option<f64> {
        let digits = name.get(range)?;
        if !digits.iter().all(u8::is_ascii_digit) {
            return None;
        }
        Some(digits.iter().fold(0.0, |n, d| 10.0 * n + f64::from(d - b'0')))
    };
    let sign = |at: usize, minus: u8, plus: u8| match name.get(at)?.to_ascii_uppercase() {
        c if c == minus => Some(-1.0),
        c if c == plus => Some(1.0),
        _ => None,
    };
    let latitude = sign(0, b'S', b'N')? * number(1..3)?;
    let longitude = sign(3, b'W', b'E')? * number(4..7)?;
    (latitude.abs() <= 90.0 && longitude.abs() <= 180.0).then_some([longitude, latitude])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_says_where() {
        assert_eq!(south_west("a/N46E008.hgt"), Some([8.0, 46.0]));
        assert_eq!(south_west("s33w071.hgt"), Some([-71.0, -33.0]));
        assert_eq!(south_west("alps.hgt"), None);
        assert_eq!(south_west("N4xE008.hgt"), None);
    }
}
