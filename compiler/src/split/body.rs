//! Splits the bodies of task functions at their task calls.
//!
//! A block is compiled in tail position against a [`Finish`]: the emission that its results go into. In each block
//! the task calls that do not wait for another one are *ready*; statements that depend on no task call are
//! evaluated before. Then
//!
//! - ready calls go out together, `live .. | a1.. f1 | a2.. f2 | continuation`, where the rest of the block is the
//!   continuation. A rest that would only put the results into an emission is no task of its own: that emission with
//!   `a1.. f1` in the place of f1's results does the same (tail calls, `A(m - 1, A(m, n - 1))` as `m-1 m n-1 A A`);
//! - a ready `if` with task calls in its branches becomes an `if` of the task; both branches finish with the rest
//!   of the block, which is a continuation of its own (the join) unless it is only an emission; a branch without
//!   task calls evaluates a small join itself;
//! - an `if` that is ready together with other calls is made a function of its own, so that it does not hold them up.

use std::collections::HashSet;

use super::live::{copy, free, prune, sink, tail_size, vars_of};
use crate::core::walk::{Renumber, calls, free_in_stmt, mentions};
use crate::core::{Atom, Block, Function, Mark, Op, Stmt, Var};
use crate::table::{Emission, Tail, TailBlock, TaskId, Token};

/// Statements of a join that a branch without task calls evaluates itself, which saves a rewrite.
const SMALL_JOIN: usize = 12;

/// Tokens of an emission beyond which calls wait for the continuation, because windows are small.
const LONGEST: usize = 64;

/// A task before it gets its number and name; token ids are indices of drafts.
pub struct Draft {
    /// The function whose variables the draft uses.
    pub function: usize,
    /// The function's own task, not a continuation.
    pub is_root: bool,
    pub params: Vec<Var>,
    pub body: TailBlock,
}

/// Splits what `entry` reaches. Draft 0 is the entry's task.
pub fn split(functions: &mut Vec<Function>, is_task: Vec<bool>, entry: usize) -> Vec<Draft> {
    let roots = vec![None; functions.len()];
    let mut splitter = Splitter { functions, is_task, roots, drafts: Vec::new(), open: Vec::new() };
    splitter.root(entry);
    while let Some(f) = splitter.open.pop() {
        splitter.function(f);
    }
    splitter.drafts
}

/// Where the results of a block go: an emission with a variable for each result.
struct Finish {
    slots: Vec<Var>,
    emission: Emission,
    /// A small join, which a block with something left to evaluate evaluates itself.
    join: Option<TailBlock>,
}

impl Finish {
    fn with(&self, results: &[Atom]) -> Emission {
        let replace = |atom: Atom| match atom {
            Atom::Var(v) => self.slots.iter().position(|s| *s == v).map_or(atom, |i| results[i]),
            Atom::Const(_) => atom,
        };
        let token = |t: &Token<Atom>| match t {
            Token::Literal(atom) => Token::Literal(replace(*atom)),
            Token::Function(f) => Token::Function(*f),
        };
        self.emission.iter().map(token).collect()
    }
}

/// A task call on its way into an emission.
struct Group {
    dst: Vec<Var>,
    tokens: Emission,
}

/// A block's statements by what they wait for.
#[derive(Default)]
struct Schedule {
    /// Depend on no task call.
    before: Vec<Stmt>,
    /// Task calls, and `if`s with task calls inside, that depend on no other.
    ready: Vec<Stmt>,
    rest: Vec<Stmt>,
}

struct Splitter<'a> {
    functions: &'a mut Vec<Function>,
    is_task: Vec<bool>,
    /// Draft of each function's own task.
    roots: Vec<Option<usize>>,
    drafts: Vec<Draft>,
    /// Functions whose draft is still empty.
    open: Vec<usize>,
}

