//! A square of little-endian 32-bit floats and nothing else, rows from north to south.

use super::grid::{Grid, Values};
use super::{DemError, DemOptions, check_shape};
use crate::terrain::field::Terrain;

pub(super) fn read(file: &str, bytes: &[u8], options: &DemOptions) -> Result<Terrain, DemError> {
    let side = ((bytes.len() / 4) as f64).sqrt() as u64;
    if side * side * 4 != bytes.len() as u64 {
        let what = format!("{} bytes are no square of 32-bit floats", bytes.len());
        return Err(DemError::unsupported(file, what, "save it as .npy, which states its shape"));
    }
    check_shape(file, side, side)?;
    let Some(spacing) = options.spacing else {
        return Err(DemError::unsupported(
            file,
            "raw floats have no spacing",
            "give --spacing dx,dy in metres",
        ));
    };
    let float = |b: &[u8]| f32::from_le_bytes([b[0], b[1], b[2], b[3]]);
    Grid {
        width: side as u32,
        height: side as u32,
        values: Values::F32(bytes.chunks_exact(4).map(float).collect()),
        nodata: None,
        scale: 1.0,
        offset: 0.0,
        spacing,
        crs: None,
        format: "raw float32".to_owned(),
        south_first: false,
    }
    .terrain(file)
}
