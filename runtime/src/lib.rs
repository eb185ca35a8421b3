//! Runtime of Ghyll: the rewriter on the GPU, its CPU twin, the oracle, and terrain.

pub mod gpu;
