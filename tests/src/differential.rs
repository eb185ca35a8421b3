//! Looks for random programs on which two modes disagree, and shrinks the first one found.
//!
//! Many programs share one file, because compiling a shader is what takes the time; a disagreement is then shrunk
//! on its own.

use crate::case::{Call, Program, Settings};
use crate::generate::{Span, batch, program, spans};
use crate::judge::{Answer, Backend, Failure};
use crate::mode::Mode;
use crate::value::{Tolerance, Value};
use proptest::collection::{VecStrategy, vec};
use proptest::num::u32::Any;
use proptest::prelude::any;
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use std::collections::BTreeSet;

/// How many programs share one file.
pub const BATCH: usize = 25;

/// Of so many files one goes to the GPU, in one of its modes. A driver takes seconds for the shader of long programs,
/// so only those of the first such file are long.
const GPU_TURN: usize = 4;

/// Most decisions in a program, and in a short one.
const LONG: usize = 500;
const SHORT: usize = 80;

/// How many programs are tried to make one smaller: a count, so that a seed shrinks alike on every machine.
const STEPS: usize = 600;

/// Most genes of the simplest value of a type.
const SIMPLEST: usize = 16;

/// Arguments of every entry.
const INPUTS: &[(&str, &str)] = &[("3", "1.5"), ("-2147483648", "-0.25"), ("65539", "100.0")];

/// A program on which a mode and the oracle disagree.
#[derive(Debug)]
pub struct Difference {
    pub mode: Mode,
    /// What the two answered.
    pub told: String,
    pub text: String,
}

/// Compares every mode with the oracle in single precision, to the bit, on `programs` random programs. The modes of
/// the GPU take turns.
pub fn search(
    backend: &dyn Backend,
    modes: &[Mode],
    seed: u64,
    programs: usize,
) -> Result<(), Box<Difference>> {
    let mut runner = TestRunner::new_with_rng(Config::default(), generator(seed));
    let (on_gpu, others): (Vec<Mode>, Vec<Mode>) = modes.iter().partition(|mode| mode.is_gpu());
    for file in 0..programs.div_ceil(BATCH) {
        let on_gpu_too = file % GPU_TURN == 0;
        let strategy = genes(if on_gpu_too && file > 0 { SHORT } else { LONG });
        let draw = |_| strategy.new_tree(&mut runner).expect("lists of numbers are never rejected").current();
        let lists: Vec<Vec<u32>> = (0..BATCH).map(draw).collect();
        let turn = file / GPU_TURN % on_gpu.len().max(1);
        let gpu = on_gpu.get(turn).filter(|_| on_gpu_too);
        let asked = Asked::new(backend, &lists);
        for mode in others.iter().chain(gpu) {
            if let Some((index, told)) = asked.compare(backend, *mode) {
                let guilty = guilty(backend, *mode, &lists, index);
                return Err(Box::new(shrink(backend, *mode, lists[guilty].clone(), told)));
            }
        }
    }
    Ok(())
}

fn genes(most: usize) -> VecStrategy<Any> {
    vec(any::<u32>(), 0..most)
}

fn generator(seed: u64) -> TestRng {
    let mut bytes = [0; 32];
    bytes[..8].copy_from_slice(&seed.to_le_bytes());
    TestRng::from_seed(RngAlgorithm::ChaCha, &bytes)
}

/// Programs in one file, and what the oracle says of them.
struct Asked {
    program: Program,
    calls: Vec<Call>,
    expected: Vec<Result<Answer, Failure>>,
}

impl Asked {
    fn new(backend: &dyn Backend, lists: &[Vec<u32>]) -> Asked {
        let program = together(lists);
        let calls: Vec<Call> = (0..lists.len())
            .flat_map(|k| INPUTS.iter().map(move |(a, x)| (k, a, x)))
            .map(|(k, a, x)| Call {
                entry: "main".into(),
                args: vec![k.to_string(), a.to_string(), x.to_string()],
            })
            .collect();
        let expected = backend.run(&program, &Settings::default(), Mode::OracleSingle, &calls);
        Asked { program, calls, expected }
    }

    /// Index of the first program on which the mode and the oracle disagree, and what they say.
    fn compare(&self, backend: &dyn Backend, mode: Mode) -> Option<(usize, String)> {
        let Asked { program, calls, expected } = self;
        let found = backend.run(program, &Settings::default(), mode, calls);
        for (call, (expected, found)) in calls.iter().zip(expected.iter().zip(&found)) {
            if !same(expected, found) {
                let index = call.args[0].parse().unwrap_or(0);
                return Some((index, told(mode, call, expected, found)));
            }
        }
        (expected.len() != calls.len() || found.len() != calls.len())
            .then(|| (0, "an answer is missing".into()))
    }
}

fn compare(backend: &dyn Backend, mode: Mode, lists: &[Vec<u32>]) -> Option<(usize, String)> {
    Asked::new(backend, lists).compare(backend, mode)
}

