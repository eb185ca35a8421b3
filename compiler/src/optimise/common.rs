//! Common subexpressions: operations that were already evaluated in this block or one around it. Calls count,
//! functions being pure. [`super::fold`] asks for each operation that it keeps.

use rustc_hash::FxHashMap;
use smallvec::SmallVec;
use std::collections::hash_map::Entry;

use crate::core::{Args, Atom, FnId, Intrinsic, Op, Prim, Scalar, Var};

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

/// The operations seen in a block and those around it. What was seen in a block that has ended stays until it is seen
/// again, since to forget it would take as long as to note it.
#[derive(Default)]
pub struct Seen {
    found: FxHashMap<Key, (Place, Results)>,
    /// The open blocks, outermost first, by the numbers that they got.
    open: Vec<u32>,
    blocks: u32,
}

/// A block: how many are around it, and its number.
type Place = (usize, u32);

impl Seen {
    /// For about so many operations.
    pub fn with_room(operations: usize) -> Seen {
        let found = FxHashMap::with_capacity_and_hasher(operations, Default::default());
        Seen { found, ..Seen::default() }
    }

    /// Opens a block.
    pub fn enter(&mut self) {
        self.open.push(self.blocks);
        self.blocks += 1;
    }

    /// Ends the block that was opened last.
    pub fn leave(&mut self) {
        self.open.pop();
    }

    /// Results of an equal operation; remembers `dst` as its results if there was none.
    pub fn earlier(&mut self, op: &Op, dst: &[Var]) -> Option<&[Var]> {
        let here = (self.open.len() - 1, *self.open.last().expect("an operation is in a block"));
        let new = || (here, Results::from_slice(dst));
        match self.found.entry(key(op)?) {
            Entry::Occupied(entry) => {
                let known = entry.into_mut();
                let (around, number) = known.0;
                if self.open.get(around) == Some(&number) {
                    return Some(&known.1);
                }
                *known = new();
                None
            }
            Entry::Vacant(entry) => {
                entry.insert(new());
                None
            }
        }
    }
}
