pub mod config;
pub mod error;
pub mod value;
pub mod world;