impl Splitter<'_> {
    fn root(&mut self, f: usize) -> TaskId {
        if let Some(draft) = self.roots[f] {
            return TaskId(draft as u32);
        }
        let body = TailBlock { stmts: Vec::new(), tail: Tail::Emit(Vec::new()) };
        let id =
            self.draft(Draft { function: f, is_root: true, params: self.functions[f].params.clone(), body });
        self.roots[f] = Some(id.0 as usize);
        self.open.push(f);
        id
    }

    fn draft(&mut self, draft: Draft) -> TaskId {
        self.drafts.push(draft);
        TaskId(self.drafts.len() as u32 - 1)
    }

    fn function(&mut self, f: usize) {
        let root = self.root(f);
        let body = std::mem::take(&mut self.functions[f].body);
        let results = self.functions[f].results.clone();
        let slots: Vec<_> = results.into_iter().map(|s| self.functions[f].fresh(s)).collect();
        let emission = literals(&slots);
        let mut split =
            self.block(f, body.stmts.clone(), &body.results, &Finish { slots, emission, join: None });
        self.functions[f].body = body;
        prune(&mut split);
        make_self_calls_loops(&mut split, root, self.functions[f].params.len());
        self.drafts[root.0 as usize].body = split;
    }

    fn any_task_call(&self, stmts: &[Stmt]) -> bool {
        calls(stmts).iter().any(|id| self.is_task[id.0 as usize])
    }

    fn schedule(&self, stmts: Vec<Stmt>) -> Schedule {
        let mut schedule = Schedule::default();
        let mut waiting: HashSet<Var> = HashSet::new();
        for stmt in stmts {
            let is_call = self.any_task_call(std::slice::from_ref(&stmt));
            let waits = !waiting.is_empty() && mentions(&stmt, &waiting);
            if is_call || waits {
                waiting.extend(&stmt.dst);
            }
            let list = match (waits, is_call) {
                (true, _) => &mut schedule.rest,
                (false, true) => &mut schedule.ready,
                (false, false) => &mut schedule.before,
            };
            list.push(stmt);
        }
        schedule
    }

    fn block(&mut self, f: usize, stmts: Vec<Stmt>, results: &[Atom], finish: &Finish) -> TailBlock {
        let Schedule { before, mut ready, mut rest } = self.schedule(stmts);
        if ready.is_empty() {
            return match &finish.join {
                Some(join) if !before.is_empty() => {
                    let last = Block { stmts: before, results: results.to_vec() };
                    self.append(f, &last, &finish.slots, join)
                }
                _ => TailBlock { stmts: before, tail: Tail::Emit(finish.with(results)) },
            };
        }
        rest.splice(0..0, ready.split_off(fitting(&ready)));
        let after = self.block(f, rest, results, finish);
        match ready.as_slice() {
            [Stmt { dst, op: Op::If(cond, yes, no) }] => self.exits(f, before, dst, (*cond, yes, no), after),
            _ => self.emit(f, before, &ready, after),
        }
    }

    /// Ready calls, then `after`.
    fn emit(&mut self, f: usize, before: Vec<Stmt>, ready: &[Stmt], after: TailBlock) -> TailBlock {
        let groups: Vec<_> = ready.iter().map(|stmt| self.group(f, stmt)).collect();
        if let (true, Tail::Emit(emission)) = (after.stmts.is_empty(), &after.tail)
            && let Some(emission) = forward(emission, &groups)
            && emission.len() <= LONGEST
        {
            return TailBlock { stmts: before, tail: Tail::Emit(emission) };
        }
        let needed = groups.iter().flat_map(|g| literal_vars(&g.tokens)).collect();
        let results: Vec<_> = groups.iter().flat_map(|g| g.dst.iter().copied()).collect();
        let (live, task) = self.continuation(f, &before, after, &results, &needed);
        let mut emission = literals(&live);
        emission.extend(groups.into_iter().flat_map(|g| g.tokens));
        emission.push(Token::Function(task));
        TailBlock { stmts: before, tail: Tail::Emit(emission) }
    }

    /// A ready `if`, then `after`.
    fn exits(
        &mut self,
        f: usize,
        before: Vec<Stmt>,
        dst: &[Var],
        (cond, yes, no): (Atom, &Block, &Block),
        after: TailBlock,
    ) -> TailBlock {
        if let (true, Tail::Emit(emission)) = (after.stmts.is_empty(), &after.tail) {
            let finish = Finish { slots: dst.to_vec(), emission: emission.clone(), join: None };
            let [yes, no] = [yes, no].map(|b| Box::new(self.block(f, b.stmts.clone(), &b.results, &finish)));
            return TailBlock { stmts: before, tail: Tail::If(cond, yes, no) };
        }
        // The join.
        let branches = Stmt { dst: dst.to_vec(), op: Op::If(cond, yes.clone(), no.clone()) };
        let needed = free_in_stmt(&branches).into_iter().collect();
        let small = tail_size(&after) <= SMALL_JOIN;
        let in_place = if small { Some(after.clone()) } else { None };
        let (live, task) = self.continuation(f, &before, after, dst, &needed);
        let mut emission = literals(&live);
        emission.extend(literals(dst));
        emission.push(Token::Function(task));
        let finish = Finish { slots: dst.to_vec(), emission, join: in_place.clone() };
        let [yes, no] = [yes, no].map(|b| {
            Box::new(match &in_place {
                Some(after) if !self.any_task_call(&b.stmts) => self.append(f, b, dst, after),
                _ => self.block(f, b.stmts.clone(), &b.results, &finish),
            })
        });
        TailBlock { stmts: before, tail: Tail::If(cond, yes, no) }
    }

    /// Statements without task calls, then a copy of `after`.
    fn append(&mut self, f: usize, branch: &Block, dst: &[Var], after: &TailBlock) -> TailBlock {
        let old = std::mem::take(&mut self.functions[f].vars);
        let mut renumber = Renumber::new(&old, old.clone());
        renumber.map.extend(dst.iter().copied().zip(branch.results.iter().copied()));
        let mut block = copy(&mut renumber, after);
        self.functions[f].vars = renumber.new;
        block.stmts.splice(0..0, branch.stmts.iter().cloned());
        block
    }

    /// A task with body `block` whose operands are live words, then `results`.
    fn continuation(
        &mut self,
        f: usize,
        before: &[Stmt],
        mut block: TailBlock,
        results: &[Var],
        needed: &HashSet<Var>,
    ) -> (Vec<Var>, TaskId) {
        let mut stmts = sink(before, &block, results, needed);
        stmts.append(&mut block.stmts);
        block.stmts = stmts;
        prune(&mut block);
        let mut live: Vec<_> = free(&block).into_iter().filter(|v| !results.contains(v)).collect();
        live.sort();
        let params = live.iter().chain(results).copied().collect();
        let task = self.draft(Draft { function: f, is_root: false, params, body: block });
        (live, task)
    }

    fn group(&mut self, f: usize, stmt: &Stmt) -> Group {
        let (callee, args) = match &stmt.op {
            Op::Call(id, args) => (id.0 as usize, args.clone()),
            _ => self.outline(f, stmt),
        };
        let mut tokens: Emission = args.into_iter().map(Token::Literal).collect();
        tokens.push(Token::Function(self.root(callee)));
        Group { dst: stmt.dst.clone(), tokens }
    }

    /// Makes a statement a function of its own; its arguments here.
    fn outline(&mut self, f: usize, stmt: &Stmt) -> (usize, Vec<Atom>) {
        let params = free_in_stmt(stmt);
        let args = params.iter().map(|v| Atom::Var(*v)).collect();
        let from = &self.functions[f];
        let mut names = self.functions.iter().map(|f| f.name.clone()).collect();
        let function = Function {
            name: super::lift::fresh_name(&mut names, &format!("{}.if", from.name)),
            params,
            results: stmt.dst.iter().map(|v| from.vars[v.0 as usize]).collect(),
            vars: from.vars.clone(),
            body: Block {
                stmts: vec![stmt.clone()],
                results: stmt.dst.iter().map(|v| Atom::Var(*v)).collect(),
            },
            mark: Mark::Auto,
            span: from.span,
        };
        self.functions.push(function);
        self.is_task.push(true);
        self.roots.push(None);
        (self.functions.len() - 1, args)
    }
}

