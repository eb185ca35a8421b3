//! Lambda-lifts loops whose condition or body calls tasks, or that are long, into recursive functions.
//!
//! `fold`, `any` and `all` recurse on their state, which the splitter makes a loop of continuations. `sum` becomes a
//! balanced binary tree over its range, all of whose leaves can be evaluated in parallel:
//! `sum(lo, hi) = if hi - lo <= 1 { body(lo) } else { sum(lo, mid) + sum(mid, hi) }` for `lo < hi`.

use rustc_hash::FxHashSet;
use smallvec::smallvec;

use super::{tasks, tasks_of};
use crate::core::graph::Graph;
use crate::core::names::Names;
use crate::core::walk::{Free, Renumber, calls_any, statements};
use crate::core::{
    Atom, Block, Const, Dst, FnId, Function, Loop, LoopKind, Mark, Op, Prim, Program, Scalar, Stmt, Var,
};

/// Lifts all such loops of the program, outermost first; inner ones are lifted out of the new functions.
pub fn loops(program: &mut Program) {
    let is_task = tasks(program);
    lift(program, Turns { of: vec![0; is_task.len()], most: u64::MAX }, is_task);
}

/// Lifts the loops that may make more than `most` turns in one rewrite as well: as tasks they can be suspended.
pub fn long_loops(program: &mut Program, most: u64) {
    let (is_task, turns, _) = measure(program, most);
    lift(program, turns, is_task);
}

/// Whether a loop may make more than `most` turns in one rewrite.
pub fn has_long_loops(program: &Program, most: u64) -> bool {
    measure(program, most).2
}

/// Which functions are tasks once long loops are, how many turns the others make, and whether any loop is long.
fn measure(program: &Program, most: u64) -> (Vec<bool>, Turns, bool) {
    let graph = Graph::new(&program.functions);
    let mut is_task = tasks_of(program, &graph);
    let mut turns = Turns { of: vec![0; is_task.len()], most };
    let mut any = false;
    for &f in &graph.bottom_up {
        let stmts = &program.functions[f].body.stmts;
        let mut has_long = false;
        statements(stmts, &mut |stmt| has_long |= matches!(&stmt.op, Op::Loop(l) if turns.is_long(l)));
        any |= has_long;
        is_task[f] |= has_long || graph.callees[f].iter().any(|g| is_task[*g]);
        // What a task does is done by another rewrite.
        turns.of[f] = if is_task[f] { 0 } else { turns.block(stmts) };
    }
    (is_task, turns, any)
}

/// Bounds of the loop turns that a rewrite makes.
struct Turns {
    /// Turns of a call of each function; 0 for tasks, and for functions that are not listed.
    of: Vec<u64>,
    /// A loop that may make more is long.
    most: u64,
}

impl Turns {
    fn is_long(&self, l: &Loop) -> bool {
        self.most < u64::MAX && self.looped(l) > self.most
    }

    fn looped(&self, l: &Loop) -> u64 {
        let turn = [&l.cond, &l.body].iter().fold(1u64, |n, b| n.saturating_add(self.block(&b.stmts)));
        l.most_turns().map_or(u64::MAX, |turns| turns.saturating_mul(turn))
    }

    fn block(&self, stmts: &[Stmt]) -> u64 {
        let of = |stmt: &Stmt| match &stmt.op {
            Op::Call(id, _) => self.of.get(id.0 as usize).copied().unwrap_or(0),
            Op::Loop(l) => self.looped(l),
            op => op.blocks().map(|b| self.block(&b.stmts)).max().unwrap_or(0),
        };
        stmts.iter().fold(0, |n, stmt| n.saturating_add(of(stmt)))
    }
}

fn lift(program: &mut Program, turns: Turns, is_task: Vec<bool>) {
    let mut lifter =
        Lifter { is_task, turns, names: Names::of(&program.functions), new: Vec::new(), base: 0 };
    let mut at = 0;
    while at < program.functions.len() {
        lifter.base = program.functions.len();
        let mut f = std::mem::take(&mut program.functions[at].body);
        lifter.block(&mut program.functions[at], &mut f);
        program.functions[at].body = f;
        lifter.is_task.extend(lifter.new.iter().map(|_| true));
        program.functions.append(&mut lifter.new);
        at += 1;
    }
}

