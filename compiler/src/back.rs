//! The back end: core to function table and WGSL.

use crate::core::Program;
use crate::optimise::{CLEANING, optimise, run};
use crate::split::live::tail_size;
use crate::split::{TooMany, copies, lift, split_lifted};
use crate::table::{Table, TaskId, Token};
use crate::wgsl::{self, Wgsl};

/// What the runtime needs of a program.
#[derive(Clone, Debug)]
pub struct Back {
    /// Core as it was split, for `--emit core`.
    pub core: Program,
    pub table: Table,
    pub entry: TaskId,
    pub wgsl: Wgsl,
    /// A fused loop may make more turns than an adapter allows in one rewrite.
    pub has_long_loops: bool,
}

/// Turns that a fused loop may make in the form for adapters on which long loops do not end: llvmpipe ends them after
/// 65535 turns of an invocation, which makes several rewrites.
const LONG_LOOP: u64 = 2048;

/// Optimises, splits and writes a verified program.
///
/// # Errors
/// [`TooMany`]
pub fn back(mut program: Program) -> Result<Back, TooMany> {
    optimise(&mut program);
    copies::bound(&mut program);
    let functions = program.functions.len();
    lift::loops(&mut program);
    finish(program, functions)
}

impl Back {
    /// The same program with its long loops as tasks, which can be suspended. Its entry has the same number and
    /// operands. It is the same where that would take too many words or tasks.
    pub fn with_loops_as_tasks(&self) -> Back {
        self.with_loops_of_more_than(LONG_LOOP)
    }

    fn with_loops_of_more_than(&self, turns: u64) -> Back {
        let mut program = self.core.clone();
        let functions = program.functions.len();
        lift::long_loops(&mut program, turns);
        finish(program, functions).unwrap_or_else(|_| self.clone())
    }
}

/// `functions` is how many the program had before loops were lifted.
fn finish(mut program: Program, functions: usize) -> Result<Back, TooMany> {
    if program.functions.len() > functions {
        run(CLEANING, &mut program);
    }
    let (table, entry) = split_lifted(program.clone())?;
    debug_assert_eq!(
        crate::table::verify::table(&table, &crate::core::verify::live_words(&program)).err(),
        None
    );
    let wgsl = wgsl::emit(&table, entry);
    let has_long_loops = lift::has_long_loops(&program, LONG_LOOP);
    Ok(Back { core: program, table, entry, wgsl, has_long_loops })
}

/// Sizes that tests hold and `ghyll explain` shows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stats {
    pub tasks: usize,
    pub helpers: usize,
    /// Statements in all tasks and helpers.
    pub statements: usize,
    /// Operands of the task with the most.
    pub longest_arity: u32,
    /// Tokens of the longest emission.
    pub longest_emission: u32,
    pub rewrites: Vec<Rewrite>,
}

/// What one task takes and leaves.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rewrite {
    pub task: String,
    pub arity: u32,
    /// Literals and function tokens of each emission.
    pub emissions: Vec<(usize, usize)>,
}

pub fn stats(table: &Table) -> Stats {
    let rewrites = table.tasks.iter().map(|task| {
        let count = |emission: &crate::table::Emission| {
            let literals = emission.iter().filter(|t| matches!(t, Token::Literal(_))).count();
            (literals, emission.len() - literals)
        };
        let emissions = task.emissions().into_iter().map(count).collect();
        Rewrite { task: task.name.clone(), arity: task.arity(), emissions }
    });
    let helpers = table.helpers.iter().map(|h| crate::core::walk::size(&h.body.stmts));
    Stats {
        tasks: table.tasks.len(),
        helpers: table.helpers.len(),
        statements: table.tasks.iter().map(|t| tail_size(&t.body)).sum::<usize>() + helpers.sum::<usize>(),
        longest_arity: table.longest_arity(),
        longest_emission: table.longest_emission(),
        rewrites: rewrites.collect(),
    }
}

#[cfg(test)]
mod tests {
    //! Random programs: every phase keeps the meaning.

    use super::*;
    use crate::core::{Const, Scalar, parse, print, verify};
    use crate::interpret::{self, Stopped};
    use crate::random::{Random, TestHost, program};
    use crate::split::split;
    use crate::stream::{initial, rounds, values};
    use crate::table::Widths;

    const FUEL: u64 = 200_000;