/// How many of the ready calls go out together.
fn fitting(ready: &[Stmt]) -> usize {
    let mut tokens = 0;
    let fits = |stmt: &&Stmt| {
        tokens += stmt.op.operands().count() + 1;
        tokens <= LONGEST
    };
    ready.iter().take_while(fits).count().max(1)
}

fn literals(vars: &[Var]) -> Emission {
    vars.iter().map(|v| Token::Literal(Atom::Var(*v))).collect()
}

fn literal_vars(emission: &Emission) -> Vec<Var> {
    let atoms: Vec<_> = emission
        .iter()
        .filter_map(|t| match t {
            Token::Literal(atom) => Some(*atom),
            Token::Function(_) => None,
        })
        .collect();
    vars_of(&atoms).collect()
}

/// `emission` with each group's tokens in the place of its results. Possible if all results stand in it exactly
/// once, those of a group side by side and in order.
fn forward(emission: &Emission, groups: &[Group]) -> Option<Emission> {
    let mut out = Vec::with_capacity(emission.len());
    let mut placed = vec![false; groups.len()];
    let mut at = 0;
    while let Some(token) = emission.get(at) {
        let group = match token {
            Token::Literal(Atom::Var(v)) => groups.iter().position(|g| g.dst.contains(v)),
            _ => None,
        };
        let Some(i) = group else {
            out.push(*token);
            at += 1;
            continue;
        };
        let dst = literals(&groups[i].dst);
        if std::mem::replace(&mut placed[i], true) || !emission[at..].starts_with(&dst) {
            return None;
        }
        out.extend(&groups[i].tokens);
        at += dst.len();
    }
    placed.iter().all(|p| *p).then_some(out)
}

/// An exit that is nothing but a call of the task itself starts the body over instead.
fn make_self_calls_loops(block: &mut TailBlock, root: TaskId, arity: usize) {
    match &mut block.tail {
        Tail::If(_, yes, no) => {
            make_self_calls_loops(yes, root, arity);
            make_self_calls_loops(no, root, arity);
        }
        Tail::Emit(emission) => {
            let args: Vec<_> = emission
                .iter()
                .map_while(|t| match t {
                    Token::Literal(atom) => Some(*atom),
                    Token::Function(_) => None,
                })
                .collect();
            let is_call = emission.len() == arity + 1 && emission.last() == Some(&Token::Function(root));
            if is_call && args.len() == arity {
                block.tail = Tail::Again(args);
            }
        }
        Tail::Again(_) => {}
    }
}