struct Lifter {
    is_task: Vec<bool>,
    turns: Turns,
    names: Names,
    /// Functions made of the current one's loops.
    new: Vec<Function>,
    /// Index of the first of them.
    base: usize,
}

impl Lifter {
    fn block(&mut self, f: &mut Function, block: &mut Block) {
        if !block.stmts.iter().any(|stmt| matches!(stmt.op, Op::Loop(_))) {
            return block
                .stmts
                .iter_mut()
                .flat_map(|stmt| stmt.op.blocks_mut())
                .for_each(|b| self.block(f, b));
        }
        let mut stmts = Vec::with_capacity(block.stmts.len());
        for mut stmt in std::mem::take(&mut block.stmts) {
            match stmt.op {
                Op::Loop(l) if self.calls_task(&l) || self.turns.is_long(&l) => {
                    self.lift(f, stmt.dst, &l, &mut stmts);
                }
                _ => {
                    stmt.op.blocks_mut().for_each(|inner| self.block(f, inner));
                    stmts.push(stmt);
                }
            }
        }
        block.stmts = stmts;
    }

    fn calls_task(&self, l: &Loop) -> bool {
        [&l.cond, &l.body].iter().any(|block| calls_any(&block.stmts, &self.is_task))
    }

    fn lift(&mut self, f: &mut Function, dst: Dst, l: &Loop, stmts: &mut Vec<Stmt>) {
        // Without calls a turn is much cheaper than a leaf of the tree.
        match Sum::of(l).filter(|_| self.calls_task(l)) {
            Some(sum) => self.lift_sum(f, dst, l, &sum, stmts),
            None => self.lift_fold(f, dst, l, stmts),
        }
    }

    /// A new function, which `make` writes with the variables of `f` and more.
    fn add(&mut self, f: &mut Function, kind: &str, make: impl FnOnce(FnId, &mut Function)) -> FnId {
        let id = FnId((self.base + self.new.len()) as u32);
        let own = f.vars.len();
        let mut function = Function {
            name: self.names.fresh(&format!("{}.{kind}", f.name)),
            params: Vec::new(),
            results: Vec::new(),
            vars: std::mem::take(&mut f.vars),
            body: Block::default(),
            mark: Mark::Auto,
            span: f.span,
        };
        make(id, &mut function);
        let mut renumber = Renumber::apart(&function.vars);
        function.params = renumber.defines(&function.params);
        function.body = renumber.block(&function.body);
        let vars = renumber.new;
        f.vars = std::mem::replace(&mut function.vars, vars);
        f.vars.truncate(own);
        self.new.push(function);
        id
    }

    /// `go(state) = if cond(state) { go(body(state)) } else { state }`.
    fn lift_fold(&mut self, f: &mut Function, dst: Dst, l: &Loop, stmts: &mut Vec<Stmt>) {
        let state: Vec<_> = l.state.iter().map(|(v, _)| *v).collect();
        let captured = captured(l);
        let id = self.add(f, "loop", |id, go| {
            go.results = dst.iter().map(|v| go.vars[v.0 as usize]).collect();
            go.params = state.iter().chain(&captured).copied().collect();
            let mut yes = l.body.clone();
            let args = yes.results.iter().copied().chain(atoms(&captured)).collect();
            let next: Vec<_> = go.results.clone().into_iter().map(|s| go.fresh(s)).collect();
            yes.stmts.push(Stmt { dst: next.clone().into(), op: Op::Call(id, args) });
            yes.results = atoms(&next).collect();
            let no = Block { stmts: Vec::new(), results: atoms(&state).collect() };
            let last: Vec<_> = go.results.clone().into_iter().map(|s| go.fresh(s)).collect();
            let mut body = l.cond.clone();
            let cond = body.results[0];
            body.stmts.push(Stmt { dst: last.clone().into(), op: Op::branch(cond, yes, no) });
            body.results = atoms(&last).collect();
            go.body = body;
        });
        let args = l.state.iter().map(|(_, init)| *init).chain(atoms(&captured)).collect();
        stmts.push(Stmt { dst, op: Op::Call(id, args) });
    }

