//! Timings for docs/performance.md: `cargo test --release gpu::tests::bench -- --ignored --nocapture`.

use super::super::*;
use super::programs::{fib, gpu};

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

#[test]
#[ignore = "a measurement, not a test"]
fn fib_27() {
    let Some(gpu) = gpu() else { return };
    let stream = [(27, false), (0, true)];
    for rewriter in [Rewriter::Auto, Rewriter::Lane, Rewriter::Block] {
        let mut engine = Engine::new(&gpu, fib(), Config { rewriter, ..Config::default() }, None).unwrap();
        let mut times = Vec::new();
        let mut last = Stats::default();
        for _ in 0..9 {
            last = engine.run(&stream).unwrap().stats;
            times.push(last.time.as_secs_f64());
        }
        let time = median(times[2..].to_vec());
        println!(
            "{rewriter:?}: {:.2} ms, {:.1} M/s, {last:?}",
            time * 1e3,
            last.rewrites as f64 / time / 1e6
        );
    }
}
