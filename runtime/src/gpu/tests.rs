//! The rewriter on whatever adapter there is.

mod bench;
mod layouts;
mod pictures;
mod programs;
mod streams;
mod values;
