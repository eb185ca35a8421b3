//! Bounds how deep blocks nest, because WGSL compilers refuse more than 127 nested braces: a block that lies
//! too deep and has blocks inside becomes a function of its own.

use std::collections::HashSet;

use crate::core::walk::Free;
use crate::core::{Atom, Block, FnId, Function, Mark, Op, Program, Stmt};

/// Blocks around a block, in one function.
const DEEPEST: usize = 40;

pub fn bound(program: &mut Program) {
    let mut names: HashSet<_> = program.functions.iter().map(|f| f.name.clone()).collect();
    let mut at = 0;
    while at < program.functions.len() {
        let mut body = std::mem::take(&mut program.functions[at].body);
        let mut outliner = Outliner {
            function: at,
            next: program.functions.len(),
            program,
            names: &mut names,
            found: Vec::new(),
        };
        outliner.block(&mut body, 0);
        let mut found = outliner.found;
        program.functions[at].body = body;
        program.functions.append(&mut found);
        at += 1;
    }
}

struct Outliner<'a> {
    program: &'a mut Program,
    function: usize,
    /// Index of the first function found.
    next: usize,
    names: &'a mut HashSet<String>,
    found: Vec<Function>,
}

impl Outliner<'_> {
    fn block(&mut self, block: &mut Block, depth: usize) {
        if depth >= DEEPEST && block.stmts.iter().any(|s| !s.op.blocks().is_empty()) {
            return self.outline(block);
        }
        for stmt in &mut block.stmts {
            for inner in stmt.op.blocks_mut() {
                self.block(inner, depth + 1);
            }
        }
    }

    /// Puts a call in the place of the block's statements.
    fn outline(&mut self, block: &mut Block) {
        let mut free = Free::default();
        free.block(block);
        let params = free.vars();
        let from = &mut self.program.functions[self.function];
        let results: Vec<_> = block.results.iter().map(|a| from.scalar(*a)).collect();
        let function = Function {
            name: crate::split::lift::fresh_name(self.names, &format!("{}.deep", from.name)),
            params: params.clone(),
            results: results.clone(),
            vars: from.vars.clone(),
            body: std::mem::take(block),
            mark: Mark::Auto,
            span: from.span,
        };
        let dst: Vec<_> = results.into_iter().map(|s| from.fresh(s)).collect();
        block.results = dst.iter().map(|v| Atom::Var(*v)).collect();
        let id = FnId((self.next + self.found.len()) as u32);
        let args = params.into_iter().map(Atom::Var).collect();
        block.stmts.push(Stmt { dst, op: Op::Call(id, args) });
        self.found.push(function);
    }
}
