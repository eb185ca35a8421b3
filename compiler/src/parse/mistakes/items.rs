//! Habits of declarations and statements.

use super::{NEAR, Place};
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::foreign;
use crate::lexer::Lexeme;

/// `return x`, `for i in ..`, `let mut x`, `a and b`.
pub(super) fn word(p: &Place) -> Option<Diagnostic> {
    let told = |offset: isize| {
        let word = p.name(offset)?;
        let help = foreign::statement(word)?;
        let title = format!("`{word}` means nothing in Ghyll");
        Some(p.error(codes::FOREIGN_WORD, offset, offset, title).help(help))
    };
    // Two operands in a row: one of them is a word that joins or begins something elsewhere.
    if (p.at_item() || p.after_operand())
        && let Some(diagnostic) = told(0)
    {
        return Some(diagnostic);
    }
    let follows = p.starts_operand(0) || matches!(p.lexeme(0)?, Lexeme::LBrace | Lexeme::In);
    if follows { told(-1) } else { None }
}

/// `Option::Some(x)`, `use terrain::bilinear;`.
pub(super) fn path(p: &Place) -> Option<Diagnostic> {
    use Lexeme::*;
    let in_use = matches!((p.lexeme(-2), p.lexeme(-1)), (Some(Use), Some(Ident(_))));
    if in_use && matches!(p.lexeme(0), Some(Colon | Dot)) {
        let title = "a module is used as a whole";
        return Some(
            p.error(codes::PATH, 0, 0, title).help("write `use terrain;`: all its names are in scope then"),
        );
    }
    let colons = (0, 1);
    let at = [(-1, 0), colons]
        .into_iter()
        .find(|&(a, b)| p.lexeme(a) == Some(Colon) && p.lexeme(b) == Some(Colon) && p.joined(a))?;
    let help = "a variant or a module's function is named alone, as in `Some(x)`; types of generic functions are inferred";
    Some(p.error(codes::PATH, at.0, at.1, "there are no names with `::`").help(help))
}

/// `float x = 1.0;`, `vec3 f(vec2 p) { .. }`, `fn f(f32 x)`.
pub(super) fn type_first(p: &Place) -> Option<Diagnostic> {
    let a_type = |word: &str| foreign::type_help(word).is_some() || is_type(word);
    let (from, ty, name) = match (p.name(-1), p.name(0), p.name(1)) {
        (_, Some(ty), Some(name)) if p.at_item() && a_type(ty) => (0, ty, name),
        (Some(ty), Some(name), _) if a_type(ty) => (-1, ty, name),
        _ => return None,
    };
    // The result type of a function, and then something that does not fit.
    if matches!(p.lexeme(from - 1), Some(Lexeme::Arrow | Lexeme::Colon)) {
        return None;
    }
    let shown = foreign::type_name(ty).unwrap_or(ty);
    let after = p.lexeme(from + 2);
    let help = match after {
        Some(Lexeme::LParen) => format!("a function is `fn {name}(x: f32) -> {shown} = ..;`"),
        Some(Lexeme::Assign | Lexeme::Semi) if p.at_item() => {
            format!("a constant is `const {name} = ..;`, what the host sets `param {name}: {shown} = ..;`")
        }
        Some(Lexeme::Assign | Lexeme::Semi) => {
            format!("write `let {name} = ..;` or `let {name}: {shown} = ..;`")
        }
        _ => format!("write `{name}: {shown}`"),
    };
    Some(
        p.error(codes::TYPE_FIRST, from, from + 1, "the type stands behind the name, after a colon")
            .help(help),
    )
}

pub(in crate::parse) fn is_type(word: &str) -> bool {
    crate::resolve::types::PLAIN.iter().any(|(name, _)| *name == word)
}

/// `Ray { origin: o }`, `struct Ray { origin: vec3 }`, `enum E(A, B)`.
pub(super) fn field_braces(p: &Place) -> Option<Diagnostic> {
    use Lexeme::*;
    if (p.lexeme(-1), p.lexeme(0)?) == (Some(With), LBrace) {
        let title = "fields stand in parentheses";
        return Some(p.error(codes::FIELD_BRACES, 0, 0, title).help("write `value with (field: new)`"));
    }
    let help = match (p.lexeme(-2), p.name(-1), p.lexeme(0)?) {
        (Some(Struct), Some(name), LBrace) => format!("write `struct {name}(field: f32);`"),
        (Some(Enum), Some(name), LParen) => {
            let title = "the variants of an enum stand in braces";
            return Some(
                p.error(codes::FIELD_BRACES, 0, 0, title)
                    .help(format!("write `enum {name} {{ A, B(f32) }}`")),
            );
        }
        (_, Some(name), LBrace)
            if p.after_operand() && name.starts_with(|c: char| c.is_ascii_uppercase()) =>
        {
            format!("write `{name}(field: value)`, or the values alone in their order")
        }
        _ => return None,
    };
    Some(p.error(codes::FIELD_BRACES, 0, 0, "fields stand in parentheses").help(help))
}

