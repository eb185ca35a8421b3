//! Operators: which types they take, which they give.

use super::goals::Placed;
use super::table::{Form, Ty};
use super::{Infer, Want, quoted};
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::source::Span;
use crate::typed::{BinaryOp, UnaryOp};

/// What matters of a type to an operator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Class {
    Unknown,
    Error,
    Literal,
    Bool,
    /// i32, u32 or f32.
    Scalar(Ty),
    Vec(u8),
    IVec(u8),
    Mat(u8),
    Other,
}

impl Infer<'_, '_> {
    pub(super) fn class(&self, ty: Ty) -> Class {
        match self.table.form(ty) {
            Form::Var { literal: true, .. } => Class::Literal,
            Form::Var { .. } => Class::Unknown,
            Form::Error => Class::Error,
            Form::Bool => Class::Bool,
            Form::I32 => Class::Scalar(Ty::I32),
            Form::U32 => Class::Scalar(Ty::U32),
            Form::F32 => Class::Scalar(Ty::F32),
            Form::Vec(n) => Class::Vec(*n),
            Form::IVec(n) => Class::IVec(*n),
            Form::Mat(n) => Class::Mat(*n),
            _ => Class::Other,
        }
    }

    pub(super) fn solve_binary(
        &mut self,
        op: BinaryOp,
        left: Placed,
        right: Placed,
        result: Ty,
        span: Span,
        guess: bool,
    ) -> bool {
        use BinaryOp::*;
        let (l, r) = (self.class(left.0), self.class(right.0));
        if l == Class::Error || r == Class::Error {
            self.table.give_up(result);
            // The other side learns nothing, and need not be reported.
            self.table.give_up(left.0);
            self.table.give_up(right.0);
            return true;
        }
        match op {
            Eq | Ne | Lt | Le | Gt | Ge => self.comparison(op, left, right, span),
            Shl | Shr => self.shift(op, left, right, result, span, guess),
            BitAnd | BitOr | BitXor => self.bits(op, left, right, result, span),
            Add | Sub | Mul | Div | Rem => self.arithmetic(op, left, right, result, span, guess),
        }
    }

    /// Both sides have one type, which the operator must have.
    fn comparison(&mut self, op: BinaryOp, left: Placed, right: Placed, span: Span) -> bool {
        let shown = (self.show(left.0), self.show(right.0));
        if self.table.unify(left.0, right.0).is_err() {
            self.no_operator(op, left, right, shown, span);
            return true;
        }
        if matches!(op, BinaryOp::Eq | BinaryOp::Ne) {
            self.comparable.push((left.0, span));
            return true;
        }
        match self.class(left.0) {
            Class::Unknown => false,
            Class::Literal | Class::Scalar(_) | Class::Error => true,
            _ => {
                self.no_operator(op, left, right, shown, span);
                true
            }
        }
    }

    fn bits(&mut self, op: BinaryOp, left: Placed, right: Placed, result: Ty, span: Span) -> bool {
        let shown = (self.show(left.0), self.show(right.0));
        if self.table.unify(left.0, right.0).is_err() {
            self.no_operator(op, left, right, shown, span);
            self.table.give_up(result);
            return true;
        }
        match self.class(left.0) {
            Class::Unknown => {
                self.result(result, left.0, span);
                !self.table.is_unknown(result)
            }
            Class::Literal | Class::Bool | Class::IVec(_) | Class::Error => self.result(result, left.0, span),
            Class::Scalar(s) if s != Ty::F32 => self.result(result, left.0, span),
            _ => {
                self.no_operator(op, left, right, shown, span);
                self.table.give_up(result);
                true
            }
        }
    }

    /// The count may have either integer type.
    fn shift(
        &mut self,
        op: BinaryOp,
        left: Placed,
        right: Placed,
        result: Ty,
        span: Span,
        guess: bool,
    ) -> bool {
        let shown = (self.show(left.0), self.show(right.0));
        let (l, r) = (self.class(left.0), self.class(right.0));
        let integer = |c: Class| matches!(c, Class::Literal | Class::Scalar(Ty::I32 | Ty::U32));
        if l == Class::Unknown {
            return false;
        }
        if r == Class::Unknown {
            if guess {
                self.require(right.1, right.0, Want::just(left.0));
            }
            return guess;
        }
        if integer(l) && integer(r) {
            return self.result(result, left.0, span);
        }
        self.no_operator(op, left, right, shown, span);
        self.table.give_up(result);
        true
    }

