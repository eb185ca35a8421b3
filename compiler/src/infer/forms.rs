//! The forms that look like calls but are none: `fold sum any all` over a range, `grad` and `deriv`.
//!
//! Their names are not reserved; this is what they mean where nothing shadows them.

use super::call::Given;
use super::goals::GoalKind;
use super::table::{Form, Ty};
use super::tree::{Kind, Node, RangeForm};
use super::{Infer, Want};
use crate::ast::ExprKind;
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::source::Span;
use crate::typed::RangeOp;

#[derive(Clone, Copy)]
enum FormOp {
    Range(RangeOp),
    /// Dimension of the argument.
    Derivative(u8),
}

struct Row {
    name: &'static str,
    op: FormOp,
    arguments: usize,
    example: &'static str,
}

const fn row(name: &'static str, op: FormOp, arguments: usize, example: &'static str) -> Row {
    Row { name, op, arguments, example }
}

const FORMS: &[Row] = &[
    row("fold", FormOp::Range(RangeOp::Fold), 3, "`fold(0..n, init, |acc, i| ..)`"),
    row("sum", FormOp::Range(RangeOp::Sum), 2, "`sum(0..n, |i| ..)`"),
    row("any", FormOp::Range(RangeOp::Any), 2, "`any(0..n, |i| ..)`"),
    row("all", FormOp::Range(RangeOp::All), 2, "`all(0..n, |i| ..)`"),
    row("grad", FormOp::Derivative(2), 1, "`grad(f)` with `f: fn(vec2) -> f32`"),
    row("deriv", FormOp::Derivative(1), 1, "`deriv(f)` with `f: fn(f32) -> f32`"),
];

fn find(name: &str) -> Option<&'static Row> {
    FORMS.iter().find(|row| row.name == name)
}

pub fn is_form(name: &str) -> bool {
    find(name).is_some()
}

pub fn names() -> impl Iterator<Item = &'static str> {
    FORMS.iter().map(|row| row.name)
}

pub fn example(name: &str) -> &'static str {
    find(name).map_or("", |row| row.example)
}

impl Infer<'_, '_> {
    pub(super) fn form_call(&mut self, name: &str, arguments: &[Given], span: Span, want: Want) -> Node {
        let Some(row) = find(name) else { return self.error_node(span) };
        if arguments.len() != row.arguments {
            self.argument_count(name, row.arguments, arguments, span, None);
            self.check_anyway(arguments);
            return self.error_node(span);
        }
        if let Some(named) = arguments.iter().find_map(|a| a.name) {
            self.named_argument(name, named.span);
        }
        match row.op {
            FormOp::Range(op) => self.range(op, row, arguments, span, want),
            FormOp::Derivative(n) => self.derivative(n, arguments[0], span, want),
        }
    }

    fn range(&mut self, op: RangeOp, row: &Row, arguments: &[Given], span: Span, want: Want) -> Node {
        let ExprKind::Range(lo, hi) = &arguments[0].value.kind else {
            if !matches!(arguments[0].value.kind, ExprKind::Error) {
                let title = format!("the first argument of `{}` is a range", row.name);
                self.report(
                    Diagnostic::error(codes::MISPLACED_RANGE, arguments[0].value.span, title)
                        .help(format!("as in {}", row.example)),
                );
            }
            self.check_anyway(arguments);
            return self.error_node(span);
        };
        let why = Some((arguments[0].value.span, "the ends of a range are i32"));
        let lo = self.expr(lo, Want { ty: Ty::I32, why });
        let hi = self.expr(hi, Want { ty: Ty::I32, why });
        let step = arguments[arguments.len() - 1].value;
        let (init, params, result) = match op {
            RangeOp::Fold => {
                let init = arguments[1].value;
                // A known type of the whole explains a wrong start; else the start explains the rest.
                let init = self.expr(init, want);
                let ty = init.ty;
                (Some(init), vec![ty, Ty::I32], ty)
            }
            RangeOp::Sum => (None, vec![Ty::I32], want.ty),
            RangeOp::Any | RangeOp::All => (None, vec![Ty::I32], Ty::BOOL),
        };
        let ty = self.table.add(Form::Fn(params, result));
        let why = match &init {
            Some(init) => Some((init.span, "the accumulator begins with this")),
            None => want.why,
        };
        let f = self.expr(step, Want { ty, why });
        if op == RangeOp::Sum {
            self.goal(GoalKind::Sum { item: result }, step.span);
        }
        let kind = Kind::Range(op, Box::new(RangeForm { lo, hi, init, f }));
        self.settle(kind, result, span, want)
    }

    fn derivative(&mut self, n: u8, argument: Given, span: Span, want: Want) -> Node {
        let ty = if n == 1 { Ty::F32 } else { Ty::vec(n) };
        let takes = self.table.add(Form::Fn(vec![ty], Ty::F32));
        let gives = self.table.add(Form::Fn(vec![ty], ty));
        let why = match n {
            1 => "`deriv` is of a `fn(f32) -> f32`, `grad` of a `fn(vec2) -> f32`",
            _ => "`grad` is of a `fn(vec2) -> f32`, `deriv` of a `fn(f32) -> f32`",
        };
        let before = self.errors;
        let f = self.expr(argument.value, Want { ty: takes, why: Some((span, why)) });
        if self.errors > before {
            return self.error_node(span);
        }
        self.settle(Kind::Derivative(Box::new(f)), gives, span, want)
    }
}
