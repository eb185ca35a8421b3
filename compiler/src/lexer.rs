//! Text to lexemes. `logos` finds the raw pieces; a thin loop over them turns numbers into values, keeps
//! count of brackets, and settles three questions that need a look at the neighbours:
//!
//! - `t.0` is a field although `.0` is a number: after a value a number that begins with `.` is split.
//! - `A<B<C>>` closes two lists although `>>` is a shift: `>` before another `>` is [`Lexeme::GtJoint`].
//! - A match arm whose body is a block needs no comma: one is put after its `}`.
//!
//! Nothing here stops at an error: what is wrong is reported and left out.

mod nesting;

use logos::{Lexer, Logos};

use crate::codes::{self, Code};
use crate::diagnostic::Diagnostic;
use crate::source::{SourceId, Span};
use nesting::{Nesting, Step};

/// Deepest nesting of brackets, and of what has no brackets.
pub const MAX_NESTING: usize = 200;
/// Longest text; positions stay far below 32 bits.
pub const MAX_LENGTH: usize = 16 << 20;

#[derive(Logos, Clone, Copy, Debug, PartialEq)]
#[logos(skip r"[ \t\r\n\f]+")]
#[logos(skip(r"//[^\n]*", allow_greedy = true))]
pub enum Lexeme<'s> {
    #[regex("[A-Za-z_][A-Za-z0-9_]*")]
    Ident(&'s str),
    #[regex(r"[0-9][0-9_]*(\.[0-9][0-9_]*)?([eE][+-]?[0-9][0-9_]*)?([A-Za-z_][A-Za-z0-9_]*)?")]
    #[regex(r"\.[0-9][0-9_]*([eE][+-]?[0-9][0-9_]*)?([A-Za-z_][A-Za-z0-9_]*)?")]
    Number(&'s str),
    /// Integer without suffix.
    Int(u64),
    /// Integer with suffix `u`.
    Uint(u64),
    Float(f64),
    #[regex(r#""[^"\n]*""#)]
    Text(&'s str),
    #[regex(r#""[^"\n]*"#)]
    OpenText,
    #[token("/*", comment)]
    Comment(bool),

    #[token("_", priority = 10)]
    Hole,
    #[token("use")]
    Use,
    #[token("const")]
    Const,
    #[token("param")]
    Param,
    #[token("raster")]
    Raster,
    #[token("fn")]
    Fn,
    #[token("struct")]
    Struct,
    #[token("enum")]
    Enum,
    #[token("type")]
    Type,
    #[token("let")]
    Let,
    #[token("if")]
    If,
    #[token("else")]
    Else,
    #[token("match")]
    Match,
    #[token("with")]
    With,
    #[token("in")]
    In,
    #[token("true")]
    True,
    #[token("false")]
    False,

    #[token("(")]
    LParen,
    #[token(")")]
    RParen,
    #[token("[")]
    LBracket,
    #[token("]")]
    RBracket,
    #[token("{")]
    LBrace,
    #[token("}")]
    RBrace,
    #[token(",")]
    Comma,
    #[token(";")]
    Semi,
    #[token(":")]
    Colon,
    #[token(".")]
    Dot,
    #[token("..")]
    DotDot,
    #[token("@")]
    At,
    #[token("->")]
    Arrow,
    #[token("=>")]
    FatArrow,
    #[token("=")]
    Assign,
    #[token("|>")]
    Pipe,
    #[token("||")]
    OrOr,
    #[token("&&")]
    AndAnd,
    #[token("==")]
    EqEq,
    #[token("!=")]
    NotEq,
    #[token("<")]
    Lt,
    #[token("<=")]
    LtEq,
    #[token(">")]
    Gt,
    /// `>` directly before another `>`.
    GtJoint,
    #[token(">=")]
    GtEq,
    #[token("|")]
    Bar,
    #[token("^")]
    Caret,
    #[token("&")]
    Amp,
    #[token("<<")]
    Shl,
    #[token("+")]
    Plus,
    #[token("-")]
    Minus,
    #[token("*")]
    Star,
    #[token("/")]
    Slash,
    #[token("%")]
    Percent,
    #[token("!")]
    Bang,
}

/// Skips a nesting comment; false when it is never closed.
fn comment<'s>(lexer: &mut Lexer<'s, Lexeme<'s>>) -> bool {
    let rest = lexer.remainder().as_bytes();
    let (mut depth, mut at) = (1usize, 0);
    while at < rest.len() {
        match rest.get(at..at + 2) {
            Some(b"/*") => (depth, at) = (depth + 1, at + 2),
            Some(b"*/") => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
        if depth == 0 {
            lexer.bump(at);
            return true;
        }
    }
    lexer.bump(rest.len());
    false
}

/// A lexeme with the bytes it covers.
pub type Spanned<'s> = (usize, Lexeme<'s>, usize);

/// All lexemes of a text and what was wrong with it.
#[derive(Debug, Default)]
pub struct Lexed<'s> {
    pub lexemes: Vec<Spanned<'s>>,
    pub diagnostics: Vec<Diagnostic>,
    /// Opening brackets that are never closed, with what would close them.
    pub unclosed: Vec<(Span, char)>,
}

