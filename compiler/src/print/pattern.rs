//! Patterns.

use super::{Doc, name, row, text};
use crate::ast::*;

pub fn pattern(p: &Pattern) -> Doc<'_> {
    match &p.kind {
        PatternKind::Error | PatternKind::Wild => text("_"),
        PatternKind::Name(of) => text(of.as_str()),
        PatternKind::Bool(b) => text(b.to_string()),
        PatternKind::Int(n, negative) => text(format!("{}{n}", if *negative { "-" } else { "" })),
        PatternKind::Uint(n) => text(format!("{n}u")),
        PatternKind::Float(x) => text(format!("{x:?}")),
        PatternKind::Tuple(items) => row("(", items.iter().map(pattern), ")"),
        PatternKind::Constructor(of, fields, rest) => {
            let fields = fields.iter().map(|field| match &field.name {
                Some(label) => name(label).append(": ").append(pattern(&field.pattern)),
                None => pattern(&field.pattern),
            });
            let rest = (*rest == Rest::Present).then(|| text(".."));
            name(of).append(row("(", fields.chain(rest), ")"))
        }
        PatternKind::Or(choices) => Doc::intersperse(choices.iter().map(atom), text(" | ")),
    }
}

/// A pattern where `|` would not be read as a choice.
pub fn atom(p: &Pattern) -> Doc<'_> {
    match p.kind {
        PatternKind::Or(_) => text("(").append(pattern(p)).append(")"),
        _ => pattern(p),
    }
}
