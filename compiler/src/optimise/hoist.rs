//! What a loop repeats though it never changes is evaluated before the loop.
//!
//! What is cheap is evaluated whether the loop runs or not. The rest (dear operations, calls, branches, inner loops)
//! is evaluated behind the loop's own test of its first state, so never in vain; a task call that leaves a loop in
//! this way may leave it fused.

use rustc_hash::{FxHashMap, FxHashSet};

use crate::core::walk::{substitute, uses};
use crate::core::{Atom, Block, Const, Dst, Function, Intrinsic, Loop, Op, Program, Stmt, Var};

/// Cost in additions up to which an operation may be evaluated for a loop that does not run.
const CHEAP: u32 = 20;
/// Statements up to which a loop's test is evaluated once more.
const TEST: usize = 4;

pub fn hoist(program: &mut Program) {
    for f in &mut program.functions {
        let mut body = std::mem::take(&mut f.body);
        block(f, &mut body);
        f.body = body;
    }
}

fn block(f: &mut Function, inner: &mut Block) {
    if !inner.stmts.iter().any(|stmt| matches!(stmt.op, Op::Loop(_))) {
        return inner.stmts.iter_mut().flat_map(|stmt| stmt.op.blocks_mut()).for_each(|b| block(f, b));
    }
    let mut stmts = Vec::with_capacity(inner.stmts.len());
    for mut stmt in std::mem::take(&mut inner.stmts) {
        stmt.op.blocks_mut().for_each(|b| block(f, b));
        if let Op::Loop(l) = &mut stmt.op {
            before(f, l, &mut stmts);
        }
        stmts.push(stmt);
    }
    inner.stmts = stmts;
}

/// Moves what never changes out of the loop.
fn before(f: &mut Function, l: &mut Loop, out: &mut Vec<Stmt>) {
    let mut changing: FxHashSet<Var> = l.state.iter().map(|(v, _)| *v).collect();
    // The test is evaluated at least once.
    out.extend(take(&mut l.cond, &mut changing, |_| true));
    // What depends on something dear stays with it.
    out.extend(take(&mut l.body, &mut changing.clone(), is_cheap));
    let Some(test) = first_test(f, l) else { return };
    let dear = take(&mut l.body, &mut changing, |_| true);
    if !dear.is_empty() {
        out.extend(test.stmts);
        out.push(guard(f, dear, test.results[0]));
    }
}

/// Statements of the block that depend on nothing in `changing` and that `wanted` accepts; the destinations of the
/// others come to `changing`.
fn take(block: &mut Block, changing: &mut FxHashSet<Var>, wanted: impl Fn(&Op) -> bool) -> Vec<Stmt> {
    let depends = |stmt: &Stmt, changing: &FxHashSet<Var>| {
        let mut any = false;
        uses(stmt, &mut |v| any = any || changing.contains(&v));
        any
    };
    let (mut found, mut kept) = (Vec::new(), Vec::with_capacity(block.stmts.len()));
    for stmt in std::mem::take(&mut block.stmts) {
        if wanted(&stmt.op) && !depends(&stmt, changing) {
            found.push(stmt);
        } else {
            changing.extend(&stmt.dst);
            kept.push(stmt);
        }
    }
    block.stmts = kept;
    found
}

/// The loop's test of its first state, if it is short.
fn first_test(f: &mut Function, l: &Loop) -> Option<Block> {
    if l.cond.stmts.len() > TEST || !l.cond.stmts.iter().all(|s| is_cheap(&s.op)) {
        return None;
    }
    let mut test = l.cond.clone();
    let mut values: FxHashMap<Var, Atom> = l.state.iter().copied().collect();
    rename(f, &mut test.stmts, &mut values);
    substitute(&mut test, &|v| values.get(&v).copied());
    Some(test)
}

/// `if entered { stmts } else { zeros }`, with the destinations that the statements had.
fn guard(f: &mut Function, stmts: Vec<Stmt>, entered: Atom) -> Stmt {
    let dst: Dst = stmts.iter().flat_map(|s| s.dst.iter().copied()).collect();
    let mut yes = Block { stmts, results: dst.iter().map(|v| Atom::Var(*v)).collect() };
    let mut values = FxHashMap::default();
    rename(f, &mut yes.stmts, &mut values);
    substitute(&mut yes, &|v| values.get(&v).copied());
    let zeros = dst.iter().map(|v| Atom::Const(Const::from_word(f.vars[v.0 as usize], 0))).collect();
    let no = Block { stmts: Vec::new(), results: zeros };
    Stmt { dst, op: Op::branch(entered, yes, no) }
}

/// Gives the statements' destinations new names, which come to `values`.
fn rename(f: &mut Function, stmts: &mut [Stmt], values: &mut FxHashMap<Var, Atom>) {
    for v in stmts.iter_mut().flat_map(|s| &mut s.dst) {
        let fresh = f.fresh(f.vars[v.0 as usize]);
        values.insert(*v, Atom::Var(fresh));
        *v = fresh;
    }
}

fn is_cheap(op: &Op) -> bool {
    match op {
        Op::Prim(prim, ..) => prim.row().cost <= CHEAP,
        Op::Live(_) => true,
        Op::Intrinsic(i, _) => Intrinsic::cost(*i) <= 1,
        _ => false,
    }
}
