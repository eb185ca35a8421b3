//! Compiling ends, soon and in little memory, whatever the text: each of [`texts`] goes through the whole compiler in a
//! process of its own, which reports the processor time and the memory that it took.
//!
//! Limits are 2 s and 1 GiB for 1 MiB of text in a release build, but a test allows half as much time again, as other work
//! slows processors down. An unoptimised build, which also verifies every phase, gets a sixteenth of that text and ten
//! times the time. `LIMITS=words cargo test --test limits` runs the texts whose
//! name has these words and shows what each took.

mod constructs;
mod crossed;
mod texts;

use cap::Cap;
use cpu_time::ProcessTime;
use ghyll_compiler::compile::{self, CompileError, Options};
use ghyll_compiler::diagnostic::Report;
use ghyll_compiler::front::Checked;
use ghyll_compiler::report;
use ghyll_compiler::source::{Files, Source};
use libtest_mimic::{Arguments, Failed, Trial};
use mimalloc::MiMalloc;
use std::collections::HashMap;
use std::io::{Read, Write};
use std::process::{Command, ExitCode, Stdio};
use std::time::{Duration, Instant};
use texts::Text;

#[global_allocator]
static MEMORY: Cap<MiMalloc> = Cap::new(MiMalloc, usize::MAX);

const RELEASE: bool = !cfg!(debug_assertions);
/// Length of a text.
const BYTES: usize = if RELEASE { 1 << 20 } else { 1 << 16 };
/// Processor time that a text may take.
const MOST_SECONDS: f64 = if RELEASE { 3.0 } else { 20.0 };
/// Memory that a text may take.
const MOST_MEBIBYTES: f32 = 1024.0;
/// Time after which a text is taken to run for ever.
const LONGEST: Duration = Duration::from_secs(120);

/// Makes texts of a length.
type Family = fn(usize) -> Vec<Text>;

fn main() -> ExitCode {
    if std::env::args().any(|a| a == "--compile") {
        let mut text = String::new();
        std::io::stdin().read_to_string(&mut text).expect("the text comes by the standard input");
        compile_all(text);
        return ExitCode::SUCCESS;
    }
    let families: [(&str, Family); 17] = [
        ("nested", texts::nested),
        ("repeated", texts::repeated),
        ("lexical", texts::lexical),
        ("items", texts::items),
        ("bodies", texts::bodies),
        ("growing", |_| texts::growing()),
        ("types", texts::types),
        ("matches", texts::matches),
        ("errors", texts::errors),
        ("functions", constructs::functions),
        ("slopes", constructs::slopes),
        ("values", constructs::values),
        ("networks", constructs::networks),
        ("names", constructs::names),
        ("fields", crossed::fields),
        ("calls", crossed::calls),
        ("depths", crossed::depths),
    ];
    let mut trials: Vec<Trial> = families
        .into_iter()
        .map(|(name, texts)| Trial::test(format!("limits::{name}"), move || within_limits(texts(BYTES))))
        .collect();
    trials.push(Trial::test("limits::what_takes_too_much_is_found", planted));
    // One by one, so that no text waits for another's memory.
    let arguments = Arguments { test_threads: Some(1), ..Arguments::from_args() };
    libtest_mimic::run(&arguments, trials).exit_code()
}

/// Does to a text what `ghyll check` and `ghyll build` do, and counts the longer of both.
fn compile_all(text: String) {
    let start = ProcessTime::now();
    if text.starts_with(PLANTED_TIME) {
        while start.elapsed().as_secs_f64() < MOST_SECONDS + 0.1 {}
    }
    if text.starts_with(PLANTED_MEMORY) {
        std::hint::black_box(vec![1u8; (MOST_MEBIBYTES as usize + 10) << 20]);
    }
    assert!(!text.starts_with(PLANTED_PANIC), "planted");
    let mut parts = text.split(constructs::MODULE);
    let own = Source::new("hostile.ghyll", parts.next().unwrap_or_default());
    let modules = Modules(parts.filter_map(|part| part.split_once('\n')).collect());
    let mut found = Vec::new();
    let checked = compile::check_with(own, &modules);
    let checked = checked.map_err(|report| found.extend(shown(&report)));
    let front = start.elapsed().as_secs_f64();
    let mut longest = 0.0;
    if let Ok(checked) = &checked {
        found.push("checked");
        found.extend(checked.warnings.iter().map(|d| d.code.as_str()));
        match compile::reach(checked, &Options::default()) {
            Ok(diagnostics) => found.extend(diagnostics.iter().map(|d| d.code.as_str())),
            Err(_) => found.push("request"),
        }
        longest = start.elapsed().as_secs_f64() - front;
        for entry in ["main", "pixel"].into_iter().filter(|entry| checked.module.function(entry).is_some()) {
            let before = start.elapsed().as_secs_f64();
            found.extend(built(checked, entry));
            longest = f64::max(longest, start.elapsed().as_secs_f64() - before);
        }
    }
    let (seconds, memory) = (front + longest, MEMORY.max_allocated() as f32 / (1 << 20) as f32);
    found.dedup();
    found.truncate(6);
    println!("{seconds} {memory} {}", found.join(","));
}

