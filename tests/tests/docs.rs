//! The documentation is true: one trial for each page about a diagnostic.

use ghyll_compiler::{codes, explain};
use ghyll_tests::pages;
use libtest_mimic::{Arguments, Failed, Trial};

fn main() {
    let mut trials = vec![Trial::test("docs::errors::complete", complete)];
    for (code, title) in codes::ALL {
        let Ok(page) = explain::page(code) else { continue };
        trials.push(Trial::test(format!("docs::errors::{code}"), move || {
            verdict(pages::faults(code, title, page))
        }));
    }
    libtest_mimic::run(&Arguments::from_args(), trials).exit();
}

fn verdict(faults: Vec<String>) -> Result<(), Failed> {
    if faults.is_empty() { Ok(()) } else { Err(faults.join("\n").into()) }
}

/// Every code has a page, every page a code.
fn complete() -> Result<(), Failed> {
    let known = |code: &str| codes::ALL.iter().any(|(known, _)| *known == code);
    let missing = codes::ALL.iter().filter(|(code, _)| explain::page(code).is_err());
    let missing = missing.map(|(code, _)| format!("docs/errors/{code}.md is missing"));
    let stray = explain::PAGES.iter().filter(|(code, _)| !known(code));
    let stray = stray.map(|(code, _)| format!("docs/errors/{code}.md explains no code"));
    verdict(missing.chain(stray).collect())
}
