//! How deep a text nests, found before it is parsed: each open part is a state on the parser's stack, and
//! going on after a syntax error copies that stack.

use super::{Lexeme, MAX_NESTING};
use crate::source::Span;

/// The open parts before a lexeme.
#[derive(Default)]
pub struct Nesting {
    brackets: Vec<Bracket>,
    /// `if` and `match` whose `{` has not come, one in another.
    heads: usize,
    /// `<` with nothing but names between them.
    angles: usize,
    /// Lambdas whose body goes on.
    lambdas: Lambdas,
}

struct Bracket {
    span: Span,
    close: char,
    /// The `{` follows `=>`.
    arm: bool,
    /// As they were before the bracket.
    lambdas: Lambdas,
}

#[derive(Clone, Copy, Default)]
struct Lambdas {
    open: usize,
    /// Between the bars of the innermost one.
    parameters: bool,
}

pub enum Step {
    Fine,
    /// A `}` that ends the body of a match arm.
    EndOfArm,
    /// Names what nests too deep.
    TooDeep(&'static str),
}

impl Nesting {
    pub fn step(&mut self, last: Option<Lexeme>, lexeme: Lexeme, span: Span) -> Step {
        let after_value = last.is_some_and(ends_value);
        self.heads = match lexeme {
            // Behind a value, `if` is the guard of an arm.
            Lexeme::If | Lexeme::Match if !after_value => self.heads + 1,
            Lexeme::LBrace => self.heads.saturating_sub(1),
            Lexeme::Semi | Lexeme::Fn => 0,
            _ => self.heads,
        };
        self.angles = match lexeme {
            Lexeme::Lt => self.angles + 1,
            Lexeme::Ident(_) => self.angles,
            _ => 0,
        };
        let around = self.brackets.last().map_or(0, |bracket| bracket.lambdas.open);
        match lexeme {
            Lexeme::Bar if self.lambdas.parameters => self.lambdas.parameters = false,
            Lexeme::Bar | Lexeme::OrOr if !after_value => {
                self.lambdas = Lambdas { open: self.lambdas.open + 1, parameters: lexeme == Lexeme::Bar };
            }
            Lexeme::Comma if !self.lambdas.parameters => self.lambdas.open = around,
            Lexeme::Semi | Lexeme::Fn => self.lambdas = Lambdas { open: around, parameters: false },
            _ => {}
        }
        let mut end_of_arm = false;
        match lexeme {
            Lexeme::LParen | Lexeme::LBracket | Lexeme::LBrace => {
                let arm = lexeme == Lexeme::LBrace && last == Some(Lexeme::FatArrow);
                let close = match lexeme {
                    Lexeme::LParen => ')',
                    Lexeme::LBracket => ']',
                    _ => '}',
                };
                self.brackets.push(Bracket { span, close, arm, lambdas: self.lambdas });
                self.lambdas.parameters = false;
            }
            Lexeme::RParen | Lexeme::RBracket | Lexeme::RBrace => {
                if let Some(bracket) = self.brackets.pop() {
                    self.lambdas = bracket.lambdas;
                    end_of_arm = bracket.arm && lexeme == Lexeme::RBrace;
                }
            }
            _ => {}
        }
        let deep = [
            (self.angles, "types"),
            (self.heads, "conditions"),
            (self.lambdas.open, "functions"),
            (self.brackets.len(), "brackets"),
        ];
        match deep.into_iter().find(|&(depth, _)| depth > MAX_NESTING) {
            Some((_, what)) => Step::TooDeep(what),
            None if end_of_arm => Step::EndOfArm,
            None => Step::Fine,
        }
    }

    /// Opening brackets that are not closed, with what would close them.
    pub fn unclosed(&self) -> Vec<(Span, char)> {
        self.brackets.iter().map(|bracket| (bracket.span, bracket.close)).collect()
    }
}

/// An operator or the end of an expression follows, not a lambda.
fn ends_value(lexeme: Lexeme) -> bool {
    matches!(
        lexeme,
        Lexeme::Ident(_)
            | Lexeme::Int(_)
            | Lexeme::Uint(_)
            | Lexeme::Float(_)
            | Lexeme::True
            | Lexeme::False
            | Lexeme::Hole
            | Lexeme::RParen
            | Lexeme::RBracket
            | Lexeme::RBrace
    )
}
