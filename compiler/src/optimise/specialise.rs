//! Parameters that have the same constant value in every call become that constant. A parameter that recursion
//! passes on unchanged counts as the same value.
//!
//! Functions marked `@task` keep their operands, since the source asks for that token.

use std::collections::VecDeque;

use crate::core::graph::Graph;
use crate::core::walk::{VarMap, statements, substitute};
use crate::core::{Atom, Const, Function, Mark, Op, Program};

#[derive(Clone, Copy, PartialEq)]
enum Known {
    /// No call seen yet.
    Nothing,
    Const(Const),
    Varies,
}

pub fn parameters(program: &mut Program) {
    let mut known: Vec<Vec<Known>> = program
        .functions
        .iter()
        .enumerate()
        .map(|(i, f)| {
            let fixed = f.mark == Mark::Task || i == program.entry as usize;
            vec![if fixed { Known::Varies } else { Known::Nothing }; f.params.len()]
        })
        .collect();
    // Callers first, so that most of it is learnt at once; a function is looked at again when more is known of it.
    let mut open: VecDeque<usize> = Graph::new(&program.functions).bottom_up.into_iter().rev().collect();
    let mut is_open = vec![true; program.functions.len()];
    let params: Vec<VarMap<usize>> = program
        .functions
        .iter()
        .map(|f| {
            let mut params = VarMap::new();
            params.extend(f.params.iter().copied().zip(0..));
            params
        })
        .collect();
    while let Some(caller) = open.pop_front() {
        is_open[caller] = false;
        learn(&program.functions[caller], &params[caller], caller, &mut known, &mut |callee| {
            if !std::mem::replace(&mut is_open[callee], true) {
                open.push_back(callee);
            }
        });
    }
    for (f, known) in program.functions.iter_mut().zip(&known) {
        replace(f, known);
    }
}

/// Looks at the calls in a function; tells of which functions something was learnt.
fn learn(
    function: &Function,
    params: &VarMap<usize>,
    caller: usize,
    known: &mut [Vec<Known>],
    learnt: &mut dyn FnMut(usize),
) {
    statements(&function.body.stmts, &mut |stmt| {
        let Op::Call(id, args) = &stmt.op else { return };
        let callee = id.0 as usize;
        for (i, arg) in args.iter().enumerate() {
            let value = match arg {
                Atom::Const(c) => Known::Const(*c),
                Atom::Var(v) => match params.get(*v) {
                    Some(param) => known[caller][param],
                    None => Known::Varies,
                },
            };
            let after = meet(known[callee][i], value);
            if std::mem::replace(&mut known[callee][i], after) != after {
                learnt(callee);
            }
        }
    });
}

fn meet(a: Known, b: Known) -> Known {
    match (a, b) {
        (Known::Nothing, other) | (other, Known::Nothing) => other,
        _ if a == b => a,
        _ => Known::Varies,
    }
}

fn replace(f: &mut Function, known: &[Known]) {
    let mut constants = VarMap::new();
    for (v, known) in f.params.iter().zip(known) {
        if let Known::Const(c) = known {
            constants.insert(*v, Atom::Const(*c));
        }
    }
    substitute(&mut f.body, &|v| constants.get(v));
}
