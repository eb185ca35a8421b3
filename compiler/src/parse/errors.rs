//! What the parser says when a lexeme does not fit.

use lalrpop_util::ParseError;

use super::{Context, MOST_RECOVERIES};
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::lexer::Lexeme;

/// Syntax errors fewer lexemes apart than this are one error.
const SEPARATION: usize = 3;

/// Label of an error that is mended before the rest is parsed.
const MISSING_SEMICOLON: &str = "`;` is missing after this";

/// Words that name nothing else.
pub const KEYWORDS: &[&str] = &[
    "use", "const", "param", "raster", "fn", "struct", "enum", "type", "let", "if", "else", "match", "with",
    "in", "true", "false",
];

/// What a set of expected lexemes amounts to: if all of `these` are expected, say `name` for them.
const GROUPS: &[(&[&str], &str)] = &[
    (&["const", "raster", "struct", "@"], "an item"),
    (&["float", "(", "match", "["], "an expression"),
    (&["float", "(", "_"], "a pattern"),
    (&["name", "(", "[", "fn"], "a type"),
    (&["+", "*", "=="], "an operator"),
];

/// Members of a group that the group's name covers.
const COVERED: &[(&str, &[&str])] = &[
    ("an item", &["use", "const", "param", "raster", "struct", "enum", "type", "fn", "@"]),
    (
        "an expression",
        &[
            "name", "integer", "unsigned", "float", "_", "(", "[", "{", "if", "match", "true", "false", "-",
            "!", "|", "||", "let",
        ],
    ),
    ("a pattern", &["name", "integer", "unsigned", "float", "_", "(", "true", "false", "-"]),
    ("a type", &["name", "(", "[", "fn"]),
    (
        "an operator",
        &[
            "|>", "||", "&&", "==", "!=", "<", "<=", ">", ">=", ">>", "|", "^", "&", "<<", "+", "-", "*",
            "/", "%", "with", ".", "[", "(",
        ],
    ),
];

impl Context<'_> {
    pub(super) fn syntax_error(&mut self, error: ParseError<usize, Lexeme, ()>) {
        if self.given_up.get() {
            return;
        }
        self.recoveries += 1;
        self.given_up.set(self.recoveries > MOST_RECOVERIES);
        let found_at = match &error {
            ParseError::UnrecognizedToken { token: (start, _, _), .. } => *start,
            _ => self.text_end,
        };
        let diagnostic = match error {
            ParseError::UnrecognizedToken { token: (start, lexeme, end), expected } => {
                self.unexpected(start, end, Some(lexeme), &expected)
            }
            ParseError::UnrecognizedEof { expected, .. } => {
                let mut end = self.lexemes.last().map_or(self.text_end, |&(_, _, end)| end);
                end = end.min(self.text_end);
                self.unexpected(end.saturating_sub(1), end, None, &expected)
            }
            ParseError::ExtraToken { token: (start, lexeme, end) } => {
                self.unexpected(start, end, Some(lexeme), &[])
            }
            ParseError::InvalidToken { location } => self.unexpected(location, location, None, &[]),
            ParseError::User { error: () } => return,
        };
        // Recovery can stumble over what directly follows.
        let start = diagnostic.primary.0.start as usize;
        let place = self.lexemes.partition_point(|&(_, _, end)| end <= start);
        if self.is_silent(start) {
            return;
        }
        let near =
            self.errors_at.range((place + 1).saturating_sub(SEPARATION)..place + SEPARATION).next().is_some();
        self.errors_at.insert(place);
        if near {
            return;
        }
        if diagnostic.primary.1 == MISSING_SEMICOLON && self.diagnostics.is_empty() && self.missing.is_none()
        {
            self.missing = Some((found_at, diagnostic.clone()));
        }
        self.silence_after(place, diagnostic.code);
        self.report(diagnostic);
    }

    /// What is wrong at a byte follows from what was told.
    pub(super) fn is_silent(&self, start: usize) -> bool {
        self.lexemes.partition_point(|&(_, _, end)| end <= start) < self.silent_to
    }

    fn unexpected(&self, start: usize, end: usize, found: Option<Lexeme>, expected: &[String]) -> Diagnostic {
        if let Some(diagnostic) = self.mistake(start, expected) {
            return diagnostic;
        }
        let found_text = found.map_or("the end of the text".to_owned(), |lexeme| describe(&lexeme));
        let names = summarise(expected);
        // At the end of the text the place is that of the last lexeme itself.
        let before = self.end_before(if found.is_some() { start } else { end });
        if names == ["`;`"]
            || (names.contains(&"`;`".to_owned()) && names.len() <= 3 && starts_statement(found))
        {
            let at = self.span(before.saturating_sub(1), before);
            let help = self.hint(start, expected).unwrap_or("items and `let` end with `;`");
            return Diagnostic::error(codes::SYNTAX, at, format!("expected `;`, found {found_text}"))
                .label(MISSING_SEMICOLON)
                .help(help);
        }
        let title = match names.as_slice() {
            [] => format!("unexpected {found_text}"),
            names => format!("expected {}, found {found_text}", alternatives(names)),
        };
        let diagnostic =
            Diagnostic::error(codes::SYNTAX, self.span(start, end), title).label("not expected here");
        let help = self.hint(start, expected).map(str::to_owned).or_else(|| help(found, expected));
        match help {
            Some(help) => diagnostic.help(help),
            None => diagnostic,
        }
    }

    /// End of the last lexeme that ends at or before a place.
    fn end_before(&self, place: usize) -> usize {
        let n = self.lexemes.partition_point(|&(_, _, end)| end <= place);
        n.checked_sub(1).map_or(place, |i| self.lexemes[i].2)
    }
}

