//! The twin in every mode against direct interpretation of core.

use std::time::Duration;

use ghyll_compiler::back::back;
use ghyll_compiler::core::{Const, Intrinsic, Program, parse, verify};
use ghyll_compiler::interpret::{Host, NoHost, run};
use ghyll_compiler::random::{self, TestHost};
use ghyll_compiler::split::split;
use ghyll_compiler::stream::{self, initial};
use ghyll_compiler::table::{Table, TaskId};

use super::Twin;
use super::allocate::Grant;
use super::decode::decode;
use super::execute::{Output, Record, execute, queue};
use super::limits::Limits;
use super::pool::Pool;
use super::splice::splice;
use super::tokens::Tokens;
use crate::config::{Config, Rewriter, Stats};
use crate::error::RunError;
use crate::memory::Memory;
use crate::progress::{Step, check, recorded};
use crate::world::World;

const FIB: &str = "entry fib
fn fib(n: i32) -> (i32) {
  small: bool = lt.i32(n, 2)
  r: i32 = if small { yield n } else {
    n1: i32 = sub.i32(n, 1)
    a: i32 = call fib(n1)
    n2: i32 = sub.i32(n, 2)
    b: i32 = call fib(n2)
    s: i32 = add.i32(a, b)
    yield s
  }
  yield r
}";

const ACKERMANN: &str = "entry A
fn A(m: i32, n: i32) -> (i32) {
  m0: bool = eq.i32(m, 0)
  r: i32 = if m0 { s: i32 = add.i32(n, 1) yield s } else {
    m1: i32 = sub.i32(m, 1)
    n0: bool = eq.i32(n, 0)
    t: i32 = if n0 { a: i32 = call A(m1, 1) yield a } else {
      n1: i32 = sub.i32(n, 1)
      b: i32 = call A(m, n1)
      c: i32 = call A(m1, b)
      yield c
    }
    yield t
  }
  yield r
}";

const TAK: &str = "entry tak
fn tak(x: i32, y: i32, z: i32) -> (i32) {
  more: bool = lt.i32(y, x)
  r: i32 = if more {
    x1: i32 = sub.i32(x, 1)
    y1: i32 = sub.i32(y, 1)
    z1: i32 = sub.i32(z, 1)
    a: i32 = call tak(x1, y, z)
    b: i32 = call tak(y1, z, x)
    c: i32 = call tak(z1, x, y)
    d: i32 = call tak(a, b, c)
    yield d
  } else { yield z }
  yield r
}";

/// `total(n) = n + total(n - 1)`: as deep as n.
const TOTAL: &str = "entry total
fn total(n: i32) -> (i32) {
  z: bool = le.i32(n, 0)
  r: i32 = if z { yield 0 } else {
    m: i32 = sub.i32(n, 1)
    a: i32 = call total(m)
    s: i32 = add.i32(a, n)
    yield s
  }
  yield r
}";

/// A tail call that exchanges its parameters.
const GCD: &str = "entry gcd
fn gcd(a: i32, b: i32, steps: i32) -> (i32, i32) {
  z: bool = eq.i32(b, 0)
  g: i32, k: i32 = if z { yield a, steps } else {
    m: i32 = rem.i32(a, b)
    t: i32 = add.i32(steps, 1)
    h: i32, u: i32 = call gcd(b, m, t)
    yield h, u
  }
  yield g, k
}";

