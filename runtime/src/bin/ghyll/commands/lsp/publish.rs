//! Diagnostics, with the words of `ghyll check`.

use super::document::Text;
use super::server::{Abilities, Server};
use super::{pages, uri};
use ghyll_compiler::analysis::Analysis;
use ghyll_compiler::codes::Code;
use ghyll_compiler::diagnostic::{self, Severity};
use ghyll_compiler::explain;
use ghyll_compiler::source::{SourceId, Span};
use lsp_types::{
    CodeDescription, Diagnostic, DiagnosticRelatedInformation, DiagnosticSeverity, DiagnosticTag, Location,
    NumberOrString, PublishDiagnosticsParams, Uri,
};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// What each open document has made known about every file, by the files' names.
pub type Published = BTreeMap<String, BTreeMap<String, Vec<Diagnostic>>>;

/// What to tell after a document was analysed: its own diagnostics, and those of files that it uses.
pub fn diagnostics(server: &mut Server, name: &str) -> Vec<PublishDiagnosticsParams> {
    let mut found: BTreeMap<String, Vec<Diagnostic>> = BTreeMap::from([(name.to_owned(), Vec::new())]);
    if let Some(analysis) = server.open.get(name).and_then(|document| document.analysis.as_ref()) {
        let mut places = Places { analysis, texts: BTreeMap::new() };
        for diagnostic in &analysis.diagnostics {
            let file = analysis.sources.get(diagnostic.primary.0.source).name.clone();
            found.entry(file).or_default().push(places.diagnostic(diagnostic, server.can));
        }
    }
    let before = server.published.insert(name.to_owned(), found.clone()).unwrap_or_default();
    tell(server, before.into_keys().chain(found.into_keys()))
}

/// What to tell when a document is closed.
pub fn withdrawn(server: &mut Server, name: &str) -> Vec<PublishDiagnosticsParams> {
    let before = server.published.remove(name).unwrap_or_default();
    tell(server, before.into_keys())
}

fn tell(server: &Server, files: impl Iterator<Item = String>) -> Vec<PublishDiagnosticsParams> {
    let files: BTreeSet<String> = files.collect();
    let params = |file: String| {
        let open = server.open.get(&file);
        let uri = open.map(|document| document.uri.clone()).or_else(|| address(&file))?;
        // An open document speaks for itself.
        let own = server.published.get(&file).and_then(|found| found.get(&file));
        let all: Vec<Diagnostic> = match (open, own) {
            (Some(_), Some(own)) => own.clone(),
            _ => {
                let mut all: Vec<Diagnostic> = Vec::new();
                for found in server.published.values().filter_map(|found| found.get(&file)).flatten() {
                    if !all.contains(found) {
                        all.push(found.clone());
                    }
                }
                all
            }
        };
        Some(PublishDiagnosticsParams {
            uri,
            diagnostics: all,
            version: open.map(|document| document.version),
        })
    };
    files.into_iter().filter_map(params).collect()
}

fn address(name: &str) -> Option<Uri> {
    uri::of_file(Path::new(name))
}

/// Places of an analysis as editors understand them.
pub struct Places<'a> {
    pub analysis: &'a Analysis,
    texts: BTreeMap<u32, Text>,
}

impl<'a> Places<'a> {
    pub fn new(analysis: &'a Analysis) -> Places<'a> {
        Places { analysis, texts: BTreeMap::new() }
    }

    pub fn text(&mut self, source: SourceId) -> &Text {
        let text = || Text::new(self.analysis.sources.get(source).text.clone());
        self.texts.entry(source.0).or_insert_with(text)
    }

    /// The file and range of a place; library modules are shown as files of their own.
    pub fn location(&mut self, span: Span) -> Option<Location> {
        let source = self.analysis.sources.get(span.source);
        let uri = match self.analysis.is_library(span.source) {
            true => pages::page(source.name.rsplit('/').next()?, &source.text)?,
            false => source
                .name
                .parse()
                .ok()
                .filter(|_| source.name.contains(':') && !Path::new(&source.name).is_absolute())
                .or_else(|| address(&source.name))?,
        };
        Some(Location::new(uri, self.text(span.source).range(span)))
    }

    fn diagnostic(&mut self, diagnostic: &diagnostic::Diagnostic, can: Abilities) -> Diagnostic {
        let (span, label) = &diagnostic.primary;
        let help = diagnostic.help.as_ref().map(|help| format!("help: {help}"));
        let mut lines = vec![diagnostic.title.clone()];
        lines.extend((!label.is_empty()).then(|| label.clone()));
        let mut related = Vec::new();
        for (span, text) in &diagnostic.secondary {
            match self.location(*span).filter(|_| can.related) {
                Some(location) => {
                    related.push(DiagnosticRelatedInformation { location, message: text.clone() })
                }
                None => lines.push(text.clone()),
            }
        }
        lines.extend(help);
        let unused = ["W0601", "W0603", "W0604", "W0605", "W0606"].contains(&diagnostic.code.as_str());
        Diagnostic {
            range: self.text(span.source).range(*span),
            severity: Some(match diagnostic.severity {
                Severity::Error => DiagnosticSeverity::ERROR,
                Severity::Warning => DiagnosticSeverity::WARNING,
            }),
            code: Some(NumberOrString::String(diagnostic.code.as_str().to_owned())),
            code_description: can.code_links.then(|| explanation(diagnostic.code)).flatten(),
            source: Some("ghyll".to_owned()),
            message: lines.join("\n"),
            related_information: (!related.is_empty()).then_some(related),
            tags: unused.then(|| vec![DiagnosticTag::UNNECESSARY]),
            data: None,
        }
    }
}

/// The page of a code as a file.
fn explanation(code: Code) -> Option<CodeDescription> {
    let text = explain::page(code.as_str()).ok()?;
    Some(CodeDescription { href: pages::page(&format!("{code}.md"), text)? })
}
