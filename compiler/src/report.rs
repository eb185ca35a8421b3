//! Diagnostics as text for people (ariadne) and as JSON for tools.

use ariadne::{CharSet, Color, Config, IndexType, Label, ReportKind};
use serde_json::{Value, json};
use std::borrow::Cow;

use crate::codes::Code;
use crate::diagnostic::{Diagnostic, Report, Severity};
use crate::source::{Source, Sources, Span};

/// Every diagnostic with the lines it is about.
pub fn render(report: &Report, color: bool) -> String {
    let mut cache = ariadne::sources(report.sources.iter().map(|s| (s.name.clone(), shown(&s.text))));
    let mut text = Vec::new();
    for diagnostic in &report.diagnostics {
        let before = text.len();
        let drawn = drawable(&report.sources, diagnostic)
            && drawing(&report.sources, diagnostic, color).write(&mut cache, &mut text).is_ok();
        if !drawn {
            text.truncate(before);
            text.extend(plain(&report.sources, diagnostic).bytes());
        }
    }
    let mut text = String::from_utf8_lossy(&text).into_owned();
    if let Some(code) = worst(report) {
        text.push_str(&format!("`ghyll check --explain {code}` says more.\n"));
    }
    text
}

/// The text without what a terminal would act on. Each character stays as long as it is, since places count bytes.
fn shown(text: &str) -> Cow<'_, str> {
    // Marks that turn the order of the text, or that take no room.
    let hidden = |c: char| matches!(c, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}');
    let acts = |c: char| c.is_control() && !matches!(c, '\n' | '\r' | '\t') || hidden(c);
    if !text.contains(acts) {
        return Cow::Borrowed(text);
    }
    let replaced = |c: char| match c.len_utf8() {
        _ if !acts(c) => c,
        1 => '?',
        2 => '\u{bf}',
        _ => char::REPLACEMENT_CHARACTER,
    };
    Cow::Owned(text.chars().map(replaced).collect())
}

/// The code to read about first: that of the first error, else of the first warning.
fn worst(report: &Report) -> Option<Code> {
    let error = report.diagnostics.iter().find(|d| d.severity == Severity::Error);
    error.or(report.diagnostics.first()).map(|d| d.code)
}

type Place = (String, std::ops::Range<usize>);

fn drawing<'a>(sources: &Sources, diagnostic: &'a Diagnostic, color: bool) -> ariadne::Report<'a, Place> {
    let (kind, shade) = match diagnostic.severity {
        Severity::Error => (ReportKind::Error, Color::Red),
        Severity::Warning => (ReportKind::Warning, Color::Yellow),
    };
    let place = |span: Span| (sources.get(span.source).name.clone(), span.start as usize..span.end as usize);
    // The lexer counts bytes, ariadne characters unless it is told.
    let config =
        Config::default().with_index_type(IndexType::Byte).with_color(color).with_char_set(CharSet::Unicode);
    let (span, text) = &diagnostic.primary;
    let alone = if diagnostic.secondary.is_empty() { "here" } else { "" };
    let mut labels = vec![(*span, if text.is_empty() { alone } else { text }, shade)];
    labels.extend(diagnostic.secondary.iter().map(|(span, text)| (*span, text.as_str(), Color::Cyan)));
    // Lines of one text are drawn together only if they come in order.
    labels.sort_by_key(|(at, ..)| (at.source != span.source, at.source, at.start));
    let mut report = ariadne::Report::build(kind, place(*span))
        .with_config(config)
        .with_code(diagnostic.code)
        .with_message(&diagnostic.title);
    for (at, text, shade) in labels {
        let label = Label::new(place(at)).with_color(shade);
        report = report.with_label(if text.is_empty() { label } else { label.with_message(text) });
    }
    if let Some(help) = &diagnostic.help {
        report = report.with_help(help);
    }
    report.finish()
}

/// Lines longer than this are no help on a terminal, and slow to draw.
const LONGEST_LINE: usize = 4 << 10;

fn drawable(sources: &Sources, diagnostic: &Diagnostic) -> bool {
    let short = |span: &Span| {
        let text = sources.get(span.source).text.as_bytes();
        [span.start, span.end].into_iter().all(|at| {
            let (before, behind) = text.split_at((at as usize).min(text.len()));
            let to_start = before.iter().rev().take(LONGEST_LINE).take_while(|b| **b != b'\n').count();
            let to_end = behind.iter().take(LONGEST_LINE).take_while(|b| **b != b'\n').count();
            to_start + to_end < LONGEST_LINE
        })
    };
    short(&diagnostic.primary.0) && diagnostic.secondary.iter().all(|(span, _)| short(span))
}

