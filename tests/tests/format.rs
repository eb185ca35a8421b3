//! Every program is formatted so that it is the same program with the same comments, and formatted again as it is.

use ghyll_compiler::format::format;
use ghyll_compiler::lexer::{Lexeme, lex};
use ghyll_compiler::parse;
use ghyll_compiler::print::same_tree;
use ghyll_compiler::random::Random;
use ghyll_compiler::source::SourceId;
use ghyll_tests::corpus::corpus;
use ghyll_tests::generate::{batch, program};
use std::path::Path;

/// Lexemes without commas, as written.
fn lexemes(text: &str) -> Vec<&str> {
    let all = lex(SourceId(0), text).lexemes;
    all.into_iter()
        .filter(|(_, lexeme, _)| *lexeme != Lexeme::Comma)
        .map(|(from, _, to)| &text[from..to])
        .collect()
}

/// What is neither blank nor lexeme nor comma.
fn rest(text: &str) -> String {
    let mut rest = text.as_bytes().to_vec();
    for (from, _, to) in lex(SourceId(0), text).lexemes {
        rest[from..to].fill(b' ');
    }
    String::from_utf8_lossy(&rest).split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Formatted text; nothing where the text is no program.
fn survives(text: &str) -> Option<String> {
    let parsed = parse::file(SourceId(0), text);
    if !parsed.diagnostics.is_empty() {
        assert!(format(SourceId(0), text).is_err(), "{text}");
        return None;
    }
    let formatted = format(SourceId(0), text).expect("a program");
    let again = parse::file(SourceId(0), &formatted);
    assert!(same_tree(&again.tree, &parsed.tree), "{text}\n-- formatted --\n{formatted}");
    assert_eq!(lexemes(&formatted), lexemes(text));
    assert_eq!(rest(&formatted), rest(text));
    assert_eq!(format(SourceId(0), &formatted).as_ref(), Ok(&formatted), "{text}");
    Some(formatted)
}

#[test]
fn programs_of_the_repository_survive() {
    let corpus = corpus();
    let formatted = corpus.iter().filter_map(|text| survives(text)).count();
    assert!(formatted > 400, "only {formatted} of {} programs", corpus.len());
}

/// Programs in which all that can be on one line is, or that are cut into as many lines as there are lexemes, with
/// comments between any two.
#[test]
fn programs_survive_any_line_ends() {
    let mut random = Random::new(7);
    for text in corpus() {
        let all = lex(SourceId(0), &text).lexemes;
        if text.len() > 4000 || !parse::file(SourceId(0), &text).diagnostics.is_empty() {
            continue;
        }
        for style in 0..3 {
            let mut other = String::new();
            let mut end = 0;
            for (from, _, to) in &all {
                if from == to {
                    continue;
                }
                if end < *from {
                    other.push_str(match (style, random.below(12)) {
                        (0, _) => " ",
                        (1, _) => "\n",
                        (_, 0) => " // c\n",
                        (_, 1) => "\n\n\n// c\n",
                        (_, 2) => " /* c */ ",
                        (_, 3) => "\n /* c\n   d */\n",
                        (_, 4..7) => "\n",
                        _ => " ",
                    });
                }
                other.push_str(&text[*from..*to]);
                end = *to;
            }
            assert!(survives(&other).is_some(), "{other}");
        }
    }
}

#[test]
fn random_programs_survive() {
    let mut random = Random::new(21);
    for id in 0..300 {
        let genes: Vec<u32> = (0..random.below(500)).map(|_| random.word() as u32).collect();
        let text = batch(&[program(id, &genes)]);
        assert!(survives(&text).is_some(), "{text}");
    }
}

#[test]
fn differences_are_noticed() {
    let text = "// a\nfn f(x: f32) -> f32 = x + 1.0; // b\n";
    assert_ne!(lexemes(text), lexemes(&text.replace("1.0", "1.00")));
    assert_ne!(rest(text), rest(&text.replace("// b", "")));
}

/// The examples, and the programs of the manual and of the README, are written as `ghyll fmt` writes them.
#[test]
fn examples_are_formatted() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut found = 0;
    for folder in ["lang-examples", "compiler/std", "benches"] {
        for entry in std::fs::read_dir(root.join(folder)).expect("the folder is there") {
            let path = entry.expect("an entry").path();
            if path.extension().is_some_and(|ending| ending == "ghyll") {
                let text = std::fs::read_to_string(&path).expect("a text");
                assert_eq!(
                    format(SourceId(0), &text).as_ref(),
                    Ok(&text),
                    "run `ghyll fmt {}`",
                    path.display()
                );
                found += 1;
            }
        }
    }
    assert!(found > 25, "{found} programs");
}