/// Loops with exchanged state, a nested loop, a branch and a helper that returns its parameter.
const LOOPS: &str = "entry main
fn both(x: i32, y: i32) -> (i32, i32) { s: i32 = add.i32(x, y) yield s, x }
fn main(n: i32, k: i32) -> (i32, i32, i32, i32) {
  i: i32, a: i32, b: i32 = loop fold (i0: i32 = 0, a0: i32 = 0, b0: i32 = 1) while {
    c: bool = lt.i32(i0, n) yield c
  } do {
    a1: i32, b1: i32 = call both(a0, b0)
    i1: i32 = add.i32(i0, 1)
    yield i1, b1, a1
  }
  j: i32, p: i32, q: i32 = loop fold (j0: i32 = 0, p0: i32 = a, q0: i32 = b) while {
    d: bool = lt.i32(j0, k) yield d
  } do {
    j1: i32 = add.i32(j0, 1)
    e: i32 = and.i32(j0, 1)
    o: bool = eq.i32(e, 0)
    p1: i32, q1: i32 = if o { yield q0, p0 } else { w: i32 = sub.i32(q0, j0) yield p0, w }
    l: i32, v: i32 = loop fold (l0: i32 = 0, v0: i32 = p1) while { f: bool = lt.i32(l0, j0) yield f } do {
      v1: i32 = xor.i32(v0, l0)
      l1: i32 = add.i32(l0, 1)
      yield l1, v1
    }
    yield j1, v, q1
  }
  x: i32 = index.i32(k, a, b, p, 7)
  y: bool = lt.i32(p, q)
  z: i32 = select.i32(p, q, y)
  yield x, z, p, q
}";

const SUMS: &str = "entry main
@task fn g(x: i32, y: i32) -> (i32) {
  i: i32, p: i32 = loop fold (i0: i32 = 0, p0: i32 = 1) while { c: bool = lt.i32(i0, x) yield c } do {
    i1: i32 = add.i32(i0, 1) p1: i32 = mul.i32(p0, y) yield i1, p1
  }
  yield p
}
fn main(n: i32) -> (i32) {
  i: i32, s: i32 = loop sum (i0: i32 = 0, s0: i32 = 0) while { c: bool = lt.i32(i0, n) yield c } do {
    j: i32, t: i32 = loop sum (j0: i32 = 0, t0: i32 = 0) while { d: bool = lt.i32(j0, i0) yield d } do {
      w: i32 = call g(i0, j0)
      t1: i32 = add.i32(t0, w)
      j1: i32 = add.i32(j0, 1)
      yield j1, t1
    }
    s1: i32 = add.i32(s0, t)
    i1: i32 = add.i32(i0, 1)
    yield i1, s1
  }
  yield s
}";

/// Never ends, one redex.
const SPIN: &str = "entry spin
fn spin(n: i32) -> (i32) { m: i32 = add.i32(n, 1) r: i32 = call spin(m) yield r }";

/// Never ends, ever longer.
const GROW: &str = "entry grow
fn grow(n: i32) -> (i32) { m: i32 = add.i32(n, 1) a: i32 = call grow(m) s: i32 = add.i32(a, n) yield s }";

/// Never ends, without a token.
const STUCK_LOOP: &str = "entry dead
fn dead(n: i32) -> (i32) {
  i: i32, s: i32 = loop fold (i0: i32 = 0, s0: i32 = 0) while { c: bool = le.i32(s0, n) yield c } do {
    s1: i32 = xor.i32(s0, 0)
    yield s1, s1
  }
  yield s
}";

fn load(text: &str) -> (Program, Table, TaskId) {
    let program = parse::program(text).expect("parses");
    verify::program(&program).expect("is core");
    let (table, entry) = split(&program).expect("few words");
    (program, table, entry)
}

fn configs() -> Vec<Config> {
    let with = |rewriter, depth, block| Config { rewriter, depth, block, ..Config::default() };
    vec![
        with(Rewriter::Lane, None, 512),
        with(Rewriter::Auto, None, 512),
        with(Rewriter::Auto, None, 2),
        with(Rewriter::Block, None, 512),
        with(Rewriter::Block, Some(1), 2),
        with(Rewriter::Block, Some(3), 11),
    ]
}

fn evaluate(text: &str, args: &[i32], config: &Config) -> Result<(Vec<u32>, Stats), RunError> {
    let (_, table, entry) = load(text);
    let args: Vec<_> = args.iter().map(|i| Const::I32(*i)).collect();
    Twin::new(&table)?.run(&initial(&table, entry, &args), config, None)
}

fn interpret(text: &str, args: &[i32]) -> Vec<u32> {
    let (program, ..) = load(text);
    let args: Vec<_> = args.iter().map(|i| Const::I32(*i)).collect();
    let values = run(&program, &args, &NoHost, 100_000_000).expect("ends");
    values.into_iter().map(Const::word).collect()
}

