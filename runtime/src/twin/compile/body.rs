//! Statements without control flow, and the registers of variables.

use ghyll_compiler::core::{Atom, FnId, Intrinsic, Op, Prim, Scalar, Stmt, Var};

use super::{Compiler, INLINE_LIMIT, Result, uses};
use crate::error::RunError;
use crate::twin::instruction::{self, Instruction, Register};

/// Where the variables of one function, or of one inlined copy of it, are held.
pub struct Names {
    registers: Vec<Option<Register>>,
    uses: Vec<u32>,
}

impl Names {
    pub fn new(vars: usize, uses: Vec<u32>) -> Names {
        Names { registers: vec![None; vars], uses }
    }

    pub fn set(&mut self, var: Var, register: Register) {
        self.registers[var.0 as usize] = Some(register);
    }

    pub fn is_set(&self, var: Var) -> bool {
        self.registers[var.0 as usize].is_some()
    }

    pub fn get(&self, var: Var) -> Result<Register> {
        self.registers[var.0 as usize]
            .ok_or_else(|| RunError::Internal(format!("variable {} is read before it is assigned", var.0)))
    }

    pub fn read_once(&self, var: Var) -> bool {
        self.uses[var.0 as usize] == 1
    }
}

impl Compiler<'_> {
    pub fn atom(&mut self, names: &Names, atom: Atom) -> Result<Register> {
        match atom {
            Atom::Var(v) => names.get(v),
            Atom::Const(c) => self.constant(c.word()),
        }
    }

    pub fn atoms(&mut self, names: &Names, atoms: &[Atom]) -> Result<Vec<Register>> {
        atoms.iter().map(|a| self.atom(names, *a)).collect()
    }

    /// The register that `var` is to be written to: the one chosen for it, or a new one.
    pub fn target(&mut self, names: &mut Names, var: Var) -> Result<Register> {
        if let Some(register) = names.registers[var.0 as usize] {
            return Ok(register);
        }
        let register = self.fresh()?;
        names.set(var, register);
        Ok(register)
    }

    /// Lets `var` be what `register` holds, without a copy where the register keeps its value.
    pub fn alias(&mut self, names: &mut Names, var: Var, register: Register) -> Result<()> {
        if !names.is_set(var) && !self.changing.contains(&register) {
            names.set(var, register);
            return Ok(());
        }
        let to = self.target(names, var)?;
        self.emit(Instruction::Move { to, from: register });
        Ok(())
    }

    pub fn statements(&mut self, names: &mut Names, stmts: &[Stmt]) -> Result<()> {
        let mut at = 0;
        while at < stmts.len() {
            // A comparison that only the next statement reads becomes part of its jump.
            if let [compare, Stmt { dst, op: Op::If(Atom::Var(cond), yes, no) }, ..] = &stmts[at..]
                && is_comparison(compare, *cond)
                && names.read_once(*cond)
            {
                self.branch(names, Some(compare), Atom::Var(*cond), dst, (yes, no))?;
                at += 2;
                continue;
            }
            self.statement(names, &stmts[at])?;
            at += 1;
        }
        Ok(())
    }

    fn statement(&mut self, names: &mut Names, stmt: &Stmt) -> Result<()> {
        match &stmt.op {
            Op::Prim(prim, scalar, args) => self.prim(names, *prim, *scalar, args, &stmt.dst),
            Op::Intrinsic(intrinsic, args) => self.intrinsic(names, *intrinsic, args, &stmt.dst),
            Op::Live(index) => self.live(names, *index, &stmt.dst),
            Op::Call(id, args) => self.call(names, *id, args, &stmt.dst),
            Op::If(cond, yes, no) => self.branch(names, None, *cond, &stmt.dst, (yes, no)),
            Op::Loop(l) => self.repeat(names, l, &stmt.dst),
        }
    }

    fn prim(
        &mut self,
        names: &mut Names,
        prim: Prim,
        scalar: Scalar,
        args: &[Atom],
        dst: &[Var],
    ) -> Result<()> {
        let args = self.atoms(names, args)?;
        let &[var] = dst else { return Err(no_meaning(prim)) };
        if let (&[a], Some(Instruction::Move { .. })) = (&args[..], instruction::unary(prim, scalar, 0, 0)) {
            return self.alias(names, var, a);
        }
        let to = self.target(names, var)?;
        let instruction = match (prim, args.as_slice()) {
            (Prim::Select, &[no, yes, cond]) => Some(Instruction::Select { to, no, yes, cond }),
            (Prim::Fma, &[a, b, c]) => Some(Instruction::Fma { to, a, b, c }),
            (Prim::Index, &[at, ref elements @ ..]) if !elements.is_empty() => {
                let start = self.operands(elements);
                Some(Instruction::Index { to, at, count: elements.len() as u16, start })
            }
            (_, &[a]) => instruction::unary(prim, scalar, to, a),
            (_, &[a, b]) => instruction::binary(prim, scalar, to, a, b),
            _ => None,
        };
        self.emit(instruction.ok_or_else(|| no_meaning(prim))?);
        Ok(())
    }

    /// Appends to the operand list.
    fn operands(&mut self, registers: &[Register]) -> u32 {
        let start = self.code.operands.len() as u32;
        self.code.operands.extend_from_slice(registers);
        start
    }

    fn intrinsic(&mut self, names: &mut Names, which: Intrinsic, args: &[Atom], dst: &[Var]) -> Result<()> {
        let mut operands = self.atoms(names, args)?;
        for var in dst {
            operands.push(self.target(names, *var)?);
        }
        if operands.len() != which.params().len() + which.results().len() {
            return Err(RunError::Internal(format!("`{}` has the wrong operands", which.name())));
        }
        let start = self.operands(&operands);
        let at = Intrinsic::ALL.iter().position(|i| *i == which).unwrap_or(0);
        self.emit(Instruction::Intrinsic { which: at as u16, start });
        Ok(())
    }

    /// A live parameter's word sits in a register that is loaded before the run, like a constant.
    fn live(&mut self, names: &mut Names, index: u32, dst: &[Var]) -> Result<()> {
        let known = self.code.live.iter().find(|(_, word)| *word == index).map(|(register, _)| *register);
        let register = match known {
            Some(register) => register,
            None => {
                let register = self.loaded(0)?;
                self.code.live.push((register, index));
                register
            }
        };
        dst.iter().try_for_each(|var| self.alias(names, *var, register))
    }

    fn call(&mut self, names: &mut Names, id: FnId, args: &[Atom], dst: &[Var]) -> Result<()> {
        let args = self.atoms(names, args)?;
        if self.sizes[id.0 as usize] <= INLINE_LIMIT {
            return self.inline(names, id, &args, dst);
        }
        let called = self.helper(id)?;
        let results = self.table.helper(id).results.len() as Register;
        for (i, from) in args.into_iter().enumerate() {
            self.emit(Instruction::Move { to: called.frame + results + i as Register, from });
        }
        self.emit(Instruction::Call { target: called.start });
        for (i, var) in dst.iter().enumerate() {
            let to = self.target(names, *var)?;
            self.emit(Instruction::Move { to, from: called.frame + i as Register });
        }
        Ok(())
    }

    fn inline(&mut self, names: &mut Names, id: FnId, args: &[Register], dst: &[Var]) -> Result<()> {
        let function = self.table.helper(id);
        let mut inner = Names::new(function.vars.len(), uses::of_function(function));
        for (param, register) in function.params.iter().zip(args) {
            inner.set(*param, *register);
        }
        self.statements(&mut inner, &function.body.stmts)?;
        let results = self.atoms(&inner, &function.body.results)?;
        for (var, register) in dst.iter().zip(results) {
            self.alias(names, *var, register)?;
        }
        Ok(())
    }
}

fn no_meaning(prim: Prim) -> RunError {
    RunError::Internal(format!("the operation {prim:?} has the wrong operands"))
}

/// Does `stmt` assign to `var` a comparison that a jump can make itself?
pub fn is_comparison(stmt: &Stmt, var: Var) -> bool {
    let Op::Prim(prim, scalar, args) = &stmt.op else { return false };
    stmt.dst[..] == [var] && args.len() == 2 && instruction::jump_if(*prim, *scalar, 0, 0, 0).is_some()
}
