//! A comparison that cannot fail is worthless: a backend with planted answers must be caught.

use super::*;
use crate::case::parse;

/// Answers what it was told to.
#[derive(Clone)]
struct Planted {
    diagnostics: Vec<Diagnostic>,
    answer: Result<Answer, Failure>,
    tasks: Vec<String>,
    picture: Vec<f32>,
}

impl Backend for Planted {
    fn check(&self, _: &Program, _: &Settings) -> Vec<Diagnostic> {
        self.diagnostics.clone()
    }

    fn run(&self, _: &Program, _: &Settings, _: Mode, calls: &[Call]) -> Vec<Result<Answer, Failure>> {
        vec![self.answer.clone(); calls.len()]
    }

    fn render(&self, _: &Program, _: &Settings, mode: Mode, _: &Render) -> Result<Picture, Failure> {
        let oracle = vec![0.0, 0.25, 0.5, 0.75];
        let values = if mode == Mode::Oracle { oracle } else { self.picture.clone() };
        Ok(Picture { width: 2, components: 1, values })
    }

    fn tasks(&self, _: &Program, _: &Settings, _: &str) -> Result<Vec<String>, Failure> {
        Ok(self.tasks.clone())
    }

    fn trace(&self, _: &Program, _: &Settings, _: &Call) -> Result<Vec<String>, Failure> {
        Ok(self.tasks.clone())
    }
}

fn answering(value: &str) -> Planted {
    Planted {
        diagnostics: Vec::new(),
        answer: Ok(Answer { value: value.into(), rounds: Some(5) }),
        tasks: vec!["fib".into()],
        picture: vec![0.0, 0.25, 0.5, 0.75],
    }
}

fn case(header: &str) -> Case {
    let text = format!("//# case a\n{header}\nfn main() -> i32 = 1;\n");
    let mut cases = parse("topic", &text).expect(header);
    Mode::in_turn(&mut cases, false);
    cases.remove(0)
}

fn program_verdict(header: &str, backend: &Planted) -> Result<(), String> {
    judge_program(&case(header), backend)
}

fn mode_verdict(header: &str, backend: &Planted) -> Result<(), String> {
    judge_mode(&case(header), Mode::CpuAuto, backend)
}

fn found(severity: Severity, code: &str, line: u32, column: u32, part: &str) -> Diagnostic {
    Diagnostic { severity, file: String::new(), code: code.into(), line, column, part: part.into() }
}

#[test]
fn a_wrong_value_is_reported() {
    assert_eq!(mode_verdict("//# run main() => 55", &answering("55")), Ok(()));
    for wrong in ["56", "55.0", "(55, 1)", "nothing at all", ""] {
        assert!(mode_verdict("//# run main() => 55", &answering(wrong)).is_err(), "{wrong}");
    }
    assert!(mode_verdict("//# run main() => 1.0 ~ 0.01", &answering("1.02")).is_err());
    let both = "//# run main() => 55\n//# run main(1) => 56";
    let verdict = mode_verdict(both, &answering("55"));
    assert_eq!(verdict, Err("main(1): expected 56, got 55".into()));
}

#[test]
fn a_missing_answer_is_reported() {
    struct Silent;
    impl Backend for Silent {
        fn check(&self, _: &Program, _: &Settings) -> Vec<Diagnostic> {
            Vec::new()
        }
        fn run(&self, _: &Program, _: &Settings, _: Mode, _: &[Call]) -> Vec<Result<Answer, Failure>> {
            Vec::new()
        }
        fn render(&self, _: &Program, _: &Settings, _: Mode, _: &Render) -> Result<Picture, Failure> {
            Err(Failure::Run("none".into()))
        }
        fn tasks(&self, _: &Program, _: &Settings, _: &str) -> Result<Vec<String>, Failure> {
            Ok(Vec::new())
        }
        fn trace(&self, _: &Program, _: &Settings, _: &Call) -> Result<Vec<String>, Failure> {
            Ok(Vec::new())
        }
    }
    assert!(judge_mode(&case("//# run main() => 1"), Mode::Oracle, &Silent).is_err());
    assert!(judge_mode(&case("//# render pixel 2x2"), Mode::Oracle, &Silent).is_err());
}

