//! The rewriter on whatever adapter there is.

mod bench;
mod pictures;
mod programs;
mod values;
