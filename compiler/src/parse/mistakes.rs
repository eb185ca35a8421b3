//! What people probably meant where a lexeme does not fit: habits of other languages, each with what Ghyll has instead.

mod expressions;
mod items;

use super::{Context, Spanned};
use crate::codes::{self, Code};
use crate::diagnostic::Diagnostic;
use crate::lexer::Lexeme;
pub(super) use expressions::if_without_else;
use expressions::{
    assignment, branch_braces, cast, compound_operator, lambda, no_else, range, reference, text,
};
pub(super) use items::is_type;
use items::{
    conditional_let, field_braces, foreign_pattern, local_function, no_value, not_an_item, path, type_first,
    word,
};

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
    no_else,
    conditional_let,
    foreign_pattern,
    assignment,
    range,
    reference,
    branch_braces,
    local_function,
    no_value,
    not_an_item,
];

/// These throw the parser out of step: what it says up to the next item follows from them.
const DISTURBING: &[Code] = &[
    codes::FOREIGN_WORD,
    codes::TYPE_FIRST,
    codes::FIELD_BRACES,
    codes::CAST,
    codes::PATH,
    codes::BRANCH_BRACES,
    codes::LOCAL_FUNCTION,
    codes::NOT_A_LAMBDA,
    codes::FOREIGN_PATTERN,
    codes::IF_WITHOUT_ELSE,
];

/// What it says up to the next semicolon follows from these.
const PASSING: &[Code] = &[
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
        RULES.iter().find_map(|rule| rule(&place))
    }

    /// Silences what follows from a message at that lexeme.
    pub(super) fn silence_after(&mut self, place: usize, code: Code) {
        let before = place.checked_sub(1).map_or(0, |before| self.lexemes[before].2);
        let in_line = |start: usize| !self.text[before..start.max(before)].contains('\n');
        let keyword = self.lexemes.get(place).filter(|l| starts_item(&l.1) && in_line(l.0));
        let keyword = keyword.filter(|_| code == codes::SYNTAX).map(|l| l.1);
        let passing = PASSING.contains(&code);
        if keyword.is_none() && !passing && !DISTURBING.contains(&code) {
            return;
        }
        // A keyword in the place of a name may stand there again.
        let ends = |lexeme: &Lexeme| {
            starts_item(lexeme) && Some(*lexeme) != keyword || passing && *lexeme == Lexeme::Semi
        };
        // What looks like items within braces belongs to what another language has in them.
        let mut depth = 0;
        let goes_on = |(_, lexeme, _): &&Spanned| {
            depth += i32::from(*lexeme == Lexeme::LBrace) - i32::from(*lexeme == Lexeme::RBrace);
            depth > 0 && !passing || !ends(lexeme)
        };
        self.silent_to = place + 1 + self.lexemes.iter().skip(place + 1).take_while(goes_on).count();
    }
}

pub(super) fn starts_item(lexeme: &Lexeme) -> bool {
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

    fn begins_line(&self, offset: isize) -> bool {
        let Some(at) = self.at.checked_add_signed(offset) else { return false };
        let before = at.checked_sub(1).map_or(0, |before| self.cx.lexemes[before].2);
        at == 0
            || self.cx.lexemes.get(at).is_some_and(|&(start, ..)| self.cx.text[before..start].contains('\n'))
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

    fn error(&self, code: Code, from: isize, to: isize, title: impl Into<String>) -> Diagnostic {
        let at = |offset: isize| self.at.saturating_add_signed(offset).min(self.cx.lexemes.len() - 1);
        let (start, end) = (self.cx.lexemes[at(from)].0, self.cx.lexemes[at(to)].2);
        Diagnostic::error(code, self.cx.span(start, end), title)
    }
}
