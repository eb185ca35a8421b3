//! Lexemes with the comments and line ends before them, and what each is for.

use crate::lexer::{Lexeme, lex};
use crate::source::SourceId;

/// A lexeme of the text.
#[derive(Clone, Debug)]
pub struct Token<'s> {
    pub lexeme: Lexeme<'s>,
    pub text: &'s str,
    /// Between the lexeme before and this one.
    pub comments: Vec<Comment<'s>>,
    /// Line ends directly before, behind the last comment.
    pub lines: usize,
    pub role: Role,
    /// The bracket that closes this one.
    pub close: Option<usize>,
    /// Follows the block of a match arm, without a comma.
    pub after_arm: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Comment<'s> {
    pub text: &'s str,
    pub line: bool,
    /// Line ends before it.
    pub lines: usize,
}

/// What a lexeme that has several uses is used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    Plain,
    /// `-` and `!` before their operand.
    Prefix,
    LambdaOpen,
    LambdaClose,
    GenericOpen,
    GenericClose,
    /// A comma between parameters of a lambda or of a type, which have no brackets that could be broken.
    Inner,
}

/// All lexemes of a text without errors; the last one is empty and has the comments at the end. `angles` are the spans of types with
/// arguments.
pub fn tokens<'s>(source: SourceId, text: &'s str, angles: &[(usize, usize)]) -> Vec<Token<'s>> {
    let mut tokens: Vec<Token> = Vec::new();
    let (mut end, mut after_arm) = (0, false);
    for (start, lexeme, stop) in lex(source, text).lexemes {
        if start == stop {
            after_arm = true;
            continue;
        }
        let (comments, lines) = gap(&text[end..start]);
        let role = Role::Plain;
        let text = &text[start..stop];
        tokens.push(Token { lexeme, text, comments, lines, role, close: None, after_arm });
        (end, after_arm) = (stop, false);
    }
    let (comments, lines) = gap(&text[end..]);
    let last = Token {
        lexeme: Lexeme::Semi,
        text: "",
        comments,
        lines,
        role: Role::Plain,
        close: None,
        after_arm: false,
    };
    tokens.push(last);
    pair(&mut tokens);
    roles(text, &mut tokens, angles);
    tokens
}

/// The comments of a text, without the blanks at the ends of their lines.
pub fn comments(text: &str) -> Vec<String> {
    let all = tokens(SourceId(0), text, &[]);
    all.iter().flat_map(|t| &t.comments).map(|c| trimmed(c.text).join("\n")).collect()
}

/// Lines of a comment, without blanks at their ends and, but for the first, at their beginnings.
pub fn trimmed(text: &str) -> Vec<&str> {
    text.lines().enumerate().map(|(i, line)| if i == 0 { line.trim_end() } else { line.trim() }).collect()
}

/// Comments and line ends of what stands between two lexemes.
fn gap(text: &str) -> (Vec<Comment<'_>>, usize) {
    let (mut comments, mut lines, mut rest) = (Vec::new(), 0, text);
    loop {
        let blank = rest.len() - rest.trim_start().len();
        lines += rest[..blank].matches('\n').count();
        rest = &rest[blank..];
        if rest.is_empty() {
            return (comments, lines);
        }
        let line = !rest.starts_with("/*");
        let length = if line { rest.find('\n').unwrap_or(rest.len()) } else { nested(rest) };
        comments.push(Comment { text: rest[..length].trim_end(), line, lines });
        (lines, rest) = (0, &rest[length..]);
    }
}

/// Length of the block comment at the beginning.
fn nested(text: &str) -> usize {
    let bytes = text.as_bytes();
    let (mut depth, mut at) = (0usize, 0);
    while at < bytes.len() {
        match bytes.get(at..at + 2) {
            Some(b"/*") => (depth, at) = (depth + 1, at + 2),
            Some(b"*/") => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
        if depth == 0 {
            break;
        }
    }
    at
}

fn pair(tokens: &mut [Token]) {
    let mut open = Vec::new();
    for i in 0..tokens.len() {
        match tokens[i].lexeme {
            Lexeme::LParen | Lexeme::LBracket | Lexeme::LBrace => open.push(i),
            Lexeme::RParen | Lexeme::RBracket | Lexeme::RBrace => {
                if let Some(opened) = open.pop() {
                    tokens[opened].close = Some(i);
                }
            }
            _ => {}
        }
    }
}

/// Whether an operand can end with this lexeme.
fn ends_operand(lexeme: &Lexeme) -> bool {
    use Lexeme::*;
    matches!(
        lexeme,
        Ident(_) | Int(_) | Uint(_) | Float(_) | True | False | Hole | RParen | RBracket | RBrace
    )
}

fn roles(text: &str, tokens: &mut [Token], angles: &[(usize, usize)]) {
    let begin = text.as_ptr() as usize;
    let mut generic = vec![false; tokens.len()];
    let starts: Vec<usize> = tokens.iter().map(|t| (t.text.as_ptr() as usize).wrapping_sub(begin)).collect();
    for (start, end) in angles {
        // The span of a type with arguments ends with the bracket; the opening one follows the name.
        let first = starts[..tokens.len() - 1].partition_point(|s| s < start);
        let behind = starts[..tokens.len() - 1].partition_point(|s| s < end);
        for at in [first + 1, behind.saturating_sub(1)] {
            generic[at] = true;
        }
    }
    let (mut depth, mut lambdas) = (0usize, Vec::new());
    let (mut head, mut generics) = (false, Vec::new());
    for i in 0..tokens.len() {
        use Lexeme::*;
        let before = i.checked_sub(1).map(|b| (tokens[b].lexeme, tokens[b].role));
        let operand = before.is_some_and(|(lexeme, _)| ends_operand(&lexeme)) && !tokens[i].after_arm;
        // `fn name<A>`
        let defined = i >= 2 && matches!(tokens[i - 2].lexeme, Fn | Struct | Enum | Type);
        tokens[i].role = match tokens[i].lexeme {
            LParen | LBracket | LBrace => {
                depth += 1;
                Role::Plain
            }
            RParen | RBracket | RBrace => {
                depth = depth.saturating_sub(1);
                Role::Plain
            }
            Lt if defined || generic[i] => {
                head |= defined;
                generics.push(depth);
                Role::GenericOpen
            }
            Gt | GtJoint if head || generic[i] => {
                head = false;
                generics.pop();
                Role::GenericClose
            }
            Comma if [lambdas.last(), generics.last()].contains(&Some(&depth)) => Role::Inner,
            Minus | Bang if !operand => Role::Prefix,
            Bar if lambdas.last() == Some(&depth) => {
                lambdas.pop();
                Role::LambdaClose
            }
            Bar if !operand => {
                lambdas.push(depth);
                Role::LambdaOpen
            }
            _ => Role::Plain,
        };
    }
}
