//! One lane: registers, and a window of two stacks. Left: literals that are produced. Right: what is still to be
//! looked at, as segments, each a header on top of its literals in stream order. The lane rewrites its part
//! of the stream depth first and can be stopped after any rewrite. The stacks grow on the heap, so there are no
//! chunks and no suspended lanes here; what they hold is charged to the run's memory.

use ghyll_compiler::core::Intrinsic;

use super::code::{Code, MOST_LITERALS, NO_TASK, header};
use super::decode::Redex;
use super::instruction::{Flow, Instruction, Registers};
use super::limits::Limits;
use super::tokens::Tokens;
use crate::error::RunError;
use crate::world::World;

type Result<T> = std::result::Result<T, RunError>;

/// Rewrites between two looks at the limits.
const SLICE: u64 = 4096;
/// Iterations of fused loops between two looks at the clock.
const TICKS: u32 = 1 << 16;
/// Segments between two looks at the clock while a window is filled or published.
const LOOK: u32 = 1 << 16;
/// Operands and results of an intrinsic.
const MOST_WORDS: usize = 17;

/// Why a lane stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// Only literals are left.
    Normal,
    /// All fuel is spent.
    Fuel,
    /// The next task is the runtime's `store`; its operands end the left stack.
    Store,
    /// The next function's operands are not in the window.
    Starved,
}

pub struct Machine<'r> {
    code: &'r Code,
    limits: &'r Limits,
    world: Option<&'r dyn World>,
    registers: Box<Registers>,
    /// Return places of helpers.
    calls: Vec<u32>,
    left: Vec<u32>,
    right: Vec<u32>,
    /// Task to run next.
    invoke: u32,
    /// Rewrites left in this slice.
    fuel: u64,
    ticks: u32,
    /// Bytes charged for the stacks.
    held: u64,
    /// Free memory below which the lane stops.
    floor: u64,
}

