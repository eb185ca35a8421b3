//! Gives a flat chain of operands and operators its structure by precedence, without recursion.

use super::Context;
use super::mistakes::is_type;
use crate::ast::{Expr, ExprKind, Operator};
use crate::codes;
use crate::diagnostic::Diagnostic;

/// An operator with the bytes it covers.
type Placed = (Operator, usize, usize);

impl Context<'_> {
    pub fn chain(&mut self, head: Vec<(Expr, Placed)>, last: Expr) -> Expr {
        let mut operands = Vec::with_capacity(head.len() + 1);
        let mut operators: Vec<Placed> = Vec::new();
        for (operand, op) in head {
            operands.push(operand);
            while let Some(&waiting) = operators.last()
                && waiting.0.precedence() >= op.0.precedence()
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

    /// `a < b < c`, and `f<i32>(x)`.
    fn check_chained(&mut self, first: Placed, second: Placed) {
        if !first.0.is_comparison() || !second.0.is_comparison() {
            return;
        }
        let (at, before) = (self.span(second.1, second.2), self.span(first.1, first.2));
        let between = self.text[first.2..second.1].trim();
        if first.0.symbol() == "<" && second.0.symbol() == ">" && (is_type(between) || between.len() == 1) {
            let title = "type arguments are not written in a call";
            return self.report_unless_wrong(
                first.1,
                Diagnostic::error(codes::CHAINED, before.to(at), title)
                    .label("read as two comparisons")
                    .help("they are inferred: write `f(x)`; to compare, `a < b && b > c`"),
            );
        }
        self.report_unless_wrong(
            first.1,
            Diagnostic::error(codes::CHAINED, at, "comparisons cannot be chained")
                .label("second comparison")
                .also(before, "first comparison")
                .help("write `a < b && b < c`, or put one comparison in parentheses"),
        );
    }
}
