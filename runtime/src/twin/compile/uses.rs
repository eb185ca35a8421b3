//! Which variables are read, how often and where.

use ghyll_compiler::core::{Atom, Block, Function, Op, Stmt, Var};
use ghyll_compiler::table::{Tail, TailBlock, Task, Token};

/// Visits a block's statements, nested ones included, outer before inner.
pub fn each_statement(block: &Block, visit: &mut dyn FnMut(&Stmt)) {
    for stmt in &block.stmts {
        each_nested(stmt, visit);
    }
}

fn each_nested(stmt: &Stmt, visit: &mut dyn FnMut(&Stmt)) {
    visit(stmt);
    for block in blocks(&stmt.op) {
        each_statement(block, visit);
    }
}

fn blocks(op: &Op) -> Vec<&Block> {
    match op {
        Op::If(_, yes, no) => vec![yes, no],
        Op::Loop(l) => vec![&l.cond, &l.body],
        _ => vec![],
    }
}

pub fn statements(block: &Block) -> usize {
    let mut count = 0;
    each_statement(block, &mut |_| count += 1);
    count
}

/// Visits the atoms that a statement reads, those of nested blocks included.
fn each_atom(stmt: &Stmt, visit: &mut dyn FnMut(Atom)) {
    each_nested(stmt, &mut |inner| {
        match &inner.op {
            Op::Prim(_, _, args) | Op::Intrinsic(_, args) | Op::Call(_, args) => {
                args.iter().for_each(|a| visit(*a));
            }
            Op::Live(_) => {}
            Op::If(cond, ..) => visit(*cond),
            Op::Loop(l) => l.state.iter().for_each(|(_, first)| visit(*first)),
        }
        for block in blocks(&inner.op) {
            block.results.iter().for_each(|a| visit(*a));
        }
    });
}

pub fn reads(stmt: &Stmt, var: Var) -> bool {
    let mut found = false;
    each_atom(stmt, &mut |a| found |= a == Atom::Var(var));
    found
}

fn count(counts: &mut [u32], atom: Atom) {
    if let Atom::Var(v) = atom {
        counts[v.0 as usize] += 1;
    }
}

/// How often each variable is read.
pub fn of_function(function: &Function) -> Vec<u32> {
    let mut counts = vec![0; function.vars.len()];
    for stmt in &function.body.stmts {
        each_atom(stmt, &mut |a| count(&mut counts, a));
    }
    function.body.results.iter().for_each(|a| count(&mut counts, *a));
    counts
}

pub fn of_task(task: &Task) -> Vec<u32> {
    let mut counts = vec![0; task.vars.len()];
    of_tail_block(&task.body, &mut counts);
    counts
}

fn of_tail_block(block: &TailBlock, counts: &mut [u32]) {
    for stmt in &block.stmts {
        each_atom(stmt, &mut |a| count(counts, a));
    }
    match &block.tail {
        Tail::Emit(emission) => {
            for token in emission {
                if let Token::Literal(a) = token {
                    count(counts, *a);
                }
            }
        }
        Tail::If(cond, yes, no) => {
            count(counts, *cond);
            of_tail_block(yes, counts);
            of_tail_block(no, counts);
        }
        Tail::Again(args) => args.iter().for_each(|a| count(counts, *a)),
    }
}