#[test]
fn a_failure_is_matched_by_status_and_text() {
    let ended = |failure| Planted { answer: Err(failure), ..answering("") };
    let out_of_memory = ended(Failure::Run("fib needs 64 KiB".into()));
    assert_eq!(mode_verdict("//# fails main() => 3 \"fib\"", &out_of_memory), Ok(()));
    assert!(mode_verdict("//# fails main() => 3 \"loop\"", &out_of_memory).is_err());
    assert!(mode_verdict("//# fails main() => 1 \"fib\"", &out_of_memory).is_err());
    assert!(mode_verdict("//# fails main() => 3 \"fib\"", &answering("1")).is_err());
    assert!(mode_verdict("//# run main() => 1", &out_of_memory).is_err());
    assert!(mode_verdict("//# rounds main() <= 9", &out_of_memory).is_err());
}

#[test]
fn too_many_rounds_are_reported() {
    assert_eq!(mode_verdict("//# rounds main() <= 5", &answering("1")), Ok(()));
    assert!(mode_verdict("//# rounds main() <= 4", &answering("1")).is_err());
}

#[test]
fn other_tasks_are_reported() {
    assert_eq!(program_verdict("//# tasks main => fib", &answering("1")), Ok(()));
    assert!(program_verdict("//# tasks main => fib main", &answering("1")).is_err());
    assert!(program_verdict("//# trace main()\n//# stream 1 fob", &answering("1")).is_err());
    assert!(program_verdict("//# trace main()\n//# stream fib\n//# stream 1", &answering("1")).is_err());
}

#[test]
fn diagnostics_must_be_those_expected_and_no_others() {
    let wrong = found(Severity::Error, "E0301", 2, 7, "Expected i32, found f32");
    let with = |diagnostics: &[Diagnostic]| Planted { diagnostics: diagnostics.to_vec(), ..answering("1") };
    let header = "//# error E0301 at 2:7 \"expected i32\"";
    assert_eq!(program_verdict(header, &with(std::slice::from_ref(&wrong))), Ok(()));
    assert_eq!(program_verdict("//# error at 2:7", &with(std::slice::from_ref(&wrong))), Ok(()));
    for other in [
        found(Severity::Error, "E0302", 2, 7, "expected i32"),
        found(Severity::Error, "E0301", 3, 7, "expected i32"),
        found(Severity::Error, "E0301", 2, 8, "expected i32"),
        found(Severity::Error, "E0301", 2, 7, "expected bool"),
        found(Severity::Warning, "E0301", 2, 7, "expected i32"),
    ] {
        assert!(program_verdict(header, &with(&[other])).is_err());
    }
    assert!(program_verdict(header, &with(&[])).is_err());
    assert!(program_verdict(header, &with(&[wrong.clone(), wrong.clone()])).is_err());
    assert!(program_verdict("//# run main() => 1", &with(&[wrong])).is_err());
}

#[test]
fn wrong_pixels_are_reported() {
    let painting = |picture: &[f32]| Planted { picture: picture.to_vec(), ..answering("1") };
    let same = painting(&[0.0, 0.25, 0.5, 0.75]);
    let other = painting(&[0.0, 0.25, 0.5, 0.76]);
    let plain = "//# render pixel 2x2";
    assert_eq!(mode_verdict(plain, &same), Ok(()));
    assert!(mode_verdict(plain, &other).is_err());
    assert!(mode_verdict(plain, &painting(&[0.0, 0.25, 0.5])).is_err());
    assert!(mode_verdict(plain, &painting(&[0.0, 0.25, 0.5, f32::NAN])).is_err());
    assert_eq!(mode_verdict(&format!("{plain}\n//# tolerance 0.02 because \"test\""), &other), Ok(()));
    assert_eq!(mode_verdict(&format!("{plain}\n//# tolerance 0 but 0.25 because \"test\""), &other), Ok(()));
    assert!(mode_verdict(&format!("{plain}\n//# tolerance 0 but 0.2 because \"test\""), &other).is_err());
    assert!(mode_verdict("//# render pixel 4x1", &same).is_err());
    assert_eq!(mode_verdict(&format!("{plain}\n//# pixel 1,1 => 0.75"), &same), Ok(()));
    assert!(mode_verdict(&format!("{plain}\n//# pixel 1,1 => 0.5"), &same).is_err());
    assert!(mode_verdict(&format!("{plain}\n//# pixel 2,2 => 0.5"), &same).is_err());
}

#[test]
fn a_broken_case_must_fail() {
    let case = case("//# broken \"not done\"\n//# run main() => 1");
    assert_eq!(judge_broken(&case, "not done", &answering("2"), &[Mode::CpuAuto]), Ok(()));
    assert!(judge_broken(&case, "not done", &answering("1"), &[Mode::CpuAuto]).is_err());
}