/// One line, should the drawing fail or not be worth it.
fn plain(sources: &Sources, diagnostic: &Diagnostic) -> String {
    let source = sources.get(diagnostic.primary.0.source);
    let (line, column) = position(source, diagnostic.primary.0.start);
    format!("{}:{line}:{column}: {}: {}\n", source.name, diagnostic.code, diagnostic.title)
}

/// An array with one object a diagnostic. Lines and columns count from 1, columns in characters.
pub fn to_json(report: &Report) -> String {
    let all: Vec<Value> = report.diagnostics.iter().map(|d| object(&report.sources, d)).collect();
    Value::Array(all).to_string()
}

fn object(sources: &Sources, diagnostic: &Diagnostic) -> Value {
    let (span, label) = &diagnostic.primary;
    let secondary: Vec<Value> =
        diagnostic.secondary.iter().map(|(span, label)| place(sources, *span, label)).collect();
    let mut object = place(sources, *span, label);
    object["severity"] = json!(match diagnostic.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
    });
    object["code"] = json!(diagnostic.code.as_str());
    object["title"] = json!(diagnostic.title);
    object["secondary"] = json!(secondary);
    object["help"] = json!(diagnostic.help);
    object
}

fn place(sources: &Sources, span: Span, label: &str) -> Value {
    let source = sources.get(span.source);
    let (line, column) = position(source, span.start);
    let (end_line, end_column) = position(source, span.end);
    json!({
        "file": source.name, "line": line, "column": column,
        "end_line": end_line, "end_column": end_column, "label": label,
    })
}

/// Line and column of a byte, from 1, columns in characters.
pub fn position(source: &Source, byte: u32) -> (usize, usize) {
    let text = &source.text;
    let mut byte = (byte as usize).min(text.len());
    while !text.is_char_boundary(byte) {
        byte -= 1;
    }
    let before = &text[..byte];
    let line_start = before.rfind('\n').map_or(0, |i| i + 1);
    (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::codes;
    use crate::source::SourceId;

    fn report() -> Report {
        let mut sources = Sources::default();
        let id = sources.add(Source::new("a.ghyll", "// größer\nfn ä() = x;\n"));
        let diagnostic =
            Diagnostic::error(codes::UNKNOWN_NAME, Span::new(id, 22, 23), "nothing is called `x`")
                .label("unknown \"name\"")
                .also(Span::new(SourceId(0), 12, 14), "in this function")
                .help("did you mean `y`?");
        Report { sources, diagnostics: vec![diagnostic] }
    }

    #[test]
    fn text_shows_the_line_and_the_help() {
        let text = render(&report(), false);
        for part in ["E0202", "a.ghyll:2:10", "fn ä() = x;", "unknown \"name\"", "did you mean `y`?"] {
            assert!(text.contains(part), "{part} is not in\n{text}");
        }
        assert!(text.ends_with("`ghyll check --explain E0202` says more.\n"), "{text}");
        assert!(!text.contains('\u{1b}'));
        assert!(render(&report(), true).contains('\u{1b}'));
    }

    #[test]
    fn what_stands_in_a_huge_line_is_told_without_it() {
        let mut sources = Sources::default();
        let id = sources.add(Source::new("a.ghyll", format!("\n{}x", " ".repeat(1 << 20))));
        let at = Span::new(id, 1 << 20, (1 << 20) + 1);
        let diagnostics = vec![Diagnostic::error(codes::SYNTAX, at, "not expected")];
        let text = render(&Report { sources, diagnostics }, false);
        assert_eq!(text.lines().next(), Some("a.ghyll:2:1048576: E0104: not expected"));
    }

    #[test]
    fn nothing_that_a_terminal_acts_on_is_repeated() {
        let mut sources = Sources::default();
        let text = "a\u{1b}[31m\u{0}\u{85}\u{202e}\tx";
        assert_eq!(shown(text).len(), text.len());
        let id = sources.add(Source::new("a.ghyll", text));
        let at = Span::new(id, text.len() - 1, text.len());
        let diagnostics = vec![Diagnostic::error(codes::SYNTAX, at, "not expected")];
        let text = render(&Report { sources, diagnostics }, false);
        assert!(text.contains("a?[31m?") && !text.contains(['\u{1b}', '\0', '\u{202e}']), "{text}");
    }

    #[test]
    fn json_counts_characters_from_one() {
        let value: Value = serde_json::from_str(&to_json(&report())).unwrap();
        let first = &value[0];
        assert_eq!((first["line"].as_u64(), first["column"].as_u64()), (Some(2), Some(10)));
        assert_eq!((first["end_line"].as_u64(), first["end_column"].as_u64()), (Some(2), Some(11)));
        assert_eq!(first["code"], "E0202");
        assert_eq!(first["secondary"][0]["column"], 1);
    }
}
