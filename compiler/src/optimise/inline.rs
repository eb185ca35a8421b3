//! Inlining (fusion), by a cost model in statements. A call is replaced by the callee's body when
//!
//! - the callee is marked `@inline` or this is its only call: the program does not grow; or
//! - what the program grows by, less what the call saves, is at most [`LIMIT`]. A call saves itself and the words it
//!   passes; the statements that fold because an argument is known, the branches not taken included
//!   ([`Model::known`]); and a rewrite ([`REWRITE`]) where the callee would else be a task only because it calls one.
//!
//! Never when the callee is marked `@task` or is recursive. A body that holds [`LARGEST`] statements takes in no more
//! of the second kind. Callees go first, so a chain of small functions becomes one body. What is marked is called all
//! the same once [`MOST_MARKED`] statements were put in place: marked functions that call each other may double at each
//! step.

use std::cell::Cell;

use crate::core::graph::Graph;
use crate::core::walk::{VarMap, calls, relocate, size};
use crate::core::{Atom, Block, FnId, Function, Mark, Op, Program, Scalar, Stmt, Var};
use crate::split::tasks;

/// Statements that a program may grow by for one call.
const LIMIT: usize = 24;
/// Statements that a rewrite costs as much as: a token, its operands and a turn of the rewriter.
const REWRITE: usize = 48;
/// Statements beyond which a body takes in no more functions that are called elsewhere, too.
const LARGEST: usize = 4000;
/// Statements of marked functions that are put in place, in the whole program.
const MOST_MARKED: usize = 200_000;

pub fn inline(program: &mut Program) {
    let graph = Graph::new(&program.functions);
    let is_task = tasks(program);
    let mut count = vec![0; program.functions.len()];
    for f in &program.functions {
        calls(&f.body.stmts).iter().for_each(|id| count[id.0 as usize] += 1);
    }
    let models = program.functions.iter().map(|_| Model::default()).collect();
    let marked = Cell::new(MOST_MARKED);
    let mut inliner = Inliner { count, recursive: graph.recursive, is_task, models, marked };
    for f in graph.bottom_up {
        let mut function = std::mem::take(&mut program.functions[f]);
        inliner.function(&mut program.functions, &mut function);
        inliner.models[f] = Model::of(&function);
        program.functions[f] = function;
    }
    super::dead::unreachable(program);
}

/// What a finished function costs.
#[derive(Default)]
struct Model {
    statements: usize,
    /// Statements that fold when parameter i is known.
    known: Vec<usize>,
}

impl Model {
    fn of(f: &Function) -> Model {
        let mut origins = VarMap::new();
        origins.extend(f.params.iter().copied().zip(0..));
        let mut known = vec![0; f.params.len()];
        fold_with(&f.body, &mut origins, &mut known);
        Model { statements: size(&f.body.stmts), known }
    }
}

/// Counts statements that depend on one parameter only, and branches that it decides.
fn fold_with(block: &Block, origins: &mut VarMap<usize>, known: &mut [usize]) {
    for stmt in &block.stmts {
        match &stmt.op {
            Op::Prim(_, _, args) => {
                let mut found = args.iter().filter_map(|a| match a {
                    Atom::Var(v) => Some(origins.get(*v)),
                    Atom::Const(_) => None,
                });
                if let Some(Some(param)) = found.next()
                    && found.all(|other| other == Some(param))
                {
                    known[param] += 1;
                    origins.insert(stmt.dst[0], param);
                }
            }
            Op::If(Atom::Var(cond), yes, no) => {
                if let Some(param) = origins.get(*cond) {
                    known[param] += 1 + size(&yes.stmts).min(size(&no.stmts));
                }
            }
            _ => {}
        }
        stmt.op.blocks().for_each(|inner| fold_with(inner, origins, known));
    }
}

struct Inliner {
    count: Vec<usize>,
    recursive: Vec<bool>,
    is_task: Vec<bool>,
    /// Of functions that are finished.
    models: Vec<Model>,
    /// Statements of marked functions that may still be put in place.
    marked: Cell<usize>,
}

impl Inliner {
    fn wants(&self, functions: &[Function], id: FnId, args: &[Atom], results: usize, room: usize) -> bool {
        let f = id.0 as usize;
        match functions[f].mark {
            _ if self.recursive[f] => false,
            Mark::Task => false,
            Mark::Inline => match self.marked.get().checked_sub(self.models[f].statements) {
                Some(left) => {
                    self.marked.set(left);
                    true
                }
                None => false,
            },
            Mark::Auto if self.count[f] == 1 => true,
            Mark::Auto => {
                let model = &self.models[f];
                let known: usize = args
                    .iter()
                    .zip(&model.known)
                    .filter(|(a, _)| matches!(a, Atom::Const(_)))
                    .map(|(_, saved)| saved)
                    .sum();
                let rewrite = if self.is_task[f] { REWRITE } else { 0 };
                let saved = 1 + args.len() + results + known + rewrite;
                model.statements <= room && model.statements <= LIMIT + saved
            }
        }
    }

    fn function(&self, functions: &mut [Function], f: &mut Function) {
        let body = std::mem::take(&mut f.body);
        let room = LARGEST.saturating_sub(size(&body.stmts));
        let vars = std::mem::take(&mut f.vars);
        let mut copy = Copy { inliner: self, functions, room, vars, results: VarMap::new() };
        f.body = copy.block(body);
        f.vars = copy.vars;
    }
}

struct Copy<'a> {
    inliner: &'a Inliner,
    functions: &'a mut [Function],
    room: usize,
    /// The function's own variables keep their numbers; those of callees come after.
    vars: Vec<Scalar>,
    /// What destinations of inlined calls have become.
    results: VarMap<Atom>,
}

impl Copy<'_> {
    fn replace(&self, atom: &mut Atom) {
        if let Atom::Var(v) = atom {
            *atom = self.results.get(*v).unwrap_or(*atom);
        }
    }

    fn block(&mut self, mut block: Block) -> Block {
        let mut stmts = Vec::with_capacity(block.stmts.len());
        for stmt in block.stmts {
            self.stmt(stmt, &mut stmts);
        }
        block.results.iter_mut().for_each(|a| self.replace(a));
        Block { stmts, results: block.results }
    }

    fn stmt(&mut self, mut stmt: Stmt, out: &mut Vec<Stmt>) {
        stmt.op.operands_mut().for_each(|a| self.replace(a));
        if let Op::Call(id, args) = &stmt.op
            && self.inliner.wants(self.functions, *id, args, stmt.dst.len(), self.room)
        {
            let results = self.expand(*id, args, out);
            self.results.extend(stmt.dst.iter().copied().zip(results));
            return;
        }
        stmt.op.blocks_mut().for_each(|block| *block = self.block(std::mem::take(block)));
        out.push(stmt);
    }

    /// The callee's statements with fresh variables; its results.
    fn expand(&mut self, id: FnId, args: &[Atom], out: &mut Vec<Stmt>) -> Vec<Atom> {
        let f = id.0 as usize;
        self.room = self.room.saturating_sub(self.inliner.models[f].statements);
        let callee = &mut self.functions[f];
        // Nothing calls it any more after its only call.
        let mut body = match self.inliner.count[f] {
            1 => std::mem::take(&mut callee.body),
            _ => callee.body.clone(),
        };
        let mut params: VarMap<Atom> = VarMap::new();
        params.extend(callee.params.iter().copied().zip(args.iter().copied()));
        let base = Var(self.vars.len() as u32);
        self.vars.extend(&callee.vars);
        relocate(&mut body, base.0, &params);
        out.extend(body.stmts);
        body.results
    }
}