    fn arithmetic(
        &mut self,
        op: BinaryOp,
        left: Placed,
        right: Placed,
        result: Ty,
        span: Span,
        guess: bool,
    ) -> bool {
        use Class::*;
        let (l, r) = (self.class(left.0), self.class(right.0));
        let product = op == BinaryOp::Mul;
        let same_only = matches!(op, BinaryOp::Add | BinaryOp::Sub);
        let ty = match (l, r) {
            (Unknown, _) | (_, Unknown) => return self.arithmetic_unknown(left, right, result, span, guess),
            (Literal | Scalar(_), Literal | Scalar(_)) => {
                let shown = (self.show(left.0), self.show(right.0));
                if self.table.unify(left.0, right.0).is_err() {
                    self.no_operator(op, left, right, shown, span);
                    self.table.give_up(result);
                    return true;
                }
                left.0
            }
            (Vec(n), Vec(m)) | (IVec(n), IVec(m)) if n == m => left.0,
            (Mat(n), Mat(m)) if n == m && (product || same_only) => left.0,
            (Mat(n), Vec(m)) if n == m && product => right.0,
            (Vec(n), Mat(m)) if n == m && product => left.0,
            (Vec(_), Scalar(Ty::F32) | Literal) => self.with_scalar(right, Ty::F32, left.0),
            (Scalar(Ty::F32) | Literal, Vec(_)) => self.with_scalar(left, Ty::F32, right.0),
            (Mat(_), Scalar(Ty::F32) | Literal) if product => self.with_scalar(right, Ty::F32, left.0),
            (Scalar(Ty::F32) | Literal, Mat(_)) if product => self.with_scalar(left, Ty::F32, right.0),
            (IVec(_), Scalar(Ty::I32) | Literal) => self.with_scalar(right, Ty::I32, left.0),
            (Scalar(Ty::I32) | Literal, IVec(_)) => self.with_scalar(left, Ty::I32, right.0),
            _ => {
                let shown = (self.show(left.0), self.show(right.0));
                self.no_operator(op, left, right, shown, span);
                self.table.give_up(result);
                return true;
            }
        };
        self.result(result, ty, span)
    }

    /// A scalar beside a vector or matrix; a literal takes the element's type.
    fn with_scalar(&mut self, scalar: Placed, element: Ty, whole: Ty) -> Ty {
        self.require(scalar.1, scalar.0, Want::just(element));
        whole
    }

    /// What can be said when one operand is not known.
    fn arithmetic_unknown(
        &mut self,
        left: Placed,
        right: Placed,
        result: Ty,
        span: Span,
        guess: bool,
    ) -> bool {
        // Only scalars give a scalar, and only their own kind.
        if let Class::Scalar(_) = self.class(result) {
            // A product of vectors is no scalar either.
            self.require(left.1, left.0, Want::just(result));
            self.require(right.1, right.0, Want::just(result));
            return true;
        }
        let (l, r) = (self.class(left.0), self.class(right.0));
        // u32 has no vectors.
        let certain = [l, r].contains(&Class::Scalar(Ty::U32));
        if (certain || guess) && (l, r) != (Class::Unknown, Class::Unknown) {
            self.require(right.1, right.0, Want::just(left.0));
            return self.result(result, left.0, span);
        }
        false
    }

    fn no_operator(
        &mut self,
        op: BinaryOp,
        left: Placed,
        right: Placed,
        shown: (String, String),
        span: Span,
    ) {
        let symbol = op.symbol();
        let (l, r) = (quoted(&shown.0), quoted(&shown.1));
        let title = match op {
            BinaryOp::Eq | BinaryOp::Ne | BinaryOp::Lt | BinaryOp::Le | BinaryOp::Gt | BinaryOp::Ge
                if l != r =>
            {
                format!("cannot compare {l} with {r}")
            }
            _ if l == r => format!("there is no operator `{symbol}` on {l}"),
            _ => format!("there is no operator `{symbol}` between {l} and {r}"),
        };
        let diagnostic = Diagnostic::error(codes::OPERATOR, span, title)
            .also(left.1, format!("this is {l}"))
            .also(right.1, format!("this is {r}"));
        self.report(match self.operator_help(op, left.0, right.0) {
            Some(help) => diagnostic.help(help),
            None => diagnostic,
        });
    }

