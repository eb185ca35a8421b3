//! Rows of the reference manual's tables, as descriptions of what they are about.

use std::collections::HashMap;
use std::sync::OnceLock;

const MANUAL: &str = include_str!("../../../docs/language.md");

/// Letters that stand for types in the manual's tables.
const LETTERS: &[(&str, &str)] = &[
    ("F", "`f32`, `vec2`, `vec3` or `vec4`"),
    ("N", "`f32`, `vec2`, `vec3`, `vec4`, `i32`, `u32`, `ivec2` or `ivec3`"),
    ("I", "`i32` or `u32`"),
    ("V", "`vec2`, `vec3` or `vec4`"),
    ("M", "`mat2`, `mat3` or `mat4`"),
    ("T", "any data type"),
];

/// What the manual says about a name: how it is written, and a text in Markdown.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    pub signature: String,
    pub text: String,
}

pub fn row(name: &str) -> Option<&'static Row> {
    static ROWS: OnceLock<HashMap<String, Row>> = OnceLock::new();
    ROWS.get_or_init(|| rows(MANUAL)).get(name)
}

/// Whether the manual has a row for a name.
pub fn described(name: &str) -> bool {
    row(name).is_some()
}

fn rows(manual: &str) -> HashMap<String, Row> {
    let mut rows = HashMap::new();
    let mut header: Vec<&str> = Vec::new();
    let tables = manual.lines().skip_while(|line| *line != "## Built-in functions");
    for line in tables.take_while(|line| *line != "## Command line") {
        let Some(line) = line.strip_prefix('|') else {
            header.clear();
            continue;
        };
        let cells: Vec<&str> = line.trim_end_matches('|').split(" | ").map(str::trim).collect();
        if header.is_empty() {
            header = cells;
            continue;
        }
        let Some((names, texts)) = cells.split_first() else { continue };
        for signature in names.split('`').skip(1).step_by(2) {
            let text = texts.iter().enumerate().filter(|(_, text)| !text.is_empty());
            let text: Vec<String> = text
                .map(|(i, text)| match header.get(i + 1) {
                    Some(&"error") => format!("Error: {text}."),
                    _ => (*text).to_owned(),
                })
                .chain(letters(signature))
                .collect();
            let row = Row { signature: signature.to_owned(), text: text.join("\n\n") };
            rows.entry(named(signature).to_owned()).or_insert(row);
        }
    }
    rows
}

/// The name that a signature is of.
fn named(signature: &str) -> &str {
    let rest = ["struct ", "type "].iter().find_map(|word| signature.strip_prefix(word)).unwrap_or(signature);
    let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len());
    &rest[..end]
}

/// What the letters in a signature stand for.
fn letters(signature: &str) -> Option<String> {
    let words: Vec<&str> = signature.split(|c: char| !c.is_ascii_alphanumeric()).collect();
    let used = LETTERS.iter().filter(|(letter, _)| words.contains(letter));
    let used: Vec<String> = used.map(|(letter, types)| format!("{letter} is {types}")).collect();
    (!used.is_empty()).then(|| format!("{}.", used.join("; ")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtins::{Builtin, Scope};

    #[test]
    fn every_built_in_has_a_row() {
        let public = Builtin::ALL.iter().filter(|b| b.scope() != Scope::Library);
        let missing: Vec<&str> = public.map(|b| b.name()).filter(|name| !described(name)).collect();
        assert!(missing.is_empty(), "not in a table of docs/language.md: {missing:?}");
    }

    #[test]
    fn rows_are_read_by_column() {
        let max = row("max").unwrap();
        assert_eq!(max.signature, "max(N, N) -> N");
        assert!(
            max.text.starts_with("the smaller, the larger\n\nError: exact.\n\nN is `f32`"),
            "{}",
            max.text
        );
        assert_eq!(row("Ray").unwrap().signature, "struct Ray(origin: vec3, dir: vec3, near: f32, far: f32)");
        assert!(!described("mx"));
    }
}
