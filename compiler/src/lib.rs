//! Compiler of Ghyll: text in, [`table::Table`] and initial stream or diagnostics out. No files, no GPU, no clock.
//!
//! text -> [`lexer`], [`parse`] -> [`ast`] -> names and types ([`front`]) -> [`typed`] tree -> [`lower`], `derive` -> [`core`]
//! -> [`optimise`] -> [`split`] -> [`table`] -> [`wgsl`]. [`compile`] plays them in order.

pub mod account;
pub mod analysis;
pub mod argument;
pub mod ast;
pub mod back;
pub mod bake;
mod bounds;
pub mod builtins;
pub mod codes;
pub mod compile;
pub mod core;
mod derive;
pub mod diagnostic;
pub mod entry;
mod exhaustive;
pub mod explain;
mod foreign;
pub mod format;
pub mod front;
mod infer;
pub mod interpret;
pub mod intrinsics;
pub mod layout;
pub mod lexer;
pub mod library;
pub mod lower;
pub mod optimise;
pub mod parse;
pub mod print;
pub mod report;
mod resolve;
pub use infer::show::show_type;
pub use resolve::similar;
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
