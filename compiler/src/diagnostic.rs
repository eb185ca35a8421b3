//! Diagnostics are data until the last line: a code, a title, labelled places, a help line.

use crate::codes::Code;
use crate::source::{Sources, Span};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Severity {
    Error,
    Warning,
}

/// What the compiler has to say about one place.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    pub severity: Severity,
    pub code: Code,
    pub title: String,
    /// The offending place and what is wrong there.
    pub primary: (Span, String),
    /// Other places that explain it.
    pub secondary: Vec<(Span, String)>,
    /// What to do.
    pub help: Option<String>,
}

impl Diagnostic {
    pub fn error(code: Code, span: Span, title: impl Into<String>) -> Diagnostic {
        Diagnostic {
            severity: Severity::Error,
            code,
            title: title.into(),
            primary: (span, String::new()),
            secondary: Vec::new(),
            help: None,
        }
    }

    pub fn warning(code: Code, span: Span, title: impl Into<String>) -> Diagnostic {
        Diagnostic { severity: Severity::Warning, ..Diagnostic::error(code, span, title) }
    }

    /// Text beside the primary place.
    pub fn label(mut self, text: impl Into<String>) -> Diagnostic {
        self.primary.1 = text.into();
        self
    }

    /// Another place that explains the problem.
    pub fn also(mut self, span: Span, text: impl Into<String>) -> Diagnostic {
        self.secondary.push((span, text.into()));
        self
    }

    /// What the person can do about it.
    pub fn help(mut self, text: impl Into<String>) -> Diagnostic {
        self.help = Some(text.into());
        self
    }
}

/// A range where there is no form to loop over it; some such places are seen by the parser, some by inference.
pub(crate) fn misplaced_range(span: Span) -> Diagnostic {
    let title = "a range `..` stands only as the first argument of `fold`, `sum`, `any` and `all`";
    Diagnostic::error(crate::codes::MISPLACED_RANGE, span, title).help(
        "loop with `fold(0..n, start, |acc, i| ..)`; an interval of numbers is a vec2 or two parameters",
    )
}

/// Diagnostics with the texts they point into, ready to print.
#[derive(Clone, Debug, Default)]
pub struct Report {
    pub sources: Sources,
    pub diagnostics: Vec<Diagnostic>,
}

impl Report {
    pub fn has_errors(&self) -> bool {
        self.diagnostics.iter().any(|d| d.severity == Severity::Error)
    }
}
