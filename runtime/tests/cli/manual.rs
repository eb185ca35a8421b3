//! The reference manual names every command and every option.

use crate::support::Folder;
use std::path::Path;

/// The first words of the rows of tables.
fn rows(manual: &str) -> Vec<&str> {
    let (_, text) = manual.split_once("## Command line").expect("the manual has the section");
    text.lines().filter_map(|line| line.strip_prefix("| `")?.split(" | ").next()).collect()
}

/// What the help of `ghyll` and its commands lists and no row has.
fn missing(manual: &str, help: impl Fn(&[&str]) -> String) -> Vec<String> {
    let rows = rows(manual);
    let has = |word: &str| {
        rows.iter().any(|row| {
            let mut words = row.split(|c: char| !c.is_alphanumeric() && c != '-');
            words.any(|found| found == word)
        })
    };
    let overview = help(&["help"]);
    let listed = overview.split("Commands:").nth(1).expect("commands are listed");
    let commands: Vec<&str> = listed
        .lines()
        .skip(1)
        .take_while(|line| !line.is_empty())
        .filter_map(|line| line.strip_prefix("  ").filter(|l| !l.starts_with(' ')))
        .filter_map(|line| line.split_whitespace().next())
        .filter(|command| *command != "help")
        .collect();
    let mut missing: Vec<String> = Vec::new();
    for command in &commands {
        if !rows.iter().any(|row| row.starts_with(&format!("ghyll {command}"))) {
            missing.push(format!("ghyll {command}"));
        }
        for line in help(&["help", command]).lines() {
            let mut words = line.split_whitespace().map(|word| word.trim_end_matches(','));
            let option = words.find(|word| !word.starts_with('-') || word.starts_with("--"));
            let Some(option) = option.filter(|word| word.starts_with("--") && line.starts_with(' ')) else {
                continue;
            };
            let option = option.split(['=', '[']).next().unwrap_or(option);
            if !has(option) {
                missing.push(format!("{command} {option}"));
            }
        }
    }
    assert!(commands.len() >= 8, "commands are found: {commands:?}");
    missing
}

#[test]
fn every_command_and_option_has_a_row() {
    let folder = Folder::new("every_command_and_option_has_a_row");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/language.md");
    let manual = std::fs::read_to_string(path).expect("the manual is there");
    let help = |arguments: &[&str]| folder.ghyll_with(arguments).printed().to_owned();
    assert_eq!(missing(&manual, help), Vec::<String>::new());
    // What is taken away is missed.
    let without = manual.replace("`--fov DEG`", "`--field DEG`").replace("| `ghyll map", "| `ghyll plot");
    assert_eq!(missing(&without, help), ["render --fov", "ghyll map", "view --fov"]);
}