fn agree(text: &str, inputs: &[&[i32]]) {
    for input in inputs {
        let expected = interpret(text, input);
        for config in configs() {
            let (found, _) = evaluate(text, input, &config).unwrap_or_else(|e| panic!("{e}"));
            assert_eq!(found, expected, "{input:?} with {config:?} of\n{text}");
        }
    }
}

fn on_large_stack(check: fn()) {
    let thread = std::thread::Builder::new().stack_size(256 << 20).spawn(check);
    thread.expect("the thread starts").join().expect("the check holds");
}

#[test]
fn every_mode_agrees_with_interpretation() {
    on_large_stack(|| {
        agree(FIB, &[&[-1], &[1], &[2], &[10], &[15]]);
        agree(ACKERMANN, &[&[0, 0], &[1, 3], &[2, 3]]);
        agree(TAK, &[&[1, 2, 3], &[8, 4, 2]]);
        agree(TOTAL, &[&[0], &[1], &[300]]);
        agree(GCD, &[&[12, 18, 0], &[1071, 462, 5], &[5, 0, 1]]);
        agree(SUMS, &[&[0], &[1], &[5], &[9]]);
        for n in 0..6 {
            agree(LOOPS, &[&[n, 0], &[n, 1], &[n, 2], &[n, 7], &[n, -3]]);
        }
    });
}

#[test]
fn a_planted_difference_is_found() {
    let expected = interpret(FIB, &[12]);
    let other = FIB.replace("sub.i32(n, 2)", "sub.i32(n, 3)");
    for config in configs() {
        assert_ne!(evaluate(&other, &[12], &config).unwrap().0, expected);
    }
}

#[test]
fn rewrites_are_the_same_in_every_mode() {
    let counts: Vec<u64> = configs().iter().map(|c| evaluate(FIB, &[14], c).unwrap().1.rewrites).collect();
    // 2 fib(15) - 1 calls, and one addition for each that is not a leaf.
    assert_eq!(counts, vec![1828; counts.len()]);
}

#[test]
fn rounds_at_depth_one_are_the_compilers() {
    let (_, table, entry) = load(FIB);
    let start = initial(&table, entry, &[Const::I32(6)]);
    let expected: Vec<_> =
        stream::rounds(&table, start.clone(), &NoHost, 100_000).map(|s| s.expect("ends").len()).collect();
    let config = Config { rewriter: Rewriter::Block, depth: Some(1), ..Config::default() };
    let mut seen = Vec::new();
    let mut observe = |s: &[_]| seen.push(s.len());
    Twin::new(&table).unwrap().run_observed(&start, &config, None, &mut observe).unwrap();
    assert_eq!(seen, expected);
}

#[test]
fn deep_recursion_and_long_loops_end() {
    for rewriter in [Rewriter::Auto, Rewriter::Lane, Rewriter::Block] {
        let config = Config { rewriter, ..Config::default() };
        assert_eq!(evaluate(TOTAL, &[200_000], &config).unwrap().0, [(200_000u64 * 200_001 / 2) as u32]);
    }
    assert_eq!(evaluate(GCD, &[1, 0, 7], &Config::default()).unwrap().0, [1, 7]);
}

#[test]
fn what_does_not_end_is_an_error_that_names_the_function() {
    let short = Duration::from_millis(300);
    for config in configs() {
        let config = Config { timeout: short, max_memory: 64 << 20, ..config };
        for (text, name) in [(SPIN, "spin"), (STUCK_LOOP, "dead")] {
            let error = evaluate(text, &[1], &config).unwrap_err();
            assert!(matches!(&error, RunError::Timeout { function, .. } if function == name), "{error}");
        }
        let error = evaluate(GROW, &[1], &Config { max_memory: 1 << 20, ..config.clone() }).unwrap_err();
        let named = match &error {
            RunError::OutOfMemory { function, .. } => function == "grow",
            // One rewrite a round is slow to fill the memory.
            RunError::Timeout { function, .. } => function == "grow" && config.depth.is_some(),
            _ => false,
        };
        assert!(named, "{error} with {config:?}");
        let error = evaluate(FIB, &[20], &Config { max_rewrites: Some(1000), ..config.clone() }).unwrap_err();
        assert_eq!(error, RunError::MaxRewrites { function: "fib".into(), limit: 1000 }, "{config:?}");
    }
}

