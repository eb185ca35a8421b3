//! `ghyll bench`.

use crate::arguments::Bench;
use crate::failure::Failure;

pub fn bench(_: &Bench) -> Result<(), Failure> {
    Err(Failure::Usage("no benchmarks yet".into()))
}
