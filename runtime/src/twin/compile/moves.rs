//! Assignments that happen at once, and results that can be computed where they are needed.

use ghyll_compiler::core::{Atom, Op, Stmt, Var};

use super::body::Names;
use super::{Compiler, Result, uses};
use crate::twin::instruction::{Instruction, Register};

impl Compiler<'_> {
    /// Assigns all sources to their targets as if at the same time.
    pub fn parallel_moves(&mut self, mut moves: Vec<(Register, Register)>) -> Result<()> {
        moves.retain(|(to, from)| to != from);
        while !moves.is_empty() {
            let free = moves.iter().position(|(to, _)| moves.iter().all(|(_, from)| from != to));
            match free {
                Some(at) => {
                    let (to, from) = moves.remove(at);
                    self.emit(Instruction::Move { to, from });
                }
                // Every target is still to be read: a cycle, broken by a copy of one.
                None => {
                    let (to, _) = moves[0];
                    let copy = self.fresh()?;
                    self.emit(Instruction::Move { to: copy, from: to });
                    moves.iter_mut().filter(|(_, from)| *from == to).for_each(|(_, from)| *from = copy);
                }
            }
        }
        Ok(())
    }

    /// For a body that ends by assigning `results` to the variables `state` held in `registers`: lets statements
    /// write their result straight into the state's register where nothing reads the old state afterwards.
    pub fn write_in_place(
        &self,
        names: &mut Names,
        stmts: &[Stmt],
        results: &[Atom],
        state: &[Var],
        registers: &[Register],
    ) {
        for (i, (result, old)) in results.iter().zip(state).enumerate() {
            let Atom::Var(new) = *result else { continue };
            let Some(at) = stmts.iter().position(|s| s.dst.contains(&new)) else { continue };
            let reads_first = matches!(stmts[at].op, Op::Prim(..) | Op::Intrinsic(..));
            let old_is_dead = (reads_first || !uses::reads(&stmts[at], *old))
                && !stmts[at + 1..].iter().any(|s| uses::reads(s, *old))
                && !results.contains(&Atom::Var(*old));
            if old_is_dead && !names.is_set(new) {
                names.set(new, registers[i]);
            }
        }
    }
}
