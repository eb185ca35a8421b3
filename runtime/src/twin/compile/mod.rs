//! From the function table to the register form.
//!
//! Every variable is assigned once, so it gets a register of its own for as long as its block lasts. Small
//! helpers are compiled into their callers; large ones once, each with a frame of its own: helpers do not recurse, so
//! frames can be fixed and a call moves nothing but operands and results. Constants sit in registers.

mod body;
mod flow;
mod moves;
mod tail;
mod uses;

use std::collections::HashMap;

use ghyll_compiler::core::{Block, FnId, Function, Op, Stmt};
use ghyll_compiler::table::{Table, Tail, TailBlock, Task};

use self::body::Names;
use super::code::{Code, TaskCode};
use super::instruction::{Instruction, Register};
use crate::error::RunError;

type Result<T> = std::result::Result<T, RunError>;

/// Helpers with at most so many statements, those of their callees included, are compiled into the caller.
const INLINE_LIMIT: usize = 200;

pub fn compile(table: &Table) -> Result<Code> {
    let mut compiler = Compiler::new(table)?;
    for id in 0..table.helpers.len() {
        if compiler.sizes[id] > INLINE_LIMIT {
            compiler.helper(FnId(id as u32))?;
        }
    }
    compiler.code.frame = compiler.register(compiler.next)?;
    for task in &table.tasks {
        compiler.task(task)?;
    }
    compiler.code.longest_emission = table.longest_emission();
    Ok(compiler.code)
}

/// A helper that is called, and where its frame begins: results, then parameters.
#[derive(Clone, Copy)]
struct Called {
    start: u32,
    frame: Register,
}

struct Compiler<'t> {
    table: &'t Table,
    code: Code,
    constants: HashMap<u32, Register>,
    called: HashMap<FnId, Called>,
    /// Statements of each helper with everything it calls.
    sizes: Vec<usize>,
    /// First free register.
    next: u32,
    /// First register that was never used.
    high: u32,
    /// Registers that a running loop or task will assign again: nothing may be an alias of them.
    changing: Vec<Register>,
}

impl<'t> Compiler<'t> {
    fn new(table: &'t Table) -> Result<Compiler<'t>> {
        let too_long = table.tasks.iter().any(|t| t.arity() > 0xffff || t.longest_emission() > 0xffff);
        if table.tasks.len() >= 0xffff || too_long {
            return Err(RunError::Unsupported("a program with more than 65534 tasks or operands".into()));
        }
        Ok(Compiler {
            table,
            code: Code::default(),
            constants: HashMap::new(),
            called: HashMap::new(),
            sizes: sizes(table)?,
            next: 0,
            high: 0,
            changing: Vec::new(),
        })
    }

    fn register(&self, at: u32) -> Result<Register> {
        let end = (1 << 16) - self.code.constants.len() as u32;
        if at >= end {
            return Err(RunError::TooManyVariables { limit: 0xffff });
        }
        Ok(at as Register)
    }

    fn fresh(&mut self) -> Result<Register> {
        let register = self.register(self.next)?;
        self.next += 1;
        self.high = self.high.max(self.next);
        Ok(register)
    }

    fn constant(&mut self, word: u32) -> Result<Register> {
        if let Some(register) = self.constants.get(&word) {
            return Ok(*register);
        }
        let register = self.loaded(word)?;
        self.constants.insert(word, register);
        Ok(register)
    }

    /// A register that holds `word` from the beginning.
    fn loaded(&mut self, word: u32) -> Result<Register> {
        let at = (1 << 16) - 1 - self.code.constants.len() as u32;
        if at <= self.high {
            return Err(RunError::Unsupported(
                "a program with more than 65535 constants and variables".into(),
            ));
        }
        self.code.constants.push(word);
        Ok(at as Register)
    }

    fn emit(&mut self, instruction: Instruction) {
        self.code.instructions.push(instruction);
    }

    fn here(&self) -> u32 {
        self.code.instructions.len() as u32
    }

    /// Lets the forward jump at `jump` arrive here.
    fn land(&mut self, jump: u32) {
        let here = self.here();
        self.code.instructions[jump as usize].set_target(here);
    }

    fn task(&mut self, task: &Task) -> Result<()> {
        let id = self.code.tasks.len() as u32;
        let start = self.here();
        self.code.tasks.push(TaskCode { start, arity: task.arity(), function: task.function.clone() });
        let base = self.next;
        let mut names = Names::new(task.vars.len(), uses::of_task(task));
        let params = task.params.iter().map(|_| self.fresh()).collect::<Result<Vec<_>>>()?;
        for (param, register) in task.params.iter().zip(&params) {
            names.set(*param, *register);
        }
        if starts_over(&task.body) {
            self.changing = params.clone();
        }
        self.tail_block(&mut names, &task.body, &tail::Own { id, params: &task.params, registers: &params })?;
        self.changing.clear();
        self.next = base;
        Ok(())
    }

    /// Compiles a helper that is called; those that it calls come first.
    fn helper(&mut self, id: FnId) -> Result<Called> {
        if let Some(called) = self.called.get(&id) {
            return Ok(*called);
        }
        let function = self.table.helper(id);
        for callee in callees(&function.body) {
            if self.sizes[callee.0 as usize] > INLINE_LIMIT {
                self.helper(callee)?;
            }
        }
        let called = Called { start: self.here(), frame: self.register(self.next)? };
        let results = function.results.iter().map(|_| self.fresh()).collect::<Result<Vec<_>>>()?;
        let mut names = Names::new(function.vars.len(), uses::of_function(function));
        for param in &function.params {
            let register = self.fresh()?;
            names.set(*param, register);
        }
        self.statements(&mut names, &function.body.stmts)?;
        for (to, result) in results.into_iter().zip(&function.body.results) {
            let from = self.atom(&names, *result)?;
            self.emit(Instruction::Move { to, from });
        }
        self.emit(Instruction::Return);
        // Frames that may be live together share no register, not even those of closed blocks.
        self.next = self.high;
        self.called.insert(id, called);
        Ok(called)
    }
}

/// Statements of each helper with those of everything it calls.
fn sizes(table: &Table) -> Result<Vec<usize>> {
    fn size(table: &Table, id: usize, known: &mut [Option<usize>], open: &mut Vec<usize>) -> Result<usize> {
        if let Some(size) = known[id] {
            return Ok(size);
        }
        let function: &Function = &table.helpers[id];
        if open.contains(&id) {
            return Err(RunError::Internal(format!("the helper `{}` is recursive", function.name)));
        }
        open.push(id);
        let mut total = uses::statements(&function.body);
        for callee in callees(&function.body) {
            let inner = size(table, callee.0 as usize, known, open)?;
            total += if inner > INLINE_LIMIT { 0 } else { inner };
        }
        open.pop();
        known[id] = Some(total);
        Ok(total)
    }
    let mut known = vec![None; table.helpers.len()];
    (0..table.helpers.len()).map(|id| size(table, id, &mut known, &mut Vec::new())).collect()
}

fn starts_over(block: &TailBlock) -> bool {
    match &block.tail {
        Tail::Emit(_) => false,
        Tail::If(_, yes, no) => starts_over(yes) || starts_over(no),
        Tail::Again(_) => true,
    }
}

fn callees(block: &Block) -> Vec<FnId> {
    let mut found = Vec::new();
    uses::each_statement(block, &mut |stmt: &Stmt| {
        if let Op::Call(id, _) = &stmt.op {
            found.push(*id);
        }
    });
    found
}
