//! Inlining. A function is put in the place of its calls when it is marked `@inline`, is small, or is called once; never
//! when it is marked `@task` or recursive. Callees go first, so a chain of small functions becomes one body.
//!
//! The size limits keep shaders small: a function called from many places stays a helper, and a body stops growing
//! at [`LARGEST`] statements, except for what is called once or marked. What is marked is called all the same once
//! [`MOST_MARKED`] statements were put in place: marked functions that call each other may double at each step.

use std::cell::Cell;
use std::collections::HashMap;

use crate::core::graph::Graph;
use crate::core::walk::{Renumber, calls, size};
use crate::core::{Atom, Block, FnId, Function, Mark, Op, Program, Stmt};

/// Statements of a function that is inlined wherever it is called.
const SMALL: usize = 24;
/// Statements beyond which a body takes in no more small functions.
const LARGEST: usize = 4000;
/// Statements of marked functions that are put in place, in the whole program.
const MOST_MARKED: usize = 200_000;

pub fn inline(program: &mut Program) {
    let graph = Graph::new(&program.functions);
    let mut count: HashMap<FnId, usize> = HashMap::new();
    for f in &program.functions {
        for id in calls(&f.body.stmts) {
            *count.entry(id).or_default() += 1;
        }
    }
    let marked = Cell::new(MOST_MARKED);
    let sizes = vec![0; program.functions.len()];
    let mut inliner = Inliner { count, recursive: graph.recursive, sizes, marked };
    for f in graph.bottom_up {
        let mut function = program.functions[f].clone();
        inliner.function(&program.functions, &mut function);
        inliner.sizes[f] = size(&function.body.stmts);
        program.functions[f] = function;
    }
}

struct Inliner {
    count: HashMap<FnId, usize>,
    recursive: Vec<bool>,
    /// Statements of each function that is finished.
    sizes: Vec<usize>,
    /// Statements of marked functions that may still be put in place.
    marked: Cell<usize>,
}

impl Inliner {
    fn wants(&self, functions: &[Function], id: FnId, room: usize) -> bool {
        let f = id.0 as usize;
        let size = self.sizes[f];
        match functions[f].mark {
            _ if self.recursive[f] => false,
            Mark::Task => false,
            Mark::Inline => match self.marked.get().checked_sub(size) {
                Some(left) => {
                    self.marked.set(left);
                    true
                }
                None => false,
            },
            Mark::Auto => self.count.get(&id) == Some(&1) || size <= SMALL && size <= room,
        }
    }

    fn function(&self, functions: &[Function], f: &mut Function) {
        let old = std::mem::take(&mut f.vars);
        let body = std::mem::take(&mut f.body);
        let mut copy = Copy {
            inliner: self,
            functions,
            room: LARGEST.saturating_sub(size(&body.stmts)),
            renumber: Renumber::new(&old, old.clone()),
        };
        // The function's own variables keep their numbers; those of callees come after.
        f.body = copy.block(body);
        f.vars = copy.renumber.new;
    }
}

struct Copy<'a> {
    inliner: &'a Inliner,
    functions: &'a [Function],
    room: usize,
    /// Replaces destinations of calls by what the callee yields; holds the growing variable list.
    renumber: Renumber<'a>,
}

impl Copy<'_> {
    fn block(&mut self, block: Block) -> Block {
        let mut stmts = Vec::with_capacity(block.stmts.len());
        for stmt in block.stmts {
            self.stmt(stmt, &mut stmts);
        }
        Block { stmts, results: self.renumber.atoms(&block.results) }
    }

    fn stmt(&mut self, mut stmt: Stmt, out: &mut Vec<Stmt>) {
        for operand in stmt.op.operands_mut() {
            *operand = self.renumber.atom(*operand);
        }
        match &stmt.op {
            Op::Call(id, args) if self.inliner.wants(self.functions, *id, self.room) => {
                let callee = &self.functions[id.0 as usize];
                self.room = self.room.saturating_sub(self.inliner.sizes[id.0 as usize]);
                let results = self.expand(callee, args, out);
                self.renumber.map.extend(stmt.dst.iter().copied().zip(results));
            }
            _ => {
                for block in stmt.op.blocks_mut() {
                    *block = self.block(std::mem::take(block));
                }
                out.push(stmt);
            }
        }
    }

    /// The callee's statements with fresh variables; its results.
    fn expand(&mut self, callee: &Function, args: &[Atom], out: &mut Vec<Stmt>) -> Vec<Atom> {
        let mut fresh = Renumber::new(&callee.vars, std::mem::take(&mut self.renumber.new));
        fresh.map.extend(callee.params.iter().copied().zip(args.iter().copied()));
        let body = fresh.block(&callee.body);
        self.renumber.new = fresh.new;
        out.extend(body.stmts);
        body.results
    }
}
