//! Compares what a backend answers with what a case expects. Every mismatch is told, not only the first.

use crate::case::{
    Call, Case, Diagnostic, Expectation, PictureTolerance, Program, Render, Settings, Severity,
};
use crate::mode::Mode;
use crate::value::{Tolerance, Value};

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq)]
pub enum Failure {
    /// Exit status 1.
    Diagnostics(Vec<Diagnostic>),
    /// Exit status 1: an input is wrong.
    Input(String),
    /// Exit status 2: what was asked for is not in the program.
    Usage(String),
    /// Exit status 2: a value that was given is wrong.
    Value(Vec<Diagnostic>),
    /// Exit status 3.
    Run(String),
}

impl Failure {
    pub fn status(&self) -> u8 {
        match self {
            Failure::Diagnostics(_) | Failure::Input(_) => 1,
            Failure::Usage(_) | Failure::Value(_) => 2,
            Failure::Run(_) => 3,
        }
    }
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Failure::Diagnostics(found) | Failure::Value(found) => {
                let lines: Vec<String> = found.iter().map(shown).collect();
                write!(f, "{}", lines.join("; "))
            }
            Failure::Input(text) | Failure::Usage(text) | Failure::Run(text) => write!(f, "{text}"),
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// In Ghyll syntax.
    pub value: String,
    /// Where the mode works in rounds.
    pub rounds: Option<u32>,
}

/// Pixels row by row from the top, `components` floats each.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    pub width: u32,
    pub components: u32,
    pub values: Vec<f32>,
}

/// What the suite needs of an implementation of the language.
pub trait Backend: Send + Sync {
    /// Every diagnostic of the program's own text, warnings included.
    fn check(&self, program: &Program, settings: &Settings) -> Vec<Diagnostic>;

    /// One answer for each call; the program is compiled once for each entry.
    fn run(
        &self,
        program: &Program,
        settings: &Settings,
        mode: Mode,
        calls: &[Call],
    ) -> Vec<Result<Answer, Failure>>;

    fn render(
        &self,
        program: &Program,
        settings: &Settings,
        mode: Mode,
        render: &Render,
    ) -> Result<Picture, Failure>;

    /// Names of the source functions in the function table, sorted, each once.
    fn tasks(&self, program: &Program, settings: &Settings, entry: &str) -> Result<Vec<String>, Failure>;

    fn trace(&self, program: &Program, settings: &Settings, call: &Call) -> Result<Vec<String>, Failure>;
}

/// The verdict of all trials of a case together: a case said to be broken must fail in one of them at least.
pub fn judge_broken(case: &Case, reason: &str, backend: &dyn Backend, modes: &[Mode]) -> Result<(), String> {
    let fails = judge_program(case, backend).is_err()
        || runs(case) && modes.iter().any(|mode| judge_mode(case, *mode, backend).is_err());
    if fails { Ok(()) } else { Err(format!("no longer broken: take away `broken \"{reason}\"`")) }
}

/// What is the same in every mode: diagnostics, the function table, the trace.
pub fn judge_program(case: &Case, backend: &dyn Backend) -> Result<(), String> {
    let mut report = Report::default();
    compare_diagnostics(case, backend.check(&case.program, &case.settings), &mut report);
    for expectation in &case.expectations {
        match expectation {
            Expectation::Tasks { entry, functions } => {
                let found = backend.tasks(&case.program, &case.settings, entry);
                report.same(&format!("tasks of {entry}"), functions, found);
            }
            Expectation::Trace { call, streams } => {
                let found = backend.trace(&case.program, &case.settings, call);
                report.same(&format!("trace of {}", told(call)), streams, found);
            }
            _ => {}
        }
    }
    report.verdict()
}

/// Whether the case has anything to run, so that it deserves a trial for each mode.
pub fn runs(case: &Case) -> bool {
    case.expectations.iter().any(|e| {
        matches!(
            e,
            Expectation::Run { .. }
                | Expectation::Fails { .. }
                | Expectation::Render(_)
                | Expectation::Rounds { .. }
        )
    })
}