/// What comes of an entry.
fn built(checked: &Checked, entry: &str) -> Vec<&'static str> {
    let options = Options { entry: Some(entry.into()), ..Options::default() };
    match compile::compile(checked, &options) {
        Err(CompileError::Program(report) | CompileError::Value(report)) => shown(&report),
        Err(CompileError::Request(_)) => vec!["request"],
        Ok(_) => vec!["compiled"],
    }
}

/// The codes of a report, after it was written as a person and as a machine would have it.
fn shown(report: &Report) -> Vec<&'static str> {
    report::render(report, false);
    report::to_json(report);
    report.diagnostics.iter().map(|d| d.code.as_str()).collect()
}

/// The modules of a text.
struct Modules<'a>(HashMap<&'a str, &'a str>);

impl Files for Modules<'_> {
    fn read(&self, name: &str) -> Result<String, String> {
        self.0.get(name).map(|text| text.to_string()).ok_or_else(|| "no such file".into())
    }
}

const PLANTED_TIME: &str = "// planted time";
const PLANTED_MEMORY: &str = "// planted memory";
const PLANTED_PANIC: &str = "// planted panic";

/// What a text took and led to, or how it ended.
fn measured(text: &str) -> Result<(f64, f32, String), String> {
    let own = std::env::current_exe().map_err(|e| e.to_string())?;
    let mut child = Command::new(own)
        .arg("--compile")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|e| e.to_string())?;
    let mut stdin = child.stdin.take().expect("it is piped");
    // A child that ends early has its own message.
    let _ = stdin.write_all(text.as_bytes());
    drop(stdin);
    let started = Instant::now();
    while child.try_wait().map_err(|e| e.to_string())?.is_none() {
        if started.elapsed() > LONGEST {
            let _ = child.kill();
            let _ = child.wait();
            return Err(format!("it did not end in {} s", LONGEST.as_secs()));
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    let output = child.wait_with_output().map_err(|e| e.to_string())?;
    let said = String::from_utf8_lossy(&output.stdout);
    let mut parts = said.trim().splitn(3, ' ');
    let mut number = || parts.next().and_then(|p| p.parse::<f64>().ok());
    match (number(), number()) {
        (Some(seconds), Some(memory)) => Ok((seconds, memory as f32, parts.next().unwrap_or("").into())),
        _ => {
            let why = String::from_utf8_lossy(&output.stderr);
            Err(format!("{}: {}", output.status, why.trim().chars().take(400).collect::<String>()))
        }
    }
}

fn verdict(text: &str) -> Result<(f64, f32, String), String> {
    let (seconds, memory, found) = measured(text)?;
    if seconds > MOST_SECONDS || memory > MOST_MEBIBYTES {
        return Err(format!("{seconds:.2} s, {memory:.0} MiB ({found})"));
    }
    if found.is_empty() {
        return Err("neither a diagnostic nor a program".into());
    }
    Ok((seconds, memory, found))
}

fn within_limits(texts: Vec<Text>) -> Result<(), Failed> {
    let words = std::env::var("LIMITS").ok();
    let chosen = texts.iter().filter(|t| words.as_ref().is_none_or(|w| t.name.contains(w)));
    let mut wrong = String::new();
    for Text { name, text } in chosen {
        let verdict = verdict(text);
        if words.is_some() {
            match &verdict {
                Ok((seconds, memory, found)) => println!("{seconds:7.3} s {memory:6.0} MiB  {name}: {found}"),
                Err(why) => println!("!! {name}: {why}"),
            }
        }
        if let Err(why) = verdict {
            wrong += &format!("{name}: {why}\n");
        }
    }
    if wrong.is_empty() { Ok(()) } else { Err(wrong.into()) }
}

fn planted() -> Result<(), Failed> {
    for (text, expected) in [(PLANTED_TIME, " s, "), (PLANTED_MEMORY, " MiB"), (PLANTED_PANIC, "planted")] {
        match verdict(text) {
            Err(why) if why.contains(expected) => {}
            other => return Err(format!("{text}: {other:?}").into()),
        }
    }
    Ok(())
}
