//! Runs the case files below `suite/`: one named trial for each case and mode.

use ghyll_compiler::codes;
use ghyll_tests::backend::Ghyll;
use ghyll_tests::case::{self, Case, Expectation};
use ghyll_tests::judge::{judge_broken, judge_mode, judge_program, runs};
use ghyll_tests::mode::Mode;
use libtest_mimic::{Arguments, Failed, Trial};
use std::path::Path;
use std::sync::Arc;

fn main() {
    let arguments = Arguments::from_args();
    let (mut cases, errors) = case::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("suite"));
    Mode::in_turn(&mut cases, flag("GHYLL_ALL_MODES"));
    let (mut backend, adapter) = Ghyll::open();
    // A few cases are run by themselves, so that what is seen is what a program of its own does.
    if arguments.filter.is_none() && !arguments.list && !flag("GHYLL_ALONE") && adapter.is_ok() {
        backend.gather(&cases);
    }
    let backend = Arc::new(backend);
    let count = cases.len();
    let mut trials = vec![
        adapter_trial(adapter),
        Trial::test("suite::headers", move || {
            let lines: Vec<String> = errors.iter().map(ToString::to_string).collect();
            if lines.is_empty() && count > 0 { Ok(()) } else { Err(lines.join("\n").into()) }
        }),
    ];
    let missing = codes_without_a_case(cases.iter());
    let without_one = codes_without_a_case(cases.iter().filter(|case| !expects(case, codes::MISMATCH)));
    trials.push(Trial::test("suite::codes", move || {
        if missing.is_empty() {
            Ok(())
        } else {
            Err(format!("no case expects {}", missing.join(", ")).into())
        }
    }));
    trials.push(Trial::test("suite::codes_without_a_case_are_found", move || {
        let only = [codes::MISMATCH.as_str()];
        if without_one == only { Ok(()) } else { Err(format!("found {without_one:?}").into()) }
    }));
    for case in cases {
        trials.extend(trials_of(Arc::new(case), &backend));
    }
    libtest_mimic::run(&arguments, trials).exit();
}

fn flag(name: &str) -> bool {
    std::env::var_os(name).is_some_and(|v| v != "0")
}

/// Says which adapter the trials reach; without one this fails where an adapter is required, else it is ignored like
/// all trials on the GPU.
fn adapter_trial(adapter: Result<String, String>) -> Trial {
    let required = flag("GHYLL_REQUIRE_GPU");
    match &adapter {
        Ok(name) => println!("adapter: {name}"),
        Err(reason) => println!("adapter: none ({reason}); the GPU's trials are ignored"),
    }
    let missing = adapter.is_err();
    Trial::test("suite::adapter", move || adapter.map(|_| ()).map_err(Failed::from))
        .with_ignored_flag(missing && !required)
}

/// Codes of diagnostics that no case asks for, but for those that stand behind a hundred others, and for what is only
/// not supported yet (E09).
fn codes_without_a_case<'a>(cases: impl Iterator<Item = &'a Case> + Clone) -> Vec<&'static str> {
    let expected = |code: codes::Code| cases.clone().any(|case| expects(case, code));
    let beyond = [codes::TOO_MANY, codes::MANY_WARNINGS];
    let needed = |c: &codes::Code| !beyond.contains(c) && !c.as_str()[1..].starts_with("09");
    let all = codes::ALL.iter().map(|(code, _)| *code);
    all.filter(|c| needed(c) && !expected(*c)).map(codes::Code::as_str).collect()
}

fn expects(case: &Case, code: codes::Code) -> bool {
    case.expectations.iter().any(|e| matches!(e, Expectation::Diagnostic(d) if d.code == code.as_str()))
}

/// `suite::recursion::numbers::fib::check`, and one for each mode.
fn trials_of(case: Arc<Case>, backend: &Arc<Ghyll>) -> Vec<Trial> {
    let name = format!("suite::{}::{}", case.topic.replace('/', "::"), case.name);
    if let Some(reason) = case.broken.clone() {
        let backend = backend.clone();
        let modes: Vec<Mode> = case.modes.iter().copied().filter(|m| backend.runs(*m)).collect();
        let run = move || told(judge_broken(&case, &reason, &*backend, &modes), &case);
        return vec![Trial::test(format!("{name}::broken"), run)];
    }
    let mut trials = Vec::new();
    {
        let (case, backend) = (case.clone(), backend.clone());
        trials.push(Trial::test(format!("{name}::check"), move || {
            told(judge_program(&case, &*backend), &case)
        }));
    }
    if !runs(&case) {
        return trials;
    }
    for mode in case.modes.clone() {
        let (case, backend) = (case.clone(), backend.clone());
        let ignored = !backend.runs(mode);
        let run = move || told(judge_mode(&case, mode, &*backend), &case);
        trials.push(Trial::test(format!("{name}::{}", mode.name()), run).with_ignored_flag(ignored));
    }
    trials
}

fn told(verdict: Result<(), String>, case: &Case) -> Result<(), Failed> {
    verdict.map_err(|text| format!("tests/suite/{}.ghyll:{}\n{text}", case.topic, case.line).into())
}
