//! No input makes the compiler or the readers of elevation data panic, hang or take all memory.
//!
//! Every run takes new inputs. The seed is printed; `GHYLL_SEED=..` repeats a run, `GHYLL_FUZZ_SECONDS=..` takes
//! another time than five seconds. Finds are saved in `tests/finds/`.

#[path = "fuzz/dems.rs"]
mod dems;
#[path = "fuzz/programs.rs"]
mod programs;

use ghyll_tests::corpus::corpus;
use ghyll_tests::hunt::Hunt;

#[test]
fn the_compiler_answers_every_text() {
    let hunt = Hunt::from_environment("compiler");
    println!("GHYLL_SEED={}", hunt.seed);
    let corpus = corpus();
    assert!(corpus.len() > 300, "only {} programs were found", corpus.len());
    match hunt.run(|random| programs::damaged(random, &corpus), programs::survive) {
        Ok(told) => println!("{told}"),
        Err(told) => panic!("{told}"),
    }
}

#[test]
fn elevation_data_is_read_or_refused() {
    let hunt = Hunt::from_environment("dem");
    println!("GHYLL_SEED={}", hunt.seed);
    let corpus = dems::corpus();
    for file in &corpus {
        dems::accept(file);
    }
    match hunt.run(|random| dems::damaged(random, &corpus), dems::survive) {
        Ok(told) => println!("{told}"),
        Err(told) => panic!("{told}"),
    }
}