/// The program that disagrees on its own too: the one that was told of, or, where the whole file was refused, the
/// first that is.
fn guilty(backend: &dyn Backend, mode: Mode, lists: &[Vec<u32>], told: usize) -> usize {
    let alone = |k: &usize| compare(backend, mode, &lists[*k..=*k]).is_some();
    std::iter::once(told).chain(0..lists.len()).find(alone).unwrap_or(told)
}

fn together(lists: &[Vec<u32>]) -> Program {
    let programs: Vec<String> = lists.iter().enumerate().map(|(id, genes)| program(id, genes)).collect();
    Program { name: "random.ghyll".into(), text: batch(&programs), files: Vec::new() }
}

/// Random programs have values: a failure is a difference, even if both fail.
fn same(a: &Result<Answer, Failure>, b: &Result<Answer, Failure>) -> bool {
    match (a, b) {
        (Ok(a), Ok(b)) => match (Value::parse(&a.value), Value::parse(&b.value)) {
            (Ok(a), Ok(b)) => a.agrees(&b, Tolerance::Given(0.0)),
            _ => false,
        },
        _ => false,
    }
}

fn told(mode: Mode, call: &Call, a: &Result<Answer, Failure>, b: &Result<Answer, Failure>) -> String {
    let show = |answer: &Result<Answer, Failure>| match answer {
        Ok(answer) => answer.value.clone(),
        Err(failure) => format!("failed: {failure}"),
    };
    format!("main({}): oracle {}, {} {}", call.args.join(", "), show(a), mode.name(), show(b))
}

/// The smallest program found that still makes the mode disagree.
fn shrink(backend: &dyn Backend, mode: Mode, genes: Vec<u32>, found: String) -> Difference {
    // A difference that needs its neighbours is shown as it was found.
    let mut best = (genes.clone(), found);
    let mut tried = BTreeSet::from([program(0, &genes)]);
    let mut fails = |genes: &[u32]| {
        if tried.len() > STEPS || !tried.insert(program(0, genes)) {
            return false;
        }
        let difference = compare(backend, mode, &[genes.to_vec()]);
        if let Some((_, told)) = &difference {
            best = (genes.to_vec(), told.clone());
        }
        difference.is_some()
    };
    let pruned = prune(genes, &mut fails);
    let reduced = reduce(pruned, &mut fails);
    prune(reduced, &mut fails);
    Difference { mode, told: best.1, text: together(&[best.0]).text }
}

/// Puts simple values, and parts of the same type, in the place of expressions, large ones first, as long as the rest
/// fails. All else of the program stays as it is.
fn prune(mut genes: Vec<u32>, mut fails: impl FnMut(&[u32]) -> bool) -> Vec<u32> {
    loop {
        let (mut at, mut better) = (0, false);
        loop {
            let mut all = spans(&genes);
            all.sort_by_key(|span| std::cmp::Reverse(span.to - span.from));
            let Some(span) = all.get(at) else { break };
            let length = program(0, &genes).len();
            let shorter = |list: &Vec<u32>| program(0, list).len() < length;
            let found = simpler(&genes, span, &all).filter(shorter).find(|list| fails(list));
            match found {
                Some(list) => (genes, better) = (list, true),
                None => at += 1,
            }
        }
        if !better {
            return genes;
        }
    }
}

/// The genes with another expression in the place of one: the simplest of its type, or a part of it.
fn simpler<'g>(genes: &'g [u32], span: &'g Span, all: &'g [Span]) -> impl Iterator<Item = Vec<u32>> + 'g {
    let fits = move |piece: &[u32]| {
        let list = [&genes[..span.from], piece, &genes[span.to..]].concat();
        let to = span.from + piece.len();
        // Whatever comes after it is decoded as before only if the piece is taken as a whole.
        let taken = spans(&list).iter().any(|new| (new.from, new.to) == (span.from, to) && new.suits(span));
        taken.then_some(list)
    };
    let simplest =
        (1..=SIMPLEST.min(span.to - span.from)).find_map(move |count| fits(&[0; SIMPLEST][..count]));
    let parts = all.iter().filter(move |part| part.is_within(span) && part.suits(span));
    simplest.into_iter().chain(parts.filter_map(move |part| fits(&genes[part.from..part.to])))
}

/// Takes pieces out of the genes, large ones first and the last ones first, then makes them 0, as long as the rest
/// fails. Genes that are missing or 0 stand for the simplest answer.
fn reduce(mut genes: Vec<u32>, mut fails: impl FnMut(&[u32]) -> bool) -> Vec<u32> {
    let mut size = genes.len().div_ceil(2);
    while size > 0 {
        let mut end = genes.len();
        while end > 0 {
            let begin = end.saturating_sub(size);
            let without = [&genes[..begin], &genes[end..]].concat();
            let mut flat = genes.clone();
            flat[begin..end].fill(0);
            if fails(&without) {
                genes = without;
            } else if genes[begin..end].iter().any(|g| *g != 0) && fails(&flat) {
                genes = flat;
            }
            end = begin.min(genes.len());
        }
        size = if size == 1 { 0 } else { size.div_ceil(2) };
    }
    // What is decided together lies anywhere: small pieces at every place.
    for size in (1..=PIECE).rev() {
        let mut begin = genes.len().saturating_sub(size);
        while begin > 0 {
            begin -= 1;
            let without = [&genes[..begin], &genes[(begin + size).min(genes.len())..]].concat();
            if fails(&without) {
                genes = without;
            }
        }
    }
    genes
}

