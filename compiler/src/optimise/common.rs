//! Common subexpressions: an operation that was already evaluated in this block or one around it is not
//! evaluated again. Calls count, functions being pure.

use std::collections::HashMap;

use crate::core::{Atom, Block, FnId, Intrinsic, Op, Prim, Program, Scalar, Var};

pub fn common(program: &mut Program) {
    for f in &mut program.functions {
        let mut seen = Seen { found: HashMap::new(), known: HashMap::new() };
        seen.block(&mut f.body);
    }
}

#[derive(Clone, PartialEq, Eq, Hash)]
enum Key {
    Prim(Prim, Scalar, Vec<Atom>),
    Intrinsic(Intrinsic, Vec<Atom>),
    Call(FnId, Vec<Atom>),
    Live(u32),
}

fn key(op: &Op) -> Option<Key> {
    match op {
        Op::Prim(prim, scalar, args) => {
            let mut args = args.clone();
            if prim.commutes() {
                args.sort_by_key(|a| match a {
                    Atom::Var(v) => (0, v.0),
                    Atom::Const(c) => (1, c.word()),
                });
            }
            Some(Key::Prim(*prim, *scalar, args))
        }
        Op::Intrinsic(i, args) => Some(Key::Intrinsic(*i, args.clone())),
        Op::Call(id, args) => Some(Key::Call(*id, args.clone())),
        Op::Live(word) => Some(Key::Live(*word)),
        Op::If(..) | Op::Loop(_) => None,
    }
}

struct Seen {
    found: HashMap<Key, Vec<Var>>,
    /// Variables replaced by an earlier one.
    known: HashMap<Var, Var>,
}

impl Seen {
    fn replace(&self, atom: &mut Atom) {
        if let Atom::Var(v) = atom
            && let Some(earlier) = self.known.get(v)
        {
            *v = *earlier;
        }
    }

    fn block(&mut self, block: &mut Block) {
        let mut entered = Vec::new();
        let mut kept = Vec::with_capacity(block.stmts.len());
        for mut stmt in std::mem::take(&mut block.stmts) {
            stmt.op.operands_mut().into_iter().for_each(|a| self.replace(a));
            let Some(key) = key(&stmt.op) else {
                stmt.op.blocks_mut().into_iter().for_each(|inner| self.block(inner));
                kept.push(stmt);
                continue;
            };
            if let Some(earlier) = self.found.get(&key) {
                self.known.extend(stmt.dst.iter().copied().zip(earlier.iter().copied()));
                continue;
            }
            self.found.insert(key.clone(), stmt.dst.clone());
            entered.push(key);
            kept.push(stmt);
        }
        block.stmts = kept;
        block.results.iter_mut().for_each(|a| self.replace(a));
        for key in entered {
            self.found.remove(&key);
        }
    }
}