pub fn lex(source: SourceId, text: &str) -> Lexed<'_> {
    let mut reader = Reader { source, text, lexed: Lexed::default(), nesting: Nesting::default() };
    if text.len() > MAX_LENGTH {
        let at = Span::new(source, 0, 0);
        let title = format!("this text is longer than {} MiB", MAX_LENGTH >> 20);
        reader.lexed.diagnostics.push(Diagnostic::error(codes::TOO_LONG, at, title));
    } else {
        reader.run();
    }
    reader.lexed.unclosed = reader.nesting.unclosed();
    reader.lexed
}

struct Reader<'s> {
    source: SourceId,
    text: &'s str,
    lexed: Lexed<'s>,
    nesting: Nesting,
}

impl<'s> Reader<'s> {
    fn run(&mut self) {
        let mut lexer = Lexeme::lexer(self.text);
        let mut comma_due = None;
        while let Some(raw) = lexer.next() {
            let (start, mut end) = (lexer.span().start, lexer.span().end);
            let Ok(mut lexeme) = raw else {
                self.bad_character(start, end);
                continue;
            };
            if let Lexeme::Comment(closed) = lexeme {
                if !closed {
                    let title = "this comment is never closed";
                    self.error(codes::UNTERMINATED, start, start + 2, title).help =
                        Some("comments nest: each `/*` needs its own `*/`".into());
                }
                continue;
            }
            if let Lexeme::Number(digits) = lexeme
                && self.ends_float(digits, end)
            {
                lexer.bump(1);
                end += 1;
            }
            if let Some(at) = comma_due.take()
                && !matches!(lexeme, Lexeme::Comma | Lexeme::RBrace)
            {
                self.lexed.lexemes.push((at, Lexeme::Comma, at));
            }
            match lexeme {
                Lexeme::OpenText => {
                    self.error(codes::UNTERMINATED, start, end, "this text is never closed");
                    continue;
                }
                Lexeme::Number(digits) => {
                    self.number(digits, start, end);
                    continue;
                }
                Lexeme::Gt if self.text[end..].starts_with('>') => lexeme = Lexeme::GtJoint,
                _ => {}
            }
            let last = self.lexed.lexemes.last().map(|&(_, last, _)| last);
            match self.nesting.step(last, lexeme, Span::new(self.source, start, end)) {
                Step::Fine => {}
                Step::EndOfArm => comma_due = Some(end),
                Step::TooDeep(what) => {
                    let title = format!("{what} nest more than {MAX_NESTING} deep");
                    self.error(codes::TOO_DEEP, start, end, &title).help =
                        Some("give the inner parts names with `let` or move them to functions".into());
                    self.nesting = Nesting::default();
                    return;
                }
            }
            self.lexed.lexemes.push((start, lexeme, end));
        }
    }

    fn error(&mut self, code: Code, start: usize, end: usize, title: &str) -> &mut Diagnostic {
        let span = Span::new(self.source, start, end);
        self.lexed.diagnostics.push(Diagnostic::error(code, span, title));
        self.lexed.diagnostics.last_mut().expect("one was just pushed")
    }

