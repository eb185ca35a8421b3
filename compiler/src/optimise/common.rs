//! Common subexpressions: operations that were already evaluated in this block or one around it. Calls count,
//! functions being pure. [`super::fold`] asks for each operation that it keeps.

use rustc_hash::FxHashMap;
use smallvec::SmallVec;
use std::collections::hash_map::Entry;

use crate::core::{Atom, FnId, Intrinsic, Op, Prim, Scalar, Var};

type Args = SmallVec<[Atom; 4]>;
type Results = SmallVec<[Var; 2]>;

#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum What {
    Prim(Prim, Scalar),
    Intrinsic(Intrinsic),
    Call(FnId),
    Live(u32),
}

type Key = (What, Args);

fn key(op: &Op) -> Option<Key> {
    Some(match op {
        Op::Prim(prim, scalar, args) => {
            let mut args = Args::from_slice(args);
            if prim.commutes() {
                args.sort_by_key(|a| match a {
                    Atom::Var(v) => (0, v.0),
                    Atom::Const(c) => (1, c.word()),
                });
            }
            (What::Prim(*prim, *scalar), args)
        }
        Op::Intrinsic(i, args) => (What::Intrinsic(*i), Args::from_slice(args)),
        Op::Call(id, args) => (What::Call(*id), Args::from_slice(args)),
        Op::Live(word) => (What::Live(*word), Args::new()),
        Op::If(..) | Op::Loop(_) => return None,
    })
}

/// The operations seen in a block and those around it.
#[derive(Default)]
pub struct Seen {
    found: FxHashMap<Key, Results>,
    /// Keys of `found`, those of inner blocks last.
    entered: Vec<Key>,
}

/// Where a block began.
pub struct Scope(usize);

impl Seen {
    pub fn enter(&self) -> Scope {
        Scope(self.entered.len())
    }

    /// Forgets what was seen since.
    pub fn leave(&mut self, scope: Scope) {
        for key in self.entered.drain(scope.0..) {
            self.found.remove(&key);
        }
    }

    /// Results of an equal operation; remembers `dst` as its results if there was none.
    pub fn earlier(&mut self, op: &Op, dst: &[Var]) -> Option<&[Var]> {
        match self.found.entry(key(op)?) {
            Entry::Occupied(entry) => Some(entry.into_mut()),
            Entry::Vacant(entry) => {
                self.entered.push(entry.key().clone());
                entry.insert(Results::from_slice(dst));
                None
            }
        }
    }
}