    fn lift_sum(&mut self, f: &mut Function, dst: Dst, l: &Loop, sum: &Sum, stmts: &mut Vec<Stmt>) {
        let index = l.state[0].0;
        let bound: FxHashSet<_> = l.state.iter().map(|(v, _)| *v).collect();
        let mut free = Free::default();
        free.bind(&[index]);
        free.block(&sum.leaf);
        let captured: Vec<_> = free.vars().into_iter().filter(|v| !bound.contains(v)).collect();
        let scalars: Vec<_> = dst[1..].iter().map(|v| f.vars[v.0 as usize]).collect();
        let id = self.add(f, "sum", |id, tree| build_tree(tree, id, index, &captured, &scalars, &sum.leaf));

        // What surrounds the tree: an empty range gives the first value, else that is added to the tree's.
        let (lo, hi) = (l.state[0].1, sum.limit);
        stmts.push(Stmt { dst: smallvec![dst[0]], op: Op::Prim(Prim::Max, Scalar::I32, smallvec![lo, hi]) });
        let some = f.fresh(Scalar::Bool);
        stmts.push(Stmt { dst: smallvec![some], op: Op::Prim(Prim::Lt, Scalar::I32, smallvec![lo, hi]) });
        let inits: Vec<_> = l.state[1..].iter().map(|(_, init)| *init).collect();
        let tree: Vec<_> = scalars.iter().map(|s| f.fresh(*s)).collect();
        let args = [lo, hi].into_iter().chain(atoms(&captured)).collect();
        let mut yes = Block::default();
        yes.stmts.push(Stmt { dst: tree.clone().into(), op: Op::Call(id, args) });
        yes.results = add_words(f, &mut yes.stmts, &scalars, &inits, &atoms(&tree).collect::<Vec<_>>());
        let no = Block { stmts: Vec::new(), results: inits };
        stmts.push(Stmt { dst: dst[1..].into(), op: Op::branch(Atom::Var(some), yes, no) });
    }
}

fn atoms(vars: &[Var]) -> impl Iterator<Item = Atom> + '_ {
    vars.iter().map(|v| Atom::Var(*v))
}

/// Variables that the loop sees from outside.
fn captured(l: &Loop) -> Vec<Var> {
    let mut free = Free::default();
    free.bind(&l.state.iter().map(|(v, _)| *v).collect::<Vec<_>>());
    free.block(&l.cond);
    free.block(&l.body);
    free.vars()
}

/// Adds words one by one; an integer zero needs no addition.
fn add_words(
    f: &mut Function,
    stmts: &mut Vec<Stmt>,
    scalars: &[Scalar],
    a: &[Atom],
    b: &[Atom],
) -> Vec<Atom> {
    let mut sums = Vec::new();
    for ((scalar, a), b) in scalars.iter().zip(a).zip(b) {
        if matches!(a, Atom::Const(Const::I32(0) | Const::U32(0))) {
            sums.push(*b);
            continue;
        }
        let sum = f.fresh(*scalar);
        stmts.push(Stmt { dst: smallvec![sum], op: Op::Prim(Prim::Add, *scalar, smallvec![*a, *b]) });
        sums.push(Atom::Var(sum));
    }
    sums
}

