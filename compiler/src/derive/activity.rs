//! Which words move when some operands of a function do.

use std::collections::{HashMap, HashSet};

use super::rules::{Rule, Rules, rule};
use super::surfaces;
use crate::core::{Atom, Block, FnId, Function, Op, Stmt, Var};

/// Bit d: the word moves in direction d.
pub(super) type Mask = u8;

/// What moves among the results of functions, by what moves among their operands.
#[derive(Default)]
pub(super) struct Activity {
    results: HashMap<(FnId, Vec<Mask>), Vec<Mask>>,
    /// Of what nothing more will be found.
    done: HashSet<(FnId, Vec<Mask>)>,
    /// Seen in this round; recursive calls use what is known of the round before.
    seen: HashSet<(FnId, Vec<Mask>)>,
    grown: bool,
    /// A function that is not written yet was met in this round.
    met_hole: bool,
}

impl Activity {
    /// For every variable of `f`. Rounds are repeated until recursive functions add nothing more.
    pub fn vars(
        &mut self,
        rules: &Rules,
        functions: &[Option<Function>],
        f: &Function,
        moving: &[Mask],
    ) -> Vec<Mask> {
        loop {
            self.seen.clear();
            (self.grown, self.met_hole) = (false, false);
            let found = self.body(rules, functions, f, moving);
            if !self.grown {
                // What was seen calls nothing but what was seen, so all of it agrees.
                if !self.met_hole {
                    self.done.extend(self.seen.drain());
                }
                return found;
            }
        }
    }

    /// What moves among the results of a function that a walk has come through.
    pub fn results(&self, id: FnId, moving: &[Mask]) -> Vec<Mask> {
        self.results.get(&(id, moving.to_vec())).cloned().unwrap_or_default()
    }

    fn body(
        &mut self,
        rules: &Rules,
        functions: &[Option<Function>],
        f: &Function,
        moving: &[Mask],
    ) -> Vec<Mask> {
        let mut walk = Walk { activity: self, rules, functions, masks: vec![0; f.vars.len()], grown: false };
        for (param, mask) in f.params.iter().zip(moving) {
            walk.add(*param, *mask);
        }
        loop {
            walk.grown = false;
            walk.block(&f.body);
            if !walk.grown {
                return walk.masks;
            }
        }
    }

    fn call(
        &mut self,
        rules: &Rules,
        functions: &[Option<Function>],
        id: FnId,
        moving: Vec<Mask>,
    ) -> Vec<Mask> {
        let key = (id, moving);
        let Some(f) = &functions[id.0 as usize] else {
            self.met_hole = true;
            return Vec::new();
        };
        let known = self.results.get(&key).cloned().unwrap_or_else(|| vec![0; f.results.len()]);
        if self.done.contains(&key) {
            return known;
        }
        if key.1.iter().all(|m| *m == 0) || !self.seen.insert(key.clone()) {
            return known;
        }
        let masks = self.body(rules, functions, f, &key.1);
        let found: Vec<Mask> = f.body.results.iter().map(|a| mask(&masks, *a)).collect();
        self.grown |= found != known;
        self.results.insert(key, found.clone());
        found
    }
}

pub(super) fn mask(masks: &[Mask], atom: Atom) -> Mask {
    match atom {
        Atom::Var(v) => masks[v.0 as usize],
        Atom::Const(_) => 0,
    }
}

struct Walk<'a> {
    activity: &'a mut Activity,
    rules: &'a Rules,
    functions: &'a [Option<Function>],
    masks: Vec<Mask>,
    grown: bool,
}

impl Walk<'_> {
    fn add(&mut self, v: Var, mask: Mask) {
        let known = &mut self.masks[v.0 as usize];
        self.grown |= *known | mask != *known;
        *known |= mask;
    }

    fn of(&self, atoms: &[Atom]) -> Vec<Mask> {
        atoms.iter().map(|a| mask(&self.masks, *a)).collect()
    }

    fn any(&self, atoms: &[Atom]) -> Mask {
        atoms.iter().fold(0, |all, a| all | mask(&self.masks, *a))
    }

    fn block(&mut self, block: &Block) {
        block.stmts.iter().for_each(|s| self.stmt(s));
    }

    fn all(&mut self, vars: impl IntoIterator<Item = Var>, masks: &[Mask]) {
        for (v, mask) in vars.into_iter().zip(masks) {
            self.add(v, *mask);
        }
    }

    fn stmt(&mut self, stmt: &Stmt) {
        match &stmt.op {
            Op::Prim(prim, on, args) => {
                if !matches!(rule(self.rules, *prim, *on), Rule::Flat) {
                    let any = self.any(args);
                    self.add(stmt.dst[0], any);
                }
            }
            Op::Intrinsic(intrinsic, args) => {
                let any = self.any(args);
                for (i, v) in stmt.dst.iter().enumerate() {
                    if surfaces::moves(*intrinsic, i) {
                        self.add(*v, any);
                    }
                }
            }
            Op::Live(_) => {}
            Op::Call(id, args) => {
                let moving = self.of(args);
                let found = self.activity.call(self.rules, self.functions, *id, moving);
                self.all(stmt.dst.iter().copied(), &found);
            }
            Op::If(_, yes, no) => {
                for block in [yes, no] {
                    self.block(block);
                    let found = self.of(&block.results);
                    self.all(stmt.dst.iter().copied(), &found);
                }
            }
            Op::Loop(l) => {
                let state: Vec<Var> = l.state.iter().map(|(v, _)| *v).collect();
                let first: Vec<Atom> = l.state.iter().map(|(_, init)| *init).collect();
                let first = self.of(&first);
                self.all(state.iter().copied(), &first);
                self.block(&l.cond);
                self.block(&l.body);
                let next = self.of(&l.body.results);
                self.all(state.iter().copied(), &next);
                let last = self.of(&state.iter().map(|v| Atom::Var(*v)).collect::<Vec<_>>());
                self.all(stmt.dst.iter().copied(), &last);
            }
        }
    }
}
