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

use rustc_hash::{FxHashMap, FxHashSet};

use super::live::{copy, free, is_cheap, prune, sink, tail_size, vars_of};
use crate::core::names::Names;
use crate::core::walk::{Free, Renumber, calls_any, free_in_stmt, uses};
use crate::core::{Args, Atom, Block, Dst, Function, Mark, Op, Stmt, Var};
use crate::table::{Emission, Tail, TailBlock, TaskId, Token};

/// Statements of a join that a branch without task calls evaluates itself, which saves a rewrite.
const SMALL_JOIN: usize = 12;

/// Tokens of an emission beyond which calls wait for the continuation, because windows are small.
const LONGEST: usize = 64;

/// Levels of a block up to which `sink` alone moves statements.
const FEW_LEVELS: usize = 16;

/// Operands of all continuations; a program that needs more is refused. Each call of a task passes on what is live.
const MOST_WORDS: usize = 500_000;

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
pub fn split(functions: &mut Vec<Function>, is_task: Vec<bool>, entry: usize) -> Option<Vec<Draft>> {
    let roots = vec![None; functions.len()];
    let names = Names::of(functions.iter());
    let mut splitter =
        Splitter { functions, is_task, roots, drafts: Vec::new(), open: Vec::new(), names, words: 0 };
    splitter.root(entry);
    while let Some(f) = splitter.open.pop() {
        splitter.function(f);
    }
    (splitter.words <= MOST_WORDS).then_some(splitter.drafts)
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
        let values: FxHashMap<Var, Atom> = self.slots.iter().copied().zip(results.iter().copied()).collect();
        let replace = |atom: Atom| match atom {
            Atom::Var(v) => values.get(&v).copied().unwrap_or(atom),
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
    dst: Dst,
    tokens: Emission,
}

/// Statements of a block that wait for the same task calls.
#[derive(Default)]
struct Level {
    /// Depend on no task call but those of earlier levels.
    before: Vec<Stmt>,
    /// Moved here to come before those, last one first.
    early: Vec<Stmt>,
    /// Task calls, and `if`s with task calls inside, that depend on no others.
    ready: Vec<Stmt>,
    /// Tokens that the calls put into an emission.
    tokens: usize,
}

impl Level {
    /// Calls that do not fit into one emission wait for the next level.
    fn takes(&self, tokens: usize) -> bool {
        self.ready.is_empty() || self.tokens + tokens <= LONGEST
    }
}

struct Splitter<'a> {
    functions: &'a mut Vec<Function>,
    is_task: Vec<bool>,
    /// Draft of each function's own task.
    roots: Vec<Option<usize>>,
    drafts: Vec<Draft>,
    /// Functions whose draft is still empty.
    open: Vec<usize>,
    names: Names,
    /// Operands of all continuations so far.
    words: usize,
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
        let mut split = self.block(f, body, &Finish { slots, emission, join: None });
        prune(&mut split);
        make_self_calls_loops(&mut split, root, self.functions[f].params.len());
        self.drafts[root.0 as usize].body = split;
    }

    fn any_task_call(&self, stmts: &[Stmt]) -> bool {
        calls_any(stmts, &self.is_task)
    }

    /// The statements by level. The last level has no calls.
    fn levels(&self, stmts: Vec<Stmt>, results: &[Atom]) -> Vec<Level> {
        if !self.any_task_call(&stmts) {
            return vec![Level { before: stmts, ..Level::default() }];
        }
        let mut levels = vec![Level::default()];
        // The level at which a variable is known, if that is not the first.
        let mut known: FxHashMap<Var, usize> = FxHashMap::default();
        // Where to look for room for a call at a level that had none.
        let mut room: FxHashMap<usize, usize> = FxHashMap::default();
        for stmt in stmts {
            let mut at = 0;
            if !known.is_empty() {
                uses(&stmt, &mut |v| at = at.max(known.get(&v).copied().unwrap_or(0)));
            }
            if !self.any_task_call(std::slice::from_ref(&stmt)) {
                if at > 0 {
                    known.extend(stmt.dst.iter().map(|v| (*v, at)));
                }
                levels[at].before.push(stmt);
                continue;
            }
            let tokens = stmt.op.operands().count() + 1;
            at = with_room(&mut room, at);
            while !levels[at].takes(tokens) {
                room.insert(at, at + 1);
                at = with_room(&mut room, at + 1);
                if at == levels.len() {
                    levels.push(Level::default());
                }
            }
            if at + 1 == levels.len() {
                levels.push(Level::default());
            }
            known.extend(stmt.dst.iter().map(|v| (*v, at + 1)));
            levels[at].tokens += tokens;
            levels[at].ready.push(stmt);
        }
        late(&mut levels, results);
        levels
    }

    fn block(&mut self, f: usize, block: Block, finish: &Finish) -> TailBlock {
        if self.words > MOST_WORDS {
            return TailBlock { stmts: Vec::new(), tail: Tail::Emit(Vec::new()) };
        }
        let mut levels = self.levels(block.stmts, &block.results);
        let Level { before, .. } = levels.pop().unwrap_or_default();
        let mut after = match &finish.join {
            Some(join) if !before.is_empty() => {
                let last = Block { stmts: before, results: block.results };
                self.append(f, last, &finish.slots, join)
            }
            _ => TailBlock { stmts: before, tail: Tail::Emit(finish.with(&block.results)) },
        };
        // From the end, because what comes after is an operand of what comes before.
        for Level { before, mut ready, .. } in levels.into_iter().rev() {
            if self.words > MOST_WORDS {
                break;
            }
            let is_if = matches!(ready.as_slice(), [Stmt { op: Op::If(..), .. }]);
            after = match ready.pop() {
                Some(Stmt { dst, op: Op::If(cond, yes, no) }) if is_if => {
                    self.exits(f, before, &dst, (cond, *yes, *no), after)
                }
                last => {
                    ready.extend(last);
                    self.emit(f, before, &ready, after)
                }
            };
        }
        after
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
        (cond, yes, no): (Atom, Block, Block),
        after: TailBlock,
    ) -> TailBlock {
        if let (true, Tail::Emit(emission)) = (after.stmts.is_empty(), &after.tail) {
            let finish = Finish { slots: dst.to_vec(), emission: emission.clone(), join: None };
            let [yes, no] = [yes, no].map(|b| Box::new(self.block(f, b, &finish)));
            return TailBlock { stmts: before, tail: Tail::If(cond, yes, no) };
        }
        // The join.
        let mut needed = Free::default();
        needed.atoms(&[cond]);
        needed.block(&yes);
        needed.block(&no);
        let needed = needed.vars().into_iter().collect();
        let small = tail_size(&after) <= SMALL_JOIN;
        let in_place = if small { Some(after.clone()) } else { None };
        let (live, task) = self.continuation(f, &before, after, dst, &needed);
        let mut emission = literals(&live);
        emission.extend(literals(dst));
        emission.push(Token::Function(task));
        let finish = Finish { slots: dst.to_vec(), emission, join: in_place };
        let [yes, no] = [yes, no].map(|b| {
            Box::new(match &finish.join {
                Some(after) if !self.any_task_call(&b.stmts) => self.append(f, b, dst, after),
                _ => self.block(f, b, &finish),
            })
        });
        TailBlock { stmts: before, tail: Tail::If(cond, yes, no) }
    }

    /// Statements without task calls, then a copy of `after`.
    fn append(&mut self, f: usize, branch: Block, dst: &[Var], after: &TailBlock) -> TailBlock {
        let mut renumber = Renumber::within(std::mem::take(&mut self.functions[f].vars));
        renumber.map.extend(dst.iter().copied().zip(branch.results));
        let mut block = copy(&mut renumber, after);
        self.functions[f].vars = renumber.new;
        block.stmts.splice(0..0, branch.stmts);
        block
    }

    /// A task with body `block` whose operands are live words, then `results`.
    fn continuation(
        &mut self,
        f: usize,
        before: &[Stmt],
        mut block: TailBlock,
        results: &[Var],
        needed: &FxHashSet<Var>,
    ) -> (Vec<Var>, TaskId) {
        let given: FxHashSet<Var> = results.iter().copied().collect();
        let mut stmts = sink(before, &block, &given, needed);
        stmts.append(&mut block.stmts);
        block.stmts = stmts;
        prune(&mut block);
        let mut live: Vec<_> = free(&block).into_iter().filter(|v| !given.contains(v)).collect();
        live.sort();
        let params: Vec<Var> = live.iter().chain(results).copied().collect();
        self.words += params.len();
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
    fn outline(&mut self, f: usize, stmt: &Stmt) -> (usize, Args) {
        let params = free_in_stmt(stmt);
        let args = params.iter().map(|v| Atom::Var(*v)).collect();
        let from = &self.functions[f];
        let mut renumber = Renumber::apart(&from.vars);
        let params = renumber.defines(&params);
        let stmts = renumber.stmts(std::slice::from_ref(stmt));
        let results = stmts.iter().flat_map(|s| &s.dst).map(|v| Atom::Var(*v)).collect();
        let function = Function {
            name: self.names.fresh(&format!("{}.if", from.name)),
            params,
            results: stmt.dst.iter().map(|v| from.vars[v.0 as usize]).collect(),
            vars: renumber.new,
            body: Block { stmts, results },
            mark: Mark::Auto,
            span: from.span,
        };
        self.functions.push(function);
        self.is_task.push(true);
        self.roots.push(None);
        (self.functions.len() - 1, args)
    }
}