fn build_tree(tree: &mut Function, id: FnId, lo: Var, captured: &[Var], scalars: &[Scalar], leaf: &Block) {
    let hi = tree.fresh(Scalar::I32);
    tree.params = [lo, hi].iter().chain(captured).copied().collect();
    tree.results = scalars.to_vec();
    let mut stmts = Vec::new();
    let prim = |tree: &mut Function, stmts: &mut Vec<Stmt>, prim: Prim, on: Scalar, args: &[Atom]| {
        let dst = tree.fresh(prim.result(on));
        stmts.push(Stmt { dst: smallvec![dst], op: Op::Prim(prim, on, args.into()) });
        Atom::Var(dst)
    };

    // Unsigned, because a range may hold more than i32::MAX numbers.
    let (lo, hi) = (Atom::Var(lo), Atom::Var(hi));
    let length = prim(tree, &mut stmts, Prim::Sub, Scalar::I32, &[hi, lo]);
    let length = prim(tree, &mut stmts, Prim::BitcastU32, Scalar::I32, &[length]);
    let one = Atom::Const(Const::U32(1));
    let is_leaf = prim(tree, &mut stmts, Prim::Le, Scalar::U32, &[length, one]);

    let mut no = Block::default();
    let half = prim(tree, &mut no.stmts, Prim::Shr, Scalar::U32, &[length, one]);
    let half = prim(tree, &mut no.stmts, Prim::BitcastI32, Scalar::U32, &[half]);
    let mid = prim(tree, &mut no.stmts, Prim::Add, Scalar::I32, &[lo, half]);
    let mut part = |tree: &mut Function, from: Atom, to: Atom| {
        let dst: Vec<_> = scalars.iter().map(|s| tree.fresh(*s)).collect();
        let args = [from, to].into_iter().chain(atoms(captured)).collect();
        no.stmts.push(Stmt { dst: dst.clone().into(), op: Op::Call(id, args) });
        atoms(&dst).collect::<Vec<_>>()
    };
    let left = part(tree, lo, mid);
    let right = part(tree, mid, hi);
    no.results = add_words(tree, &mut no.stmts, scalars, &left, &right);

    let dst: Vec<_> = scalars.iter().map(|s| tree.fresh(*s)).collect();
    stmts.push(Stmt { dst: dst.clone().into(), op: Op::branch(is_leaf, leaf.clone(), no) });
    tree.body = Block { stmts, results: atoms(&dst).collect() };
}

/// A `sum` loop that still has the shape its kind promises: the index goes up by one to a limit, and each
/// accumulator is used only where a word is added to it.
struct Sum {
    limit: Atom,
    /// Yields the words that are added.
    leaf: Block,
}

impl Sum {
    fn of(l: &Loop) -> Option<Sum> {
        if l.kind != LoopKind::Sum {
            return None;
        }
        let index = l.state.first()?.0;
        let state: FxHashSet<_> = l.state.iter().map(|(v, _)| *v).collect();
        let [Stmt { dst, op: Op::Prim(Prim::Lt, Scalar::I32, test) }] = l.cond.stmts.as_slice() else {
            return None;
        };
        let limit = test[1];
        let outside = !matches!(limit, Atom::Var(v) if state.contains(&v));
        if test[0] != Atom::Var(index) || l.cond.results != [Atom::Var(dst[0])] || !outside {
            return None;
        }
        let next = definition(&l.body, *l.body.results.first()?)?;
        if next.op
            != Op::Prim(Prim::Add, Scalar::I32, smallvec![Atom::Var(index), Atom::Const(Const::I32(1))])
        {
            return None;
        }
        let mut leaf = l.body.clone();
        leaf.results.clear();
        for (accumulator, result) in state_after_index(l) {
            let add = definition(&l.body, result)?;
            leaf.results.push(added(add, accumulator)?);
            leaf.stmts.retain(|s| s.dst != add.dst);
        }
        let accumulators: FxHashSet<_> = state_after_index(l).map(|(v, _)| v).collect();
        let sums: FxHashSet<_> = l.body.results[1..].iter().copied().collect();
        let hidden = |a: &Atom| sums.contains(a) || matches!(a, Atom::Var(v) if accumulators.contains(v));
        (!uses_any(&leaf, &hidden)).then_some(Sum { limit, leaf })
    }
}

fn state_after_index(l: &Loop) -> impl Iterator<Item = (Var, Atom)> + '_ {
    l.state.iter().map(|(v, _)| *v).zip(l.body.results.iter().copied()).skip(1)
}

fn definition(block: &Block, atom: Atom) -> Option<&Stmt> {
    let Atom::Var(v) = atom else { return None };
    block.stmts.iter().find(|s| s.dst[..] == [v])
}

/// The word that `stmt` adds to the accumulator.
fn added(stmt: &Stmt, accumulator: Var) -> Option<Atom> {
    let Op::Prim(Prim::Add, _, args) = &stmt.op else { return None };
    match args.as_slice() {
        [Atom::Var(v), word] | [word, Atom::Var(v)] if *v == accumulator => Some(*word),
        _ => None,
    }
}

fn uses_any(block: &Block, wanted: &dyn Fn(&Atom) -> bool) -> bool {
    let mut found = block.results.iter().any(wanted);
    statements(&block.stmts, &mut |stmt| {
        found |= stmt.op.operands().any(|a| wanted(&a));
        found |= stmt.op.blocks().any(|b| b.results.iter().any(wanted));
    });
    found
}
