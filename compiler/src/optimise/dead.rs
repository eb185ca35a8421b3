//! Removes what nothing needs, over the whole program at once: statements, results of branches, loop state,
//! parameters and results of functions. So a field that is never read is never computed, passed or put on the stream.
//!
//! It is optimistic: everything is unneeded until the entry's results come to need it, which also finds loop state
//! and recursive parameters that only keep themselves alive.

use rustc_hash::{FxHashMap, FxHashSet};
use smallvec::{Array, SmallVec};

use crate::core::graph::Graph;
use crate::core::walk::{self, VarMap, map_calls, statements};
use crate::core::{Atom, Block, FnId, Function, Op, Program, Stmt, Var};

/// Removes functions that the entry does not reach.
pub fn unreachable(program: &mut Program) {
    let reached = Graph::new(&program.functions).reached([program.entry as usize]);
    let mut number = FxHashMap::default();
    for (f, reached) in reached.iter().enumerate() {
        if *reached {
            number.insert(f as u32, number.len() as u32);
        }
    }
    let mut at = 0;
    program.functions.retain(|_| {
        at += 1;
        reached[at - 1]
    });
    for f in &mut program.functions {
        map_calls(&mut f.body.stmts, &|id| FnId(number[&id.0]));
    }
    program.entry = number[&program.entry];
}

/// Numbers variables in the order of their definitions.
pub fn compact(program: &mut Program) {
    program.functions.iter_mut().for_each(walk::compact);
}

/// Removes values that nothing needs. The entry keeps its parameters and results.
pub fn unused(program: &mut Program) {
    let needs = Needs::find(program);
    let entry = program.entry as usize;
    for (i, f) in program.functions.iter_mut().enumerate() {
        let sweep = Sweep { needs: &needs, function: i, entry };
        sweep.function(f);
    }
}

/// Something a program computes.
#[derive(Clone, Copy)]
enum Value {
    Var(usize, Var),
    /// Result number `.1` of function `.0`.
    Result(usize, usize),
}

/// How a variable is defined.
#[derive(Clone, Copy)]
enum Definition<'a> {
    Param(usize),
    /// Destination `.1` of a statement.
    Stmt(&'a Stmt, usize),
    /// State `.1` of a loop.
    State(&'a Stmt, usize),
}

struct Needs {
    vars: Vec<Vec<bool>>,
    results: Vec<Vec<bool>>,
    params: Vec<Vec<bool>>,
}

struct Mark<'a> {
    functions: &'a [Function],
    definitions: Vec<VarMap<Definition<'a>>>,
    needs: Needs,
    open: Vec<Value>,
    /// Calls that are needed, by callee: caller and arguments.
    calls: Vec<Vec<(usize, &'a [Atom])>>,
    /// The same calls, to meet each once whatever number of its results is needed.
    called: FxHashSet<*const Stmt>,
}

impl Needs {
    fn find(program: &Program) -> Needs {
        let functions = &program.functions;
        let needs = Needs {
            vars: functions.iter().map(|f| vec![false; f.vars.len()]).collect(),
            results: functions.iter().map(|f| vec![false; f.results.len()]).collect(),
            params: functions.iter().map(|f| vec![false; f.params.len()]).collect(),
        };
        let definitions = functions.iter().map(definitions).collect();
        let calls = vec![Vec::new(); functions.len()];
        let called = FxHashSet::default();
        let mut mark = Mark { functions, definitions, needs, open: Vec::new(), calls, called };
        // The entry keeps its parameters, so calls of it must pass them.
        let entry = program.entry as usize;
        mark.needs.params[entry].fill(true);
        for i in 0..functions[entry].results.len() {
            mark.result(entry, i);
        }
        while let Some(value) = mark.open.pop() {
            mark.follow(value);
        }
        mark.needs
    }
}

fn definitions(f: &Function) -> VarMap<Definition<'_>> {
    let mut all = VarMap::new();
    all.extend(f.params.iter().enumerate().map(|(i, v)| (*v, Definition::Param(i))));
    statements(&f.body.stmts, &mut |stmt| {
        all.extend(stmt.dst.iter().enumerate().map(|(i, v)| (*v, Definition::Stmt(stmt, i))));
        all.extend(stmt.op.binders().enumerate().map(|(i, v)| (v, Definition::State(stmt, i))));
    });
    all
}

impl<'a> Mark<'a> {
    fn atom(&mut self, f: usize, atom: Atom) {
        if let Atom::Var(v) = atom
            && !std::mem::replace(&mut self.needs.vars[f][v.0 as usize], true)
        {
            self.open.push(Value::Var(f, v));
        }
    }

    fn atoms(&mut self, f: usize, atoms: &[Atom]) {
        atoms.iter().for_each(|a| self.atom(f, *a));
    }

