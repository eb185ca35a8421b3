//! The language suite: programs with their expectations, run on every answer that Ghyll can give.
//!
//! ```text
//! suite/**/*.ghyll --case--> cases --judge--> one verdict per case and mode
//! ```
//!
//! | module | what it is |
//! |---|---|
//! | [`case`] | what a case file says, and the reader that refuses what it does not know |
//! | [`corpus`] | every program of the repository |
//! | [`value`] | values in Ghyll syntax and when two of them agree |
//! | [`mode`] | THE table of machines and settings a case runs on |
//! | [`judge`] | compares what a backend answers with what the case expects |
//! | [`manual`] | whether the programs of the documentation do what it says, and whether the manual is complete |
//! | [`pages`] | whether the pages about diagnostics are true |
//! | [`differential`] | looks for random programs on which two modes disagree |
//! | [`generate`] | random well-typed programs, and their shrinking |
//! | [`hunt`] | looks for inputs that end in a panic, a hang or too much memory |
//!
//! The format of case files is described in `tests/README.md`.

pub mod backend;
pub mod case;
pub mod corpus;
pub mod differential;
pub mod generate;
pub mod hunt;
pub mod judge;
pub mod manual;
pub mod mode;
pub mod pages;
pub mod value;
