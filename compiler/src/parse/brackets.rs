//! Brackets that do not pair. They are told where they stand and put right before the grammar reads the text: it would
//! go on for long before it stumbled, and then over something else.
//!
//! Which bracket is wrong cannot be known. In a text whose brackets pair nothing here has a say; in any other an item
//! that begins a line closes everything, and indentation tells the bracket that was meant.

use super::Spanned;
use super::mistakes::starts_item;
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::front::MAX_DIAGNOSTICS;
use crate::lexer::Lexeme;
use crate::source::{SourceId, Span};

/// A text with its brackets paired.
pub(super) struct Repaired<'s> {
    pub lexemes: Vec<Spanned<'s>>,
    pub diagnostics: Vec<Diagnostic>,
    /// Bytes where anything else that is wrong follows from a bracket.
    pub doubtful: Vec<(usize, usize)>,
}

/// Nothing if all brackets pair.
pub(super) fn repair<'s>(source: SourceId, text: &str, lexemes: &[Spanned<'s>]) -> Option<Repaired<'s>> {
    if is_paired(lexemes) {
        return None;
    }
    let repaired = Repaired {
        lexemes: Vec::with_capacity(lexemes.len()),
        diagnostics: Vec::new(),
        doubtful: Vec::new(),
    };
    let mut walk = Walk {
        source,
        text,
        lexemes,
        repaired,
        open: Vec::new(),
        suspects: Vec::new(),
        indent: 0,
        line: 0,
        extra: None,
    };
    (0..lexemes.len()).for_each(|at| walk.step(at));
    walk.close(0, lexemes.len(), "the text ends here");
    Some(walk.repaired)
}

fn closing(lexeme: Lexeme) -> Option<Lexeme<'static>> {
    match lexeme {
        Lexeme::LParen => Some(Lexeme::RParen),
        Lexeme::LBracket => Some(Lexeme::RBracket),
        Lexeme::LBrace => Some(Lexeme::RBrace),
        _ => None,
    }
}

fn closes(lexeme: Lexeme) -> bool {
    matches!(lexeme, Lexeme::RParen | Lexeme::RBracket | Lexeme::RBrace)
}

fn is_paired(lexemes: &[Spanned]) -> bool {
    let mut open = Vec::new();
    lexemes.iter().all(|&(_, lexeme, _)| match closing(lexeme) {
        Some(close) => {
            open.push(close);
            true
        }
        None => !closes(lexeme) || open.pop() == Some(lexeme),
    }) && open.is_empty()
}

struct Open {
    at: usize,
    close: Lexeme<'static>,
    /// Of its line.
    indent: usize,
    line: usize,
}

/// A closing bracket whose line is not indented as that of its opening one.
struct Suspect {
    open: usize,
    close: usize,
    /// It stands further left.
    outward: bool,
    /// Its place among the lexemes that are kept.
    kept: usize,
}

struct Walk<'a, 's> {
    source: SourceId,
    text: &'a str,
    lexemes: &'a [Spanned<'s>],
    repaired: Repaired<'s>,
    open: Vec<Open>,
    /// Within the item.
    suspects: Vec<Suspect>,
    /// Of the line of the lexeme, and where that begins.
    indent: usize,
    line: usize,
    /// The last closing bracket that closes nothing.
    extra: Option<usize>,
}

impl Walk<'_, '_> {
    fn step(&mut self, at: usize) {
        let (start, lexeme, end) = self.lexemes[at];
        let before = at.checked_sub(1).map_or(0, |before| self.lexemes[before].2);
        let begins_line = at == 0 || self.text[before..start].contains('\n');
        if begins_line {
            self.line = self.text[..start].rfind('\n').map_or(0, |end| end + 1);
            self.indent = start - self.line;
        }
        if begins_line && self.begins_item(at) && self.open.first().is_none_or(|o| self.indent <= o.indent) {
            self.close(0, at, "the next item begins here");
            self.suspects.clear();
        }
        let top = self.open.last().map(|open| open.close);
        let in_list = matches!(top, Some(Lexeme::RParen | Lexeme::RBracket));
        match lexeme {
            // Neither stands in parentheses; in brackets a `;` stands before a length.
            Lexeme::Semi if top == Some(Lexeme::RParen) => self.close_lists(at, Lexeme::RBracket),
            Lexeme::Let if in_list => self.close_lists(at, Lexeme::RBrace),
            // A type of functions has its own parentheses before the arrow.
            Lexeme::Arrow
                if top == Some(Lexeme::RParen) && before_is(self.lexemes, at, |l| l != Lexeme::RParen) =>
            {
                self.close(self.open.len() - 1, at, "before this");
            }
            _ => {}
        }
        if let Some(close) = closing(lexeme) {
            self.open.push(Open { at, close, indent: self.indent, line: self.line });
        } else if closes(lexeme) {
            match self.open.iter().rposition(|open| open.close == lexeme) {
                Some(partner) => {
                    self.close(partner + 1, at, "before this");
                    self.pair(at);
                }
                None => match self.open.pop() {
                    Some(open) => {
                        self.wrong(&open, at);
                        self.repaired.lexemes.push((start, open.close, end));
                        return;
                    }
                    None => return self.extra(at),
                },
            }
        }
        self.repaired.lexemes.push((start, lexeme, end));
    }

    /// Whether an item begins here, which cannot be a type `fn(..)`.
    fn begins_item(&self, at: usize) -> bool {
        let next = self.lexemes.get(at + 1).map(|&(_, next, _)| next);
        starts_item(&self.lexemes[at].1) && matches!(next, Some(Lexeme::Ident(_) | Lexeme::Text(_)))
    }

