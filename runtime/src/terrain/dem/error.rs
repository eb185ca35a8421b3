//! What can be wrong with a DEM, and what to do about it.

use std::fmt::Display;

#[derive(Debug, thiserror::Error)]
pub enum DemError {
    #[error("cannot read {file}: {source}; check the path and its permissions")]
    Unreadable { file: String, source: std::io::Error },
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
    pub(in crate::terrain) fn truncated(file: &str, what: impl Display) -> DemError {
        DemError::Truncated { file: file.to_owned(), what: what.to_string() }
    }

    pub(in crate::terrain) fn lying(file: &str, what: impl Display) -> DemError {
        DemError::Lying { file: file.to_owned(), what: what.to_string() }
    }

    pub(in crate::terrain) fn unsupported(file: &str, what: impl Display, mend: impl Display) -> DemError {
        DemError::Unsupported { file: file.to_owned(), what: what.to_string(), mend: mend.to_string() }
    }
}