/// Values, failures and pictures of one mode.
pub fn judge_mode(case: &Case, mode: Mode, backend: &dyn Backend) -> Result<(), String> {
    let mut report = Report::default();
    let wanted: Vec<(&Expectation, &Call)> =
        case.expectations.iter().filter_map(|e| called(e).map(|call| (e, call))).collect();
    if !wanted.is_empty() {
        let calls: Vec<Call> = wanted.iter().map(|(_, call)| (*call).clone()).collect();
        let answers = backend.run(&case.program, &case.settings, mode, &calls);
        if answers.len() != calls.len() {
            report.add(format!("{} calls, {} answers", calls.len(), answers.len()));
        }
        for ((expectation, call), answer) in wanted.iter().zip(answers) {
            compare_answer(expectation, call, answer, &mut report);
        }
    }
    for expectation in &case.expectations {
        if let Expectation::Render(render) = expectation {
            compare_render(case, mode, render, backend, &mut report);
        }
    }
    report.verdict()
}

fn called(expectation: &Expectation) -> Option<&Call> {
    match expectation {
        Expectation::Run { call, .. }
        | Expectation::Fails { call, .. }
        | Expectation::Rounds { call, .. } => Some(call),
        _ => None,
    }
}

#[derive(Default)]
struct Report(Vec<String>);

impl Report {
    fn add(&mut self, line: String) {
        self.0.push(line);
    }

    fn same(&mut self, what: &str, expected: &[String], found: Result<Vec<String>, Failure>) {
        match found {
            Ok(found) if found == expected => {}
            Ok(found) => self.add(format!(
                "{what}:\n  expected {}\n  got      {}",
                expected.join("\n           "),
                found.join("\n           ")
            )),
            Err(failure) => self.add(format!("{what}: {failure}")),
        }
    }

    fn verdict(self) -> Result<(), String> {
        if self.0.is_empty() { Ok(()) } else { Err(self.0.join("\n")) }
    }
}

fn told(call: &Call) -> String {
    format!("{}({})", call.entry, call.args.join(", "))
}

// ---- diagnostics ----

fn shown(d: &Diagnostic) -> String {
    let severity = match d.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
    };
    let colon = if d.file.is_empty() { "" } else { ":" };
    format!("{severity} {} at {}{colon}{}:{} \"{}\"", d.code, d.file, d.line, d.column, d.part)
}

/// Each expected diagnostic is found once, and nothing else is found.
fn compare_diagnostics(case: &Case, mut found: Vec<Diagnostic>, report: &mut Report) {
    for expectation in &case.expectations {
        let Expectation::Diagnostic(expected) = expectation else { continue };
        match found.iter().position(|d| fits(expected, d)) {
            Some(at) => {
                found.remove(at);
            }
            None => report.add(format!("missing:    {}", shown(expected))),
        }
    }
    for d in &found {
        report.add(format!("unexpected: {}", shown(d)));
    }
}

fn fits(expected: &Diagnostic, found: &Diagnostic) -> bool {
    let title = found.part.to_lowercase();
    expected.severity == found.severity
        && (&expected.file, expected.line, expected.column) == (&found.file, found.line, found.column)
        && (expected.code.is_empty() || expected.code == found.code)
        && title.contains(&expected.part.to_lowercase())
}

// ---- values ----

fn compare_answer(
    expectation: &Expectation,
    call: &Call,
    answer: Result<Answer, Failure>,
    report: &mut Report,
) {
    let call = told(call);
    match (expectation, answer) {
        (Expectation::Run { value, tolerance, .. }, Ok(answer)) => match Value::parse(&answer.value) {
            Ok(actual) if value.agrees(&actual, *tolerance) => {}
            Ok(_) => report.add(format!("{call}: expected {value}, got {}", answer.value)),
            Err(reason) => report.add(format!("{call}: expected {value}, got no value: {reason}")),
        },
        (Expectation::Run { value, .. }, Err(failure)) => {
            report.add(format!("{call}: expected {value}, got: {failure}"));
        }
        (Expectation::Rounds { most, .. }, Ok(Answer { rounds: Some(rounds), .. })) if rounds > *most => {
            report.add(format!("{call}: at most {most} rounds expected, took {rounds}"));
        }
        (Expectation::Rounds { .. }, Err(failure)) => report.add(format!("{call}: {failure}")),
        (Expectation::Fails { status, .. }, Ok(answer)) => {
            report.add(format!("{call}: expected exit status {status}, got {}", answer.value));
        }
        (Expectation::Fails { status, part, .. }, Err(failure)) => {
            let text = failure.to_string();
            if failure.status() != *status || !text.to_lowercase().contains(&part.to_lowercase()) {
                let got = failure.status();
                report
                    .add(format!("{call}: expected exit status {status} and \"{part}\", got {got}: {text}"));
            }
        }
        _ => {}
    }
}

