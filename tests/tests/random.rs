//! Random programs have one value on every machine.
//!
//! Every run takes new programs. The seed is printed; `GHYLL_SEED=..` repeats a run, `GHYLL_PROGRAMS=..` takes another
//! number of programs.

use ghyll_tests::backend::Ghyll;
use ghyll_tests::differential::search;
use ghyll_tests::mode::Mode;
use std::time::{SystemTime, UNIX_EPOCH};

const PROGRAMS: usize = 2000;

fn number(name: &str) -> Option<u64> {
    std::env::var(name).ok().map(|text| match text.parse() {
        Ok(n) => n,
        Err(_) => panic!("{name} must be a number, not `{text}`"),
    })
}

fn new_seed() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(1, |time| time.as_nanos() as u64 % 1_000_000_000)
}

#[test]
fn random_programs_agree_on_every_machine() {
    let seed = number("GHYLL_SEED").unwrap_or_else(new_seed);
    let programs = number("GHYLL_PROGRAMS").map_or(PROGRAMS, |n| n as usize);
    let (ghyll, _) = Ghyll::open();
    let rewrites = |mode: &Mode| mode.family() == "cpu" || mode.is_gpu();
    let modes: Vec<Mode> =
        Mode::ALL.iter().copied().filter(rewrites).filter(|mode| ghyll.runs(*mode)).collect();
    let names: Vec<&str> = modes.iter().map(|mode| mode.name()).collect();
    println!("GHYLL_SEED={seed}: {programs} programs on oracle-single {}", names.join(" "));
    if let Err(found) = search(&ghyll, &modes, seed, programs) {
        panic!("GHYLL_SEED={seed}\n{}\n\n{}", found.told, found.text);
    }
}