/// `if let Some(x) = o { .. }`, `let x = 1 in x + 1`.
pub(super) fn conditional_let(p: &Place) -> Option<Diagnostic> {
    let lexeme = p.lexeme(0)?;
    let (from, title, help) = match lexeme {
        Lexeme::Let if p.lexeme(-1) == Some(Lexeme::If) => {
            (-1, "there is no `if let`", "write `match o { Some(x) => .., None => .. }`")
        }
        Lexeme::Let if p.wants_operand() => (
            0,
            "a `let` stands in a block",
            "write `{ let x = ..; value }`, whose value is the last expression",
        ),
        Lexeme::In if p.after_operand() => {
            let statement = (0..p.at).rev().take(NEAR).map(|i| p.cx.lexemes[i].1);
            let mut begins = statement.filter(|l| matches!(l, Lexeme::Let | Lexeme::Semi | Lexeme::LBrace));
            if begins.next() != Some(Lexeme::Let) {
                return None;
            }
            (0, "a `let` ends with `;`", "write `let x = ..;` and the value after it")
        }
        _ => return None,
    };
    Some(p.error(codes::FOREIGN_WORD, from, 0, title).help(help))
}

/// `[a, b] =>`, `x @ Some(_) =>`, `(a, ..) =>`.
pub(super) fn foreign_pattern(p: &Place) -> Option<Diagnostic> {
    // What follows a pattern, or a pattern itself.
    let in_pattern = p.expects("=>") || p.expects("_") && p.expects("float") && !p.expects("[");
    let (title, help) = match p.lexeme(0)? {
        Lexeme::LBracket if p.expects("_") && !p.expects("[") && p.lexeme(-1) != Some(Lexeme::Colon) => (
            "there are no patterns of arrays",
            "match a tuple of the elements meant: `match (a[0], a[1]) { (0, x) => .., _ => .. }`",
        ),
        Lexeme::At if p.name(-1).is_some() && in_pattern => (
            "a pattern names either the whole or its parts",
            "give the whole a name before: `let x = ..; match x { Some(y) => .., None => .. }`",
        ),
        Lexeme::DotDot if in_pattern && matches!(p.lexeme(-1), Some(Lexeme::Comma | Lexeme::LParen)) => (
            "a pattern of a tuple has all its components",
            "write `_` for each one that does not matter: `(a, _, _)`",
        ),
        _ => return None,
    };
    Some(p.error(codes::FOREIGN_PATTERN, 0, 0, title).help(help))
}

/// `fn` within a block.
pub(super) fn local_function(p: &Place) -> Option<Diagnostic> {
    let named = p.lexeme(0)? == Lexeme::Fn && (p.name(1).is_some() || p.lexeme(1) == Some(Lexeme::LParen));
    if !named || !p.wants_operand() {
        return None;
    }
    Some(
        p.error(codes::LOCAL_FUNCTION, 0, 0, "a function is not defined within an expression")
            .help("move it to the top level, or name a lambda: `let f = |x: f32| ..;`"),
    )
}

/// `let x;`, `const A: f32;`, `param p: f32;`.
pub(super) fn no_value(p: &Place) -> Option<Diagnostic> {
    if p.lexeme(0)? != Lexeme::Semi || !p.expects("=") {
        return None;
    }
    let begins = (0..p.at).rev().take(NEAR).find_map(|i| match p.cx.lexemes[i].1 {
        Lexeme::Let => {
            Some(("`let`", "write `let x = ..;` where the value is known; `if` and `match` have values too"))
        }
        Lexeme::Const => Some(("constant", "write `const NAME = ..;`")),
        Lexeme::Param => Some((
            "parameter",
            "write `param name: f32 = 1.0;`, with the value it has when the host sets none",
        )),
        Lexeme::Type => Some(("alias", "write `type Name = f32;`")),
        Lexeme::Fn => Some((
            "function",
            "write `fn name(x: f32) -> f32 = ..;`; functions need no declaration before they are used",
        )),
        _ => None,
    });
    let (what, help) = begins?;
    Some(p.error(codes::NO_VALUE, 0, 0, format!("this {what} has no value")).label("expected `=`").help(help))
}

/// `let` at top level, an expression, a stray `;` or `}`.
pub(super) fn not_an_item(p: &Place) -> Option<Diagnostic> {
    use Lexeme::*;
    if !p.at_item() {
        return None;
    }
    let (title, help) = match p.lexeme(0)? {
        Let => ("a `let` stands in a block", "at top level write `const NAME = ..;`"),
        Semi => ("this `;` ends nothing", "remove it: after `}` an item has ended"),
        RBrace | RParen | RBracket => ("this closes nothing", "remove it, or look above for the opening one"),
        If | Match | Int(_) | Uint(_) | Float(_) | LParen | LBrace | LBracket | True | False => (
            "an expression stands in a function",
            "write `fn main() -> f32 = ..;`, whose value `ghyll run` prints",
        ),
        Ident(_) if matches!(p.lexeme(1), Some(LParen)) => (
            "a call stands in a function, and a function begins with `fn`",
            "write `fn name(x: f32) -> f32 = ..;`",
        ),
        Ident(_) if matches!(p.lexeme(1), Some(Assign)) => {
            ("a definition begins with a word that says what it is", "write `const NAME = ..;`")
        }
        _ => return None,
    };
    Some(p.error(codes::NOT_AN_ITEM, 0, 0, title).help(help))
}
