//! What can be wrong with a DEM, and what to do about it.

use std::error::Error;
use std::fmt::Display;
use std::io;

#[derive(Debug, thiserror::Error)]
pub enum DemError {
    #[error("cannot read {file}: {source}; check the path and its permissions")]
    Unreadable { file: String, source: io::Error },
    #[error(
        "{file} is not elevation data that can be read; the formats are GeoTIFF, .hgt, .asc, .bil, .npy, PNG, PGM, \
         USGS .dem and raw .f32, .i16 or .u16, each also as .gz or .zip"
    )]
    UnknownFormat { file: String },
    #[error("{file} is truncated or damaged: {what}; get the file again")]
    Truncated { file: String, what: String },
    #[error("{file} contradicts itself: {what}; get the file again")]
    Lying { file: String, what: String },
    #[error("{file} is too large: {what}; cut a window or reduce it first")]
    TooLarge { file: String, what: String },
    #[error("{file} cannot be used: {what}; {mend}")]
    Unsupported { file: String, what: String, mend: String },
}

impl DemError {
    /// The same about the file that was named, where it was found in what that holds.
    pub(super) fn about(mut self, name: &str) -> DemError {
        let (DemError::Unreadable { file, .. }
        | DemError::UnknownFormat { file }
        | DemError::Truncated { file, .. }
        | DemError::Lying { file, .. }
        | DemError::TooLarge { file, .. }
        | DemError::Unsupported { file, .. }) = &mut self;
        name.clone_into(file);
        self
    }

    /// What a decoder could not make sense of, without its own words.
    pub(in crate::terrain) fn damaged(file: &str, format: &str, error: &(dyn Error + 'static)) -> DemError {
        let mut short = false;
        let mut cause = Some(error);
        while let Some(e) = cause {
            let found = match e.downcast_ref::<image::ImageError>() {
                Some(image::ImageError::IoError(e)) => Some(e),
                _ => e.downcast_ref::<io::Error>(),
            };
            short |= found.is_some_and(|e| e.kind() == io::ErrorKind::UnexpectedEof);
            cause = e.source();
        }
        match short {
            true => DemError::truncated(file, format!("its {format} data ends too early")),
            false => DemError::truncated(
                file,
                format!("its {format} data does not fit its checksums or its structure"),
            ),
        }
    }

    pub(in crate::terrain) fn truncated(file: &str, what: impl Display) -> DemError {
        DemError::Truncated { file: file.to_owned(), what: what.to_string() }
    }

    pub(in crate::terrain) fn lying(file: &str, what: impl Display) -> DemError {
        DemError::Lying { file: file.to_owned(), what: what.to_string() }
    }

    /// Read on, every row after the first would be shifted or the last ones lost.
    pub(in crate::terrain) fn too_many(file: &str, held: u64, shape: &[u64]) -> DemError {
        let sides: Vec<String> = shape.iter().map(u64::to_string).collect();
        let (sides, count) = (sides.join(" x "), shape.iter().product::<u64>());
        let what = format!("it holds {held} numbers where its header says {sides} = {count}");
        DemError::lying(file, what)
    }

    pub(in crate::terrain) fn unsupported(file: &str, what: impl Display, mend: impl Display) -> DemError {
        DemError::Unsupported { file: file.to_owned(), what: what.to_string(), mend: mend.to_string() }
    }
}
