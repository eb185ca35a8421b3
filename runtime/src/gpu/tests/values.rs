//! Values.

use std::time::Duration;

use super::super::readback::Readback;
use super::super::*;
use super::programs::{
    ackermann, branches, count, fib, fused, fused_value, gpu, grow, hofstadter, spin, takeuchi, total,
};

fn config(rewriter: Rewriter) -> Config {
    Config { rewriter, ..Config::default() }
}

fn value(gpu: &Gpu, code: Code, config: Config, operands: &[u32]) -> Result<Outcome, RunError> {
    let stream: Vec<_> = operands.iter().map(|word| (*word, false)).chain([(0, true)]).collect();
    Engine::new(gpu, code, config, None)?.run(&stream)
}

#[test]
fn fib_by_every_rewriter_checked_and_trusted() {
    let Some(gpu) = gpu() else { return };
    for rewriter in [Rewriter::Block, Rewriter::Lane, Rewriter::Auto] {
        for trusted in [true, false] {
            let mut engine = Engine::new(&gpu, fib(), Config { trusted, ..config(rewriter) }, None).unwrap();
            // The second run finds what the first has left in memory.
            for (n, value, calls) in [(15, 610, 1973), (18, 2584, 8361)] {
                let outcome = engine.run(&[(n, false), (0, true)]).unwrap();
                assert_eq!(outcome.words, [value]);
                assert_eq!(outcome.stats.rewrites, calls + calls / 2);
            }
        }
    }
}

#[test]
fn tasks_see_the_same_stream_by_hand_and_in_the_window() {
    use super::super::shape::Shape;
    use ghyll_compiler::table::Widths;
    let Some(gpu) = gpu() else { return };
    let run = |code: Code, first, later, segment, operands: &[u32]| {
        let code = Code { widths: Widths { first, later, segment }, ..code };
        let limited = Config { timeout: Duration::from_secs(20), ..config(Rewriter::Auto) };
        let hand = Shape::new(&code, &limited, 0, true).unwrap().hand;
        (hand.is_some(), value(&gpu, code, limited, operands).map(|outcome| outcome.words))
    };
    for (code, [first, later, segment], operands, expected) in [
        (fib(), [1, 3, 1], vec![18], 2584),
        (takeuchi(), [3, 9, 3], vec![8, 4, 2], 3),
        (ackermann(), [3, 1, 0], vec![2, 9], 21),
    ] {
        assert_eq!(run(code.clone(), first, later, segment, &operands), (true, Ok(vec![expected])));
        // More than a hand has.
        assert_eq!(run(code, 100, later, segment, &operands), (false, Ok(vec![expected])));
    }
    // A hand that is too small loses what waits to the right.
    assert_ne!(run(fib(), 1, 0, 1, &[18]), (true, Ok(vec![2584])));
}

#[test]
fn tiny_blocks_and_tiny_arenas() {
    let Some(gpu) = gpu() else { return };
    for rewriter in [Rewriter::Block, Rewriter::Lane, Rewriter::Auto] {
        let small = Config { block: 32, max_memory: 64 << 10, ..config(rewriter) };
        assert_eq!(value(&gpu, fib(), small, &[13]).unwrap().words, [233], "{rewriter:?}");
    }
}

#[test]
fn deep_lanes_outgrow_their_window() {
    let Some(gpu) = gpu() else { return };
    for (block, groups, threads) in [(512, None, None), (32, None, None), (512, Some(1), Some(3))] {
        let config = Config { block, groups, threads, ..config(Rewriter::Lane) };
        assert_eq!(value(&gpu, fib(), config, &[23]).unwrap().words, [28657]);
    }
}

#[test]
fn deep_recursion() {
    let Some(gpu) = gpu() else { return };
    let n = 1_000_000u32;
    let sum = (1..=n).fold(0u32, u32::wrapping_add);
    let outcome = value(&gpu, total(), config(Rewriter::Auto), &[n]).unwrap();
    eprintln!("total(1000000): {:?}", outcome.stats);
    assert_eq!(outcome.words, [sum]);
    assert_eq!(outcome.stats.rewrites, 2 * u64::from(n) + 1);
}

#[test]
fn deep_recursion_in_a_small_arena_by_blocks() {
    let Some(gpu) = gpu() else { return };
    let config = Config { depth: Some(64), max_memory: 1 << 20, ..config(Rewriter::Block) };
    let outcome = value(&gpu, total(), config, &[20_000]).unwrap();
    assert_eq!(outcome.words, [(1..=20_000u32).sum::<u32>()]);
}

#[test]
fn tail_calls() {
    let Some(gpu) = gpu() else { return };
    let n = 10_000_000u32;
    let sum = (1..=n).fold(0u32, u32::wrapping_add);
    let outcome = value(&gpu, count(), config(Rewriter::Auto), &[n, 0]).unwrap();
    eprintln!("count(10000000): {:?}", outcome.stats);
    assert_eq!(outcome.words, [sum]);
}

#[test]
fn nested_recursion() {
    let Some(gpu) = gpu() else { return };
    let outcome = value(&gpu, ackermann(), config(Rewriter::Auto), &[2, 300]).unwrap();
    eprintln!("ackermann(2, 300): {:?}", outcome.stats);
    assert_eq!(outcome.words, [603]);
}

#[test]
fn mutual_recursion() {
    let Some(gpu) = gpu() else { return };
    let n = 120usize;
    let (mut female, mut male) = (vec![1usize], vec![0usize]);
    for i in 1..=n {
        male.push(i - female[male[i - 1]]);
        female.push(i - male[female[i - 1]]);
    }
    let outcome = value(&gpu, hofstadter(), config(Rewriter::Auto), &[n as u32]).unwrap();
    eprintln!("female(120): {:?}", outcome.stats);
    assert_eq!(outcome.words, [female[n] as u32]);
}

