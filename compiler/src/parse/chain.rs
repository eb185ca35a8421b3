//! Gives a flat chain of operands and operators its structure by precedence, without recursion.

use super::Context;
use crate::ast::{Expr, ExprKind, Operator};
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::typed::BinaryOp::*;

/// An operator with the bytes it covers.
type Placed = (Operator, usize, usize);

const COMPARISON: u8 = 4;

/// How tightly an operator binds; all associate to the left.
fn precedence(op: Operator) -> u8 {
    match op {
        Operator::Pipe => 1,
        Operator::Or => 2,
        Operator::And => 3,
        Operator::Plain(Eq | Ne | Lt | Le | Gt | Ge) => COMPARISON,
        Operator::Plain(BitOr) => 5,
        Operator::Plain(BitXor) => 6,
        Operator::Plain(BitAnd) => 7,
        Operator::Plain(Shl | Shr) => 8,
        Operator::Plain(Add | Sub) => 9,
        Operator::Plain(Mul | Div | Rem) => 10,
    }
}

impl Context<'_> {
    pub fn chain(&mut self, head: Vec<(Expr, Placed)>, last: Expr) -> Expr {
        let mut operands = Vec::with_capacity(head.len() + 1);
        let mut operators: Vec<Placed> = Vec::new();
        for (operand, op) in head {
            operands.push(operand);
            while let Some(&waiting) = operators.last()
                && precedence(waiting.0) >= precedence(op.0)
            {
                self.check_chained(waiting, op);
                operators.pop();
                self.combine(&mut operands, waiting);
            }
            operators.push(op);
        }
        operands.push(last);
        while let Some(waiting) = operators.pop() {
            self.combine(&mut operands, waiting);
        }
        operands.pop().expect("a chain has at least one operand")
    }

    fn combine(&mut self, operands: &mut Vec<Expr>, (op, ..): Placed) {
        let right = operands.pop().expect("two operands for each operator");
        let left = operands.pop().expect("two operands for each operator");
        let (start, end) = (left.span.start as usize, right.span.end as usize);
        operands.push(self.expr(ExprKind::Binary(op, Box::new(left), Box::new(right)), start, end));
    }

    fn check_chained(&mut self, first: Placed, second: Placed) {
        if precedence(first.0) != COMPARISON || precedence(second.0) != COMPARISON {
            return;
        }
        let (at, before) = (self.span(second.1, second.2), self.span(first.1, first.2));
        self.report_unless_wrong(
            first.1,
            Diagnostic::error(codes::CHAINED, at, "comparisons cannot be chained")
                .label("second comparison")
                .also(before, "first comparison")
                .help("write `a < b && b < c`, or put one comparison in parentheses"),
        );
    }
}
