//! What people probably meant where a lexeme does not fit: habits of other languages, each with what Ghyll has instead.

use super::Context;
use crate::codes;
use crate::diagnostic::{Diagnostic, misplaced_range};
use crate::foreign;
use crate::lexer::Lexeme;

/// The lexeme that does not fit, and its neighbours.
pub(super) struct Place<'a, 's> {
    cx: &'a Context<'s>,
    at: usize,
    expected: &'a [String],
}

/// The first that recognises the place speaks.
const RULES: &[fn(&Place) -> Option<Diagnostic>] = &[
    compound_operator,
    lambda,
    word,
    path,
    type_first,
    cast,
    text,
    field_braces,
    assignment,
    range,
    reference,
    branch_braces,
    local_function,
    no_value,
    not_an_item,
];

/// These throw the parser out of step: what it says up to the next item follows from them.
const DISTURBING: &[&str] = &[
    codes::FOREIGN_WORD,
    codes::TYPE_FIRST,
    codes::FIELD_BRACES,
    codes::CAST,
    codes::PATH,
    codes::BRANCH_BRACES,
    codes::LOCAL_FUNCTION,
    codes::NOT_A_LAMBDA,
];

/// What it says up to the next semicolon follows from these.
const PASSING: &[&str] = &[
    codes::ASSIGNMENT,
    codes::FOREIGN_OPERATOR,
    codes::TEXT,
    codes::NOT_AN_ITEM,
    codes::REFERENCE,
    codes::MISPLACED_RANGE,
];

/// How many lexemes back a rule looks.
const NEAR: usize = 64;

impl Context<'_> {
    /// A particular message for the lexeme that begins at `start`, if it is recognised.
    pub(super) fn mistake(&self, start: usize, expected: &[String]) -> Option<Diagnostic> {
        let at = self.lexemes.partition_point(|&(from, ..)| from < start);
        let place = Place { cx: self, at, expected };
        let found = RULES.iter().find_map(|rule| rule(&place))?;
        Some(found)
    }

    /// Silences what follows from a message at that lexeme.
    pub(super) fn silence_after(&mut self, place: usize, code: &str) {
        let passing = PASSING.contains(&code);
        if !passing && !DISTURBING.contains(&code) {
            return;
        }
        let ends = |lexeme: &Lexeme| starts_item(lexeme) || passing && *lexeme == Lexeme::Semi;
        let rest = self.lexemes.iter().skip(place + 1);
        self.silent_to = place + 1 + rest.take_while(|(_, lexeme, _)| !ends(lexeme)).count();
    }
}

fn starts_item(lexeme: &Lexeme) -> bool {
    use Lexeme::*;
    matches!(lexeme, Use | Const | Param | Raster | Fn | Struct | Enum | Type | At)
}

impl<'s> Place<'_, 's> {
    /// The lexeme some places further on, or back.
    fn lexeme(&self, offset: isize) -> Option<Lexeme<'s>> {
        let at = self.at.checked_add_signed(offset)?;
        self.cx.lexemes.get(at).map(|&(_, lexeme, _)| lexeme)
    }

    fn name(&self, offset: isize) -> Option<&'s str> {
        match self.lexeme(offset)? {
            Lexeme::Ident(name) => Some(name),
            _ => None,
        }
    }

    /// Whether nothing stands between this lexeme and the next one.
    fn joined(&self, offset: isize) -> bool {
        let end = |at: Option<usize>| at.and_then(|at| self.cx.lexemes.get(at));
        let here = end(self.at.checked_add_signed(offset));
        let next = end(self.at.checked_add_signed(offset + 1));
        matches!((here, next), (Some(&(.., end)), Some(&(start, ..))) if end == start)
    }

    fn expects(&self, what: &str) -> bool {
        self.expected.iter().any(|e| e.trim_matches('"') == what)
    }

    /// An expression could begin here.
    fn wants_operand(&self) -> bool {
        self.expects("float") && self.expects("(")
    }

    /// An expression has ended here. The parser may have closed it already when it finds that nothing fits.
    fn after_operand(&self) -> bool {
        use Lexeme::*;
        let closed = || {
            let ends = matches!(
                self.lexeme(-1),
                Some(Ident(_) | Int(_) | Uint(_) | Float(_) | True | False | RParen | RBracket | RBrace)
            );
            ends && [";", "}", "{", ",", ")", "]"].into_iter().any(|end| self.expects(end))
                && !self.in_header()
        };
        self.expects("==") || closed()
    }

    /// Between the word that begins an item or a `let` and its value: names, types and patterns.
    fn in_header(&self) -> bool {
        use Lexeme::*;
        let before =
            self.cx.lexemes[..self.at.min(self.cx.lexemes.len())].iter().rev().map(|(_, lexeme, _)| lexeme);
        let stop = |lexeme: &&Lexeme| {
            starts_item(lexeme) || matches!(lexeme, Let | Assign | LBrace | Semi | FatArrow)
        };
        before.take(NEAR).find(stop).map_or(self.at < NEAR, |lexeme| starts_item(lexeme) || *lexeme == Let)
    }

    fn at_item(&self) -> bool {
        self.expects("struct") && self.expects("raster")
    }

    fn starts_operand(&self, offset: isize) -> bool {
        use Lexeme::*;
        self.lexeme(offset).is_some_and(|lexeme| {
            matches!(
                lexeme,
                Ident(_) | Int(_) | Uint(_) | Float(_) | LParen | True | False | If | Match | Bang
            )
        })
    }

    fn error(&self, code: &'static str, from: isize, to: isize, title: impl Into<String>) -> Diagnostic {
        let at = |offset: isize| self.at.saturating_add_signed(offset).min(self.cx.lexemes.len() - 1);
        let (start, end) = (self.cx.lexemes[at(from)].0, self.cx.lexemes[at(to)].2);
        Diagnostic::error(code, self.cx.span(start, end), title)
    }
}