#[test]
fn the_clock_is_looked_at_within_a_round() {
    // Where the stream doubles, a whole round takes as long as all before it.
    let config = Config { timeout: Duration::ZERO, rewriter: Rewriter::Block, ..Config::default() };
    let error = evaluate(GROW, &[1], &config).unwrap_err();
    assert!(
        matches!(&error, RunError::Timeout { function, reached, .. } if function == "grow" && reached == "0 rewrites"),
        "{error}"
    );
}

/// Twice as many redexes in every step, none of which another one's value can stand for.
const DOUBLE: &str = "entry double
fn double(n: i32) -> (i32) {
  m: i32 = add.i32(n, 1)
  a: i32 = call double(m)
  b: i32 = call double(a)
  k: i32 = add.i32(n, 2)
  c: i32 = call double(k)
  s: i32 = add.i32(b, c)
  yield s
}";

#[test]
fn what_the_lanes_of_a_round_leave_counts_as_memory() {
    let (_, table, _) = load(DOUBLE);
    let code = super::compile::compile(&table).unwrap();
    let config = Config { max_memory: 8 << 20, ..Config::default() };
    let limits = Limits::new(&config, Memory::default()).unwrap();
    let pool = Pool::new(&code, &[], &limits, None);
    let mut tokens = Tokens::default();
    for n in 0..64 {
        tokens.push_literals(&[n]);
        tokens.push_function(0);
    }
    let pairs = [decode(&code, 0, true, 64, tokens, || false)];
    let made = |queue: &[Record]| {
        let outputs = execute(&pool, &pairs, queue, (1 << 16, 1), 0).unwrap();
        let left: usize = outputs.iter().map(|o| o.left).sum();
        (outputs.iter().map(|o| o.tokens.bytes()).sum::<u64>(), left)
    };
    let queue = queue(&pairs);
    assert_eq!(queue.len(), 64);
    let (alone, _) = made(&queue[..1]);
    let (all, left) = made(&queue);
    assert!(alone * 64 > 4 * config.max_memory, "too little to tell: {alone}");
    assert!(all < 2 * config.max_memory && left > 0, "{all} bytes, {left} left");
    let error = evaluate(DOUBLE, &[1], &config).unwrap_err();
    assert!(matches!(&error, RunError::OutOfMemory { function, .. } if function == "double"), "{error}");
}

#[test]
fn long_passes_over_the_stream_look_at_the_clock() {
    let (_, table, _) = load(TOTAL);
    let code = super::compile::compile(&table).unwrap();
    let mut tokens = Tokens::default();
    for n in 0..200_000 {
        tokens.push_literals(&[n]);
        tokens.push_function(0);
    }
    let found = |is_over: bool| decode(&code, 0, false, usize::MAX, tokens.clone(), || is_over);
    assert_eq!(found(false).redexes.len(), 200_000);
    let some = found(true);
    assert!(some.redexes.len() < 100_000);
    let none = vec![Some(Grant { output: 0, from: 0, to: 0 }); some.redexes.len()];
    assert!(splice(&some, &none, &[Output::default()], || true).len() < 100_000);
    let config = Config { timeout: Duration::ZERO, ..Config::default() };
    let limits = Limits::new(&config, Memory::default()).unwrap();
    Pool::new(&code, &[], &limits, None).with(|lane| {
        lane.begin_stream(&tokens);
        let mut out = Tokens::default();
        lane.publish(&mut out);
        assert!(out.len() < 200_000, "{}", out.len());
    });
}

