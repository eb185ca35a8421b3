//! Habits within expressions.

use super::items::is_type;
use super::{NEAR, Place};
use crate::codes;
use crate::diagnostic::{Diagnostic, misplaced_range};
use crate::foreign;
use crate::lexer::Lexeme;
use crate::source::Span;

/// `x += 1`, `i++`, `a ** b`, `a === b`, `a <> b`, `a => b` for at least.
pub(super) fn compound_operator(p: &Place) -> Option<Diagnostic> {
    use Lexeme::*;
    let pair = |from: isize| match (p.lexeme(from)?, p.lexeme(from + 1)?) {
        _ if !p.joined(from) => None,
        (Plus, Plus) => {
            Some(("++", "nothing changes its value: write `x + 1` where the next value is needed"))
        }
        (Minus, Minus) => {
            Some(("--", "nothing changes its value: write `x - 1` where the next value is needed"))
        }
        (Star, Star) => Some(("**", "the power is `pow(x, y)`")),
        (Plus | Minus | Star | Slash | Percent | Amp | Bar | Caret | AndAnd | OrOr | Shl, Assign)
        | (GtJoint, GtEq) => Some(("op=", "nothing changes its value: write `let y = x + 1;`")),
        (EqEq, Assign) => Some(("===", "to compare, write `==`")),
        (NotEq, Assign) => Some(("!==", "to compare, write `!=`")),
        (Lt, Gt) => Some(("<>", "to compare, write `!=`")),
        (Assign, Lt) => Some(("=<", "at most is `a <= b`")),
        (Colon, Assign) => Some((":=", "write `let x = ..;`")),
        (DotDot, Assign) => Some(("..=", "ranges end before their second number: write `0..n + 1`")),
        (Lt, Minus) => Some(("<-", "write `let x = ..;`")),
        _ => None,
    };
    // `- -` may be two signs: seen only once nothing follows that they could belong to.
    let decrement = |from: isize| pair(from).filter(|(operator, _)| *operator == "--");
    let (from, (operator, help)) = match [-1, 0].into_iter().find_map(|from| Some((from, pair(from)?))) {
        Some(found) => found,
        None => (-2, decrement(-2)?),
    };
    if operator == "--" && (p.at_item() || p.begins_line(from)) {
        let title = "`--` begins no comment";
        return Some(
            p.error(codes::FOREIGN_OPERATOR, from, from + 1, title)
                .help("a comment is `// ..` or `/* .. */`"),
        );
    }
    let title = match operator {
        "op=" => "there are no operators that change a name's value".to_owned(),
        _ => format!("there is no operator `{operator}`"),
    };
    Some(p.error(codes::FOREIGN_OPERATOR, from, from + 1, title).help(help))
}

/// `x => e`, `(x) => e`, `(x) -> e`.
pub(super) fn lambda(p: &Place) -> Option<Diagnostic> {
    let arrow = match p.lexeme(0)? {
        Lexeme::FatArrow => "=>",
        Lexeme::Arrow => "->",
        _ => return None,
    };
    if arrow == "->" && p.expects("=>") {
        let title = "an arm of a `match` is written `pattern => value`";
        return Some(p.error(codes::SYNTAX, 0, 0, title).label("`=>` belongs here"));
    }
    if !p.after_operand() && !p.wants_operand() {
        return None;
    }
    let title = format!("`{arrow}` does not stand between expressions");
    Some(p.error(codes::NOT_A_LAMBDA, 0, 0, title).help(match arrow {
        "=>" => "a function without a name is `|x| ..`; at least is written `a >= b`",
        _ => "a function without a name is `|x| ..`; a field is read by `value.field`",
    }))
}

/// `(float) x`.
pub(super) fn cast(p: &Place) -> Option<Diagnostic> {
    let word = p.name(-2)?;
    let parenthesised = p.lexeme(-3) == Some(Lexeme::LParen) && p.lexeme(-1) == Some(Lexeme::RParen);
    let ty = foreign::type_name(word).or(is_type(word).then_some(word))?;
    if !parenthesised || !p.starts_operand(0) {
        return None;
    }
    let help = format!("a conversion is a call: `{ty}(..)`");
    Some(p.error(codes::CAST, -3, -1, "there are no casts").help(help))
}

pub(super) fn text(p: &Place) -> Option<Diagnostic> {
    if !matches!(p.lexeme(0)?, Lexeme::Text(_)) || !p.wants_operand() {
        return None;
    }
    Some(
        p.error(codes::TEXT, 0, 0, "a text is no value")
            .help("texts only name files, in `use \"file.ghyll\";`: use a number, or an enum with a name for each choice"),
    )
}

