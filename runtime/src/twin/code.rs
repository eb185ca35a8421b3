//! A compiled function table.

use super::instruction::{Instruction, Register, Registers};

/// No task: a lane has nothing to invoke, a segment is literals only.
pub const NO_TASK: u32 = 0xffff;

/// Literals that one header can count.
pub const MOST_LITERALS: usize = 0xffff;

/// A segment's header: its task and how many literals lie below it.
pub fn header(task: u32, literals: u32) -> u32 {
    task | literals << 16
}

#[derive(Clone, Debug)]
pub struct TaskCode {
    pub start: u32,
    pub arity: u32,
    /// Source function, for messages.
    pub function: String,
}

#[derive(Clone, Debug, Default)]
pub struct Code {
    pub instructions: Vec<Instruction>,
    /// Registers that `Index` and `Intrinsic` refer to.
    pub operands: Vec<Register>,
    /// Held by the registers from the last one downwards.
    pub constants: Vec<u32>,
    /// Registers of live parameters' words.
    pub live: Vec<(Register, u32)>,
    pub tasks: Vec<TaskCode>,
    /// First register of every task's frame, where its operands go.
    pub frame: Register,
    pub longest_emission: u32,
}

impl Code {
    /// Id of the runtime's own task, which takes a pixel from the stream.
    pub fn store(&self) -> u32 {
        self.tasks.len() as u32
    }

    /// The function that a task belongs to.
    pub fn function(&self, task: u32) -> &str {
        self.tasks.get(task as usize).map_or("store", |t| &t.function)
    }

    /// Puts constants and live words where the instructions expect them.
    pub fn preload(&self, live: &[u32], registers: &mut Registers) {
        for (register, word) in registers.iter_mut().rev().zip(&self.constants) {
            *register = *word;
        }
        for (register, index) in &self.live {
            registers[*register as usize] = live.get(*index as usize).copied().unwrap_or(0);
        }
    }
}
