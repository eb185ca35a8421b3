//! Runs lexer and grammar, and builds the nodes that need more than the grammar knows: operator chains,
//! bounded depth, and messages for what is almost right.

mod brackets;
mod chain;
mod errors;
mod mistakes;

use std::cell::Cell;
use std::collections::BTreeSet;
use std::rc::Rc;

use lalrpop_util::{ErrorRecovery, lalrpop_mod};

use crate::ast::*;
use crate::codes::{self, Code};
use crate::diagnostic::Diagnostic;
use crate::lexer::{Lexed, Lexeme, lex};
use crate::source::{SourceId, Span};
use crate::typed::{Attributes, UnaryOp};

pub use errors::KEYWORDS;

lalrpop_mod!(
    #[allow(clippy::all)]
    #[rustfmt::skip]
    grammar
);

/// Deepest expression tree. Later phases recurse on it.
pub const MAX_DEPTH: u32 = 500;
/// Deepest type as written.
const MAX_TYPE_DEPTH: u32 = 64;

/// What was parsed; not to be looked at when there are errors among the diagnostics.
#[derive(Debug)]
pub struct Parsed<T> {
    pub tree: T,
    pub diagnostics: Vec<Diagnostic>,
}

/// Parses a whole text.
pub fn file(source: SourceId, text: &str) -> Parsed<File> {
    parse(source, text, |cx, lexemes| {
        let lexemes = cx.until_given_up(lexemes);
        grammar::FileParser::new().parse(cx, lexemes).unwrap_or_else(|e| {
            cx.syntax_error(e);
            Vec::new()
        })
    })
}

/// Parses a text that is one expression.
pub fn expression(source: SourceId, text: &str) -> Parsed<Expr> {
    parse(source, text, |cx, lexemes| {
        let lexemes = cx.until_given_up(lexemes);
        grammar::ExprParser::new().parse(cx, lexemes).unwrap_or_else(|e| {
            cx.syntax_error(e);
            cx.expr(ExprKind::Error, 0, 0)
        })
    })
}

/// Missing semicolons put in before the rest of the text is left as it is.
const MOST_REPAIRS: usize = 64;
/// Lexemes that are read again for the sake of repairs.
const MOST_READ: usize = 1 << 19;
/// Places where parsing goes on after an error. Each costs far more than a lexeme that fits, and few of so many are told.
const MOST_RECOVERIES: usize = 5_000;

fn parse<T>(
    source: SourceId,
    text: &str,
    run: impl for<'s> Fn(&mut Context<'s>, &[Spanned<'s>]) -> T,
) -> Parsed<T> {
    let Lexed { mut lexemes, mut diagnostics, .. } = lex(source, text);
    let has = |codes: &[Code]| diagnostics.iter().any(|d| codes.contains(&d.code));
    // The text was cut off: what follows would only repeat that.
    let cut = has(&[codes::TOO_DEEP, codes::TOO_LONG]);
    // A text without its end may hold the brackets that are missed.
    let swallowed = has(&[codes::UNTERMINATED]);
    let mut doubtful = Vec::new();
    if !cut && let Some(repaired) = brackets::repair(source, text, &lexemes) {
        (lexemes, doubtful) = (repaired.lexemes, repaired.doubtful);
        if !swallowed {
            diagnostics.extend(repaired.diagnostics);
        }
    }
    let mut repairs: Vec<Diagnostic> = Vec::new();
    let (tree, cx) = loop {
        let index =
            |d: &Diagnostic| lexemes.partition_point(|&(_, _, end)| end <= d.primary.0.start as usize);
        let errors_at = diagnostics.iter().map(index).collect();
        let mut cx = Context {
            source,
            text_end: text.len(),
            text,
            lexemes: lexemes.clone(),
            diagnostics: Vec::new(),
            too_deep: false,
            errors_at,
            missing: None,
            silent_to: 0,
            recoveries: 0,
            given_up: Rc::default(),
        };
        let tree = run(&mut cx, &lexemes);
        // What follows a missing semicolon is read as if it stood there.
        match cx.missing.take() {
            Some((place, diagnostic))
                if repairs.len() < MOST_REPAIRS && repairs.len() * lexemes.len() < MOST_READ =>
            {
                let before = lexemes.partition_point(|&(start, _, _)| start < place);
                let at = before.checked_sub(1).map_or(place, |i| lexemes[i].2);
                lexemes.insert(before, (at, Lexeme::Semi, at));
                repairs.push(diagnostic);
            }
            _ => break (tree, cx),
        }
    };
    let mut all = diagnostics;
    if !cut {
        let is_doubtful = |d: &Diagnostic| {
            let at = d.primary.0.start as usize;
            doubtful.iter().any(|&(from, to)| from <= at && at < to)
        };
        all.extend(repairs.into_iter().chain(cx.diagnostics).filter(|d| !is_doubtful(d)));
    }
    for diagnostic in &mut all {
        whole_characters(text, &mut diagnostic.primary.0);
    }
    all.sort_by_key(|d| d.primary.0.start);
    Parsed { tree, diagnostics: all }
}

/// A place one byte before a lexeme may lie within a character that the language does not use.
fn whole_characters(text: &str, span: &mut Span) {
    while !text.is_char_boundary(span.start as usize) {
        span.start -= 1;
    }
    while !text.is_char_boundary(span.end as usize) {
        span.end += 1;
    }
}

type Spanned<'s> = (usize, Lexeme<'s>, usize);