    fn rewritten(table: &Table, entry: TaskId, args: &[Const]) -> Result<Vec<Const>, Stopped> {
        let mut last = Vec::new();
        for stream in rounds(table, initial(table, entry, args), &TestHost, 4 * FUEL) {
            last = stream?;
        }
        Ok(values(&last))
    }

    /// All NaN are one value.
    fn canonical(values: Vec<Const>) -> Vec<Const> {
        let canonical = |c| match c {
            Const::F32(bits) if f32::from_bits(bits).is_nan() => Const::f32(f32::NAN),
            other => other,
        };
        values.into_iter().map(canonical).collect()
    }

    fn inputs(random: &mut Random) -> Vec<Const> {
        let depth = Const::I32(random.below(4) as i32);
        let words =
            [Scalar::Bool, Scalar::I32, Scalar::U32].map(|s| Const::from_word(s, random.below(5) as u32));
        [&[depth], words.as_slice(), &[Const::f32(random.below(9) as f32 / 2.0)]].concat()
    }

    /// Checks one program on a few inputs; how many of them were compared.
    fn check(seed: u64) -> usize {
        let text = program(seed);
        let source = parse::program(&text).unwrap_or_else(|why| panic!("seed {seed}: {why}\n{text}"));
        verify::program(&source).unwrap_or_else(|why| panic!("seed {seed}: {why}\n{text}"));
        let (plain, plain_entry) = split(&source).expect("few words");
        let back = back(source.clone()).expect("few words");
        wgsl::tests::check(&back.wgsl);
        let lifted = back.with_loops_of_more_than(1);
        wgsl::tests::check(&lifted.wgsl);
        let mut random = Random::new(seed);
        let mut compared = 0;
        for _ in 0..4 {
            let args = inputs(&mut random);
            let Ok(expected) = interpret::run(&source, &args, &TestHost, FUEL) else { continue };
            let expected = Ok(canonical(expected));
            let context = || format!("seed {seed}, {args:?}\n{text}\n{}", print::program(&back.core));
            let optimised = interpret::run(&back.core, &args, &TestHost, FUEL).map(canonical);
            assert_eq!(optimised, expected, "optimised: {}", context());
            let split = rewritten(&plain, plain_entry, &args).map(canonical);
            assert_eq!(split, expected, "split: {}", context());
            let all = rewritten(&back.table, back.entry, &args).map(canonical);
            assert_eq!(all, expected, "optimised and split: {}", context());
            let lifted = rewritten(&lifted.table, lifted.entry, &args).map(canonical);
            assert_eq!(lifted, expected, "with loops as tasks: {}", context());
            compared += 1;
        }
        compared
    }

    #[test]
    fn random_programs_keep_their_meaning() {
        let compared: usize = (0..150).map(check).sum();
        assert!(compared > 400, "only {compared} comparisons");
    }

    #[test]
    fn a_planted_difference_is_found() {
        let find = |seed: &u64| {
            let text = program(*seed);
            let planted = text.replace("n: i32 = sub.i32(v0, 1)", "n: i32 = sub.i32(v0, 2)");
            let source = parse::program(&text).expect("parses");
            let (table, entry) = split(&parse::program(&planted).expect("parses")).expect("few words");
            let args = [Const::I32(2), Const::Bool(true), Const::I32(3), Const::U32(4), Const::f32(0.5)];
            let expected = interpret::run(&source, &args, &TestHost, FUEL).map(canonical);
            expected.is_ok() && rewritten(&table, entry, &args).map(canonical) != expected
        };
        let found = (0..200).filter(find).count();
        assert!(found > 20, "only {found}");
    }

    #[test]
    fn random_programs_survive_printing() {
        for seed in 0..100 {
            let mut source = parse::program(&program(seed)).expect("parses");
            source.functions.iter_mut().for_each(crate::core::walk::compact);
            assert_eq!(parse::program(&print::program(&source)), Ok(source));
        }
    }

    #[test]
    fn stats_count_what_the_table_has() {
        let source = parse::program(crate::split::tests::FIB).expect("parses");
        let table = back(source).expect("few words").table;
        assert_eq!(table.widths(), Widths { first: 2, later: 3, segment: 1 });
        let stats = stats(&table);
        assert_eq!((stats.tasks, stats.helpers, stats.longest_arity, stats.longest_emission), (2, 0, 2, 5));
        let fib = Rewrite { task: "fib".into(), arity: 1, emissions: vec![(1, 0), (2, 3)] };
        assert_eq!(stats.rewrites[0], fib);
    }
}
