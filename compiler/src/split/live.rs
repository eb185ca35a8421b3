//! Which words a continuation gets, and which statements it evaluates itself to get fewer of them.

use std::collections::BinaryHeap;

use rustc_hash::{FxHashMap, FxHashSet};

use crate::core::walk::{Free, Renumber, free_in_stmt, size, uses};
use crate::core::{Atom, Op, Stmt, Var};
use crate::table::{Tail, TailBlock, Token};

/// Operations that cost more than this are never evaluated twice to save a word.
const CHEAP: u32 = 4;

/// Variables that a body takes from outside, in the order of first use.
pub fn free(block: &TailBlock) -> Vec<Var> {
    let mut free = Free::default();
    see(&mut free, block);
    free.vars()
}

fn see(free: &mut Free, block: &TailBlock) {
    free.stmts(&block.stmts);
    match &block.tail {
        Tail::Emit(emission) => {
            for token in emission {
                if let Token::Literal(atom) = token {
                    free.atoms(&[*atom]);
                }
            }
        }
        Tail::If(cond, yes, no) => {
            free.atoms(&[*cond]);
            see(free, yes);
            see(free, no);
        }
        Tail::Again(args) => free.atoms(args),
    }
}

/// Copies a body into the variable space of `renumber`.
pub fn copy(renumber: &mut Renumber, block: &TailBlock) -> TailBlock {
    let stmts = renumber.stmts(&block.stmts);
    let tail = match &block.tail {
        Tail::Emit(emission) => Tail::Emit(emission.iter().map(|t| token(renumber, t)).collect()),
        Tail::Again(args) => Tail::Again(renumber.atoms(args)),
        Tail::If(cond, yes, no) => {
            let cond = renumber.atom(*cond);
            let yes = Box::new(copy(renumber, yes));
            Tail::If(cond, yes, Box::new(copy(renumber, no)))
        }
    };
    TailBlock { stmts, tail }
}

fn token(renumber: &Renumber, token: &Token<Atom>) -> Token<Atom> {
    match token {
        Token::Literal(atom) => Token::Literal(renumber.atom(*atom)),
        Token::Function(f) => Token::Function(*f),
    }
}

/// Statements of a body.
pub fn tail_size(block: &TailBlock) -> usize {
    let inner = match &block.tail {
        Tail::If(_, yes, no) => tail_size(yes) + tail_size(no),
        _ => 0,
    };
    size(&block.stmts) + inner
}

/// Removes statements whose results the block does not use.
pub fn prune(block: &mut TailBlock) {
    used_when_pruned(block);
}

/// Prunes the block; the variables that it then uses, its own among them.
fn used_when_pruned(block: &mut TailBlock) -> FxHashSet<Var> {
    let mut used: FxHashSet<Var> = match &mut block.tail {
        Tail::If(cond, yes, no) => {
            let (mut more, mut less) = (used_when_pruned(yes), used_when_pruned(no));
            if more.len() < less.len() {
                std::mem::swap(&mut more, &mut less);
            }
            more.extend(less);
            more.extend(vars_of(&[*cond]));
            more
        }
        Tail::Emit(emission) => {
            let literals = emission.iter().filter_map(|token| match token {
                Token::Literal(Atom::Var(v)) => Some(*v),
                _ => None,
            });
            literals.collect()
        }
        Tail::Again(args) => vars_of(args).collect(),
    };
    for stmt in std::mem::take(&mut block.stmts).into_iter().rev() {
        if stmt.dst.iter().any(|v| used.contains(v)) {
            uses(&stmt, &mut |v| {
                used.insert(v);
            });
            block.stmts.push(stmt);
        }
    }
    block.stmts.reverse();
    used
}

/// The statements of `before` that a continuation with body `block` should evaluate itself, chosen so that it has
/// few live words. Those that `needed` depends on would be evaluated twice, so they must be cheap and save a word.
pub fn sink(
    before: &[Stmt],
    block: &TailBlock,
    results: &FxHashSet<Var>,
    needed: &FxHashSet<Var>,
) -> Vec<Stmt> {
    let needed = closure(before, needed);
    let mut live: FxHashSet<Var> = free(block).into_iter().filter(|v| !results.contains(v)).collect();
    let places = before.iter().enumerate().flat_map(|(at, stmt)| stmt.dst.iter().map(move |v| (*v, at)));
    let places: FxHashMap<Var, usize> = places.collect();
    let mut taken = vec![false; before.len()];
    for at in (0..before.len()).rev() {
        if taken[at] || !before[at].dst.iter().any(|v| live.contains(v)) {
            continue;
        }
        if !take(before, &[at], &needed, &mut live, &mut taken) {
            let cone = cone(before, at, &live, &places);
            take(before, &cone, &needed, &mut live, &mut taken);
        }
    }
    before.iter().zip(taken).filter(|(_, taken)| *taken).map(|(stmt, _)| stmt.clone()).collect()
}

/// Takes these statements along if that pays; whether it did.
fn take(
    before: &[Stmt],
    parts: &[usize],
    needed: &FxHashSet<Var>,
    live: &mut FxHashSet<Var>,
    taken: &mut [bool],
) -> bool {
    let defined: FxHashSet<Var> = parts.iter().flat_map(|p| before[*p].dst.iter().copied()).collect();
    let saved = defined.iter().filter(|v| live.contains(v)).count();
    let operands = parts.iter().flat_map(|p| free_in_stmt(&before[*p]));
    let added: FxHashSet<Var> = operands.filter(|v| !defined.contains(v) && !live.contains(v)).collect();
    let twice = defined.iter().any(|v| needed.contains(v));
    let cheap = parts.iter().all(|p| is_cheap(&before[*p]));
    let pays = if twice { cheap && added.len() < saved } else { added.len() <= saved };
    if pays {
        parts.iter().for_each(|p| taken[*p] = true);
        for v in &defined {
            live.remove(v);
        }
        live.extend(added);
    }
    pays
}

/// `vars` and everything of `before` that they depend on.
fn closure(before: &[Stmt], vars: &FxHashSet<Var>) -> FxHashSet<Var> {
    let mut all = vars.clone();
    for stmt in before.iter().rev() {
        if stmt.dst.iter().any(|v| all.contains(v)) {
            all.extend(free_in_stmt(stmt));
        }
    }
    all
}

/// Statement `at` with the cheap ones it depends on, down to variables that are live anyway.
fn cone(before: &[Stmt], at: usize, live: &FxHashSet<Var>, places: &FxHashMap<Var, usize>) -> Vec<usize> {
    let mut parts = Vec::new();
    let mut open = BinaryHeap::from([at]);
    while let Some(i) = open.pop() {
        // Operands are defined before, so equal indices come one after the other.
        if parts.last() == Some(&i) {
            continue;
        }
        parts.push(i);
        if parts.len() > 8 {
            return vec![at];
        }
        let wanted = free_in_stmt(&before[i]).into_iter().filter(|v| !live.contains(v));
        open.extend(wanted.filter_map(|v| places.get(&v)).filter(|p| is_cheap(&before[**p])));
    }
    parts.reverse();
    parts
}

pub fn is_cheap(stmt: &Stmt) -> bool {
    match &stmt.op {
        Op::Prim(prim, ..) => prim.row().cost <= CHEAP,
        Op::Live(_) => true,
        _ => false,
    }
}

/// Variables among atoms.
pub fn vars_of(atoms: &[Atom]) -> impl Iterator<Item = Var> + '_ {
    atoms.iter().filter_map(|a| match a {
        Atom::Var(v) => Some(*v),
        Atom::Const(_) => None,
    })
}
