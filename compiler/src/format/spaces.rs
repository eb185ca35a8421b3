//! Blanks between two lexemes of a line.

use super::tokens::{Role, Token};
use crate::lexer::Lexeme::*;

/// Whether a blank stands between them.
pub fn space(before: &Token, token: &Token) -> bool {
    // `1.` and `.5` beside a range would be read as other numbers.
    match (before.lexeme, token.lexeme) {
        (_, DotDot) => return before.lexeme == Comma || before.text.ends_with('.'),
        (DotDot, _) => return token.text.starts_with('.'),
        (LBrace, RBrace) => return false,
        (GtJoint, Gt | GtJoint | GtEq) => return false,
        _ => {}
    }
    match before.role {
        Role::Prefix | Role::LambdaOpen | Role::GenericOpen => return false,
        Role::GenericClose if token.lexeme == LParen => return false,
        _ => {}
    }
    if matches!(token.role, Role::LambdaClose | Role::GenericOpen | Role::GenericClose)
        || matches!(before.lexeme, LParen | LBracket | Dot | At)
        || matches!(token.lexeme, RParen | RBracket | Dot | Comma | Semi | Colon)
    {
        return false;
    }
    match token.lexeme {
        LParen => !matches!(before.lexeme, Ident(_) | RParen | RBracket | Fn | Hole),
        LBracket => !matches!(before.lexeme, Ident(_) | RParen | RBracket),
        _ => true,
    }
}
