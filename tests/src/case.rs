//! What a case file says, as data.
//!
//! A case is a program with its expectations in the header above it; `tests/README.md` lists the words of a header.

mod parse;

use crate::mode::Mode;
use crate::value::{Tolerance, Value};
use std::path::{Path, PathBuf};

pub use parse::parse;

/// One program and what is expected of it.
#[derive(Clone, Debug)]
pub struct Case {
    /// Folder and file below `suite/`: `functions/closures`.
    pub topic: String,
    pub name: String,
    /// Line of the case file on which the case begins.
    pub line: u32,
    pub program: Program,
    pub settings: Settings,
    pub expectations: Vec<Expectation>,
    /// Those that the header names; [`Mode::in_turn`] gives modes to the others.
    pub modes: Vec<Mode>,
    /// Why the case must fail for now; a trial that passes is an error, so that the word is taken away.
    pub broken: Option<String>,
}

impl Case {
    /// The folder below `suite/`.
    pub fn area(&self) -> &str {
        self.topic.split('/').next().unwrap_or_default()
    }
}

/// A program's text and the modules it may `use`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Program {
    pub name: String,
    pub text: String,
    /// Name and text of further modules, found beside the program.
    pub files: Vec<(String, String)>,
}

/// What the host sets before it runs a program.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings {
    pub set: Vec<(String, String)>,
    pub live: Vec<String>,
    pub dem: Option<Dem>,
    pub rasters: Vec<Raster>,
    pub no_bake: bool,
    /// Seconds.
    pub timeout: Option<f64>,
    /// Bytes.
    pub memory: Option<u64>,
}

/// A height field written in the header; rows from north to south.
#[derive(Clone, Debug, PartialEq)]
pub struct Dem {
    pub width: u32,
    pub height: u32,
    pub spacing: (f64, f64),
    pub heights: Vec<f32>,
}

/// A data layer written in the header; rows from north to south, a texel's numbers side by side.
#[derive(Clone, Debug, PartialEq)]
pub struct Raster {
    pub name: String,
    pub width: u32,
    pub height: u32,
    pub components: u32,
    pub numbers: Vec<f32>,
}

/// An entry with its arguments in Ghyll syntax.
#[derive(Clone, Debug, PartialEq)]
pub struct Call {
    pub entry: String,
    pub args: Vec<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    Error,
    Warning,
}

/// A diagnostic at a place of the program's own texts.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    pub severity: Severity,
    /// The module's file; empty for the program itself.
    pub file: String,
    /// Any code if empty.
    pub code: String,
    pub line: u32,
    pub column: u32,
    /// Part of the title.
    pub part: String,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Expectation {
    Diagnostic(Diagnostic),
    Run {
        call: Call,
        value: Value,
        tolerance: Tolerance,
    },
    /// The run ends with this exit status and a message that holds `part`.
    Fails {
        call: Call,
        status: u8,
        part: String,
    },
    /// The source functions whose calls stay tokens, in alphabetical order.
    Tasks {
        entry: String,
        functions: Vec<String>,
    },
    /// The most rewriting rounds that a run may take when each redex is rewritten once a round.
    Rounds {
        call: Call,
        most: u32,
    },
    /// s0, s1, .. as `ghyll trace` prints them.
    Trace {
        call: Call,
        streams: Vec<String>,
    },
    Render(Render),
}

/// An image entry; its picture is compared between modes, and at some pixels with values.
#[derive(Clone, Debug, PartialEq)]
pub struct Render {
    pub entry: String,
    pub width: u32,
    pub height: u32,
    pub pixels: Vec<Pixel>,
    /// How far two modes' pixels may be apart, which share of pixels may be further, and why.
    pub tolerance: Option<PictureTolerance>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct PictureTolerance {
    pub value: f64,
    pub share: f64,
    pub reason: String,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Pixel {
    pub x: u32,
    pub y: u32,
    pub value: Value,
    pub tolerance: Tolerance,
}

/// A header that cannot be read: file, line, reason.
#[derive(Clone, Debug, PartialEq)]
pub struct CaseError {
    pub file: PathBuf,
    pub line: u32,
    pub reason: String,
}

impl std::fmt::Display for CaseError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}:{}: {}", self.file.display(), self.line, self.reason)
    }
}

/// Reads every case file below `folder`; an empty list of errors means that all of them are sound.
pub fn load(folder: &Path) -> (Vec<Case>, Vec<CaseError>) {
    let (mut cases, mut errors) = (Vec::new(), Vec::new());
    for path in case_files(folder) {
        let topic = path.strip_prefix(folder).unwrap_or(&path).with_extension("");
        let topic = topic.to_string_lossy().replace('\\', "/");
        let text = match std::fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) => {
                errors.push(CaseError { file: path, line: 0, reason: error.to_string() });
                continue;
            }
        };
        match parse(&topic, &text) {
            Ok(found) => cases.extend(found),
            Err((line, reason)) => errors.push(CaseError { file: path, line, reason }),
        }
    }
    (cases, errors)
}

fn case_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "ghyll") {
                files.push(path);
            }
        }
    }
    files.sort();
    files
}

/// The repository's root: paths in headers are relative to it.
pub fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}