    fn result(&mut self, f: usize, i: usize) {
        if !std::mem::replace(&mut self.needs.results[f][i], true) {
            self.open.push(Value::Result(f, i));
        }
    }

    fn follow(&mut self, value: Value) {
        let (f, v) = match value {
            Value::Result(f, i) => return self.atom(f, self.functions[f].body.results[i]),
            Value::Var(f, v) => (f, v),
        };
        match self.definitions[f].get(v) {
            Some(Definition::Param(i)) => self.param(f, i),
            Some(Definition::Stmt(stmt, i)) => self.destination(f, stmt, i),
            Some(Definition::State(stmt, i)) => self.state(f, stmt, i),
            None => {}
        }
    }

    fn param(&mut self, f: usize, i: usize) {
        self.needs.params[f][i] = true;
        for at in 0..self.calls[f].len() {
            let (caller, args) = self.calls[f][at];
            self.atom(caller, args[i]);
        }
    }

    fn destination(&mut self, f: usize, stmt: &'a Stmt, i: usize) {
        match &stmt.op {
            Op::Prim(_, _, args) | Op::Intrinsic(_, args) => self.atoms(f, args),
            Op::Live(_) => {}
            Op::Call(id, args) => {
                self.result(id.0 as usize, i);
                if self.called.insert(stmt) {
                    self.call(f, id.0 as usize, args);
                }
            }
            Op::If(cond, yes, no) => {
                self.atom(f, *cond);
                self.atom(f, yes.results[i]);
                self.atom(f, no.results[i]);
            }
            Op::Loop(l) => {
                self.atom(f, Atom::Var(l.state[i].0));
                self.atom(f, l.cond.results[0]);
            }
        }
    }

    fn state(&mut self, f: usize, stmt: &'a Stmt, i: usize) {
        if let Op::Loop(l) = &stmt.op {
            self.atom(f, l.state[i].1);
            self.atom(f, l.body.results[i]);
        }
    }

    fn call(&mut self, caller: usize, callee: usize, args: &'a [Atom]) {
        self.calls[callee].push((caller, args));
        for (i, arg) in args.iter().enumerate() {
            if self.needs.params[callee][i] {
                self.atom(caller, *arg);
            }
        }
    }
}

struct Sweep<'a> {
    needs: &'a Needs,
    function: usize,
    entry: usize,
}

impl Sweep<'_> {
    fn is_needed(&self, v: Var) -> bool {
        self.needs.vars[self.function][v.0 as usize]
    }

    fn function(&self, f: &mut Function) {
        self.stmts(&mut f.body.stmts);
        if self.function != self.entry {
            keep(&mut f.params, &self.needs.params[self.function]);
            keep(&mut f.results, &self.needs.results[self.function]);
            keep(&mut f.body.results, &self.needs.results[self.function]);
        }
    }

    fn stmts(&self, stmts: &mut Vec<Stmt>) {
        stmts.retain(|s| s.dst.iter().any(|v| self.is_needed(*v)));
        stmts.iter_mut().for_each(|s| self.stmt(s));
    }

    fn stmt(&self, stmt: &mut Stmt) {
        if stmt.op.blocks().next().is_none() && !matches!(stmt.op, Op::Call(..)) {
            return;
        }
        let mask: SmallVec<[bool; 16]> = stmt.dst.iter().map(|v| self.is_needed(*v)).collect();
        match &mut stmt.op {
            Op::Prim(..) | Op::Intrinsic(..) | Op::Live(_) => {}
            Op::Call(id, args) => {
                let callee = id.0 as usize;
                if callee != self.entry {
                    keep_few(args, &self.needs.params[callee]);
                    keep_few(&mut stmt.dst, &self.needs.results[callee]);
                }
            }
            Op::If(_, yes, no) => {
                keep_few(&mut stmt.dst, &mask);
                for block in [yes, no] {
                    self.block(block, &mask);
                }
            }
            Op::Loop(l) => {
                // A state may be needed by the loop though not after it.
                let mask: Vec<_> =
                    l.state.iter().zip(mask).map(|((v, _), after)| after || self.is_needed(*v)).collect();
                keep_few(&mut stmt.dst, &mask);
                keep(&mut l.state, &mask);
                self.block(&mut l.body, &mask);
                self.block(&mut l.cond, &[true]);
            }
        }
    }

    fn block(&self, block: &mut Block, results: &[bool]) {
        self.stmts(&mut block.stmts);
        keep(&mut block.results, results);
    }
}

fn keep_few<A: Array>(items: &mut SmallVec<A>, mask: &[bool]) {
    let mut mask = mask.iter();
    items.retain(|_| mask.next() == Some(&true));
}

fn keep<T>(items: &mut Vec<T>, mask: &[bool]) {
    let mut mask = mask.iter();
    items.retain(|_| mask.next() == Some(&true));
}
