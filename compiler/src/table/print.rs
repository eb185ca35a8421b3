//! Text of a function table, for `ghyll build --emit table` and for tests.
//!
//! ```text
//! task fib(v0: i32)
//!   v1: bool = lt.i32(v0, 2)
//!   if v1
//!     emit v0
//!   else
//!     v2: i32 = sub.i32(v0, 1)
//!     v3: i32 = sub.i32(v0, 2)
//!     emit v2 fib v3 fib fib.1
//! ```

use super::{Emission, Table, Tail, TailBlock, Token};
use crate::core::print::{self, Printer};

pub fn table(table: &Table) -> String {
    let mut out = String::new();
    for task in &table.tasks {
        let mut printer = Printer::new(&task.vars, &table.helpers);
        printer.line(&format!("task {}({})", task.name, printer.binders(&task.params)));
        tail_block(&mut printer, table, &task.body);
        out += &printer.out;
        out.push('\n');
    }
    for helper in &table.helpers {
        out += &print::function(helper, &table.helpers);
        out.push('\n');
    }
    out
}

/// Tokens of an emission with the tasks' names: `v2 fib v3 fib fib.1`.
pub fn emission(table: &Table, emission: &Emission) -> String {
    let token = |t: &_| match t {
        Token::Literal(atom) => print::atom(*atom),
        Token::Function(f) => table.task(*f).name.clone(),
    };
    emission.iter().map(token).collect::<Vec<_>>().join(" ")
}

fn tail_block(printer: &mut Printer, table: &Table, block: &TailBlock) {
    printer.indent += 1;
    printer.stmts(&block.stmts);
    match &block.tail {
        Tail::Emit(tokens) => printer.line(format!("emit {}", emission(table, tokens)).trim_end()),
        Tail::Again(args) => printer.line(format!("again {}", print::atoms(args)).trim_end()),
        Tail::If(cond, yes, no) => {
            printer.line(&format!("if {}", print::atom(*cond)));
            tail_block(printer, table, yes);
            printer.line("else");
            tail_block(printer, table, no);
        }
    }
    printer.indent -= 1;
}
