//! Time from text to WGSL of generated programs, phase by phase: `cargo bench -p ghyll-compiler`.
//!
//! `--bench front -- --phases N` prints the phases of one program of N lines instead, for profilers.

#[path = "program.rs"]
mod program;

use divan::{Bencher, black_box};
use ghyll_compiler::back::{Back, back};
use ghyll_compiler::compile::check;
use ghyll_compiler::core::Program;
use ghyll_compiler::front::Checked;
use ghyll_compiler::lower::{Asked, Settings, lower};
use ghyll_compiler::optimise::{CLEANING, run};
use ghyll_compiler::source::Source;
use ghyll_compiler::split::{lift, split};
use ghyll_compiler::wgsl;
use mimalloc::MiMalloc;

/// As in the binary.
#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

const LINES: &[usize] = &[1_000, 3_000, 10_000, 30_000, 100_000];

fn main() {
    let args: Vec<String> = std::env::args().collect();
    match args.iter().position(|a| a == "--phases") {
        Some(at) => phases(args.get(at + 1).and_then(|n| n.parse().ok()).unwrap_or(10_000)),
        None => divan::main(),
    }
}

fn source(lines: usize) -> Source {
    Source::new("generated.ghyll", program::program(lines))
}

fn checked(lines: usize) -> Checked {
    check(source(lines)).unwrap_or_else(|_| panic!("a generated program has errors"))
}

fn lowered(checked: &Checked) -> Program {
    let entry = checked.module.function("main").expect("generated programs have a `main`");
    let lowered = lower(&checked.module, entry, Asked::Plainly, &Settings::default());
    lowered.unwrap_or_else(|_| panic!("a generated program is refused"))
}

fn whole(source: Source) -> Back {
    let checked = check(source).unwrap_or_else(|_| panic!("a generated program has errors"));
    back(lowered(&checked)).expect("few words")
}

/// Text to WGSL.
#[divan::bench(args = LINES, sample_count = 10, sample_size = 1)]
fn text_to_wgsl(bencher: Bencher, lines: usize) {
    bencher.with_inputs(|| source(lines)).bench_values(whole);
}

/// Text to typed tree.
#[divan::bench(args = LINES, sample_count = 10, sample_size = 1)]
fn front(bencher: Bencher, lines: usize) {
    bencher.with_inputs(|| source(lines)).bench_values(|s| check(s).is_ok());
}

/// Typed tree to core.
#[divan::bench(args = LINES, sample_count = 10, sample_size = 1)]
fn lowering(bencher: Bencher, lines: usize) {
    let checked = checked(lines);
    bencher.bench(|| lowered(&checked));
}

/// Core to WGSL.
#[divan::bench(args = LINES, sample_count = 10, sample_size = 1)]
fn back_end(bencher: Bencher, lines: usize) {
    let program = lowered(&checked(lines));
    bencher.with_inputs(|| program.clone()).bench_values(back);
}

/// What a driver's front end takes for the same text: naga's parser.
#[divan::bench(args = &[1_000, 10_000], sample_count = 3, sample_size = 1)]
fn naga(bencher: Bencher, lines: usize) {
    let back = whole(source(lines));
    bencher.bench(|| naga::front::wgsl::parse_str(black_box(&back.wgsl.text)).is_ok());
}

fn phases(lines: usize) {
    let mut last = std::time::Instant::now();
    let mut report = |name: &str| {
        eprintln!("{:10.2} ms  {name}", last.elapsed().as_secs_f64() * 1e3);
        last = std::time::Instant::now();
    };
    let source = source(lines);
    report("generate");
    let checked = check(source).unwrap_or_else(|_| panic!("a generated program has errors"));
    report("front");
    let mut program = lowered(&checked);
    report("lower");
    for pass in ghyll_compiler::optimise::passes() {
        run(&[pass], &mut program);
        report(pass.0);
    }
    let functions = program.functions.len();
    lift::loops(&mut program);
    if program.functions.len() > functions {
        run(CLEANING, &mut program);
    }
    report("lift and clean");
    let (table, entry) = split(&program).expect("few words");
    report("split");
    let wgsl = wgsl::emit(&table, entry);
    report("wgsl");
    eprintln!(
        "{} tasks, {} helpers, {} bytes of WGSL",
        table.tasks.len(),
        table.helpers.len(),
        wgsl.text.len()
    );
}