    fn operator_help(&self, op: BinaryOp, left: Ty, right: Ty) -> Option<String> {
        use Class::*;
        let other = |side: &str, name: &str| {
            Some(format!("nothing is converted by itself: write `{name}(..)` around the {side} side"))
        };
        match (self.class(left), self.class(right)) {
            (Scalar(Ty::F32), Scalar(Ty::F32) | Literal) | (Literal, Scalar(Ty::F32))
                if op == BinaryOp::BitXor =>
            {
                Some("the power is `pow(x, y)`; integers have bits".to_owned())
            }
            (Scalar(a), Scalar(b)) if a == b => Some("integers have it: convert with `i32(..)`".to_owned()),
            (Scalar(Ty::F32), Scalar(_)) | (Vec(_) | Mat(_), Scalar(_)) => other("right", "f32"),
            (Scalar(_), Scalar(Ty::F32)) | (Scalar(_), Vec(_) | Mat(_)) => other("left", "f32"),
            (Scalar(Ty::I32), Scalar(_)) | (IVec(_), Scalar(_)) => other("right", "i32"),
            (Scalar(_), Scalar(Ty::I32)) | (Scalar(_), IVec(_)) => other("left", "i32"),
            (Bool, Bool) => Some("use `&&`, `||` and `!` on bool".to_owned()),
            (Vec(n), Vec(m)) if n != m => {
                Some(format!("take components, as in `v.{}`", &"xyzw"[..n.min(m) as usize]))
            }
            (Vec(_), Vec(_)) if matches!(op, BinaryOp::Lt | BinaryOp::Le | BinaryOp::Gt | BinaryOp::Ge) => {
                Some("compare components, or `length(..)`".to_owned())
            }
            (Mat(n), Vec(m)) | (Vec(m), Mat(n)) if n != m => {
                Some(format!("a mat{n} goes with a vec{n}"))
            }
            (Other, _) | (_, Other) => {
                Some("structs, tuples, enums and type parameters have no operators: take their parts, or pass a function that does it".to_owned())
            }
            (Mat(_), Mat(_)) if op == BinaryOp::Div => Some("multiply by the inverse".to_owned()),
            _ => None,
        }
    }

    pub(super) fn solve_unary(&mut self, op: UnaryOp, operand: Ty, result: Ty, span: Span) -> bool {
        let class = self.class(operand);
        let fits = match (op, class) {
            // A literal may still become what has no such operator.
            (_, Class::Unknown | Class::Literal) => {
                self.result(result, operand, span);
                return false;
            }
            (_, Class::Error) => true,
            (UnaryOp::Neg, Class::Scalar(s)) => s != Ty::U32,
            (UnaryOp::Neg, Class::Vec(_) | Class::IVec(_) | Class::Mat(_)) => true,
            (UnaryOp::Not, Class::Bool | Class::IVec(_)) => true,
            (UnaryOp::Not, Class::Scalar(s)) => s != Ty::F32,
            _ => false,
        };
        if fits {
            return self.result(result, operand, span);
        }
        self.table.give_up(result);
        let symbol = if op == UnaryOp::Neg { '-' } else { '!' };
        let title = format!("there is no operator `{symbol}` on {}", quoted(&self.show(operand)));
        let diagnostic = Diagnostic::error(codes::OPERATOR, span, title);
        self.report(match (op, class) {
            (UnaryOp::Neg, Class::Scalar(_)) => {
                diagnostic.help("u32 has no negative values: convert with `i32(..)`")
            }
            (UnaryOp::Not, _) => diagnostic.help("`!` is for bool and integers; compare with 0 instead"),
            _ => diagnostic,
        });
        true
    }

    pub(super) fn solve_sum(&mut self, item: Ty, span: Span) -> bool {
        match self.class(item) {
            Class::Unknown => false,
            Class::Bool | Class::Other => {
                let title = format!("`sum` cannot add {}", quoted(&self.show(item)));
                self.report(
                    Diagnostic::error(codes::OPERATOR, span, title)
                        .help("it adds numbers, vectors and matrices; use `fold` for anything else"),
                );
                true
            }
            _ => true,
        }
    }
}
