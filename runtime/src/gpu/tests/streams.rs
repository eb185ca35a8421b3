//! Random streams of arithmetic tasks against a sequential evaluation in post-order.

use std::cell::RefCell;

use proptest::prelude::*;
use proptest::test_runner::{Config as Cases, TestRunner};

use super::super::*;
use super::programs::{code, gpu};

/// Tasks of arity 0 to 4; `pair` has two results, `later` needs a second rewrite.
fn arithmetic() -> Code {
    let functions = "
fn task_0() { consume(0u); literal(7u); }
fn task_1() { consume(1u); literal(operand(0u) * 3u + 1u); }
fn task_2() { consume(2u); literal(operand(0u) - operand(1u)); }
fn task_3() {
    consume(3u);
    let a = operand(0u);
    let b = operand(1u);
    let c = operand(2u);
    literal(a ^ b);
    literal(b + c);
    invoke = 2u;
}
fn task_4() {
    consume(4u);
    let a = operand(0u);
    let b = operand(1u);
    let c = operand(2u);
    let d = operand(3u);
    later(2u);
    later(d);
    later(1u | (1u << 16u));
    literal(a + b + c);
    invoke = 1u;
}
fn task_5() {
    consume(1u);
    let a = operand(0u);
    literal(a);
    literal(a + 1u);
}";
    let tasks = [("seven", 0), ("affine", 1), ("minus", 2), ("mixed", 3), ("nested", 4), ("pair", 1)];
    code(functions, &tasks, 6)
}

fn apply(task: u32, stack: &mut Vec<u32>) {
    let mut pop = || stack.pop().expect("the generator keeps enough operands");
    let affine = |a: u32| a.wrapping_mul(3).wrapping_add(1);
    let results = match task {
        0 => vec![7],
        1 => vec![affine(pop())],
        2 => {
            let (b, a) = (pop(), pop());
            vec![a.wrapping_sub(b)]
        }
        3 => {
            let (c, b, a) = (pop(), pop(), pop());
            vec![(a ^ b).wrapping_sub(b.wrapping_add(c))]
        }
        4 => {
            let (d, c, b, a) = (pop(), pop(), pop(), pop());
            vec![affine(a.wrapping_add(b).wrapping_add(c)).wrapping_sub(affine(d))]
        }
        _ => {
            let a = pop();
            vec![a, a.wrapping_add(1)]
        }
    };
    stack.extend(results);
}

/// A stream from random choices, and its value.
fn stream(choices: &[(u32, u32)]) -> (Vec<(u32, bool)>, Vec<u32>) {
    const ARITIES: [usize; 6] = [0, 1, 2, 3, 4, 1];
    let (mut tokens, mut stack) = (Vec::new(), Vec::new());
    for (kind, word) in choices {
        let task = *kind as usize;
        if task < ARITIES.len() && stack.len() >= ARITIES[task] {
            tokens.push((*kind, true));
            apply(*kind, &mut stack);
        } else {
            tokens.push((*word, false));
            stack.push(*word);
        }
    }
    (tokens, stack)
}

#[test]
fn random_streams_by_every_rewriter() {
    let Some(gpu) = gpu() else { return };
    let configs = [
        Config { rewriter: Rewriter::Auto, ..Config::default() },
        Config { rewriter: Rewriter::Block, ..Config::default() },
        Config { rewriter: Rewriter::Block, block: 32, trusted: false, ..Config::default() },
        Config { rewriter: Rewriter::Lane, block: 64, ..Config::default() },
        Config { depth: Some(3), ..Config::default() },
    ];
    for config in configs {
        let name = format!("{:?} {}", config.rewriter, config.block);
        let engine = RefCell::new(Engine::new(&gpu, arithmetic(), config, None).unwrap());
        let choices = proptest::collection::vec((0u32..11, any::<u32>()), 0..6000);
        let mut runner = TestRunner::new(Cases { cases: 24, failure_persistence: None, ..Cases::default() });
        let result = runner.run(&choices, |choices| {
            let (tokens, value) = stream(&choices);
            let outcome = engine_run(&mut engine.borrow_mut(), &tokens)?;
            prop_assert_eq!(outcome, value);
            Ok(())
        });
        assert!(result.is_ok(), "{name}: {result:?}");
    }
}

fn engine_run(engine: &mut Engine, tokens: &[(u32, bool)]) -> Result<Vec<u32>, TestCaseError> {
    engine.run(tokens).map(|outcome| outcome.words).map_err(|error| TestCaseError::fail(error.to_string()))
}

#[test]
fn wide_streams() {
    let Some(gpu) = gpu() else { return };
    let choices: Vec<_> = (0..300_000u32).map(|i| ((i * 7919) % 11, i.wrapping_mul(2_654_435_761))).collect();
    let (tokens, value) = stream(&choices);
    for rewriter in [Rewriter::Auto, Rewriter::Block] {
        let mut engine =
            Engine::new(&gpu, arithmetic(), Config { rewriter, ..Config::default() }, None).unwrap();
        assert_eq!(engine.run(&tokens).unwrap().words, value, "{rewriter:?}");
    }
}