/// Moves what takes one variable and is first needed at a later level there, which keeps as many words live. `sink`
/// does the same level by level, and nothing that is evaluated early keeps calls apart; but it takes as long as levels times statements.
fn late(levels: &mut [Level], results: &[Atom]) {
    if levels.len() <= FEW_LEVELS {
        return;
    }
    let last = levels.len() - 1;
    let mut needed: FxHashMap<Var, usize> = vars_of(results).map(|v| (v, last)).collect();
    for at in (0..=last).rev() {
        for stmt in &levels[at].ready {
            uses(stmt, &mut |v| {
                needed.insert(v, at);
            });
        }
        let mut before = std::mem::take(&mut levels[at].before);
        let mut moved: Vec<(usize, Stmt)> = Vec::new();
        for i in (0..before.len()).rev() {
            let stmt = &before[i];
            let first = stmt.dst.iter().filter_map(|v| needed.get(v)).min().copied().unwrap_or(at);
            let moves = first > at && is_cheap(stmt) && free_in_stmt(stmt).len() == 1;
            let place = if moves { first } else { at };
            uses(stmt, &mut |v| {
                let known = needed.entry(v).or_insert(place);
                *known = place.min(*known);
            });
            if moves {
                let stmt = std::mem::replace(&mut before[i], Stmt { dst: Dst::new(), op: Op::Live(0) });
                moved.push((first, stmt));
            }
        }
        before.retain(|stmt| !stmt.dst.is_empty());
        levels[at].before = before;
        // The last one first, so that each lands before what it is needed by.
        for (place, stmt) in moved {
            levels[place].early.push(stmt);
        }
    }
    for level in levels {
        level.early.reverse();
        level.early.append(&mut level.before);
        level.before = std::mem::take(&mut level.early);
    }
}

/// The next level from `at` on that may have room for a call; shortens the way there.
fn with_room(room: &mut FxHashMap<usize, usize>, at: usize) -> usize {
    let mut end = at;
    while let Some(next) = room.get(&end) {
        end = *next;
    }
    let mut on = at;
    while on != end {
        on = room.insert(on, end).unwrap_or(end);
    }
    end
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
    let owners = groups.iter().enumerate().flat_map(|(i, g)| g.dst.iter().map(move |v| (*v, i)));
    let owners: FxHashMap<Var, usize> = owners.collect();
    let mut out = Vec::with_capacity(emission.len());
    let mut placed = vec![false; groups.len()];
    let mut at = 0;
    while let Some(token) = emission.get(at) {
        let group = match token {
            Token::Literal(Atom::Var(v)) => owners.get(v).copied(),
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
