//! Compiler of Ghyll: text in, [`table::Table`] and initial stream or diagnostics out.
pub mod back;
pub mod builtins;
pub mod core;
pub mod diagnostic;
pub mod interpret;
pub mod intrinsics;
pub mod layout;
pub mod lower;
pub mod optimise;
pub mod scalar;
pub mod source;
pub mod split;
pub mod stream;
pub mod table;
pub mod typed;
pub mod types;
pub mod wgsl;

/// Random programs for the differential tests of this crate and of the runtime.
#[doc(hidden)]
pub mod random;