impl Context<'_> {
    /// What to do where the neighbours tell what was meant, though not so surely as in `mistakes`.
    fn hint(&self, start: usize, expected: &[String]) -> Option<&'static str> {
        use Lexeme::*;
        let expects = |what: &str| expected.iter().any(|e| e.trim_matches('"') == what);
        let at = self.lexemes.partition_point(|&(from, ..)| from < start);
        let lexeme = |at: Option<usize>| at.and_then(|at| self.lexemes.get(at)).map(|&(_, lexeme, _)| lexeme);
        let before = lexeme(at.checked_sub(1));
        Some(match lexeme(Some(at))? {
            Ident(_) | LParen if matches!(before, Some(Int(_) | Uint(_) | Float(_))) => {
                "a product needs its operator: `2.0 * x`"
            }
            Colon | Ident(_) if expects("->") => {
                "the result type stands behind an arrow: `fn name(x: f32) -> f32 = ..;`"
            }
            Ident(_) if expects(":") && expects(")") => "the type stands behind a colon: `x: f32`",
            Assign if before != Some(Colon) && expects(":") => "state the type: `param name: f32 = 1.0;`",
            Semi if expects(",") && expects("]") => "an array is written out: `[a, a, a]`",
            Semi if expects(",") && expects("}") => "arms and variants are separated by commas",
            Semi if expects(",") && expects(")") => "a `)` is missing before this, or this shall be a comma",
            Colon if expects("=>") => "an arm is written `pattern => value`",
            DotDot if expects("=>") => "a pattern is no range: write a guard, `x if 1 <= x && x < 3 => ..`",
            Lt | LtEq | Gt | GtJoint | GtEq | EqEq | NotEq if expects("=>") => {
                "a condition stands behind the pattern: `x if x > 3 => ..`"
            }
            Comma if expects("..") => "a range is written `lo..hi`",
            RBracket if expects(";") && !expects(",") => "the type of an array states its length: `[f32; 4]`",
            Comma if expects("]") && !expects(",") => "an index is one number: write `m[0][1]`",
            Ident(_) | Int(_) | Uint(_) | Float(_) | True | False | Hole | LParen | Minus
                if expects(",") && [")", "]", "}"].into_iter().any(expects) =>
            {
                "a comma is missing before this"
            }
            _ if expects("struct") && expects("raster") => {
                "an item begins with `fn`, `const`, `param`, `struct`, `enum`, `type`, `raster` or `use`"
            }
            _ => return None,
        })
    }
}

