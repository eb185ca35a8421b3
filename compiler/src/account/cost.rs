//! Operations of a rewrite, estimated: the dearer side of each branch, known loops in full, others one turn.

use crate::core::{Block, Function, Op, Stmt};
use crate::table::{Table, Tail, TailBlock};

/// What one rewrite, or one call, does at most.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Scalar operations, those of intrinsics by the table's estimate.
    pub operations: u64,
    /// Whether some loop makes turns that only the run knows, of which one was counted.
    pub open: bool,
}

impl Cost {
    fn and(self, other: Cost) -> Cost {
        let operations = self.operations.saturating_add(other.operations);
        Cost { operations, open: self.open || other.open }
    }

    fn or(self, other: Cost) -> Cost {
        Cost { operations: self.operations.max(other.operations), open: self.open || other.open }
    }
}

pub struct Costs {
    pub helpers: Vec<Cost>,
}

impl Costs {
    pub fn new(table: &Table) -> Costs {
        // Helpers call earlier ones or later ones, but never each other.
        let mut costs = Costs { helpers: vec![Cost::default(); table.helpers.len()] };
        let mut done = vec![false; table.helpers.len()];
        for at in 0..table.helpers.len() {
            costs.helper(at, &table.helpers, &mut done);
        }
        costs
    }

    fn helper(&mut self, at: usize, helpers: &[Function], done: &mut [bool]) {
        if std::mem::replace(&mut done[at], true) {
            return;
        }
        for called in crate::core::walk::calls(&helpers[at].body.stmts) {
            self.helper(called.0 as usize, helpers, done);
        }
        self.helpers[at] = self.stmts(&helpers[at].body.stmts);
    }

    /// Of a task.
    pub fn tail(&self, block: &TailBlock) -> Cost {
        let rest = match &block.tail {
            Tail::If(_, yes, no) => self.tail(yes).or(self.tail(no)),
            Tail::Emit(_) | Tail::Again(_) => Cost::default(),
        };
        self.stmts(&block.stmts).and(rest)
    }

    fn stmts(&self, stmts: &[Stmt]) -> Cost {
        stmts.iter().fold(Cost::default(), |sum, stmt| sum.and(self.op(&stmt.op)))
    }

    fn block(&self, block: &Block) -> Cost {
        self.stmts(&block.stmts)
    }

    fn op(&self, op: &Op) -> Cost {
        match op {
            Op::Prim(..) | Op::Live(_) => Cost { operations: 1, open: false },
            Op::Intrinsic(intrinsic, _) => Cost { operations: u64::from(intrinsic.cost()), open: false },
            Op::Call(id, _) => self.helpers[id.0 as usize],
            Op::If(_, yes, no) => self.block(yes).or(self.block(no)),
            Op::Loop(l) => {
                let turn = self.block(&l.cond).and(self.block(&l.body));
                let turns = l.most_turns();
                let operations = turn.operations.saturating_mul(turns.unwrap_or(1));
                Cost { operations, open: turn.open || turns.is_none() }
            }
        }
    }
}