/// `x += 1`, `i++`, `a ** b`, `a === b`, `a <> b`, `a => b` for at least.
fn compound_operator(p: &Place) -> Option<Diagnostic> {
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
    let title = match operator {
        "op=" => "there are no operators that change a name's value".to_owned(),
        _ => format!("there is no operator `{operator}`"),
    };
    Some(p.error(codes::FOREIGN_OPERATOR, from, from + 1, title).help(help))
}

/// `x => e`, `(x) => e`, `(x) -> e`.
fn lambda(p: &Place) -> Option<Diagnostic> {
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

/// `return x`, `for i in ..`, `let mut x`, `a and b`.
fn word(p: &Place) -> Option<Diagnostic> {
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
fn path(p: &Place) -> Option<Diagnostic> {
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
fn type_first(p: &Place) -> Option<Diagnostic> {
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

fn is_type(word: &str) -> bool {
    crate::resolve::types::PLAIN.iter().any(|(name, _)| *name == word)
}

/// `(float) x`.
fn cast(p: &Place) -> Option<Diagnostic> {
    let word = p.name(-2)?;
    let parenthesised = p.lexeme(-3) == Some(Lexeme::LParen) && p.lexeme(-1) == Some(Lexeme::RParen);
    let ty = foreign::type_name(word).or(is_type(word).then_some(word))?;
    if !parenthesised || !p.starts_operand(0) {
        return None;
    }
    let help = format!("a conversion is a call: `{ty}(..)`");
    Some(p.error(codes::CAST, -3, -1, "there are no casts").help(help))
}

fn text(p: &Place) -> Option<Diagnostic> {
    if !matches!(p.lexeme(0)?, Lexeme::Text(_)) || !p.wants_operand() {
        return None;
    }
    Some(
        p.error(codes::TEXT, 0, 0, "a text is no value")
            .help("texts only name files, in `use \"file.ghyll\";`: use a number, or an enum with a name for each choice"),
    )
}

/// `Ray { origin: o }`, `struct Ray { origin: vec3 }`, `enum E(A, B)`.
fn field_braces(p: &Place) -> Option<Diagnostic> {
    use Lexeme::*;
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

/// `x = 1;`, `if x = 1 { .. }`.
fn assignment(p: &Place) -> Option<Diagnostic> {
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
    let name = p.name(-1).unwrap_or("x");
    Some(
        p.error(codes::ASSIGNMENT, 0, 0, "`=` neither compares nor changes a value")
            .label("not here")
            .help(format!("to compare, write `==`; to give a name to a value, `let {name} = ..;`")),
    )
}

/// `let r = 0..n;`
fn range(p: &Place) -> Option<Diagnostic> {
    if p.lexeme(0)? != Lexeme::DotDot || !p.after_operand() {
        return None;
    }
    let (start, _, end) = p.cx.lexemes[p.at];
    Some(misplaced_range(p.cx.span(start, end)))
}

/// `&x`, `*x`.
fn reference(p: &Place) -> Option<Diagnostic> {
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
fn branch_braces(p: &Place) -> Option<Diagnostic> {
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

/// `fn` within a block.
fn local_function(p: &Place) -> Option<Diagnostic> {
    let named = p.lexeme(0)? == Lexeme::Fn && (p.name(1).is_some() || p.lexeme(1) == Some(Lexeme::LParen));
    if !named || !p.wants_operand() || !p.cx.unclosed.is_empty() {
        return None;
    }
    Some(
        p.error(codes::LOCAL_FUNCTION, 0, 0, "a function is not defined within an expression")
            .help("move it to the top level, or name a lambda: `let f = |x: f32| ..;`"),
    )
}

/// `let x;`, `const A: f32;`, `param p: f32;`.
fn no_value(p: &Place) -> Option<Diagnostic> {
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
fn not_an_item(p: &Place) -> Option<Diagnostic> {
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