impl<'r> Machine<'r> {
    pub fn new(
        code: &'r Code,
        live: &[u32],
        limits: &'r Limits,
        world: Option<&'r dyn World>,
    ) -> Machine<'r> {
        let zeros = vec![0; 1 << 16].into_boxed_slice();
        let mut registers: Box<Registers> = zeros.try_into().expect("the slice has as many elements");
        code.preload(live, &mut registers);
        Machine {
            code,
            limits,
            world,
            registers,
            calls: Vec::new(),
            left: Vec::new(),
            right: Vec::new(),
            invoke: NO_TASK,
            fuel: 0,
            ticks: TICKS,
            held: 0,
            floor: 0,
        }
    }

    /// Makes the lane stop early, as if out of fuel, where less memory than this is free.
    pub fn leave_free(&mut self, bytes: u64) {
        self.floor = bytes;
    }

    /// Empties the window, then holds a redex and its region.
    pub fn begin(&mut self, tokens: &Tokens, redex: Redex) {
        self.clear();
        self.segments(tokens, redex.at + 1, redex.to);
        self.left.extend_from_slice(&tokens.words()[redex.from..redex.at]);
        self.invoke = redex.task;
    }

    /// Empties the window, then holds `tokens`, all still to be looked at.
    pub fn begin_stream(&mut self, tokens: &Tokens) {
        self.clear();
        self.segments(tokens, 0, tokens.len());
    }

    /// Puts tokens `from..to` on the right stack. A long stream is left incomplete when the run is over.
    fn segments(&mut self, tokens: &Tokens, from: usize, to: usize) {
        let words = tokens.words();
        let (mut end, mut task) = (to, NO_TASK);
        for step in 0u32.. {
            let before = tokens.last_function(from, end);
            let literals = &words[before.map_or(from, |at| at + 1)..end];
            if task != NO_TASK || !literals.is_empty() {
                self.segment(literals, task);
            }
            let Some(at) = before else { return };
            if step % LOOK == LOOK - 1 && self.limits.is_over() {
                return;
            }
            (end, task) = (at, words[at]);
        }
    }

    /// Puts `literals task` on the right stack, in pieces that a header can count.
    fn segment(&mut self, literals: &[u32], task: u32) {
        let mut pieces = literals.rchunks(MOST_LITERALS);
        let last = pieces.next().unwrap_or(&[]);
        for (piece, task) in std::iter::once((last, task)).chain(pieces.map(|p| (p, NO_TASK))) {
            self.right.extend_from_slice(piece);
            self.right.push(header(task, piece.len() as u32));
        }
    }

    /// Empties the window, then holds a pixel: `index x y task store`.
    pub fn begin_pixel(&mut self, index: u32, position: [f32; 2], task: u32) {
        self.clear();
        self.right.push(header(self.code.store(), 0));
        self.left.extend_from_slice(&[index, position[0].to_bits(), position[1].to_bits()]);
        self.invoke = task;
    }

    /// Windows that grew beyond this give their memory back.
    const KEPT_WORDS: usize = 1 << 16;

    fn clear(&mut self) {
        for stack in [&mut self.left, &mut self.right] {
            stack.clear();
            stack.shrink_to(Self::KEPT_WORDS);
        }
        self.calls.clear();
        self.invoke = NO_TASK;
    }

    /// The left stack: the value of a window in normal form, the operands of a `store`.
    pub fn literals(&self) -> &[u32] {
        &self.left
    }

    /// Takes the operands of `store` from the window: pixel index, components.
    pub fn take_store(&mut self, components: u32) -> Option<(u32, Vec<u32>)> {
        let start = self.left.len().checked_sub(1 + components as usize)?;
        let words = self.left.split_off(start);
        self.invoke = NO_TASK;
        let (index, components) = words.split_first()?;
        Some((*index, components.to_vec()))
    }

    /// Writes the window as tokens: left, the function to come, right. Not all of a long window when the run is over.
    pub fn publish(&mut self, out: &mut Tokens) {
        out.push_literals(&self.left);
        if self.invoke != NO_TASK {
            out.push_function(self.invoke);
        }
        let mut step = 0;
        while let Some(word) = self.right.pop() {
            let (task, count) = (word & 0xffff, (word >> 16) as usize);
            let start = self.right.len().saturating_sub(count);
            out.push_literals(&self.right[start..]);
            self.right.truncate(start);
            if task != NO_TASK {
                out.push_function(task);
            }
            step += 1;
            if step % LOOK == 0 && self.limits.is_over() {
                break;
            }
        }
        self.clear();
    }

    /// Rewrites until the window is in normal form, at most `most` times.
    pub fn run(&mut self, most: u64) -> Result<Stop> {
        let mut left = most;
        loop {
            let slice = left.min(SLICE);
            self.fuel = slice;
            let stop = self.rewrite();
            let spent = slice - self.fuel;
            left -= spent;
            let code = self.code;
            let function = self.function(code);
            self.limits.spend(spent, function)?;
            self.charge(function)?;
            match stop? {
                Stop::Fuel if left > 0 && self.limits.free_memory() >= self.floor => {
                    self.limits.check_clock(function)?;
                }
                stop => return Ok(stop),
            }
        }
    }

    /// The function to name in a message: the one that runs next.
    fn function<'c>(&self, code: &'c Code) -> &'c str {
        let next = match (self.invoke, self.right.last()) {
            (NO_TASK, Some(header)) => header & 0xffff,
            (NO_TASK, None) => 0,
            (task, _) => task,
        };
        code.function(if next == NO_TASK { 0 } else { next })
    }

    fn charge(&mut self, function: &str) -> Result<()> {
        let bytes = 4 * (self.left.capacity() + self.right.capacity()) as u64;
        if self.floor > 0 && bytes > self.held {
            // One of several lanes stops soon after rather than end the run.
            self.limits.take(bytes - self.held);
        } else if bytes != self.held {
            self.limits.hold(self.held, bytes, function)?;
        }
        self.held = bytes;
        Ok(())
    }

    /// Next task, its operands' place on the left stack; none if the lane stops.
    fn select(&mut self) -> std::result::Result<(u32, usize), Stop> {
        while self.invoke == NO_TASK {
            let Some(word) = self.right.pop() else { return Err(Stop::Normal) };
            let count = (word >> 16) as usize;
            let start = self.right.len().saturating_sub(count);
            self.left.extend_from_slice(&self.right[start..]);
            self.right.truncate(start);
            self.invoke = word & 0xffff;
        }
        let task = self.invoke;
        let Some(entry) = self.code.tasks.get(task as usize) else { return Err(Stop::Store) };
        let first = self.left.len().checked_sub(entry.arity as usize).ok_or(Stop::Starved)?;
        if self.fuel == 0 {
            return Err(Stop::Fuel);
        }
        Ok((entry.start, first))
    }

    fn rewrite(&mut self) -> Result<Stop> {
        loop {
            let (start, first) = match self.select() {
                Ok(next) => next,
                Err(stop) => return Ok(stop),
            };
            self.fuel -= 1;
            let frame = self.code.frame as usize;
            let arity = self.left.len() - first;
            for i in 0..arity {
                self.registers[(frame + i) & 0xffff] = self.left[first + i];
            }
            self.left.truncate(first);
            self.execute(start as usize, arity)?;
        }
    }

    /// Runs a task's body from `start` to the end of its emission.
    #[inline]
    fn execute(&mut self, start: usize, arity: usize) -> Result<()> {
        let code = self.code;
        let instructions = code.instructions.as_slice();
        let mut pc = start;
        loop {
            let instruction = instructions[pc];
            pc += 1;
            match instruction.step(&mut self.registers, &mut pc, &mut self.ticks) {
                Flow::Next => continue,
                Flow::Tick => {
                    self.tick()?;
                    continue;
                }
                Flow::Other => {}
            }
            let r = &mut *self.registers;
            match instruction {
                Instruction::Literal { a } => self.left.push(r[a as usize]),
                Instruction::Literal2 { a, b } => {
                    self.left.extend_from_slice(&[r[a as usize], r[b as usize]]);
                }
                Instruction::Literal3 { a, b, c } => {
                    self.left.extend_from_slice(&[r[a as usize], r[b as usize], r[c as usize]]);
                }
                Instruction::Later { a } => self.right.push(r[a as usize]),
                Instruction::Later2 { a, b } => {
                    self.right.extend_from_slice(&[r[a as usize], r[b as usize]]);
                }
                Instruction::Later3 { a, b, c } => {
                    self.right.extend_from_slice(&[r[a as usize], r[b as usize], r[c as usize]]);
                }
                Instruction::Header { word } => self.right.push(word),
                Instruction::Invoke { task } => {
                    self.invoke = task;
                    return Ok(());
                }
                Instruction::Done => {
                    self.invoke = NO_TASK;
                    return Ok(());
                }
                Instruction::Again { task } => {
                    if self.fuel == 0 {
                        let frame = code.frame as usize;
                        self.left.extend_from_slice(&r[frame..frame + arity]);
                        self.invoke = task;
                        return Ok(());
                    }
                    self.fuel -= 1;
                    pc = start;
                }
                Instruction::Index { to, at, count, start } => {
                    let at = i64::from(r[at as usize] as i32).clamp(0, i64::from(count) - 1);
                    r[to as usize] = r[code.operands[start as usize + at as usize] as usize];
                }
                Instruction::Call { target } => {
                    self.calls.push(pc as u32);
                    pc = target as usize;
                }
                Instruction::Return => pc = self.calls.pop().map_or(pc, |to| to as usize),
                Instruction::Intrinsic { which, start } => self.intrinsic(which, start as usize)?,
                // All others are steps.
                _ => {}
            }
        }
    }

    #[cold]
    fn tick(&mut self) -> Result<()> {
        self.ticks = TICKS;
        let code = self.code;
        self.limits.check_clock(self.function(code))
    }

    fn intrinsic(&mut self, which: u16, start: usize) -> Result<()> {
        let which = Intrinsic::ALL[which as usize];
        let (params, results) = (which.params().len(), which.results().len());
        let world = self.world.ok_or_else(|| {
            RunError::Unsupported(format!("`{}` without a terrain; name one with --dem", which.name()))
        })?;
        let operands = &self.code.operands[start..start + params + results];
        let (mut args, mut out) = ([0; MOST_WORDS], [0; MOST_WORDS]);
        for (arg, register) in args.iter_mut().zip(&operands[..params]) {
            *arg = self.registers[*register as usize];
        }
        world.eval_f32(which, &args[..params], &mut out[..results]);
        for (register, word) in operands[params..].iter().zip(out) {
            self.registers[*register as usize] = word;
        }
        Ok(())
    }
}

impl Drop for Machine<'_> {
    fn drop(&mut self) {
        self.limits.release(self.held);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intrinsics_fit() {
        for intrinsic in Intrinsic::ALL {
            assert!(intrinsic.params().len().max(intrinsic.results().len()) <= MOST_WORDS);
        }
    }
}