#[test]
fn a_round_costs_what_its_redexes_do() {
    let config = Config { rewriter: Rewriter::Block, depth: Some(1), ..Config::default() };
    let (words, stats) = evaluate(TOTAL, &[5000], &config).unwrap();
    assert_eq!(words, [5000 * 5001 / 2]);
    assert!(stats.rounds >= 10_000 && stats.longest_stream > 10_000, "{stats:?}");
    // A redex, its pair of blocks.
    assert!(stats.tokens_moved <= stats.rounds * 1100, "{stats:?}");
}

#[test]
fn an_image_counts_as_memory() {
    let (_, table, entry) = load(PICTURE);
    let render = |max_memory| {
        let config = Config { max_memory, ..Config::default() };
        Twin::new(&table).unwrap().render((40, 30), 2, entry, &config, None)
    };
    let image = 40 * 30 * 2 * 4;
    let error = render(image - 1).unwrap_err();
    assert!(matches!(error, RunError::TooLittleMemory { needed, .. } if needed.image == image), "{error}");
    let stats = render(1 << 20).unwrap().1;
    assert!(stats.memory.image == image && stats.memory.stream > 0, "{stats:?}");
}

#[test]
fn progress_is_told_by_tiles_and_rewrites() {
    let (_, table, entry) = load(PICTURE);
    for rewriter in [Rewriter::Auto, Rewriter::Block] {
        let (progress, steps) = recorded();
        let config = Config { rewriter, progress, max_memory: 1 << 20, ..Config::default() };
        Twin::new(&table).unwrap().render((90, 95), 2, entry, &config, None).unwrap();
        check(&steps.lock().unwrap(), 90 * 95, 3).unwrap();
    }
    let (progress, steps) = recorded();
    evaluate(FIB, &[20], &Config { progress, ..Config::default() }).unwrap();
    let told = steps.lock().unwrap();
    assert!(told.iter().any(|step| matches!(step, Step::Rewrites(n) if *n > 0)), "{told:?}");
}

#[test]
fn little_memory_turns_breadth_into_depth() {
    let config = Config { rewriter: Rewriter::Block, depth: Some(1), ..Config::default() };
    let (words, free) = evaluate(FIB, &[16], &config).unwrap();
    let tight = Config { max_memory: 4096, threads: Some(1), ..config };
    let (same, stats) = evaluate(FIB, &[16], &tight).unwrap();
    assert_eq!(words, same);
    assert!(stats.longest_stream * 2 < free.longest_stream, "{stats:?}");
    assert!(stats.memory.total() <= 4096);
}

/// Colours a pixel by its position, with a recursive task.
const PICTURE: &str = "entry pixel
@task fn shade(x: f32, n: i32) -> (f32) {
  z: bool = le.i32(n, 0)
  r: f32 = if z { yield x } else {
    m: i32 = sub.i32(n, 1)
    a: f32 = call shade(x, m)
    b: f32 = mul.f32(a, 0.5)
    yield b
  }
  yield r
}
fn pixel(x: f32, y: f32) -> (f32, f32) {
  n: i32 = to_i32.f32(y)
  a: f32 = call shade(x, n)
  yield a, y
}";

#[test]
fn pictures_are_the_same_in_every_mode() {
    let (_, table, entry) = load(PICTURE);
    let twin = Twin::new(&table).unwrap();
    let (width, height) = (19, 13);
    for config in configs() {
        let (image, _) = twin.render((width, height), 2, entry, &config, None).unwrap();
        for (at, pixel) in image.chunks(2).enumerate() {
            let (x, y) = ((at as u32 % width) as f32 + 0.5, (at as u32 / width) as f32 + 0.5);
            assert_eq!(pixel, [x * 0.5f32.powi(y as i32), y], "{config:?}");
        }
    }
}

/// Answers intrinsics with sums of their operands.
struct Sums;

impl World for Sums {
    fn eval_f64(&self, _: Intrinsic, args: &[f64], out: &mut [f64]) {
        out.fill(args.iter().sum());
    }

    fn eval_f32(&self, _: Intrinsic, args: &[u32], out: &mut [u32]) {
        let sum: f32 = args.iter().map(|w| f32::from_bits(*w)).sum();
        for (i, out) in out.iter_mut().enumerate() {
            *out = (sum + i as f32).to_bits();
        }
    }
}

