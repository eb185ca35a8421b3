//! From decoded numbers to samples: voids, 16-bit storage where it is lossless, rows from south to north.

use super::DemError;
use crate::terrain::field::{Georeference, Samples, Terrain, VOID_F32, VOID_I16};

/// Decoded numbers, rows from north to south.
#[derive(Debug)]
pub(in crate::terrain) enum Values {
    I16(Vec<i16>),
    U16(Vec<u16>),
    I32(Vec<i32>),
    U32(Vec<u32>),
    I64(Vec<i64>),
    F32(Vec<f32>),
    F64(Vec<f64>),
}

/// A decoded file on its way to a [`Terrain`].
pub(super) struct Grid {
    pub width: u32,
    pub height: u32,
    pub values: Values,
    /// The number that stands for a missing sample; -32768 always does in 16-bit data, and NaN in floats.
    pub nodata: Option<f64>,
    /// Height is `value * scale + offset`.
    pub scale: f64,
    pub offset: f64,
    pub spacing: [f64; 2],
    pub crs: Option<Georeference>,
    pub format: String,
    /// Rows from south to north already.
    pub south_first: bool,
}

impl Grid {
    pub fn terrain(self, file: &str) -> Result<Terrain, DemError> {
        let width = self.width as usize;
        let (mut samples, shift) = match self.values {
            Values::I16(mut data) => {
                let nodata = self.nodata.filter(|n| n.fract() == 0.0).map(|n| n as i64);
                for value in &mut data {
                    if nodata == Some(i64::from(*value)) {
                        *value = VOID_I16;
                    }
                }
                (Samples::I16(data), 0.0)
            }
            Values::U16(data) => integers(&data, self.nodata),
            Values::I32(data) => integers(&data, self.nodata),
            Values::U32(data) => integers(&data, self.nodata),
            Values::I64(data) => integers(&data, self.nodata),
            Values::F32(data) => {
                // Files say nodata in decimal; it is compared as the samples are stored.
                let nodata = self.nodata.map(|n| n as f32);
                let keep = |v: f32| if v.is_finite() && Some(v) != nodata { v } else { VOID_F32 };
                (Samples::F32(data.into_iter().map(keep).collect()), 0.0)
            }
            Values::F64(data) => {
                let fits = |v: f64| v.is_finite() && v.abs() < 1e37 && Some(v) != self.nodata;
                let keep = |v: f64| if fits(v) { v as f32 } else { VOID_F32 };
                (Samples::F32(data.into_iter().map(keep).collect()), 0.0)
            }
        };
        if !self.south_first && samples.len() >= width {
            match &mut samples {
                Samples::I16(data) => turn(data, width),
                Samples::F32(data) => turn(data, width),
            }
        }
        let offset = self.offset + shift * self.scale;
        let scaling = (self.scale, offset);
        let terrain = Terrain::new(
            file,
            self.width,
            self.height,
            self.spacing,
            samples,
            scaling,
            self.crs,
            self.format,
        )?;
        Ok(Terrain { nodata: self.nodata, ..terrain })
    }
}

/// Integers as 16-bit samples if their range allows it, with what has to be added to them; else as floats.
fn integers<T: Copy + Into<i64>>(data: &[T], nodata: Option<f64>) -> (Samples, f64) {
    let nodata = nodata.filter(|n| n.fract() == 0.0).map(|n| n as i64);
    let valid = |v: &T| Some((*v).into()) != nodata;
    let (mut lo, mut hi) = (i64::MAX, i64::MIN);
    for v in data.iter().filter(|v| valid(v)) {
        lo = lo.min((*v).into());
        hi = hi.max((*v).into());
    }
    let (least, most) = (i64::from(i16::MIN) + 1, i64::from(i16::MAX));
    if lo > hi || hi.saturating_sub(lo) <= most - least {
        let shift = if lo > hi || (lo >= least && hi <= most) { 0 } else { lo - least };
        let raw = |v: &T| if valid(v) { ((*v).into() - shift) as i16 } else { VOID_I16 };
        return (Samples::I16(data.iter().map(raw).collect()), shift as f64);
    }
    let raw = |v: &T| if valid(v) { (*v).into() as f32 } else { VOID_F32 };
    (Samples::F32(data.iter().map(raw).collect()), 0.0)
}

/// Reverses the order of rows.
fn turn<T>(data: &mut [T], width: usize) {
    let rows = data.len() / width;
    for r in 0..rows / 2 {
        let (south, north) = data.split_at_mut((rows - 1 - r) * width);
        south[r * width..(r + 1) * width].swap_with_slice(&mut north[..width]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_turned() {
        let mut data = vec![1, 2, 3, 4, 5, 6];
        turn(&mut data, 2);
        assert_eq!(data, [5, 6, 3, 4, 1, 2]);
    }

    #[test]
    fn integers_stay_sixteen_bit_where_they_can() {
        let (samples, shift) = integers(&[40_000u16, 65_535, 30_000], Some(65_535.0));
        let Samples::I16(data) = samples else { panic!("fits") };
        assert_eq!(data[1], VOID_I16);
        assert_eq!((f64::from(data[0]) + shift, f64::from(data[2]) + shift), (40_000.0, 30_000.0));
        assert!(matches!(integers(&[0u16, 65_535], None).0, Samples::F32(_)));
        assert!(matches!(integers(&[i64::MIN, i64::MAX], None).0, Samples::F32(_)));
    }
}
