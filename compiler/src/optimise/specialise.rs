//! Parameters that have the same constant value in every call become that constant. A parameter that recursion
//! passes on unchanged counts as the same value.
//!
//! Functions marked `@task` keep their operands, since the source asks for that token.

use crate::core::walk::statements;
use crate::core::{Atom, Const, Function, Mark, Op, Program, Var};

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
    while learn(&program.functions, &mut known) {}
    for (f, known) in program.functions.iter_mut().zip(&known) {
        replace(f, known);
    }
}

/// Looks at every call once more; whether anything was learnt.
fn learn(functions: &[Function], known: &mut [Vec<Known>]) -> bool {
    let mut learnt = false;
    for (caller, f) in functions.iter().enumerate() {
        statements(&f.body.stmts, &mut |stmt| {
            let Op::Call(id, args) = &stmt.op else { return };
            for (i, arg) in args.iter().enumerate() {
                let value = match arg {
                    Atom::Const(c) => Known::Const(*c),
                    Atom::Var(v) => match f.params.iter().position(|p| p == v) {
                        Some(param) => known[caller][param],
                        None => Known::Varies,
                    },
                };
                let before = &mut known[id.0 as usize][i];
                let after = meet(*before, value);
                learnt |= after != *before;
                *before = after;
            }
        });
    }
    learnt
}

fn meet(a: Known, b: Known) -> Known {
    match (a, b) {
        (Known::Nothing, other) | (other, Known::Nothing) => other,
        _ if a == b => a,
        _ => Known::Varies,
    }
}

fn replace(f: &mut Function, known: &[Known]) {
    let constants: Vec<(Var, Const)> = f
        .params
        .iter()
        .zip(known)
        .filter_map(|(v, known)| match known {
            Known::Const(c) => Some((*v, *c)),
            _ => None,
        })
        .collect();
    if !constants.is_empty() {
        let mut body = std::mem::take(&mut f.body);
        replace_in(&mut body, &constants);
        f.body = body;
    }
}

fn replace_in(block: &mut crate::core::Block, constants: &[(Var, Const)]) {
    let put = |atom: &mut Atom| {
        if let Atom::Var(v) = atom
            && let Some((_, c)) = constants.iter().find(|(p, _)| p == v)
        {
            *atom = Atom::Const(*c);
        }
    };
    for stmt in &mut block.stmts {
        stmt.op.operands_mut().into_iter().for_each(put);
        stmt.op.blocks_mut().into_iter().for_each(|b| replace_in(b, constants));
    }
    block.results.iter_mut().for_each(put);
}