// ---- pictures ----

/// The picture must hold the pixels named in the header and agree with the oracle's.
fn compare_render(case: &Case, mode: Mode, render: &Render, backend: &dyn Backend, report: &mut Report) {
    let picture = match backend.render(&case.program, &case.settings, mode, render) {
        Ok(picture) => picture,
        Err(failure) => return report.add(format!("{}: {failure}", render.entry)),
    };
    let size = (render.width * render.height * picture.components) as usize;
    if picture.width != render.width || picture.values.len() != size {
        return report.add(format!("{}: the picture has another size than asked", render.entry));
    }
    for pixel in &render.pixels {
        let actual = pixel_value(&picture, pixel.x, pixel.y);
        if !pixel.value.agrees(&actual, pixel.tolerance) {
            let (x, y) = (pixel.x, pixel.y);
            report.add(format!("pixel {x},{y}: expected {}, got {actual}", pixel.value));
        }
    }
    if mode == Mode::Oracle || !case.modes.contains(&Mode::Oracle) {
        return;
    }
    match backend.render(&case.program, &case.settings, Mode::Oracle, render) {
        Ok(oracle) => compare_pictures(&oracle, &picture, render.tolerance.as_ref(), report),
        Err(failure) => report.add(format!("{} on the oracle: {failure}", render.entry)),
    }
}

fn pixel_value(picture: &Picture, x: u32, y: u32) -> Value {
    let at = ((y * picture.width + x) * picture.components) as usize;
    let Some(parts) = picture.values.get(at..at + picture.components as usize) else {
        return Value::Tuple(Vec::new());
    };
    let floats = parts.iter().map(|v| Value::Float(f64::from(*v)));
    match parts.len() {
        1 => Value::Float(f64::from(parts[0])),
        n => Value::Make(format!("vec{n}"), floats.map(|f| (None, f)).collect()),
    }
}

/// Without a word in the header a component may be this far from the oracle's: f32 against f64.
const PICTURE_TOLERANCE: f64 = 1e-4;

fn compare_pictures(
    oracle: &Picture,
    picture: &Picture,
    tolerance: Option<&PictureTolerance>,
    report: &mut Report,
) {
    if oracle.components != picture.components || oracle.values.len() != picture.values.len() {
        return report.add("the oracle's picture has another shape".into());
    }
    let (allowed, share) = tolerance.map_or((PICTURE_TOLERANCE, 0.0), |t| (t.value, t.share));
    let per_pixel = picture.components.max(1) as usize;
    let pairs = oracle.values.chunks(per_pixel).zip(picture.values.chunks(per_pixel));
    let apart = |a: &[f32], b: &[f32]| {
        let tolerance = Tolerance::Given(allowed);
        let agree = |(a, b): (&f32, &f32)| {
            Value::Float(f64::from(*a)).agrees(&Value::Float(f64::from(*b)), tolerance)
        };
        !a.iter().zip(b).all(agree)
    };
    let off: Vec<usize> =
        pairs.enumerate().filter(|(_, (a, b))| apart(a, b)).map(|(index, _)| index).collect();
    let pixels = picture.values.len() / per_pixel;
    if off.len() as f64 > share * pixels as f64 {
        let (x, y) = (off[0] as u32 % picture.width, off[0] as u32 / picture.width);
        let (a, b) = (pixel_value(oracle, x, y), pixel_value(picture, x, y));
        report.add(format!(
            "{} of {pixels} pixels differ from the oracle's, first {x},{y}: {a}, got {b}",
            off.len()
        ));
    }
}

#[cfg(test)]
mod tests;
