//! Compiler of Ghyll: text in, [`table::Table`] and initial stream or diagnostics out.
pub mod back;
pub mod argument;
pub mod ast;
pub mod builtins;
pub mod codes;
pub mod core;
pub mod diagnostic;
pub mod interpret;
pub mod intrinsics;
pub mod layout;
pub mod lower;
pub mod optimise;
pub mod scalar;
mod exhaustive;
pub mod front;
mod infer;
pub mod intrinsics;
pub mod lexer;
pub mod library;
pub mod parse;
pub mod report;
mod resolve;
pub mod source;
pub mod split;
pub mod stream;
pub mod table;
pub mod typed;
pub mod types;
pub mod wgsl;

#[cfg(test)]
mod random;
