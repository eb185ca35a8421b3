//! The programs of the documentation, and whether the reference manual leaves anything out.
//!
//! A block ` ```ghyll ` is a program without errors and warnings; a line `// f(1) => 2` in it states a value. A block
//! ` ```ghyll error CODE .. ` gives these codes, and one of ` ```ghyll pending "reason" ` does not work yet.

use crate::case::{self, Case};
use crate::judge::{Backend, judge_mode};
use crate::mode::Mode;
use crate::pages;
use ghyll_compiler::builtins::{Builtin, Scope};
use ghyll_compiler::explain::Block;
use ghyll_compiler::library;
use ghyll_compiler::parse::KEYWORDS;
use ghyll_compiler::typed::Attributes;
use std::collections::BTreeSet;

/// What is wrong with one block of a text, on these machines.
pub fn faults(block: &Block, backend: &dyn Backend, modes: &[Mode]) -> Vec<String> {
    let words: Vec<&str> = block.tag.split_whitespace().collect();
    match words[..] {
        ["ghyll"] => program_faults(block, backend, modes),
        ["ghyll", "error", ref codes @ ..] => {
            let found = pages::codes_of(&block.text);
            let expected: BTreeSet<String> = codes.iter().map(|code| (*code).to_owned()).collect();
            if found == expected { vec![] } else { vec![format!("expected {expected:?}, found {found:?}")] }
        }
        ["ghyll", "pending", ..] => match program_faults(block, backend, modes).is_empty() {
            true => vec!["no longer pending".to_owned()],
            false => vec![],
        },
        _ => vec![format!("`{}` is no tag of a program", block.tag)],
    }
}

fn program_faults(block: &Block, backend: &dyn Backend, modes: &[Mode]) -> Vec<String> {
    let codes = pages::codes_of(&block.text);
    if !codes.is_empty() {
        return vec![format!("expected no diagnostics, found {codes:?}")];
    }
    match values(block) {
        Ok(None) => vec![],
        Ok(Some(case)) => modes.iter().filter_map(|mode| judge_mode(&case, *mode, backend).err()).collect(),
        Err(reason) => vec![reason],
    }
}

/// The values that comments state, as a case.
fn values(block: &Block) -> Result<Option<Case>, String> {
    let stated = |line: &str| line.strip_prefix("// ").filter(|l| l.contains(") => ")).map(str::to_owned);
    let runs: String = block.text.lines().filter_map(stated).map(|run| format!("//# run {run}\n")).collect();
    if runs.is_empty() {
        return Ok(None);
    }
    let text = format!("//# case block\n{runs}{}", block.text);
    let cases = case::parse("docs", &text).map_err(|(_, reason)| reason)?;
    Ok(cases.into_iter().next())
}

/// What the manual does not explain: built-ins, attributes and everything of the library modules that a program can
/// name. Each has a row of a table of its own; the keywords are listed and stand in the grammar.
pub fn missing(manual: &str) -> Vec<String> {
    let rows: Vec<&str> = manual.lines().filter(|line| line.starts_with("| `")).collect();
    let spans: Vec<&str> = rows
        .iter()
        .flat_map(|row| row.split(" | ").next().unwrap_or(row).split('`').skip(1).step_by(2))
        .collect();
    let builtins =
        Builtin::ALL.iter().filter(|b| b.scope() != Scope::Library).map(|b| format!("{}(", b.name()));
    let mut missing: Vec<String> =
        builtins.filter(|start| !spans.iter().any(|span| span.starts_with(start.as_str()))).collect();
    let attributes = Attributes::NAMES.map(|name| format!("@{name}"));
    missing.extend(attributes.into_iter().filter(|name| !spans.contains(&name.as_str())));
    let listed = manual.lines().find(|line| line.starts_with("| keyword |")).unwrap_or_default();
    let listed: Vec<&str> = listed.split(|c: char| !c.is_alphanumeric()).collect();
    let (_, grammar) = manual.split_once("## Grammar").unwrap_or((manual, ""));
    let keywords =
        KEYWORDS.iter().filter(|word| !listed.contains(word) || !grammar.contains(&format!("\"{word}\"")));
    missing.extend(keywords.map(|word| format!("keyword {word}")));
    for (_, text) in library::MODULES {
        missing.extend(signatures(text).into_iter().filter(|wanted| !spans.contains(&wanted.as_str())));
    }
    missing
}

