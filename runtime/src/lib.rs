//! Runtime of Ghyll.
pub mod gpu_terrain;
pub mod image;
pub mod terrain;