#[test]
fn intrinsics_are_asked_of_the_world() {
    let text = "entry main
        fn main(x: f32) -> (f32, f32) {
          g: f32, h: f32 = @gradient_bilinear(x, 2.0)
          a: f32 = add.f32(g, h)
          yield a, h
        }";
    let (_, table, entry) = load(text);
    let twin = Twin::new(&table).unwrap();
    let start = initial(&table, entry, &[Const::f32(1.5)]);
    let (words, _) = twin.run(&start, &Config::default(), Some(&Sums)).unwrap();
    assert_eq!(words, [8.0f32.to_bits(), 4.5f32.to_bits()]);
    let error = twin.run(&start, &Config::default(), None).unwrap_err();
    assert!(matches!(error, RunError::Unsupported(_)), "{error}");
}

#[test]
fn live_words_change_between_runs() {
    let text = "live k: (i32, i32)
        entry main
        fn main(x: i32) -> (i32) { a: i32 = live(1) b: i32 = mul.i32(a, x) yield b }";
    let (_, table, entry) = load(text);
    let mut twin = Twin::new(&table).unwrap();
    for word in [3, 5] {
        twin.set_live(&[9, word]);
        let start = initial(&table, entry, &[Const::I32(7)]);
        assert_eq!(twin.run(&start, &Config::default(), None).unwrap().0, [7 * word]);
    }
}

/// The compiler's test host as a world.
struct Mixed;

impl World for Mixed {
    fn eval_f64(&self, _: Intrinsic, _: &[f64], out: &mut [f64]) {
        out.fill(0.0);
    }

    fn eval_f32(&self, intrinsic: Intrinsic, args: &[u32], out: &mut [u32]) {
        let args: Vec<Const> = args.iter().map(|w| Const::U32(*w)).collect();
        let results = TestHost.intrinsic(intrinsic, &args).unwrap_or_default();
        for (out, result) in out.iter_mut().zip(results) {
            *out = result.word();
        }
    }
}

/// Words with one NaN for all.
fn canonical(values: &[Const], words: &[u32]) -> Vec<u32> {
    let canonical = |(value, word): (&Const, &u32)| match value {
        Const::F32(_) if f32::from_bits(*word).is_nan() => f32::NAN.to_bits(),
        _ => *word,
    };
    values.iter().zip(words).map(canonical).collect()
}

/// A random program, as it is and optimised, in every mode; how many inputs were compared.
fn compare_random(seed: u64) -> usize {
    const FUEL: u64 = 200_000;
    let text = random::program(seed);
    let source = parse::program(&text).unwrap_or_else(|why| panic!("seed {seed}: {why}\n{text}"));
    let (plain, plain_entry) = split(&source).expect("few words");
    let optimised = back(source.clone()).expect("few words");
    let mut compared = 0;
    for depth in [0, 1, 3] {
        let args =
            [Const::I32(depth), Const::Bool(seed & 1 == 0), Const::I32(3), Const::U32(4), Const::f32(2.5)];
        let Ok(values) = run(&source, &args, &TestHost, FUEL) else { continue };
        let words: Vec<u32> = values.iter().map(|c| c.word()).collect();
        let expected = canonical(&values, &words);
        for (table, entry) in [(&plain, plain_entry), (&optimised.table, optimised.entry)] {
            let mut twin = Twin::new(table).unwrap();
            twin.set_live(&[TestHost.live(0).unwrap(), TestHost.live(1).unwrap()]);
            for config in configs() {
                let start = initial(table, entry, &args);
                let (found, _) = twin
                    .run(&start, &config, Some(&Mixed))
                    .unwrap_or_else(|e| panic!("seed {seed}: {e} with {config:?}\n{text}"));
                assert_eq!(canonical(&values, &found), expected, "seed {seed} {depth} {config:?}\n{text}");
                compared += 1;
            }
        }
    }
    compared
}

#[test]
fn random_programs_agree_in_every_mode() {
    on_large_stack(|| {
        let compared: usize = (0..60).map(compare_random).sum();
        assert!(compared > 1000, "only {compared} runs were compared");
    });
}
