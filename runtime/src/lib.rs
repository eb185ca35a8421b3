//! Runtime of Ghyll: the rewriter on the GPU, its CPU twin, the oracle, and terrain. [`machine`] runs a compiled
//! program on any of them; [`api`] is the interface for Rust programs.

pub mod api;
pub mod bake;
pub mod config;
pub mod emit;
pub mod error;
pub mod files;
pub mod gpu;
pub mod gpu_terrain;
pub mod image;
pub mod kernels;
pub mod machine;
pub mod map;
pub mod memory;
mod needs;
pub mod oracle;
pub mod presets;
pub mod progress;
pub mod rasters;
pub mod renderer;
pub mod samples;
pub mod terrain;
pub mod tuner;
pub mod twin;
pub mod value;
pub mod world;
