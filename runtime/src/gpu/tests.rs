//! The rewriter on whatever adapter there is.

mod programs;
mod values;
