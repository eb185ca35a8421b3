//! What can go wrong on the GPU. A message says what ran out, where, and what to do.

use thiserror::Error;

/// No device.
#[derive(Debug, Error)]
pub enum GpuError {
    #[error("no GPU adapter was found; install a Vulkan, Metal or Direct3D 12 driver, or use --on cpu")]
    NoAdapter,
    #[error("no GPU adapter's name contains `{wanted}`; there are: {found}")]
    NoSuchAdapter { wanted: String, found: String },
    #[error("adapter {adapter} cannot run compute shaders; use --on cpu")]
    NoCompute { adapter: String },
    #[error("adapter {adapter} gave no device: {reason}")]
    NoDevice { adapter: String, reason: String },
}
