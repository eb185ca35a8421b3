//! Diagnostics as text for people (ariadne) and as JSON for tools.

use ariadne::{CharSet, Config, IndexType, Label, ReportKind};
use serde_json::{Value, json};

use crate::diagnostic::{Diagnostic, Report, Severity};
use crate::source::{Source, Sources, Span};

/// Every diagnostic with the lines it is about.
pub fn render(report: &Report, color: bool) -> String {
    report.diagnostics.iter().map(|d| render_one(&report.sources, d, color)).collect()
}

fn render_one(sources: &Sources, diagnostic: &Diagnostic, color: bool) -> String {
    let kind = match diagnostic.severity {
        Severity::Error => ReportKind::Error,
        Severity::Warning => ReportKind::Warning,
    };
    let place = |span: Span| (sources.get(span.source).name.clone(), span.start as usize..span.end as usize);
    // The lexer counts bytes, ariadne characters unless it is told.
    let config =
        Config::default().with_index_type(IndexType::Byte).with_color(color).with_char_set(CharSet::Unicode);
    let (span, text) = &diagnostic.primary;
    let mut builder = ariadne::Report::build(kind, place(*span))
        .with_config(config)
        .with_code(diagnostic.code)
        .with_message(&diagnostic.title);
    let label = if text.is_empty() { "here" } else { text };
    let mut primary = Label::new(place(*span)).with_message(label).with_priority(1);
    if color {
        primary = primary.with_color(match diagnostic.severity {
            Severity::Error => ariadne::Color::Red,
            Severity::Warning => ariadne::Color::Yellow,
        });
    }
    builder = builder.with_label(primary);
    for (span, text) in &diagnostic.secondary {
        let mut label = Label::new(place(*span)).with_message(text);
        if color {
            label = label.with_color(ariadne::Color::Cyan);
        }
        builder = builder.with_label(label);
    }
    if let Some(help) = &diagnostic.help {
        builder = builder.with_help(help);
    }
    let cache = ariadne::sources(sources.iter().map(|s| (s.name.clone(), s.text.clone())));
    let mut text = Vec::new();
    match builder.finish().write(cache, &mut text) {
        Ok(()) => String::from_utf8_lossy(&text).into_owned(),
        Err(_) => plain(sources, diagnostic),
    }
}

/// One line, should the drawing fail.
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
    object["code"] = json!(diagnostic.code);
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
        assert!(!text.contains('\u{1b}'));
        assert!(render(&report(), true).contains('\u{1b}'));
    }

    #[test]
    fn json_counts_characters_from_one() {
        let value: Value = serde_json::from_str(&to_json(&report())).unwrap();
        let first = &value[0];
        assert_eq!((first["line"].as_u64(), first["column"].as_u64()), (Some(2), Some(10)));
        assert_eq!((first["end_line"].as_u64(), first["end_column"].as_u64()), (Some(2), Some(11)));
        assert_eq!(first["code"], "E0202");
        assert_eq!(first["secondary"][0]["column"], 1 + 0);
    }
}
