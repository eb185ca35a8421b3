//! Chooses operators by measurement (paper, section 4 and what its section 7 leaves open): a frame time, an error or a memory limit is
//! given, a few choices are drawn, and the best that meets the limits is taken.
//!
//! Errors are against the picture of the best choice: every operator at its best and the most samples. So nothing is asked
//! for that no choice can give, and a choice that draws the same picture is without error.

pub mod choices;
pub mod file;
pub mod limits;
pub mod measure;

pub use choices::{Choice, SAMPLES, choices};
pub use file::{FileError, Subject, TuningFile};
pub use limits::{Limit, Limits, Shortfall};
pub use measure::{Measured, Studio};