/// Lanes that outgrow their window give back the redexes that are far, so a round never waits for one lane.
#[test]
fn nested_calls_stay_parallel_at_any_depth() {
    let Some(gpu) = gpu() else { return };
    let rounds = |depth: u32| {
        let config = Config { depth: Some(depth), ..config(Rewriter::Block) };
        let outcome = value(&gpu, takeuchi(), config, &[12, 8, 4]).unwrap();
        assert_eq!(outcome.words, [5]);
        outcome.stats.rounds
    };
    let each: Vec<u64> = [1, 2, 4, 8, 16, 64].map(rounds).into();
    assert!(each[1..].iter().all(|deep| *deep < each[0]), "{each:?}");
}

#[test]
fn endless_loop_ends_by_timeout() {
    let Some(gpu) = gpu() else { return };
    let config = Config { timeout: Duration::from_millis(300), ..config(Rewriter::Auto) };
    match value(&gpu, spin(), config, &[0]) {
        Err(RunError::Timeout { function, .. }) => assert_eq!(function, "spin"),
        other => panic!("{other:?}"),
    }
}

/// Nothing interrupts a driver, but a run does not wait for it for ever.
#[test]
fn an_adapter_that_does_not_answer_ends_the_run() {
    let Some(gpu) = gpu() else { return };
    let usage = wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
    let size = 64 << 20;
    let large = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size,
        usage,
        mapped_at_creation: false,
    });
    let started = std::time::Instant::now();
    let mut readback = Readback::default();
    readback.wait_for(started, Duration::from_secs(30));
    assert!(readback.read(&gpu, &[(&large, 0, 1)]).is_ok());
    let Some(long_ago) = started.checked_sub(Duration::from_secs(60)) else { return };
    readback.wait_for(long_ago, Duration::from_secs(1));
    match readback.read(&gpu, &[(&large, 0, size as usize / 4)]) {
        Err(error @ RunError::Unanswered { .. }) => {
            assert!(error.to_string().contains("--timeout"), "{error}")
        }
        other => panic!("{:?}", other.map(|words| words.len())),
    }
}

#[test]
fn lanes_that_are_never_cut_short_have_a_function_to_blame() {
    let Some(gpu) = gpu() else { return };
    let mut code = grow();
    code.names.push("main".into());
    let timeout = Duration::from_millis(300);
    let config = Config { timeout, depth: Some(1), ..config(Rewriter::Block) };
    match value(&gpu, code, config, &[0]) {
        Err(RunError::Timeout { function, .. }) => assert_eq!(function, "grow"),
        other => panic!("{other:?}"),
    }
}

/// 64 branches that each want more than a sixty-fourth of the arena: most have to wait. A lean round of depth 1 is one
/// rewrite, so blocks get shorter branches.
#[test]
fn breadth_turns_into_depth_when_memory_is_low() {
    let Some(gpu) = gpu() else { return };
    for (rewriter, kib, depth) in
        [(Rewriter::Auto, 128, 1000), (Rewriter::Lane, 64, 1000), (Rewriter::Block, 64, 200)]
    {
        let config = Config { max_memory: kib << 10, ..config(rewriter) };
        let found = value(&gpu, branches(), config, &[6, depth]).map(|outcome| outcome.words);
        assert_eq!(found, Ok(vec![64 * (depth + 1)]), "{rewriter:?}");
    }
}

#[test]
fn endless_growth_ends_by_memory() {
    let Some(gpu) = gpu() else { return };
    for rewriter in [Rewriter::Block, Rewriter::Lane, Rewriter::Auto] {
        match value(&gpu, grow(), Config { max_memory: 1 << 20, ..config(rewriter) }, &[0]) {
            Err(RunError::OutOfMemory { function, bytes, limit }) => {
                assert_eq!(function, "grow", "{rewriter:?}");
                assert!(bytes <= limit && bytes > limit / 2);
            }
            other => panic!("{rewriter:?} {other:?}"),
        }
    }
}

#[test]
fn most_rewrites() {
    let Some(gpu) = gpu() else { return };
    let config = Config { max_rewrites: Some(10_000), ..config(Rewriter::Auto) };
    match value(&gpu, fib(), config, &[27]) {
        Err(RunError::MaxRewrites { function, limit }) => {
            assert_eq!((function.as_str(), limit), ("fib", 10_000));
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn fused_loops_get_the_fuel_they_need() {
    let Some(gpu) = gpu() else { return };
    let outcome = value(&gpu, fused(), config(Rewriter::Auto), &[15_000]).unwrap();
    assert_eq!(outcome.words, [fused_value(15_000)]);
    match value(&gpu, fused(), config(Rewriter::Auto), &[u32::MAX]) {
        Err(RunError::LoopTooLong { function, .. }) => assert_eq!(function, "fused"),
        other => panic!("{other:?}"),
    }
}

#[test]
fn lacking_operands_are_an_error() {
    let Some(gpu) = gpu() else { return };
    let mut engine = Engine::new(&gpu, fib(), Config::default(), None).unwrap();
    match engine.run(&[(1, false), (1, true)]) {
        Err(RunError::Stuck { function }) => assert_eq!(function, "fib"),
        other => panic!("{other:?}"),
    }
}

#[test]
fn literals_alone_and_nothing() {
    let Some(gpu) = gpu() else { return };
    let mut engine = Engine::new(&gpu, fib(), Config::default(), None).unwrap();
    assert_eq!(engine.run(&[(5, false), (6, false)]).unwrap().words, [5, 6]);
    assert!(engine.run(&[]).unwrap().words.is_empty());
}