/// What the grammar's actions share.
pub struct Context<'s> {
    source: SourceId,
    text: &'s str,
    text_end: usize,
    lexemes: Vec<Spanned<'s>>,
    diagnostics: Vec<Diagnostic>,
    too_deep: bool,
    /// Indices of the lexemes where something was wrong.
    errors_at: BTreeSet<usize>,
    /// A semicolon is missing before this place, the first syntax error.
    missing: Option<(usize, Diagnostic)>,
    /// Syntax errors before this lexeme follow from one that was told.
    silent_to: usize,
    recoveries: usize,
    /// There were too many errors: the rest of the text is not read.
    given_up: Rc<Cell<bool>>,
}

/// A field of a constructor pattern.
pub enum Field {
    Pattern(FieldPattern),
    Rest(Span),
}

impl Context<'_> {
    pub fn span(&self, start: usize, end: usize) -> Span {
        Span::new(self.source, start, end.max(start))
    }

    fn until_given_up<'l, 's>(
        &self,
        lexemes: &'l [Spanned<'s>],
    ) -> impl Iterator<Item = Result<Spanned<'s>, ()>> + use<'l, 's> {
        let given_up = Rc::clone(&self.given_up);
        lexemes.iter().take_while(move |_| !given_up.get()).map(|&lexeme| Ok(lexeme))
    }

    fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    /// Reports unless something behind that place is wrong already, of which this would be a consequence.
    fn report_unless_wrong(&mut self, start: usize, diagnostic: Diagnostic) {
        // They come in the order of the text, but for a few of one place.
        if !self.is_silent(start)
            && !self.diagnostics.iter().rev().take(4).any(|d| d.primary.0.end as usize > start)
        {
            self.report(diagnostic);
        }
    }

    pub fn recovered(&mut self, e: ErrorRecovery<usize, Lexeme, ()>, _start: usize, _end: usize) {
        self.syntax_error(e.error);
    }

    pub fn name(&self, text: &str, start: usize, end: usize) -> Name {
        Name { text: text.to_owned(), span: self.span(start, end) }
    }

    // Items

    pub fn attributes(&mut self, names: Vec<Name>) -> Attributes {
        let mut attributes = Attributes::default();
        let last = names.last().map(|n| n.span);
        for name in names {
            let Some(flag) = attributes.flag(&name.text) else {
                let title = format!("there is no attribute `@{}`", name.text);
                let known = Attributes::NAMES.map(|name| format!("`@{name}`")).join(", ");
                self.report(
                    Diagnostic::error(codes::UNKNOWN_ATTRIBUTE, name.span, title)
                        .help(format!("the attributes are {known}")),
                );
                continue;
            };
            if std::mem::replace(flag, true) {
                let title = format!("`@{}` stands twice", name.text);
                self.report(
                    Diagnostic::error(codes::UNKNOWN_ATTRIBUTE, name.span, title).help("remove one of them"),
                );
            }
        }
        if let (true, true, Some(at)) = (attributes.task, attributes.inline, last) {
            self.report(
                Diagnostic::error(codes::UNKNOWN_ATTRIBUTE, at, "`@task` and `@inline` exclude each other")
                    .help(
                        "a task stays a token of its own, an inline function never is one: keep one of them",
                    ),
            );
        }
        attributes
    }

    /// The result type of a function, which must be stated.
    pub fn result(&mut self, stated: Option<Type>, end: usize) -> Type {
        stated.unwrap_or_else(|| {
            let at = self.span(end.saturating_sub(1), end);
            self.report(
                Diagnostic::error(codes::UNSTATED_TYPE, at, "this function does not state its result type")
                    .label("expected `-> Type` after this")
                    .help("top-level functions state the types of their parameters and their result"),
            );
            Type::error(at)
        })
    }

    pub fn untyped_param(&mut self, name: Name) -> (Name, Type) {
        let title = format!("the parameter `{}` does not state its type", name.text);
        if !self.is_silent(name.span.start as usize) {
            self.report(
                Diagnostic::error(codes::UNSTATED_TYPE, name.span, title)
                    .help(format!("write `{}: f32`, with the type that it has", name.text)),
            );
        }
        let ty = Type::error(name.span);
        (name, ty)
    }

    // Types

    pub fn ty(&mut self, kind: TypeKind, start: usize, end: usize) -> Type {
        let deepest = |types: &[Type]| types.iter().map(|t| t.depth).max().unwrap_or(0);
        let below = match &kind {
            TypeKind::Error => 0,
            TypeKind::Named(_, items) | TypeKind::Tuple(items) => deepest(items),
            TypeKind::Array(item, n) => item.depth.max(n.depth),
            TypeKind::Fn(params, result) => deepest(params).max(result.depth),
        };
        let span = self.span(start, end);
        if below < MAX_TYPE_DEPTH {
            return Type { kind, span, depth: below + 1 };
        }
        if !std::mem::replace(&mut self.too_deep, true) {
            let title = format!("this type is more than {MAX_TYPE_DEPTH} levels deep");
            self.report(
                Diagnostic::error(codes::TOO_DEEP, span, title).help("give parts of it names with `type`"),
            );
        }
        Type::error(span)
    }

    pub fn fn_type(&mut self, prefixes: Vec<(usize, Vec<Type>)>, result: Type, end: usize) -> Type {
        prefixes
            .into_iter()
            .rev()
            .fold(result, |result, (at, params)| self.ty(TypeKind::Fn(params, Box::new(result)), at, end))
    }

    pub fn tuple_type(&mut self, mut items: Vec<Type>, last: Option<Type>, start: usize, end: usize) -> Type {
        let span = self.span(start, end);
        match last {
            Some(only) if items.is_empty() => return Type { span, ..only },
            last => items.extend(last),
        }
        if items.len() < 2 {
            self.short_tuple(span);
        }
        self.ty(TypeKind::Tuple(items), start, end)
    }

    fn short_tuple(&mut self, span: Span) {
        let title = "a tuple has at least two components";
        self.report(
            Diagnostic::error(codes::BAD_TUPLE, span, title).help("there is neither `()` nor `(a,)`"),
        );
    }

    // Expressions

    pub fn expr(&mut self, kind: ExprKind, start: usize, end: usize) -> Expr {
        let mut expr = Expr { kind, span: self.span(start, end), depth: 0 };
        let mut below = 0;
        expr.for_each_part(&mut |part| below = below.max(part.depth));
        // A chain of `else if` nests to the right later.
        expr.depth = match &expr.kind {
            ExprKind::If(branches, _) => below + branches.len() as u32,
            _ => below + 1,
        };
        if expr.depth <= MAX_DEPTH {
            return expr;
        }
        if !std::mem::replace(&mut self.too_deep, true) {
            let title = format!("this expression is more than {MAX_DEPTH} operations deep");
            self.report(
                Diagnostic::error(codes::TOO_DEEP, expr.span, title)
                    .help("give parts of it names with `let`, or use `sum` or `fold`"),
            );
        }
        Expr { kind: ExprKind::Error, depth: 1, span: expr.span }
    }

    pub fn postfix(&mut self, e: Expr, end: usize, kind: impl FnOnce(Box<Expr>) -> ExprKind) -> Expr {
        let start = e.span.start as usize;
        self.expr(kind(Box::new(e)), start, end)
    }

    pub fn unary(&mut self, ops: Vec<(UnaryOp, usize)>, e: Expr) -> Expr {
        ops.into_iter().rev().fold(e, |e, (op, start)| {
            let end = e.span.end as usize;
            self.expr(ExprKind::Unary(op, Box::new(e)), start, end)
        })
    }

    pub fn lambda(&mut self, params: Vec<LambdaParam>, body: Expr, start: usize, end: usize) -> Expr {
        if params.is_empty() {
            let at = self.span(start, start + 2);
            self.report(
                Diagnostic::error(codes::SYNTAX, at, "a lambda has at least one parameter")
                    .help("use the value itself, or `|_| ..` to ignore an argument"),
            );
        }
        self.expr(ExprKind::Lambda(params, Box::new(body)), start, end)
    }

    pub fn tuple(&mut self, mut items: Vec<Expr>, last: Option<Expr>, start: usize, end: usize) -> Expr {
        let span = self.span(start, end);
        match last {
            Some(only) if items.is_empty() => return Expr { span, ..only },
            last => items.extend(last),
        }
        if items.len() < 2 {
            self.short_tuple(span);
        }
        self.expr(ExprKind::Tuple(items), start, end)
    }

    pub fn array(&mut self, items: Vec<Expr>, start: usize, end: usize) -> Expr {
        if items.is_empty() {
            let span = self.span(start, end);
            self.report(Diagnostic::error(codes::BAD_TUPLE, span, "an array has at least one element"));
        }
        self.expr(ExprKind::Array(items), start, end)
    }

    pub fn conditional(
        &mut self,
        condition: Expr,
        value: Expr,
        rest: Vec<(Expr, Expr)>,
        last: Option<Expr>,
        start: usize,
        end: usize,
    ) -> Expr {
        let last = last.unwrap_or_else(|| {
            let at = self.span(start, start + 2);
            self.report_unless_wrong(start, mistakes::if_without_else(at));
            self.expr(ExprKind::Error, end, end)
        });
        let branches = std::iter::once((condition, value)).chain(rest).collect();
        self.expr(ExprKind::If(branches, Box::new(last)), start, end)
    }

    pub fn block(&mut self, lets: Vec<Option<Let>>, value: Option<Expr>, start: usize, end: usize) -> Expr {
        let lets: Vec<Let> = lets.into_iter().flatten().collect();
        let value = value.unwrap_or_else(|| {
            let at = self.span(end.saturating_sub(1), end);
            self.report_unless_wrong(
                start,
                Diagnostic::error(codes::BLOCK_VALUE, at, "this block does not end with a value")
                    .label("expected an expression before this")
                    .help("a block is `{ let a = ..; value }`, without `;` after the value"),
            );
            self.expr(ExprKind::Error, end, end)
        });
        if lets.is_empty() {
            return value;
        }
        self.expr(ExprKind::Block(lets, Box::new(value)), start, end)
    }

    /// `value;` in a block.
    pub fn unused(&mut self, value: Expr, end: usize) -> Option<Let> {
        if matches!(value.kind, ExprKind::Error) {
            return None;
        }
        let span = self.span(value.span.start as usize, end);
        self.report_unless_wrong(
            value.span.start as usize,
            Diagnostic::error(codes::UNUSED_VALUE, span, "nothing uses this value")
                .help("name it with `let`, or remove the `;` if it is the value of the block"),
        );
        let pattern = Pattern { kind: PatternKind::Wild, span: value.span };
        Some(Let { pattern, ty: None, value })
    }

    // Patterns

    pub fn pattern(&self, kind: PatternKind, start: usize, end: usize) -> Pattern {
        Pattern { kind, span: self.span(start, end) }
    }

    pub fn or_pattern(&self, first: Pattern, rest: Vec<Pattern>, start: usize, end: usize) -> Pattern {
        let all = std::iter::once(first).chain(rest).collect();
        self.pattern(PatternKind::Or(all), start, end)
    }

    pub fn tuple_pattern(
        &mut self,
        mut items: Vec<Pattern>,
        last: Option<Pattern>,
        start: usize,
        end: usize,
    ) -> Pattern {
        match last {
            Some(only) if items.is_empty() => return only,
            last => items.extend(last),
        }
        if items.len() < 2 {
            self.short_tuple(self.span(start, end));
        }
        self.pattern(PatternKind::Tuple(items), start, end)
    }

    pub fn constructor(&mut self, name: Name, fields: Vec<Field>, start: usize, end: usize) -> Pattern {
        let count = fields.len();
        let mut patterns = Vec::new();
        let mut rest = Rest::Absent;
        for (i, field) in fields.into_iter().enumerate() {
            match field {
                Field::Pattern(pattern) => patterns.push(pattern),
                Field::Rest(span) => {
                    rest = Rest::Present;
                    if i + 1 < count {
                        let title = "`..` stands last in a pattern";
                        self.report(
                            Diagnostic::error(codes::MISPLACED_REST, span, title)
                                .help("move it behind the fields that are named"),
                        );
                    }
                }
            }
        }
        self.pattern(PatternKind::Constructor(name, patterns, rest), start, end)
    }
}

#[cfg(test)]
mod tests;
