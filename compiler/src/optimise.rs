//! The optimiser: a list of passes over core, each meaning-preserving and leaving verified core.
//!
//! Passes come more than once where one makes work for another: folding after inlining, because arguments are known
//! then; removal last, because every pass leaves statements that nobody uses.

mod common;
mod dead;
mod fold;
mod hoist;
mod identity;
mod inline;
mod motion;
mod nesting;
mod specialise;
#[cfg(test)]
pub(crate) mod tests;

use crate::core::{Program, verify};

pub type Pass = fn(&mut Program);

/// All passes in order.
pub const PASSES: &[(&str, Pass)] = &[
    ("unreachable functions", dead::unreachable),
    ("constants, known branches, common subexpressions", fold::fold),
    ("unused values, parameters and results", dead::unused),
    ("parameters with one value", specialise::parameters),
    ("inline", inline::inline),
    ("constants, known branches, common subexpressions", fold::fold),
    ("unused values, parameters and results", dead::unused),
    // What has lost parameters and branches may be small enough now.
    ("parameters with one value", specialise::parameters),
    ("inline", inline::inline),
    ("constants, known branches, common subexpressions", fold::fold),
    ("operations that a loop repeats", hoist::hoist),
    ("operations that one branch needs", motion::sink),
    ("choices", motion::choose),
    ("constants, known branches, common subexpressions", fold::fold),
    ("unused values, parameters and results", dead::unused),
    ("unreachable functions", dead::unreachable),
    ("nesting", nesting::bound),
    ("number variables anew", dead::compact),
];

/// Cleans up after a pass that writes new functions, such as loop lifting.
pub const CLEANING: &[(&str, Pass)] = &[
    ("constants, known branches, common subexpressions", fold::fold),
    ("unused values, parameters and results", dead::unused),
    ("unreachable functions", dead::unreachable),
    ("number variables anew", dead::compact),
];

/// Runs passes in order; a debug build verifies the program after each.
pub fn run(passes: &[(&str, Pass)], program: &mut Program) {
    for (name, pass) in passes {
        pass(program);
        if cfg!(debug_assertions)
            && let Err(why) = verify::program(program)
        {
            panic!("after `{name}`: {why}");
        }
    }
}

pub fn optimise(program: &mut Program) {
    run(PASSES, program);
}