    /// Neighbouring bad characters make one message.
    fn bad_character(&mut self, start: usize, end: usize) {
        if let Some(last) = self.lexed.diagnostics.last_mut()
            && last.code == codes::BAD_CHARACTER
            && last.primary.0.end as usize == start
        {
            last.primary.0.end = end as u32;
            return;
        }
        let found = &self.text[start..end];
        let (code, help) = match found {
            "?" => (codes::FOREIGN_OPERATOR, "a choice is `if c { a } else { b }`"),
            "~" => (codes::FOREIGN_OPERATOR, "all bits turned is `!x`"),
            "'" => (codes::BAD_CHARACTER, "there are no characters and texts: use numbers or an enum"),
            "#" => (
                codes::BAD_CHARACTER,
                "there is no preprocessor: constants are `const`, modules come by `use`, comments begin with `//`",
            ),
            "\\" => (codes::BAD_CHARACTER, "a function without a name is `|x| ..`"),
            "\u{d7}" => (codes::BAD_CHARACTER, "a product is `a * b`"),
            "\u{2212}" | "\u{2013}" => {
                (codes::BAD_CHARACTER, "a difference is `a - b`, with the minus of the keyboard")
            }
            "\u{a0}" | "\u{feff}" => (codes::BAD_CHARACTER, "this is an unusual blank: use a plain space"),
            _ => (
                codes::BAD_CHARACTER,
                "names are of ASCII letters, digits and `_`; other characters stand in comments only",
            ),
        };
        let title = match code {
            codes::FOREIGN_OPERATOR => format!("there is no operator `{found}`"),
            _ if found.bytes().all(|b| b.is_ascii_graphic()) => format!("`{found}` means nothing in Ghyll"),
            _ => format!("`{}` means nothing in Ghyll", found.escape_debug()),
        };
        self.error(code, start, end, &title).help = Some(help.to_owned());
    }

    /// `1.` is a number unless a field, a range or digits follow.
    fn ends_float(&self, digits: &str, end: usize) -> bool {
        let mut rest = self.text[end..].chars();
        digits.bytes().all(|b| b.is_ascii_digit() || b == b'_')
            && rest.next() == Some('.')
            && !rest.next().is_some_and(|c| c == '.' || c == '_' || c.is_ascii_alphanumeric())
            && !matches!(self.lexed.lexemes.last(), Some((_, Lexeme::Dot, _)))
    }

    fn number(&mut self, digits: &str, start: usize, end: usize) {
        let after_value = matches!(
            self.lexed.lexemes.last(),
            Some((_, Lexeme::Ident(_) | Lexeme::RParen | Lexeme::RBracket | Lexeme::RBrace, at)) if *at == start
        ) || self.after_tuple_field(start);
        let lexemes = &mut self.lexed.lexemes;
        // `t.0`, `t.0.1`
        if after_value && let Some(Ok(field)) = digits.strip_prefix('.').map(str::parse) {
            lexemes.push((start, Lexeme::Dot, start + 1));
            lexemes.push((start + 1, Lexeme::Int(field), end));
            return;
        }
        match number(&self.text[start..end]) {
            Ok(lexeme) => lexemes.push((start, lexeme, end)),
            Err(title) => {
                self.error(codes::BAD_NUMBER, start, end, &title).help =
                    Some(number_help(&self.text[start..end]).to_owned());
                self.lexed.lexemes.push((start, Lexeme::Int(0), end));
            }
        }
    }

    fn after_tuple_field(&self, start: usize) -> bool {
        matches!(self.lexed.lexemes[..], [.., (_, Lexeme::Dot, _), (_, Lexeme::Int(_), at)] if at == start)
    }
}

/// The value of a number as written.
fn number(written: &str) -> Result<Lexeme<'static>, String> {
    let plain = written.replace('_', "");
    let too_big = || format!("the integer `{written}` is larger than any type holds");
    if let Some(hex) = plain.strip_prefix("0x").or_else(|| plain.strip_prefix("0X")) {
        let (digits, unsigned) = match hex.strip_suffix('u') {
            Some(digits) => (digits, true),
            None => (hex, false),
        };
        if digits.is_empty() || !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
            return Err(format!("`{written}` is not a hexadecimal number"));
        }
        let value = u64::from_str_radix(digits, 16).map_err(|_| too_big())?;
        return Ok(if unsigned { Lexeme::Uint(value) } else { Lexeme::Int(value) });
    }
    if let Some(digits) = plain.strip_suffix('u')
        && digits.bytes().all(|b| b.is_ascii_digit())
    {
        return digits.parse().map(Lexeme::Uint).map_err(|_| too_big());
    }
    if plain.bytes().all(|b| b.is_ascii_digit()) {
        return plain.parse().map(Lexeme::Int).map_err(|_| too_big());
    }
    match plain.parse::<f64>() {
        Ok(value) if (value as f32).is_finite() => Ok(Lexeme::Float(value)),
        Ok(_) => Err(format!("`{written}` is larger than f32 holds")),
        Err(_) => Err(format!("`{written}` is not a number")),
    }
}