    fn span(&self, at: usize) -> Span {
        match self.lexemes.get(at) {
            Some(&(start, _, end)) => Span::new(self.source, start, end),
            None => {
                let end = self.lexemes.last().map_or(0, |last| last.2);
                Span::new(self.source, end.saturating_sub(1), end)
            }
        }
    }

    fn report(&mut self, diagnostic: Diagnostic) {
        if self.repaired.diagnostics.len() <= MAX_DIAGNOSTICS {
            self.repaired.diagnostics.push(diagnostic);
        }
    }

    fn pair(&mut self, at: usize) {
        let Some(open) = self.open.pop() else { return };
        if open.line != self.line && open.indent != self.indent {
            let (outward, kept) = (self.indent < open.indent, self.repaired.lexemes.len());
            self.suspects.push(Suspect { open: open.at, close: at, outward, kept });
        }
    }

    /// Closes lists down to one of a kind that stays open.
    fn close_lists(&mut self, at: usize, stays: Lexeme) {
        let first = self.open.iter().rposition(|open| open.close == stays || open.close == Lexeme::RBrace);
        self.close(first.map_or(0, |first| first + 1), at, "before this");
    }

    /// Closes what was opened since `first` before a lexeme: one message.
    fn close(&mut self, first: usize, at: usize, met: &str) {
        if self.open.len() <= first {
            return;
        }
        let unclosed = self.open.split_off(first);
        let end = at.checked_sub(1).map_or(0, |before| self.lexemes[before].2);
        let innermost = &unclosed[unclosed.len() - 1];
        let closed_by = unclosed.iter().rev().map(|open| (end, open.close, end));
        self.repaired.lexemes.extend(closed_by);
        let symbols = |at: usize| &self.text[self.lexemes[at].0..self.lexemes[at].2];
        let close = symbol(innermost.close);
        let suspect =
            self.suspects.iter().find(|s| s.outward && first == 0 && innermost.close == Lexeme::RBrace);
        let blamed = suspect.map_or(innermost.at, |suspect| suspect.open);
        let title = format!("this `{}` is never closed", symbols(blamed));
        let mut diagnostic = Diagnostic::error(codes::UNCLOSED, self.span(blamed), title)
            .label("opened here")
            .help(format!("add `{close}` where it shall end"));
        diagnostic = match suspect {
            Some(s) => {
                diagnostic.also(self.span(s.close), "this is indented as if it closed the one around it")
            }
            None if met == "before this" => {
                diagnostic.also(self.span(at), format!("`{close}` belongs before this"))
            }
            None => diagnostic.also(self.span(at), met),
        };
        if suspect.is_none() {
            for open in unclosed.iter().rev().skip(1) {
                diagnostic = diagnostic.also(self.span(open.at), "nor is this");
            }
        }
        let from = suspect.map_or(usize::MAX, |s| self.line_of(s.open));
        let from = unclosed.iter().map(|open| open.line).min().unwrap_or(0).min(from);
        self.repaired.doubtful.push((from, self.lexemes.get(at).map_or(self.text.len(), |l| l.0)));
        self.report(diagnostic);
    }

    fn line_of(&self, at: usize) -> usize {
        self.text[..self.lexemes[at].0].rfind('\n').map_or(0, |end| end + 1)
    }

    /// A closing bracket of the wrong kind, with none of the right kind around it.
    fn wrong(&mut self, open: &Open, at: usize) {
        let (start, _, end) = self.lexemes[open.at];
        let title = format!("this closes no `{}`", &self.text[start..end]);
        self.report(
            Diagnostic::error(codes::UNOPENED, self.span(at), title)
                .label(format!("`{}` belongs here", symbol(open.close)))
                .also(self.span(open.at), "opened here")
                .help(format!("write `{}`", symbol(open.close))),
        );
    }

    /// A closing bracket with none open. One before it may have closed what it should close.
    fn extra(&mut self, at: usize) {
        let neighbour = self.extra.replace(at).is_some_and(|last| last + 1 == at);
        if neighbour {
            return;
        }
        let diagnostic = Diagnostic::error(codes::UNOPENED, self.span(at), "this closes nothing")
            .label("nothing is open here");
        let suspect = self.suspects.iter().position(|s| self.lexemes[s.close].1 == self.lexemes[at].1);
        let Some(suspect) = suspect.map(|first| self.suspects.swap_remove(first)) else {
            return self.report(diagnostic.help("remove it, or add the bracket that it closes"));
        };
        let (start, lexeme, end) = self.lexemes[at];
        self.repaired.lexemes.push((start, lexeme, end));
        self.repaired.lexemes.remove(suspect.kept);
        self.suspects.clear();
        self.repaired.doubtful.push((self.line_of(suspect.close), end));
        self.report(
            diagnostic
                .also(self.span(suspect.close), "this may be one too many, to judge by the indentation")
                .help("remove one of them, or add the bracket that it closes"),
        );
    }
}

fn before_is(lexemes: &[Spanned], at: usize, is: impl Fn(Lexeme) -> bool) -> bool {
    at.checked_sub(1).is_some_and(|before| is(lexemes[before].1))
}

fn symbol(close: Lexeme) -> &'static str {
    match close {
        Lexeme::RParen => ")",
        Lexeme::RBracket => "]",
        _ => "}",
    }
}
