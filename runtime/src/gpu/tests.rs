//! The rewriter on whatever adapter there is.

mod examples;
mod layouts;
mod pictures;
mod programs;
mod streams;
mod values;
