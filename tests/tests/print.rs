//! Every program is printed so that it is the same program, and printed again as it is.

use ghyll_compiler::parse;
use ghyll_compiler::print::{file, same_tree};
use ghyll_compiler::random::Random;
use ghyll_compiler::source::SourceId;
use ghyll_tests::corpus::corpus;
use ghyll_tests::generate::{batch, program};

/// Printed text; nothing where the text is no program.
fn survives(text: &str) -> Option<String> {
    let parsed = parse::file(SourceId(0), text);
    if !parsed.diagnostics.is_empty() {
        return None;
    }
    let printed = file(&parsed.tree);
    let again = parse::file(SourceId(0), &printed);
    assert!(again.diagnostics.is_empty(), "{:?}\n{text}\n-- printed --\n{printed}", again.diagnostics);
    assert!(same_tree(&again.tree, &parsed.tree), "{text}\n-- printed --\n{printed}");
    assert_eq!(file(&again.tree), printed);
    Some(printed)
}

#[test]
fn programs_of_the_repository_survive() {
    let corpus = corpus();
    let printed = corpus.iter().filter_map(|text| survives(text)).count();
    assert!(printed > 400, "only {printed} of {} programs", corpus.len());
}

#[test]
fn random_programs_survive() {
    let mut random = Random::new(20);
    for id in 0..300 {
        let genes: Vec<u32> = (0..random.below(500)).map(|_| random.word() as u32).collect();
        let text = batch(&[program(id, &genes)]);
        assert!(survives(&text).is_some(), "{text}");
    }
}
