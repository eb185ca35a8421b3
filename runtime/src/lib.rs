//! Runtime of Ghyll.
pub mod terrain;
