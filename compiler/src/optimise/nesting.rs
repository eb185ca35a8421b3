//! Bounds how deep branches and loops nest in what one rewrite evaluates, calls of helpers included.
//!
//! WGSL compilers refuse more than 127 nested braces, and drivers inline everything and may then give wrong results
//! without a word (llvmpipe beyond 80 nested branches). A block that lies too deep becomes a task of its own, so
//! that it is evaluated by another rewrite.

use crate::core::graph::Graph;
use crate::core::names::Names;
use crate::core::walk::{Free, Renumber, calls_any};
use crate::core::{Atom, Block, FnId, Function, Mark, Op, Program, Stmt};
use crate::split::tasks_of;

/// Nesting allowed in all.
const DEEPEST: usize = 32;
/// Blocks that lie less deep than this stay, even if what is in them is too deep.
const SHALLOW: usize = 16;
/// A loop's exits are branches, too.
const LOOP: usize = 3;

pub fn bound(program: &mut Program) {
    let graph = Graph::new(&program.functions);
    let is_task = tasks_of(program, &graph);
    let names = Names::of(&program.functions);
    let heights = vec![0; program.functions.len()];
    let mut bounder = Bounder { heights, is_task, names, found: Vec::new() };
    for f in graph.bottom_up {
        let mut function = std::mem::take(&mut program.functions[f]);
        let mut body = std::mem::take(&mut function.body);
        let height = bounder.block(&mut function, &mut body, 0);
        // What calls a task is a task, and its callers do not nest it.
        bounder.is_task[f] |= bounder.calls_task(&body);
        bounder.heights[f] = if bounder.is_task[f] { 0 } else { height };
        function.body = body;
        program.functions[f] = function;
    }
    program.functions.append(&mut bounder.found);
}

struct Bounder {
    /// Nesting inside each function that is finished; 0 for tasks.
    heights: Vec<usize>,
    is_task: Vec<bool>,
    names: Names,
    /// New functions, whose indices follow those of the program.
    found: Vec<Function>,
}

impl Bounder {
    fn calls_task(&self, block: &Block) -> bool {
        calls_any(&block.stmts, &self.is_task)
    }

    /// Nesting below the block, after blocks that lie too deep were taken out.
    fn block(&mut self, f: &mut Function, block: &mut Block, depth: usize) -> usize {
        let mut height = 0;
        for stmt in &mut block.stmts {
            let own = match &stmt.op {
                Op::Call(id, _) => self.heights[id.0 as usize],
                _ => 0,
            };
            let step = if matches!(stmt.op, Op::Loop(_)) { LOOP } else { 1 };
            let inner = stmt.op.blocks_mut().map(|b| step + self.block(f, b, depth + step)).max();
            height = height.max(own).max(inner.unwrap_or(0));
        }
        if depth >= SHALLOW && depth + height > DEEPEST {
            self.take_out(f, block);
            return 0;
        }
        height
    }

    /// Puts a call of a new task in the place of the block's statements.
    fn take_out(&mut self, f: &mut Function, block: &mut Block) {
        let mut free = Free::default();
        free.block(block);
        let params = free.vars();
        let results: Vec<_> = block.results.iter().map(|a| f.scalar(*a)).collect();
        let mut renumber = Renumber::apart(&f.vars);
        let task = Function {
            name: self.names.fresh(&format!("{}.deep", f.name)),
            params: renumber.defines(&params),
            results: results.clone(),
            body: renumber.block(&std::mem::take(block)),
            vars: renumber.new,
            mark: Mark::Task,
            span: f.span,
        };
        let dst: Vec<_> = results.into_iter().map(|s| f.fresh(s)).collect();
        block.results = dst.iter().map(|v| Atom::Var(*v)).collect();
        let id = FnId(self.heights.len() as u32);
        let args = params.into_iter().map(Atom::Var).collect();
        block.stmts.push(Stmt { dst: dst.into(), op: Op::Call(id, args) });
        self.found.push(task);
        self.heights.push(0);
        self.is_task.push(true);
    }
}
