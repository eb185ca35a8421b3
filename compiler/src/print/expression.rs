//! Expressions: parentheses by precedence.

use super::pattern::{atom, pattern};
use super::{Doc, INDENT, list, name, text, type_doc};
use crate::ast::*;
use crate::typed::UnaryOp;

/// ` = value`, on a line of its own where it does not fit and does not break well itself.
pub fn defined(value: &Expr) -> Doc<'_> {
    match value.kind {
        ExprKind::Binary(..) | ExprKind::Field(..) | ExprKind::Index(..) | ExprKind::Unary(..) => {
            text(" =").append(Doc::line().append(expr(value)).nest(INDENT)).group()
        }
        _ => text(" = ").append(expr(value)),
    }
}

/// An expression that ends where something begins that it cannot take in.
pub fn expr(e: &Expr) -> Doc<'_> {
    operand(e, 0, true)
}

fn parens(e: &Expr) -> Doc<'_> {
    text("(").append(expr(e)).append(")")
}

/// An operand of an operator, which takes what binds at least as tightly as `least`. A lambda reaches as far right as
/// it can, so it stands last only.
fn operand(e: &Expr, least: u8, last: bool) -> Doc<'_> {
    match &e.kind {
        ExprKind::Binary(op, ..) if op.precedence() >= least => chain(e, last),
        ExprKind::Binary(..) => parens(e),
        ExprKind::Lambda(params, body) if last => lambda(params, body),
        ExprKind::Lambda(..) => parens(e),
        ExprKind::If(..) | ExprKind::Match(..) if !last => parens(e),
        ExprKind::Block(..) if least > 0 => parens(e),
        ExprKind::Unary(op, of) => unary(*op, of),
        ExprKind::Range(lo, hi) => operand(lo, 1, false).append("..").append(expr(hi)),
        _ => postfix(e),
    }
}

/// Operators of one precedence, broken before each of them or none.
fn chain(e: &Expr, last: bool) -> Doc<'_> {
    let ExprKind::Binary(op, ..) = &e.kind else { return postfix(e) };
    let level = op.precedence();
    let (mut first, mut links) = (e, Vec::new());
    while let ExprKind::Binary(op, left, right) = &first.kind
        && op.precedence() == level
        && (links.is_empty() || !op.is_comparison())
    {
        links.push((op, right));
        first = left;
    }
    let mut doc = operand(first, level + 1, false);
    let mut rest = Doc::nil();
    while let Some((op, right)) = links.pop() {
        let right = operand(right, level + 1, last && links.is_empty());
        rest = rest.append(Doc::line()).append(op.symbol()).append(" ").append(right);
    }
    doc = doc.append(rest.nest(INDENT));
    doc.group()
}

fn unary(op: UnaryOp, of: &Expr) -> Doc<'_> {
    let sign = match op {
        UnaryOp::Neg => "-",
        UnaryOp::Not => "!",
    };
    let of = match &of.kind {
        ExprKind::Unary(op, of) => unary(*op, of),
        _ => base(of),
    };
    text(sign).append(of)
}

/// What a postfix stands behind.
fn base(e: &Expr) -> Doc<'_> {
    use ExprKind::*;
    match e.kind {
        Binary(..) | Unary(..) | Lambda(..) | If(..) | Match(..) | Block(..) => parens(e),
        _ => postfix(e),
    }
}

/// `1.x` and `_.0` would be read as numbers.
fn field_base(e: &Expr) -> Doc<'_> {
    use ExprKind::*;
    match e.kind {
        Bool(_) | Int(_) | Uint(_) | Float(_) | Hole => parens(e),
        _ => base(e),
    }
}

