//! Branches and loops.

use ghyll_compiler::core::{Atom, Block, Loop, Op, Stmt, Var};

use super::body::{Names, is_comparison};
use super::{Compiler, Result};
use crate::error::RunError;
use crate::twin::instruction::{Instruction, Register, jump_if, jump_unless};

/// Where a jump goes and when.
#[derive(Clone, Copy)]
pub enum Jump {
    /// Backwards, if the condition holds.
    If(u32),
    /// Forwards, unless it holds; the target comes later.
    Unless,
}

impl Compiler<'_> {
    /// A jump on `cond`, together with the comparison that computes it if there is one. Returns its place.
    pub fn jump(&mut self, names: &Names, compare: Option<&Stmt>, cond: Atom, jump: Jump) -> Result<u32> {
        let fused = match compare.map(|s| &s.op) {
            Some(Op::Prim(prim, scalar, args)) => {
                let (a, b) = (self.atom(names, args[0])?, self.atom(names, args[1])?);
                match jump {
                    Jump::If(target) => jump_if(*prim, *scalar, a, b, target),
                    Jump::Unless => jump_unless(*prim, *scalar, a, b, 0),
                }
            }
            _ => None,
        };
        let instruction = match (fused, jump) {
            (Some(fused), _) => fused,
            (None, Jump::If(target)) => Instruction::If { a: self.atom(names, cond)?, target },
            (None, Jump::Unless) => Instruction::Unless { a: self.atom(names, cond)?, target: 0 },
        };
        let place = self.here();
        self.emit(instruction);
        Ok(place)
    }

    pub fn branch(
        &mut self,
        names: &mut Names,
        compare: Option<&Stmt>,
        cond: Atom,
        dst: &[Var],
        (yes, no): (&Block, &Block),
    ) -> Result<()> {
        let targets = dst.iter().map(|v| self.target(names, *v)).collect::<Result<Vec<_>>>()?;
        let to_no = self.jump(names, compare, cond, Jump::Unless)?;
        self.arm(names, yes, &targets)?;
        let to_end = self.here();
        self.emit(Instruction::Jump { target: 0 });
        self.land(to_no);
        let no_start = self.here();
        self.arm(names, no, &targets)?;
        if self.here() == no_start {
            // Nothing to jump over.
            self.code.instructions.pop();
            self.land(to_no);
        } else {
            self.land(to_end);
        }
        Ok(())
    }

    /// One side of a branch, its results left in `targets`, which nothing reads before.
    fn arm(&mut self, names: &mut Names, block: &Block, targets: &[Register]) -> Result<()> {
        let base = self.next;
        for (result, target) in block.results.iter().zip(targets) {
            if let Atom::Var(v) = result
                && block.stmts.iter().any(|s| s.dst.contains(v))
                && !names.is_set(*v)
            {
                names.set(*v, *target);
            }
        }
        self.statements(names, &block.stmts)?;
        for (result, to) in block.results.iter().zip(targets) {
            let from = self.atom(names, *result)?;
            if from != *to {
                self.emit(Instruction::Move { to: *to, from });
            }
        }
        self.next = base;
        Ok(())
    }

    /// `while cond(state) { state = body(state) }`, the condition at the bottom.
    pub fn repeat(&mut self, names: &mut Names, l: &Loop, dst: &[Var]) -> Result<()> {
        let mut registers = Vec::new();
        for (_, first) in &l.state {
            let from = self.atom(names, *first)?;
            let to = self.fresh()?;
            self.emit(Instruction::Move { to, from });
            registers.push(to);
        }
        let state: Vec<Var> = l.state.iter().map(|(v, _)| *v).collect();
        for (var, register) in state.iter().zip(&registers) {
            names.set(*var, *register);
        }
        let (base, changing) = (self.next, self.changing.len());
        self.changing.extend_from_slice(&registers);

        let to_cond = self.here();
        self.emit(Instruction::Jump { target: 0 });
        let top = self.here();
        self.write_in_place(names, &l.body.stmts, &l.body.results, &state, &registers);
        self.statements(names, &l.body.stmts)?;
        let next = self.atoms(names, &l.body.results)?;
        self.parallel_moves(registers.iter().copied().zip(next).collect())?;
        self.next = base;

        self.land(to_cond);
        self.condition(names, &l.cond, top)?;
        self.next = base;
        self.changing.truncate(changing);
        for (var, register) in dst.iter().zip(registers) {
            self.alias(names, *var, register)?;
        }
        Ok(())
    }

    /// Jumps back to `top` where the condition holds.
    fn condition(&mut self, names: &mut Names, cond: &Block, top: u32) -> Result<()> {
        let &[holds] = cond.results.as_slice() else {
            return Err(RunError::Internal("a loop's condition has not one result".into()));
        };
        let (before, compare) = split_comparison(names, &cond.stmts, holds);
        self.statements(names, before)?;
        self.jump(names, compare, holds, Jump::If(top))?;
        Ok(())
    }
}

/// The last statement apart, if it is a comparison that only yields `cond`.
pub fn split_comparison<'s>(names: &Names, stmts: &'s [Stmt], cond: Atom) -> (&'s [Stmt], Option<&'s Stmt>) {
    match (stmts, cond) {
        ([before @ .., last], Atom::Var(v)) if is_comparison(last, v) && names.read_once(v) => {
            (before, Some(last))
        }
        _ => (stmts, None),
    }
}