/// What to write for a number as other languages write it.
fn number_help(written: &str) -> &'static str {
    let plain = |suffix: &str| {
        written
            .strip_suffix(suffix)
            .is_some_and(|digits| digits.bytes().all(|b| b.is_ascii_digit() || b == b'.'))
    };
    if written.starts_with("0b") || written.starts_with("0o") {
        "integers are decimal or hexadecimal: 42, 0x2a"
    } else if ["f", "F", "f32", "h"].into_iter().any(plain) {
        "leave the suffix out: with a point it is an f32"
    } else if ["i", "l", "L", "i32"].into_iter().any(plain) {
        "leave the suffix out: an integer takes the type its place needs, i32 where none is needed"
    } else if ["U", "ul", "u32"].into_iter().any(plain) {
        "the only suffix is `u`, for u32"
    } else {
        "numbers look like 42, 0x2a, 42u, 1.5, .5, 1e-3 or 1_000"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds(text: &str) -> Vec<Lexeme<'_>> {
        let lexed = lex(SourceId(0), text);
        assert_eq!(lexed.diagnostics, vec![], "{text}");
        lexed.lexemes.into_iter().map(|(_, lexeme, _)| lexeme).collect()
    }

    fn codes_of(text: &str) -> Vec<codes::Code> {
        lex(SourceId(0), text).diagnostics.iter().map(|d| d.code).collect()
    }

    #[test]
    fn numbers() {
        use Lexeme::{Float, Int, Uint};
        let all = kinds("42 0x2a 42u 1.5 .5 1e-3 1_000 1. 0x2Au 2E2");
        let expected =
            [Int(42), Int(42), Uint(42), Float(1.5), Float(0.5), Float(1e-3), Int(1000), Float(1.0)];
        assert_eq!(all[..8], expected);
        assert_eq!(all[8..], [Uint(42), Float(200.0)]);
    }

    #[test]
    fn ranges_and_fields() {
        use Lexeme::{Dot, DotDot, Float, Ident, Int, Minus};
        assert_eq!(kinds("0..n"), [Int(0), DotDot, Ident("n")]);
        assert_eq!(kinds("0...5"), [Int(0), DotDot, Float(0.5)]);
        assert_eq!(kinds("t.0.1"), [Ident("t"), Dot, Int(0), Dot, Int(1)]);
        assert_eq!(kinds("0xe-3"), [Int(14), Minus, Int(3)]);
    }

    #[test]
    fn malformed_numbers() {
        for text in ["12abc", "0x", "0xg", "1e", "42i", "1.5f", "99999999999999999999", "1e39", "1.5u"] {
            assert_eq!(codes_of(text), [codes::BAD_NUMBER], "{text}");
        }
    }

    #[test]
    fn comments_nest() {
        assert_eq!(
            kinds("a /* b /* c */ d */ e // f\ng /// h"),
            [Lexeme::Ident("a"), Lexeme::Ident("e"), Lexeme::Ident("g")]
        );
        assert_eq!(codes_of("a /* b /* c */"), [codes::UNTERMINATED]);
        assert_eq!(codes_of("use \"abc"), [codes::UNTERMINATED]);
    }

    #[test]
    fn bad_characters_make_one_message() {
        assert_eq!(codes_of("a ### b ö"), [codes::BAD_CHARACTER, codes::BAD_CHARACTER]);
    }

    #[test]
    fn block_arms_end_with_a_comma() {
        let commas = |text| kinds(text).iter().filter(|l| **l == Lexeme::Comma).count();
        assert_eq!(commas("match x { A => { 1 } B => { 2 } }"), 1);
        assert_eq!(commas("match x { A => { 1 }, B => { 2 }, }"), 2);
    }

    #[test]
    fn deep_nesting_stops() {
        for part in ["(", "|x| ", "|| ", "|(a, b), c: (i32, i32)| ", "match ", "if ", "1 + |x| ", "f(|x| "] {
            assert_eq!(codes_of(&part.repeat(1_000)), [codes::TOO_DEEP], "{part}");
        }
    }

    #[test]
    fn long_is_not_deep() {
        for part in
            ["a | ", "a || ", "(|x| x, 1), ", "let a = |x| x; ", "f(a, |x| x, |y| y), ", "y if y == 1 => 2, "]
        {
            assert_eq!(codes_of(&part.repeat(1_000)), [], "{part}");
        }
        assert_eq!(codes_of(&format!("f({})", "|x| x, ".repeat(1_000))), []);
    }
}
