//! Moves statements to where they are evaluated least.
//!
//! - [`sink`]: what only one branch of an `if` uses is evaluated in that branch. Calls of tasks stay where they are,
//!   because there they can go out together with others.
//! - [`choose`]: an `if` with nothing left to evaluate in its branches becomes a `select`. Last, because such an
//!   `if` can still take in what [`sink`] moves.

use rustc_hash::FxHashMap;
use smallvec::smallvec;

use crate::core::walk::{VarMap, calls_any, uses, uses_in, vars_of};
use crate::core::{Atom, Block, Function, Op, Prim, Program, Stmt, Var};
use crate::split::tasks;

/// Blocks around a branch into which no `if` or loop is moved: a chain of them would become as deep as it is long.
const DEEPEST: usize = 16;

pub fn sink(program: &mut Program) {
    let is_task = tasks(program);
    let mut sinker = Sinker { is_task: &is_task, sites: Sites::default() };
    for f in &mut program.functions {
        sinker.block(&mut f.body, 0);
    }
}

/// Who uses a variable, among the statements of one block.
#[derive(Clone, Copy, PartialEq)]
enum Site {
    /// Branch `.1` (0 is the taken one) of the `if` at `.0`.
    Branch(usize, usize),
    Elsewhere,
}

/// Who uses the variables that one block uses.
#[derive(Default)]
struct Sites {
    of: VarMap<Site>,
    noted: Vec<Var>,
}

impl Sites {
    fn note(&mut self, v: Var, site: Site) {
        match self.of.get(v) {
            Some(known) if known == site => {}
            Some(_) => self.of.insert(v, Site::Elsewhere),
            None => {
                self.of.insert(v, site);
                self.noted.push(v);
            }
        }
    }

    fn clear(&mut self) {
        for v in self.noted.drain(..) {
            self.of.set(v, None);
        }
    }
}

struct Sinker<'a> {
    is_task: &'a [bool],
    /// One for all blocks, each of which leaves it empty.
    sites: Sites,
}

impl Sinker<'_> {
    fn block(&mut self, block: &mut Block, depth: usize) {
        if block.stmts.iter().any(|stmt| matches!(stmt.op, Op::If(..))) {
            self.sink(block, depth);
        }
        for stmt in &mut block.stmts {
            stmt.op.blocks_mut().for_each(|inner| self.block(inner, depth + 1));
        }
    }

    /// Moves the block's statements into its branches.
    fn sink(&mut self, block: &mut Block, depth: usize) {
        vars_of(block.results.iter().copied()).for_each(|v| self.sites.note(v, Site::Elsewhere));

        // From the last statement to the first, so that a moved statement takes its operands along.
        let mut moved: FxHashMap<(usize, usize), Vec<Stmt>> = FxHashMap::default();
        let mut kept: Vec<(usize, Stmt)> = Vec::new();
        for (at, stmt) in std::mem::take(&mut block.stmts).into_iter().enumerate().rev() {
            let target = target(&stmt, &self.sites).filter(|_| may_move(&stmt, self.is_task, depth));
            note_uses(&mut self.sites, at, &stmt, target);
            match target {
                Some(place) => moved.entry(place).or_default().push(stmt),
                None => kept.push((at, stmt)),
            }
        }
        self.sites.clear();
        block.stmts = kept.into_iter().rev().map(|(at, stmt)| with_moved(stmt, at, &mut moved)).collect();
    }
}

/// The branch that all uses of the statement's results are in.
fn target(stmt: &Stmt, sites: &Sites) -> Option<(usize, usize)> {
    let mut used = stmt.dst.iter().filter_map(|v| sites.of.get(*v));
    let first = used.next()?;
    match first {
        Site::Branch(at, branch) if used.all(|site| site == first) => Some((at, branch)),
        _ => None,
    }
}

fn may_move(stmt: &Stmt, is_task: &[bool], depth: usize) -> bool {
    (depth < DEEPEST || stmt.op.blocks().next().is_none()) && !calls_any(std::slice::from_ref(stmt), is_task)
}

fn note_uses(sites: &mut Sites, at: usize, stmt: &Stmt, target: Option<(usize, usize)>) {
    if let Some((at, branch)) = target {
        return uses(stmt, &mut |v| sites.note(v, Site::Branch(at, branch)));
    }
    let Op::If(cond, yes, no) = &stmt.op else {
        return uses(stmt, &mut |v| sites.note(v, Site::Elsewhere));
    };
    if let Atom::Var(v) = cond {
        sites.note(*v, Site::Elsewhere);
    }
    for (branch, block) in [yes, no].into_iter().enumerate() {
        uses_in(block, &mut |v| sites.note(v, Site::Branch(at, branch)));
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
    block.stmts.iter_mut().flat_map(|stmt| stmt.op.blocks_mut()).for_each(|inner| choose_in(f, inner));
    if !block.stmts.iter().any(|stmt| matches!(stmt.op, Op::If(..))) {
        return;
    }
    let mut stmts = Vec::with_capacity(block.stmts.len());
    for stmt in std::mem::take(&mut block.stmts) {
        match &stmt.op {
            Op::If(cond, yes, no) if yes.stmts.is_empty() && no.stmts.is_empty() => {
                for ((v, yes), no) in stmt.dst.iter().zip(&yes.results).zip(&no.results) {
                    let op = Op::Prim(Prim::Select, f.vars[v.0 as usize], smallvec![*no, *yes, *cond]);
                    stmts.push(Stmt { dst: smallvec![*v], op });
                }
            }
            _ => stmts.push(stmt),
        }
    }
    block.stmts = stmts;
}
