pub mod config;
pub mod error;
pub mod oracle;
pub mod value;
pub mod world;