/// Genes of a struct with its fields, about.
const PIECE: usize = 8;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::Ghyll;
    use crate::case::Diagnostic;
    use crate::judge::Picture;
    use ghyll_compiler::core::{Op, Prim, Scalar, Stmt};
    use ghyll_compiler::table::{Table, Tail, TailBlock};

    /// Answers alike in every mode, but wrongly on the CPU where an entry's text holds the word.
    struct Planted(&'static str);

    impl Backend for Planted {
        fn check(&self, _: &Program, _: &Settings) -> Vec<Diagnostic> {
            Vec::new()
        }

        fn run(
            &self,
            program: &Program,
            _: &Settings,
            mode: Mode,
            calls: &[Call],
        ) -> Vec<Result<Answer, Failure>> {
            let answer = |call: &Call| {
                let name = format!("_{}", call.args[0]);
                let own = program.text.lines().any(|l| l.contains(&name) && l.contains(self.0));
                let value = if own && mode == Mode::CpuAuto { "1.0000001" } else { "1.0" };
                Ok(Answer { value: value.into(), rounds: None })
            };
            calls.iter().map(answer).collect()
        }

        fn render(
            &self,
            _: &Program,
            _: &Settings,
            _: Mode,
            _: &crate::case::Render,
        ) -> Result<Picture, Failure> {
            Err(Failure::Run("no pictures".into()))
        }

        fn tasks(&self, _: &Program, _: &Settings, _: &str) -> Result<Vec<String>, Failure> {
            Ok(Vec::new())
        }

        fn trace(&self, _: &Program, _: &Settings, _: &Call) -> Result<Vec<String>, Failure> {
            Ok(Vec::new())
        }
    }

    #[test]
    fn a_planted_difference_is_found_and_shrunk() {
        let found = search(&Planted("fold("), &[Mode::CpuLane, Mode::CpuAuto], 7, 100).expect_err("planted");
        assert_eq!(found.mode, Mode::CpuAuto);
        assert!(found.told.contains("1.0000001"), "{}", found.told);
        assert!(found.text.contains("fold("));
        assert!(found.text.len() < 1200 + batch(&[]).len(), "not shrunk: {}", found.text);
    }

    fn subtract_the_other_way(table: &mut Table) {
        fn change(stmts: &mut [Stmt]) {
            for stmt in stmts {
                if let Op::Prim(Prim::Sub, Scalar::I32, operands) = &mut stmt.op {
                    operands.reverse();
                }
                stmt.op.blocks_mut().for_each(|block| change(&mut block.stmts));
            }
        }
        fn tail(block: &mut TailBlock) {
            change(&mut block.stmts);
            if let Tail::If(_, yes, no) = &mut block.tail {
                tail(yes);
                tail(no);
            }
        }
        table.helpers.iter_mut().for_each(|helper| change(&mut helper.body.stmts));
        table.tasks.iter_mut().for_each(|task| tail(&mut task.body));
    }

    #[test]
    fn a_wrong_step_of_the_compiler_is_found_and_shrunk() {
        let ghyll = Ghyll::planted(subtract_the_other_way);
        for seed in 1..=5 {
            let found = search(&ghyll, &[Mode::CpuLane], seed, 200).expect_err("planted");
            assert!(found.text.contains(" - "), "{}", found.text);
            let own: usize = found.text.lines().filter(|l| l.contains("_0")).map(str::len).sum();
            println!("seed {seed}: {own}");
            assert!(own < 400, "seed {seed} not shrunk: {}", found.text);
        }
    }

    #[test]
    fn genes_are_reduced_to_those_that_matter() {
        let genes: Vec<u32> = (1..=200).collect();
        let reduced = reduce(genes, |g| g.contains(&77) && g.contains(&150));
        assert_eq!(reduced, [77, 150]);
        let at_its_place = reduce((1..=50).collect(), |g| g.get(20) == Some(&21));
        assert_eq!(at_its_place, [[0; 20].as_slice(), &[21]].concat());
    }

    #[test]
    fn agreement_is_no_difference() {
        assert!(search(&Planted("no such text"), &[Mode::CpuAuto], 7, 50).is_ok());
    }

    #[test]
    fn a_seed_gives_its_programs_again() {
        let list = |seed| {
            let mut runner = TestRunner::new_with_rng(Config::default(), generator(seed));
            genes(LONG).new_tree(&mut runner).map(|t| t.current()).unwrap_or_default()
        };
        assert_eq!(list(5), list(5));
        assert_ne!(list(5), list(6));
    }
}