/// What a library module lets a program name, as it is declared.
fn signatures(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    let starts = text.match_indices('\n').map(|(at, _)| at + 1).chain([0]);
    for item in starts.map(|at| &text[at..]) {
        let item =
            item.trim_start_matches("@task ").trim_start_matches("@inline ").trim_start_matches("@bake ");
        let Some((kind, rest)) = item.split_once(' ') else { continue };
        let (end, keep) = match kind {
            "fn" => ([" = ", " =\n", "{", ";"].into_iter().filter_map(|end| rest.find(end)).min(), ""),
            "struct" => (rest.find(';'), "struct "),
            "enum" => (rest.find('\n'), "enum "),
            "type" => (rest.find(';'), "type "),
            "const" => (rest.find([':', ' ']), ""),
            _ => continue,
        };
        let declared = rest[..end.unwrap_or(rest.len())].split_whitespace().collect::<Vec<_>>().join(" ");
        let declared = declared.replace("( ", "(").replace(" )", ")").replace(",)", ")");
        if !declared.starts_with('_') {
            found.push(format!("{keep}{declared}"));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signatures_are_as_declared() {
        let text = "/// One.\nfn one(\n    x: f32,\n    y: fn(A) -> B,\n) -> f32 = x;\nfn _hidden() -> i32 = 1;\n@task fn two() -> (f32, u32) =\n\
                    1 = 2;\nstruct S(a: f32);\ntype T = fn(f32) -> f32;\nconst FAR = 1e9;\nenum E<A> { Some(A), None }\n";
        let expected = [
            "one(x: f32, y: fn(A) -> B) -> f32",
            "two() -> (f32, u32)",
            "struct S(a: f32)",
            "type T = fn(f32) -> f32",
            "FAR",
            "enum E<A> { Some(A), None }",
        ];
        let found: BTreeSet<String> = signatures(text).into_iter().collect();
        assert_eq!(found, expected.map(str::to_owned).into());
    }

    #[test]
    fn what_is_left_out_is_missed() {
        let all = missing("");
        assert!(
            all.contains(&"atan2(".to_owned()) && all.contains(&"hash(x: u32) -> u32".to_owned()),
            "{all:?}"
        );
        assert!(!missing("| `atan2(y, x)` |").contains(&"atan2(".to_owned()));
        assert!(missing("atan2(y, x)").contains(&"atan2(".to_owned()));
        assert!(missing("Not a row: `atan2(y, x)`").contains(&"atan2(".to_owned()));
        assert!(missing("| `acos(x)` | see `atan2(y, x)` |").contains(&"atan2(".to_owned()));
        assert!(
            all.contains(&"@bake".to_owned())
                && !missing("| `@bake` | meaning |").contains(&"@bake".to_owned())
        );
        let half = "| keyword | `use with` |\n## Grammar\n\"use\"";
        assert!(
            all.contains(&"keyword use".to_owned()) && !missing(half).contains(&"keyword use".to_owned())
        );
        assert!(missing(half).contains(&"keyword with".to_owned()));
    }

    #[test]
    fn stated_values_become_runs() {
        let block = |text: &str| Block { tag: "ghyll".into(), text: text.into(), line: 1 };
        assert!(matches!(values(&block("fn main() -> i32 = 1; // not main() => 2\n")), Ok(None)));
        let case = values(&block("fn main() -> i32 = 1;\n// main() => 1\n// main() => 2\n"));
        assert_eq!(case.map(|c| c.map(|c| c.expectations.len())), Ok(Some(2)));
        assert!(values(&block("fn main() -> i32 = 1;\n// main() => 1 +\n")).is_err());
    }
}