/// `x = 1;`, `if x = 1 { .. }`.
pub(super) fn assignment(p: &Place) -> Option<Diagnostic> {
    use Lexeme::{Comma, LParen};
    if p.lexeme(0)? != Lexeme::Assign {
        return None;
    }
    if p.in_header() && p.expects(")") {
        let title = "a parameter has no default value";
        return Some(
            p.error(codes::ASSIGNMENT, 0, 0, title)
                .help("give the value in the call, or define a second function that calls this one"),
        );
    }
    if !p.after_operand() {
        return None;
    }
    if let (Some(LParen | Comma), Some(field)) = (p.lexeme(-2), p.name(-1))
        && p.expects(")")
    {
        let title = "a field is given with a colon";
        return Some(
            p.error(codes::ASSIGNMENT, 0, 0, title)
                .label("`:` belongs here")
                .help(format!("write `{field}: ..`; the arguments of a function have no names")),
        );
    }
    let name = p.name(-1).unwrap_or("x");
    Some(
        p.error(codes::ASSIGNMENT, 0, 0, "`=` neither compares nor changes a value")
            .label("not here")
            .help(format!("to compare, write `==`; to give a name to a value, `let {name} = ..;`")),
    )
}

/// `if c { a }` and then something else.
pub(super) fn no_else(p: &Place) -> Option<Diagnostic> {
    use Lexeme::*;
    if !p.expects("else")
        || p.lexeme(-1) != Some(RBrace)
        || matches!(p.lexeme(0)?, Semi | Comma | RParen | RBracket)
    {
        return None;
    }
    let mut depth = 0usize;
    let lexemes = &p.cx.lexemes;
    let at = (0..p.at).rev().take(16 * NEAR).find(|&i| {
        match lexemes[i].1 {
            RBrace | RParen | RBracket => depth += 1,
            LBrace | LParen | LBracket => depth = depth.saturating_sub(1),
            _ => {}
        }
        depth == 0 && lexemes[i].1 == If
    })?;
    let (start, _, end) = lexemes[at];
    Some(if_without_else(p.cx.span(start, end)))
}

pub(in crate::parse) fn if_without_else(at: Span) -> Diagnostic {
    Diagnostic::error(codes::IF_WITHOUT_ELSE, at, "this `if` has no `else`")
        .label("has no value when the condition is false")
        .help("`if` is an expression: add `else { .. }`")
}

/// `let r = 0..n;`
pub(super) fn range(p: &Place) -> Option<Diagnostic> {
    if p.lexeme(0)? != Lexeme::DotDot || !p.after_operand() {
        return None;
    }
    let (start, _, end) = p.cx.lexemes[p.at];
    Some(misplaced_range(p.cx.span(start, end)))
}

/// `&x`, `*x`.
pub(super) fn reference(p: &Place) -> Option<Diagnostic> {
    let symbol = match p.lexeme(0)? {
        Lexeme::Amp | Lexeme::AndAnd => '&',
        Lexeme::Star => '*',
        _ => return None,
    };
    if !(p.wants_operand() || p.expects("fn") && p.expects("[")) || !p.starts_operand(1) {
        return None;
    }
    let title = "there are no references and pointers";
    Some(p.error(codes::REFERENCE, 0, 0, title).help(format!(
        "leave out the `{symbol}`: everything is passed as a value, and what is not used costs nothing"
    )))
}

/// `if c a else b`, `else b`.
pub(super) fn branch_braces(p: &Place) -> Option<Diagnostic> {
    if !p.expects("{") || !p.starts_operand(0) {
        return None;
    }
    let after_else = p.lexeme(-1) == Some(Lexeme::Else);
    // After a condition a block may follow, and so may all that goes on with an expression.
    let after_condition = p.after_operand() && !p.expects(";") && !p.expects(",") && !p.expects(")");
    let in_match = (0..p.at).rev().take(NEAR).find_map(|i| match p.cx.lexemes[i].1 {
        Lexeme::If | Lexeme::Match => Some(p.cx.lexemes[i].1 == Lexeme::Match),
        _ => None,
    });
    if !after_else && (!after_condition || in_match != Some(false)) {
        return None;
    }
    Some(
        p.error(codes::BRANCH_BRACES, 0, 0, "the branches of an `if` stand in braces")
            .label("`{` belongs before this")
            .help("write `if c { a } else { b }`"),
    )
}
