//! How a task ends: emissions, branches between them, self tail calls.

use ghyll_compiler::core::{Atom, Var};
use ghyll_compiler::table::{Emission, Tail, TailBlock, TaskId, Token};

use super::body::Names;
use super::flow::{Jump, split_comparison};
use super::{Compiler, Result};
use crate::twin::code::{NO_TASK, header};
use crate::twin::instruction::{Instruction, Register};

/// The task that is compiled, for its self tail calls.
pub struct Own<'a> {
    pub id: u32,
    pub params: &'a [Var],
    pub registers: &'a [Register],
}

impl Compiler<'_> {
    pub fn tail_block(&mut self, names: &mut Names, block: &TailBlock, own: &Own) -> Result<()> {
        let base = self.next;
        match &block.tail {
            Tail::Emit(emission) => {
                self.statements(names, &block.stmts)?;
                self.emission(names, emission)?;
            }
            Tail::If(cond, yes, no) => {
                let (before, compare) = split_comparison(names, &block.stmts, *cond);
                self.statements(names, before)?;
                let to_no = self.jump(names, compare, *cond, Jump::Unless)?;
                self.tail_block(names, yes, own)?;
                self.land(to_no);
                self.tail_block(names, no, own)?;
            }
            Tail::Again(args) => {
                self.write_in_place(names, &block.stmts, args, own.params, own.registers);
                self.statements(names, &block.stmts)?;
                let args = self.atoms(names, args)?;
                self.parallel_moves(own.registers.iter().copied().zip(args).collect())?;
                self.emit(Instruction::Again { task: own.id });
            }
        }
        self.next = base;
        Ok(())
    }

    /// Segments from the last one on go to the right stack; the first stays on the left and runs next.
    fn emission(&mut self, names: &Names, emission: &Emission) -> Result<()> {
        let mut segments = segments(emission).into_iter();
        let (literals, first) = segments.next().unwrap_or_default();
        for (literals, task) in segments.rev() {
            let registers = self.atoms(names, &literals)?;
            for group in registers.chunks(3) {
                self.emit(match *group {
                    [a, b, c] => Instruction::Later3 { a, b, c },
                    [a, b] => Instruction::Later2 { a, b },
                    _ => Instruction::Later { a: group[0] },
                });
            }
            let word = header(task.map_or(NO_TASK, |t| t.0), literals.len() as u32);
            self.emit(Instruction::Header { word });
        }
        let registers = self.atoms(names, &literals)?;
        for group in registers.chunks(3) {
            self.emit(match *group {
                [a, b, c] => Instruction::Literal3 { a, b, c },
                [a, b] => Instruction::Literal2 { a, b },
                _ => Instruction::Literal { a: group[0] },
            });
        }
        self.emit(match first {
            Some(task) => Instruction::Invoke { task: task.0 },
            None => Instruction::Done,
        });
        Ok(())
    }
}

/// Literals up to each function token; what follows the last one has none.
fn segments(emission: &Emission) -> Vec<(Vec<Atom>, Option<TaskId>)> {
    let mut segments = Vec::new();
    let mut literals = Vec::new();
    for token in emission {
        match token {
            Token::Literal(atom) => literals.push(*atom),
            Token::Function(task) => segments.push((std::mem::take(&mut literals), Some(*task))),
        }
    }
    if !literals.is_empty() || segments.is_empty() {
        segments.push((literals, None));
    }
    segments
}
