//! The documentation is true: one trial for each page about a diagnostic and for each program in the other texts.

use ghyll_compiler::{codes, explain};
use ghyll_tests::backend::Ghyll;
use ghyll_tests::case;
use ghyll_tests::mode::Mode;
use ghyll_tests::{manual, pages};
use libtest_mimic::{Arguments, Failed, Trial};
use std::sync::Arc;

/// Texts with programs in them.
const TEXTS: &[&str] = &["README.md", "docs/language.md"];

/// Of so many programs one goes to the GPU too; the suite has most of their kind.
const GPU_TURN: usize = 4;

fn main() {
    let (backend, _) = Ghyll::open();
    let backend = Arc::new(backend);
    let mut trials = vec![
        Trial::test("docs::errors::complete", complete),
        Trial::test("docs::language::complete", || {
            verdict(
                manual::missing(&text("docs/language.md")?)
                    .iter()
                    .map(|what| format!("not in the manual: {what}"))
                    .collect(),
            )
        }),
    ];
    for (code, title) in codes::ALL {
        let code = code.to_string();
        let Ok(page) = explain::page(&code) else { continue };
        trials.push(Trial::test(format!("docs::errors::{code}"), move || {
            verdict(pages::faults(&code, title, page))
        }));
    }
    for path in TEXTS {
        trials.extend(programs_of(path, &backend));
    }
    libtest_mimic::run(&Arguments::from_args(), trials).exit();
}

/// A trial for each program of a text, named by its line; a text without programs is a mistake.
fn programs_of(path: &'static str, backend: &Arc<Ghyll>) -> Vec<Trial> {
    let name = path.trim_start_matches("docs/").trim_end_matches(".md").to_lowercase();
    let text = match text(path) {
        Ok(text) => text,
        Err(error) => return vec![Trial::test(format!("docs::{name}"), || Err(error))],
    };
    let programs: Vec<_> =
        explain::blocks(&text).into_iter().filter(|block| block.tag.starts_with("ghyll")).collect();
    if programs.is_empty() {
        return vec![Trial::test(format!("docs::{name}"), || Err("no program in this text".into()))];
    }
    let trial = |(index, block): (usize, explain::Block)| {
        let backend = backend.clone();
        let gpu = (index % GPU_TURN == 0).then_some(Mode::GpuAuto);
        Trial::test(format!("docs::{name}::line-{}", block.line), move || {
            let modes: Vec<Mode> =
                Mode::usual().into_iter().chain(gpu).filter(|mode| backend.runs(*mode)).collect();
            verdict(manual::faults(&block, &*backend, &modes))
        })
    };
    programs.into_iter().enumerate().map(trial).collect()
}

fn text(path: &str) -> Result<String, Failed> {
    std::fs::read_to_string(case::root().join(path)).map_err(|e| format!("{path}: {e}").into())
}

fn verdict(faults: Vec<String>) -> Result<(), Failed> {
    if faults.is_empty() { Ok(()) } else { Err(faults.join("\n").into()) }
}

/// Every code has a page, every page a code. What is not supported yet (E09) needs none.
fn complete() -> Result<(), Failed> {
    let known: Vec<String> = codes::ALL.iter().map(|(code, _)| code.to_string()).collect();
    let missing = known.iter().filter(|code| !code[1..].starts_with("09") && explain::page(code).is_err());
    let missing = missing.map(|code| format!("docs/errors/{code}.md is missing"));
    let stray = explain::PAGES.iter().filter(|(code, _)| !known.iter().any(|known| known == code));
    let stray = stray.map(|(code, _)| format!("docs/errors/{code}.md explains no code"));
    verdict(missing.chain(stray).collect())
}
