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

use std::hash::{Hash, Hasher};

use rustc_hash::FxHasher;

use crate::core::{Program, verify};

pub type Pass = fn(&mut Program);
type Named = (&'static str, Pass);

const FOLD: Named = ("constants, known branches, common subexpressions", fold::fold);
const UNUSED: Named = ("unused values, parameters and results", dead::unused);
const UNREACHABLE: Named = ("unreachable functions", dead::unreachable);
const KNOWN: Named = ("parameters with one value", specialise::parameters);
const INLINE: Named = ("inline", inline::inline);
const NUMBER: Named = ("number variables anew", dead::compact);

/// When a phase runs.
#[derive(Clone, Copy, PartialEq)]
enum When {
    Always,
    /// If the phase before it ran and changed the program: else there is nothing new to work on.
    Changed,
}

/// All passes in order.
const PHASES: &[(When, &[Named])] = &[
    (When::Always, &[UNREACHABLE, FOLD, UNUSED]),
    (When::Always, &[KNOWN, INLINE]),
    (When::Changed, &[FOLD, UNUSED]),
    // What has lost parameters and branches may be small enough now.
    (When::Changed, &[KNOWN, INLINE]),
    (When::Changed, &[FOLD]),
    (
        When::Always,
        &[
            ("operations that a loop repeats", hoist::hoist),
            ("operations that one branch needs", motion::sink),
            ("choices", motion::choose),
        ],
    ),
    (When::Changed, &[FOLD, UNUSED]),
    (When::Always, &[UNREACHABLE, ("nesting", nesting::bound), NUMBER]),
];

/// Cleans up after a pass that writes new functions, such as loop lifting.
pub const CLEANING: &[Named] = &[FOLD, UNUSED, UNREACHABLE, NUMBER];

/// Every pass in order, whether or not its phase would run.
pub fn passes() -> impl Iterator<Item = Named> {
    PHASES.iter().flat_map(|(_, passes)| passes.iter().copied())
}

/// Runs passes in order; a debug build verifies the program after each.
pub fn run(passes: &[Named], program: &mut Program) {
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
    let mut has_changed = true;
    for (phase, (when, passes)) in PHASES.iter().enumerate() {
        if *when == When::Changed && !has_changed {
            continue;
        }
        let is_asked = matches!(PHASES.get(phase + 1), Some((When::Changed, _)));
        let before = is_asked.then(|| digest(program));
        run(passes, program);
        has_changed = before.is_some_and(|before| before != digest(program));
    }
}

fn digest(program: &Program) -> u64 {
    let mut hasher = FxHasher::default();
    program.functions.iter().for_each(|f| (&f.params, &f.body).hash(&mut hasher));
    hasher.finish()
}
