//! Moves statements to where they are evaluated least.
//!
//! - [`sink`]: what only one branch of an `if` uses is evaluated in that branch. Calls of tasks stay where they are,
//!   because there they can go out together with others.
//! - [`choose`]: an `if` with nothing left to evaluate in its branches becomes a `select`. Last, because such an
//!   `if` can still take in what [`sink`] moves.

use rustc_hash::FxHashMap;

use crate::core::walk::{Free, calls_any, free_in_stmt};
use crate::core::{Atom, Block, Function, Op, Prim, Program, Stmt, Var};
use crate::split::tasks;

pub fn sink(program: &mut Program) {
    let is_task = tasks(program);
    for f in &mut program.functions {
        sink_in(&mut f.body, &is_task);
    }
}

/// Who uses a variable, among the statements of one block.
#[derive(Clone, Copy, PartialEq)]
enum Site {
    /// Branch `.1` (0 is the taken one) of the `if` at `.0`.
    Branch(usize, usize),
    Elsewhere,
}

fn sink_in(block: &mut Block, is_task: &[bool]) {
    let mut sites: FxHashMap<Var, Site> = FxHashMap::default();
    let mut results = Free::default();
    results.atoms(&block.results);
    sites.extend(results.vars().into_iter().map(|v| (v, Site::Elsewhere)));

    // From the last statement to the first, so that a moved statement takes its operands along.
    let mut moved: FxHashMap<(usize, usize), Vec<Stmt>> = FxHashMap::default();
    let mut kept: Vec<(usize, Stmt)> = Vec::new();
    for (at, stmt) in std::mem::take(&mut block.stmts).into_iter().enumerate().rev() {
        let target = target(&stmt, &sites).filter(|_| may_move(&stmt, is_task));
        note_uses(&mut sites, at, &stmt, target);
        match target {
            Some(place) => moved.entry(place).or_default().push(stmt),
            None => kept.push((at, stmt)),
        }
    }
    block.stmts = kept.into_iter().rev().map(|(at, stmt)| with_moved(stmt, at, &mut moved)).collect();
    for stmt in &mut block.stmts {
        stmt.op.blocks_mut().for_each(|inner| sink_in(inner, is_task));
    }
}

/// The branch that all uses of the statement's results are in.
fn target(stmt: &Stmt, sites: &FxHashMap<Var, Site>) -> Option<(usize, usize)> {
    let mut used = stmt.dst.iter().filter_map(|v| sites.get(v));
    let first = *used.next()?;
    match first {
        Site::Branch(at, branch) if used.all(|site| *site == first) => Some((at, branch)),
        _ => None,
    }
}

fn may_move(stmt: &Stmt, is_task: &[bool]) -> bool {
    !calls_any(std::slice::from_ref(stmt), is_task)
}

fn note_uses(sites: &mut FxHashMap<Var, Site>, at: usize, stmt: &Stmt, target: Option<(usize, usize)>) {
    let mut note = |vars: Vec<Var>, site: Site| {
        for v in vars {
            sites
                .entry(v)
                .and_modify(|s| *s = if *s == site { site } else { Site::Elsewhere })
                .or_insert(site);
        }
    };
    if let Some((at, branch)) = target {
        return note(free_in_stmt(stmt), Site::Branch(at, branch));
    }
    let Op::If(cond, yes, no) = &stmt.op else {
        return note(free_in_stmt(stmt), Site::Elsewhere);
    };
    if let Atom::Var(v) = cond {
        note(vec![*v], Site::Elsewhere);
    }
    for (branch, block) in [yes, no].into_iter().enumerate() {
        let mut free = Free::default();
        free.block(block);
        note(free.vars(), Site::Branch(at, branch));
    }
}

/// The statement with what was moved into its branches, which was collected last one first.
fn with_moved(mut stmt: Stmt, at: usize, moved: &mut FxHashMap<(usize, usize), Vec<Stmt>>) -> Stmt {
    for (branch, block) in stmt.op.blocks_mut().enumerate() {
        if let Some(mut stmts) = moved.remove(&(at, branch)) {
            stmts.reverse();
            stmts.append(&mut block.stmts);
            block.stmts = stmts;
        }
    }
    stmt
}

pub fn choose(program: &mut Program) {
    for f in &mut program.functions {
        let mut body = std::mem::take(&mut f.body);
        choose_in(f, &mut body);
        f.body = body;
    }
}

fn choose_in(f: &Function, block: &mut Block) {
    let mut stmts = Vec::with_capacity(block.stmts.len());
    for mut stmt in std::mem::take(&mut block.stmts) {
        stmt.op.blocks_mut().for_each(|inner| choose_in(f, inner));
        match &stmt.op {
            Op::If(cond, yes, no) if yes.stmts.is_empty() && no.stmts.is_empty() => {
                for ((v, yes), no) in stmt.dst.iter().zip(&yes.results).zip(&no.results) {
                    let op = Op::Prim(Prim::Select, f.vars[v.0 as usize], vec![*no, *yes, *cond]);
                    stmts.push(Stmt { dst: vec![*v], op });
                }
            }
            _ => stmts.push(stmt),
        }
    }
    block.stmts = stmts;
}
