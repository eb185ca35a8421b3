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
use crate::core::walk::{VarMap, calls, compact, relocate, size};
use crate::core::{Atom, Block, Dst, FnId, Function, Mark, Op, Program, Scalar, Stmt, Var};
use crate::split::tasks_of;

/// Statements that a program may grow by for one call.
const LIMIT: usize = 24;
/// Statements that a rewrite costs as much as: a token, its operands and a turn of the rewriter.
const REWRITE: usize = 48;
/// Statements beyond which a body takes in no more functions that are called elsewhere, too.
const LARGEST: usize = 4000;
/// Statements of marked functions that are put in place, in the whole program.
const MOST_MARKED: usize = 200_000;
/// Nesting beyond which a body takes in nothing: `nesting` would only take it out again.
const DEEPEST: usize = 100;

pub fn inline(program: &mut Program) {
    let graph = Graph::new(&program.functions);
    let stays = |f: &usize| graph.recursive[*f] || program.functions[*f].mark == Mark::Task;
    if graph.callees.iter().flatten().all(stays) {
        return super::dead::unreachable(program);
    }
    // Copies take all variables of the callee along, so they should be those that it still has.
    program.functions.iter_mut().for_each(compact);
    let is_task = tasks_of(program, &graph);
    let mut count = vec![0; program.functions.len()];
    for f in &program.functions {
        calls(&f.body.stmts).iter().for_each(|id| count[id.0 as usize] += 1);
    }
    let models = program.functions.iter().map(|_| Model::default()).collect();
    let marked = Cell::new(MOST_MARKED);
    let stays: Vec<bool> =
        (0..count.len()).map(|f| graph.recursive[f] || program.functions[f].mark == Mark::Task).collect();
    let called_once = |f: usize| count[f] == 1 && !stays[f] && f != program.entry as usize;
    let called_once = (0..count.len()).map(called_once).collect();
    let mut inliner = Inliner { called_once, recursive: graph.recursive, is_task, models, marked };
    // What is called once is met where it is called, so that a chain of such functions is copied once and not once a link.
    let mut open: Vec<usize> = graph.bottom_up.into_iter().rev().collect();
    open.retain(|f| !inliner.called_once[*f]);
    while let Some(f) = open.pop() {
        let mut function = std::mem::take(&mut program.functions[f]);
        let left = inliner.function(&mut program.functions, &mut function);
        if count[f] > 0 && !stays[f] {
            inliner.models[f] = Model::of(&function);
        }
        program.functions[f] = function;
        open.extend(left);
    }
    super::dead::unreachable(program);
}

/// What a finished function costs.
#[derive(Default)]
struct Model {
    statements: usize,
    /// Blocks in each other.
    nesting: usize,
    /// Statements that fold when parameter i is known.
    known: Vec<usize>,
}

impl Model {
    fn of(f: &Function) -> Model {
        let mut origins = VarMap::new();
        origins.extend(f.params.iter().copied().zip(0..));
        let mut known = vec![0; f.params.len()];
        fold_with(&f.body, &mut origins, &mut known);
        Model { statements: size(&f.body.stmts), nesting: nesting(&f.body.stmts), known }
    }
}

fn nesting(stmts: &[Stmt]) -> usize {
    stmts.iter().flat_map(|stmt| stmt.op.blocks()).map(|block| 1 + nesting(&block.stmts)).max().unwrap_or(0)
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
    /// Put in place at the only call, which lets nothing grow.
    called_once: Vec<bool>,
    recursive: Vec<bool>,
    is_task: Vec<bool>,
    /// Of functions that are finished.
    models: Vec<Model>,
    /// Statements of marked functions that may still be put in place.
    marked: Cell<usize>,
}