fn starts_statement(found: Option<Lexeme>) -> bool {
    use Lexeme::*;
    matches!(
        found,
        Some(Let | Use | Const | Param | Raster | Fn | Struct | Enum | Type | At | RBrace | Ident(_)) | None
    )
}

fn help(found: Option<Lexeme>, expected: &[String]) -> Option<String> {
    let expects = |what: &str| expected.iter().any(|e| e.trim_matches('"') == what);
    match found? {
        Lexeme::DotDot => Some("a range stands only as the first argument of fold, sum, any and all".into()),
        Lexeme::Amp | Lexeme::Bar if !expects("+") => None,
        found if keyword(&found).is_some() && expects("name") => {
            Some(format!("`{}` is a keyword and cannot be a name", keyword(&found)?))
        }
        _ => None,
    }
}

/// Short names for what was expected, groups first.
fn summarise(expected: &[String]) -> Vec<String> {
    let mut left: Vec<&str> = expected.iter().map(|e| e.trim_matches('"')).collect();
    let mut names = Vec::new();
    for (needed, group) in GROUPS {
        if needed.iter().all(|n| left.contains(n)) {
            names.push((*group).to_owned());
            let covered = COVERED.iter().find(|(name, _)| name == group).map_or(&[][..], |(_, all)| all);
            left.retain(|l| !covered.contains(l));
        }
    }
    names.extend(left.into_iter().map(expected_name));
    // After a whole expression nearly anything goes on; what ends it is what the person forgot.
    if names.len() > 1 && names[0] == "an operator" {
        let operator = names.remove(0);
        if names.len() > 1 {
            names.push(operator);
        }
    }
    names
}

fn expected_name(lexeme: &str) -> String {
    match lexeme {
        "name" => "a name".to_owned(),
        "integer" | "unsigned" => "an integer".to_owned(),
        "float" => "a number".to_owned(),
        "text" => "a path in quotes".to_owned(),
        symbol => format!("`{symbol}`"),
    }
}

fn alternatives(names: &[String]) -> String {
    const SHOWN: usize = 4;
    match names {
        [one] => one.clone(),
        [head @ .., last] if names.len() <= SHOWN => format!("{} or {last}", head.join(", ")),
        many => format!("one of {}, ..", many[..SHOWN].join(", ")),
    }
}

fn keyword(lexeme: &Lexeme) -> Option<&'static str> {
    let name = format!("{lexeme:?}").to_lowercase();
    KEYWORDS.iter().find(|k| **k == name).copied()
}

fn describe(lexeme: &Lexeme) -> String {
    use Lexeme::*;
    if let Some(word) = keyword(lexeme) {
        return format!("the keyword `{word}`");
    }
    let symbol = match lexeme {
        Ident(name) => return format!("`{name}`"),
        Number(text) => return format!("`{text}`"),
        Int(value) => return format!("`{value}`"),
        Uint(value) => return format!("`{value}u`"),
        Float(value) => return format!("`{value}`"),
        Text(text) => return text.to_string(),
        Hole => "_",
        LParen => "(",
        RParen => ")",
        LBracket => "[",
        RBracket => "]",
        LBrace => "{",
        RBrace => "}",
        Comma => ",",
        Semi => ";",
        Colon => ":",
        Dot => ".",
        DotDot => "..",
        At => "@",
        Arrow => "->",
        FatArrow => "=>",
        Assign => "=",
        Pipe => "|>",
        OrOr => "||",
        AndAnd => "&&",
        EqEq => "==",
        NotEq => "!=",
        Lt => "<",
        LtEq => "<=",
        Gt | GtJoint => ">",
        GtEq => ">=",
        Bar => "|",
        Caret => "^",
        Amp => "&",
        Shl => "<<",
        Plus => "+",
        Minus => "-",
        Star => "*",
        Slash => "/",
        Percent => "%",
        Bang => "!",
        _ => return "this".to_owned(),
    };
    format!("`{symbol}`")
}
