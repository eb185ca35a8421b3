//! The rewriter on the GPU: a stream of tokens is rewritten in rounds until only literals are left.
//!
//! A round is the chain of dispatches decode, execute, allocate, splice (`shaders/`, one file a stage). Rounds are
//! recorded several to a submission with indirect dispatch, so the host reads one [`layout::State`] per submission:
//!
//! 1. [`Gpu`] opens an adapter ([`device`]).
//! 2. [`Engine::new`] derives all sizes from the program ([`shape`]), assembles the kernels ([`shader`]) and makes the
//!    buffers ([`buffers`]); pipelines are compiled when first used ([`pipelines`]).
//! 3. [`Engine::run`] writes the stream and plays rounds ([`rounds`]); [`Engine::render`] feeds lanes from a counter
//!    of pixels and plays rounds only for what they could not finish ([`image`]).
//!
//! Time per submission is held down by fuel ([`fuel`]), memory by the allocate stage and [`rounds`].

mod buffers;
mod code;
mod device;
mod engine;
mod error;
mod fuel;
mod hand;
mod image;
mod layout;
mod pipelines;
mod readback;
mod rounds;
mod shader;
mod shape;
mod template;

#[cfg(test)]
mod tests;

pub use crate::config::{Config, Rewriter};
pub use crate::error::RunError;
pub use code::{Code, Suspendable};
pub use device::{Gpu, GpuOptions, Info};
pub use engine::{Engine, Frame, Outcome, Scene, Stats};
pub use error::GpuError;
pub(crate) use image::readback_of_picture;
pub use pipelines::{SceneLayout, trusted_module};
pub use shader::of_program as shader;
