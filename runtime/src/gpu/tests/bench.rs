//! Timings for docs/performance.md: `cargo test --release gpu::tests::bench -- --ignored --nocapture`.

use super::super::shape::{Shape, Windows};
use super::super::*;
use super::programs::{fib, gpu};

fn median(times: &[f64]) -> f64 {
    let mut times = times.to_vec();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// Processor time of this process in seconds, where the system tells; it counts the work of a software adapter
/// whatever else the machine does.
fn processor_time() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields = stat.rsplit(')').next().unwrap_or_default().split_whitespace().skip(11).take(2);
    fields.filter_map(|field| field.parse::<f64>().ok()).sum::<f64>() / 100.0
}

/// A variant: its name, its configuration, and what it changes in the sizes.
type Variant = (&'static str, Config, fn(&mut Shape));

/// Runs the variants in turn, so that what else the machine does falls on all of them.
fn compare(gpu: &Gpu, stream: &[(u32, bool)], turns: usize, variants: &[Variant]) {
    let mut engines: Vec<Engine> = variants
        .iter()
        .map(|(_, config, change)| {
            let mut shape = Shape::new(&fib(), config, 0, gpu.info().software).unwrap();
            change(&mut shape);
            Engine::with_shape(gpu, fib(), config.clone(), None, shape).unwrap()
        })
        .collect();
    let mut times = vec![Vec::new(); variants.len()];
    let mut processor = vec![0.0; variants.len()];
    let mut last = vec![Stats::default(); variants.len()];
    for turn in 0..turns + 3 {
        for (index, engine) in engines.iter_mut().enumerate() {
            let before = processor_time();
            let cold = turn == 0;
            let outcome = match engine.run(stream) {
                Ok(outcome) => outcome,
                Err(error) => panic!("{}: {error}", variants[index].0),
            };
            assert_eq!(outcome.words, [196_418]);
            if cold {
                println!(
                    "{:24} cold: processor {:7.0} ms",
                    variants[index].0,
                    (processor_time() - before) * 1e3
                );
            }
            if turn >= 3 {
                processor[index] += (processor_time() - before) / turns as f64;
                times[index].push(outcome.stats.time.as_secs_f64());
            }
            last[index] = outcome.stats;
        }
    }
    for (index, (name, ..)) in variants.iter().enumerate() {
        let time = median(&times[index]);
        let least = times[index].iter().copied().fold(f64::MAX, f64::min);
        println!(
            "{name:24} median {:7.2} ms, least {:7.2} ms, processor {:7.2} ms, {:5.1} M rewrites/s, {} rounds, {} submissions, {} tokens moved",
            time * 1e3,
            least * 1e3,
            processor[index] * 1e3,
            last[index].rewrites as f64 / time / 1e6,
            last[index].rounds,
            last[index].submissions,
            last[index].moved,
        );
    }
}

const FIB_27: [(u32, bool); 2] = [(27, false), (0, true)];

#[test]
#[ignore = "a measurement, not a test"]
fn fib_27_by_rewriter() {
    let Some(gpu) = gpu() else { return };
    let of = |rewriter| Config { rewriter, ..Config::default() };
    let same: fn(&mut Shape) = |_| {};
    let variants: [Variant; 7] = [
        ("auto", of(Rewriter::Auto), same),
        ("auto, checked", Config { trusted: false, ..Config::default() }, same),
        ("lane", of(Rewriter::Lane), same),
        ("block", of(Rewriter::Block), same),
        ("auto, workgroup windows", of(Rewriter::Auto), |s| s.windows = Windows::Workgroup),
        ("block, private windows", of(Rewriter::Block), |s| s.windows = Windows::Private),
        ("block, depth 8", Config { depth: Some(8), ..of(Rewriter::Block) }, same),
    ];
    compare(&gpu, &FIB_27, 5, &variants);
}

#[test]
#[ignore = "a measurement, not a test"]
fn fib_27_by_shape() {
    let Some(gpu) = gpu() else { return };
    let config = || Config { timeout: std::time::Duration::from_secs(60), ..Config::default() };
    let threads = |threads| Config { threads: Some(threads), ..Config::default() };
    let variants: [Variant; 13] = [
        ("as is", config(), |_| {}),
        ("workgroup windows", config(), |s| s.windows = Windows::Workgroup),
        ("burst 16", config(), |s| s.burst = 16),
        ("burst 256", config(), |s| s.burst = 256),
        ("window 32", config(), |s| s.window = 32),
        ("window 48", config(), |s| s.window = 48),
        ("window 128", config(), |s| s.window = 128),
        ("expand 4", config(), |s| s.expand = 4),
        ("expand 16", config(), |s| s.expand = 16),
        ("pull 1", config(), |s| s.pull = 1),
        ("32 threads", threads(32), |_| {}),
        ("128 threads", threads(128), |_| {}),
        ("256 threads", threads(256), |_| {}),
    ];
    compare(&gpu, &FIB_27, 9, &variants);
}
