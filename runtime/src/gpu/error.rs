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

/// A run that did not end in a value.
#[derive(Debug, Error)]
pub enum RunError {
    #[error(
        "`{function}` was still running after {seconds:.1} s and {rewrites} rewrites; does it end? \
         A longer time can be given with --timeout"
    )]
    Timeout { function: String, seconds: f64, rewrites: u64 },
    #[error(
        "`{function}` ran out of memory: {bytes} bytes are in use and the limit is {limit}; does it end? \
         More can be allowed with --max-memory"
    )]
    OutOfMemory { function: String, bytes: u64, limit: u64 },
    #[error("`{function}` was still running after {rewrites} rewrites, the limit given with --max-rewrites")]
    MaxRewrites { function: String, rewrites: u64 },
    #[error(
        "a loop in `{function}` did not end within {steps} steps, the most that fit into one submission; \
         mark the function @task to run it in pieces"
    )]
    LoopTooLong { function: String, steps: u32 },
    #[error("the GPU device was lost: {0}; try again, or use --on cpu")]
    DeviceLost(String),
    #[error("the program has a call of {arity} words, more than the {limit} that a stream block can hold")]
    ArityTooLong { arity: u32, limit: u32 },
    #[error("the stream cannot be rewritten further: `{function}` lacks operands")]
    Stuck { function: String },
    #[error("the adapter refused a shader: {0}")]
    Shader(String),
    #[error("the picture of {width}x{height} does not fit a buffer of this adapter ({limit} bytes)")]
    ImageTooLarge { width: u32, height: u32, limit: u64 },
}