impl Inliner {
    fn wants(&self, functions: &[Function], stmt: (FnId, &[Atom], usize), room: usize, depth: usize) -> bool {
        let (id, args, results) = stmt;
        let f = id.0 as usize;
        match functions[f].mark {
            _ if self.recursive[f] || depth + self.models[f].nesting > DEEPEST => false,
            Mark::Task => false,
            Mark::Inline => match self.marked.get().checked_sub(self.models[f].statements) {
                Some(left) => {
                    self.marked.set(left);
                    true
                }
                None => false,
            },
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

    /// Functions that are called once and stay functions all the same.
    fn function(&self, functions: &mut [Function], f: &mut Function) -> Vec<usize> {
        let body = std::mem::take(&mut f.body);
        let vars = std::mem::take(&mut f.vars);
        let mut copy = Copy {
            inliner: self,
            functions,
            room: LARGEST.saturating_sub(size(&body.stmts)),
            depth: 0,
            written: 0,
            vars,
            results: VarMap::new(),
            left: Vec::new(),
        };
        f.body = copy.block(body);
        f.vars = copy.vars;
        copy.left
    }
}

struct Copy<'a> {
    inliner: &'a Inliner,
    functions: &'a mut [Function],
    /// Statements that the function being copied may still take in of functions that are called elsewhere, too.
    room: usize,
    /// Blocks around.
    depth: usize,
    /// Statements written so far.
    written: usize,
    /// The function's own variables keep their numbers; those of callees come after.
    vars: Vec<Scalar>,
    /// What destinations of inlined calls have become.
    results: VarMap<Atom>,
    left: Vec<usize>,
}

/// Statements to be copied: of a block, or of a function called once that is put in place there.
struct Source {
    stmts: std::vec::IntoIter<Stmt>,
    call: Option<Call>,
}

/// The call that a function is put in the place of.
struct Call {
    dst: Dst,
    results: Vec<Atom>,
    /// The caller's, when the call was met.
    room: usize,
    written: usize,
}

impl Copy<'_> {
    fn replace(&self, atom: &mut Atom) {
        if let Atom::Var(v) = atom {
            *atom = self.results.get(*v).unwrap_or(*atom);
        }
    }

    fn block(&mut self, mut block: Block) -> Block {
        let mut out = Vec::with_capacity(block.stmts.len());
        let mut sources = vec![Source { stmts: block.stmts.into_iter(), call: None }];
        while let Some(source) = sources.last_mut() {
            match source.stmts.next() {
                Some(stmt) => sources.extend(self.stmt(stmt, &mut out)),
                None => {
                    if let Some(call) = sources.pop().and_then(|source| source.call) {
                        self.finish(call);
                    }
                }
            }
        }
        block.results.iter_mut().for_each(|a| self.replace(a));
        Block { stmts: out, results: block.results }
    }

    /// Copies a statement, or opens the function that is to be copied in its place.
    fn stmt(&mut self, mut stmt: Stmt, out: &mut Vec<Stmt>) -> Option<Source> {
        stmt.op.operands_mut().for_each(|a| self.replace(a));
        if let Op::Call(id, args) = &stmt.op {
            let f = id.0 as usize;
            let call = (*id, args.as_slice(), stmt.dst.len());
            if self.inliner.called_once[f] {
                if self.depth + nesting(&self.functions[f].body.stmts) <= DEEPEST {
                    return Some(self.open(f, args, std::mem::take(&mut stmt.dst)));
                }
                self.left.push(f);
            } else if self.inliner.wants(self.functions, call, self.room, self.depth) {
                self.clone_in(f, args, &stmt.dst, out);
                return None;
            }
        }
        self.depth += 1;
        stmt.op.blocks_mut().for_each(|block| *block = self.block(std::mem::take(block)));
        self.depth -= 1;
        self.written += 1;
        out.push(stmt);
        None
    }

    /// A function called once, its body moved into this variable space.
    fn open(&mut self, f: usize, args: &[Atom], dst: Dst) -> Source {
        let callee = std::mem::take(&mut self.functions[f]);
        let body = self.relocated(callee.body, &callee.params, &callee.vars, args);
        let call = Call { dst, results: body.results, room: self.room, written: self.written };
        self.room = LARGEST.saturating_sub(size(&body.stmts));
        Source { stmts: body.stmts.into_iter(), call: Some(call) }
    }

    fn finish(&mut self, mut call: Call) {
        call.results.iter_mut().for_each(|a| self.replace(a));
        self.results.extend(call.dst.into_iter().zip(call.results));
        self.room = call.room.saturating_sub(self.written - call.written);
    }

    /// A copy of a finished function.
    fn clone_in(&mut self, f: usize, args: &[Atom], dst: &[Var], out: &mut Vec<Stmt>) {
        let statements = self.inliner.models[f].statements;
        self.room = self.room.saturating_sub(statements);
        self.written += statements;
        let callee = std::mem::take(&mut self.functions[f]);
        let body = self.relocated(callee.body.clone(), &callee.params, &callee.vars, args);
        self.functions[f] = callee;
        out.extend(body.stmts);
        self.results.extend(dst.iter().copied().zip(body.results));
    }

    /// A callee's body with fresh variables, the arguments in the place of its parameters.
    fn relocated(&mut self, mut body: Block, params: &[Var], vars: &[Scalar], args: &[Atom]) -> Block {
        let mut values: VarMap<Atom> = VarMap::new();
        values.extend(params.iter().copied().zip(args.iter().copied()));
        let base = self.vars.len() as u32;
        self.vars.extend(vars);
        relocate(&mut body, base, &values);
        body
    }
}
