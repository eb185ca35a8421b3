//! Values.

use super::super::*;
use super::programs::{fib, gpu};

fn config(rewriter: Rewriter) -> Config {
    Config { rewriter, ..Config::default() }
}

#[test]
fn fib_by_every_rewriter() {
    let Some(gpu) = gpu() else { return };
    for rewriter in [Rewriter::Block, Rewriter::Lane, Rewriter::Auto] {
        let mut engine = Engine::new(&gpu, fib(), config(rewriter), None).unwrap();
        for _ in 0..2 {
            let outcome = engine.run(&[(15, false), (0, true)]).unwrap();
            eprintln!("{rewriter:?} {:?}", outcome.stats);
            assert_eq!(outcome.words, [610]);
            assert_eq!(outcome.stats.rewrites, 1973 + 986);
        }
    }
}