fn postfix(e: &Expr) -> Doc<'_> {
    match &e.kind {
        ExprKind::Error | ExprKind::Hole => text("_"),
        ExprKind::Bool(b) => text(b.to_string()),
        ExprKind::Int(n) => text(n.to_string()),
        ExprKind::Uint(n) => text(format!("{n}u")),
        ExprKind::Float(x) => text(format!("{x:?}")),
        ExprKind::Name(of) => text(of.as_str()),
        ExprKind::Call(of, given) => base(of).append(arguments(given)),
        ExprKind::With(of, fields) => base(of).append(" with ").append(arguments(fields)),
        ExprKind::Field(of, field) => field_base(of).append(".").append(name(field)),
        ExprKind::Index(of, index) => base(of).append("[").append(expr(index)).append("]"),
        ExprKind::Tuple(items) => list("(", items.iter().map(expr), ")"),
        ExprKind::Array(items) => list("[", items.iter().map(expr), "]"),
        ExprKind::If(branches, otherwise) => conditional(branches, otherwise),
        ExprKind::Match(of, arms) => {
            let arms = arms.iter().map(|a| Doc::hardline().append(arm(a)));
            let arms = Doc::concat(arms).nest(INDENT);
            text("match ").append(expr(of)).append(" {").append(arms).append(Doc::hardline()).append("}")
        }
        ExprKind::Block(..) => braces(e),
        ExprKind::Binary(..) | ExprKind::Unary(..) | ExprKind::Lambda(..) | ExprKind::Range(..) => parens(e),
    }
}

/// A lambda that ends the arguments keeps them on its first line, and its braces hold the lines.
fn arguments(given: &[Argument]) -> Doc<'_> {
    let one = |argument: &Argument| -> bool {
        matches!(&argument.value.kind, ExprKind::Lambda(_, body) if ends_in_braces(body))
    };
    match given.split_last() {
        Some((last, _)) if one(last) => {
            text("(").append(Doc::intersperse(given.iter().map(argument), text(", "))).append(")")
        }
        _ => list("(", given.iter().map(argument), ")"),
    }
}

fn ends_in_braces(e: &Expr) -> bool {
    matches!(e.kind, ExprKind::Block(..) | ExprKind::Match(..) | ExprKind::If(..))
}

fn argument(argument: &Argument) -> Doc<'_> {
    let label = argument.name.as_ref().map_or(Doc::nil(), |label| name(label).append(": "));
    label.append(expr(&argument.value))
}

fn lambda<'a>(params: &'a [LambdaParam], body: &'a Expr) -> Doc<'a> {
    let params = params.iter().map(|param| {
        let note = param.ty.as_ref().map_or(Doc::nil(), |ty| text(": ").append(type_doc(ty)));
        atom(&param.pattern).append(note)
    });
    super::row("|", params, "| ").append(expr(body))
}

fn conditional<'a>(branches: &'a [(Expr, Expr)], otherwise: &'a Expr) -> Doc<'a> {
    let mut doc = Doc::nil();
    for (index, (condition, value)) in branches.iter().enumerate() {
        let word = if index == 0 { "if " } else { " else if " };
        doc = doc.append(word).append(expr(condition)).append(" ").append(braces(value));
    }
    doc.append(" else ").append(braces(otherwise)).group()
}

/// A block; with names in it on lines of its own, else as the group around it has it.
fn braces(e: &Expr) -> Doc<'_> {
    let (lets, value, line) = match &e.kind {
        ExprKind::Block(lets, value) => (lets.as_slice(), &**value, Doc::hardline()),
        _ => (&[][..], e, Doc::line()),
    };
    let lets = lets.iter().map(|l| {
        let note = l.ty.as_ref().map_or(Doc::nil(), |ty| text(": ").append(type_doc(ty)));
        let head = Doc::hardline().append("let ").append(pattern(&l.pattern)).append(note);
        head.append(defined(&l.value)).append(";")
    });
    let inner = Doc::concat(lets).append(line.clone()).append(expr(value)).nest(INDENT);
    text("{").append(inner).append(line).append("}")
}

fn arm(arm: &Arm) -> Doc<'_> {
    let guard = arm.guard.as_ref().map_or(Doc::nil(), |guard| text(" if ").append(expr(guard)));
    let head = pattern(&arm.pattern).append(guard).append(" => ");
    match arm.value.kind {
        ExprKind::Block(..) => head.append(braces(&arm.value)),
        _ => head.append(expr(&arm.value)).append(","),
    }
}
