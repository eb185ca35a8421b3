//! All places of a name, and another name for them.

use super::answer::{OWN, place};
use super::publish::Places;
use super::server::{Answer, Overlay, Refused, Server};
use super::uri;
use ghyll_compiler::analysis::{Analysis, Meaning, analyse};
use ghyll_compiler::diagnostic::Severity;
use ghyll_compiler::parse::KEYWORDS;
use ghyll_compiler::source::{Files, Source, Span};
use lsp_server::ErrorCode;
use lsp_types::{
    Location, PrepareRenameResponse, ReferenceParams, RenameParams, TextDocumentPositionParams, TextEdit,
    Uri, WorkspaceEdit,
};
use std::collections::{BTreeMap, BTreeSet, HashMap};

pub fn references(server: &mut Server, params: ReferenceParams) -> Answer<Option<Vec<Location>>> {
    let (_, analysis, at) = place(server, &params.text_document_position)?;
    let Some(mention) = analysis.mention_at(OWN, at) else { return Ok(None) };
    let definition = analysis.definition(mention.meaning);
    let wanted = |span: &Span| params.context.include_declaration || Some(*span) != definition;
    let mut places = Places::new(analysis);
    let spans: Vec<Span> = analysis.mentions_of(mention.meaning).filter(wanted).collect();
    // The library's own uses of what it defines are of no interest.
    let spans = spans.into_iter().filter(|span| !analysis.is_library(span.source));
    Ok(Some(spans.filter_map(|span| places.location(span)).collect()))
}

pub fn prepare(server: &mut Server, at: TextDocumentPositionParams) -> Answer<Option<PrepareRenameResponse>> {
    let (document, analysis, at) = place(server, &at)?;
    let found =
        analysis.mention_at(OWN, at).filter(|mention| own_definition(analysis, mention.meaning).is_some());
    Ok(found.map(|mention| PrepareRenameResponse::Range(document.text.range(mention.span))))
}

/// Where something is defined in a user's file.
fn own_definition(analysis: &Analysis, meaning: Meaning) -> Option<Span> {
    let named = !matches!(meaning, Meaning::Module(_));
    analysis.definition(meaning).filter(|span| named && !analysis.is_library(span.source))
}

// The protocol's own type is a map by addresses, which remember how they were parsed.
#[allow(clippy::mutable_key_type)]
pub fn rename(server: &mut Server, params: RenameParams) -> Answer<Option<WorkspaceEdit>> {
    let refuse = |text: String| Err(Refused(ErrorCode::RequestFailed, text));
    let new = params.new_name;
    let mut letters = new.chars();
    let begins = letters.next().is_some_and(|c| c.is_ascii_alphabetic() || c == '_');
    if !begins || !letters.all(|c| c.is_ascii_alphanumeric() || c == '_') || KEYWORDS.contains(&new.as_str())
    {
        return refuse(format!("`{}` is no name", new.escape_debug()));
    }
    let (_, analysis, at) = place(server, &params.text_document_position)?;
    let Some(mention) = analysis.mention_at(OWN, at) else { return refuse("there is no name here".into()) };
    let Some(definition) = own_definition(analysis, mention.meaning) else {
        return refuse("what the language or a library module defines keeps its name".into());
    };
    if broken(analysis) {
        return refuse("mend the program's errors first: not every place of the name is known".into());
    }
    let file = analysis.sources.get(definition.source).name.clone();
    // Every open document that uses the file may name it.
    let names: Vec<String> = server.open.keys().cloned().collect();
    let mut found: BTreeMap<String, BTreeSet<(u32, u32)>> = BTreeMap::new();
    for name in &names {
        let Some((_, analysis)) = server.analysed(name) else { continue };
        let spans = places(analysis, &file, definition.start);
        if !spans.is_empty() && broken(analysis) {
            return refuse(format!("mend the errors in {name} first: not every place of the name is known"));
        }
        for (name, places) in spans {
            found.entry(name).or_default().extend(places);
        }
    }
    let texts: BTreeMap<String, String> = found
        .iter()
        .map(|(name, places)| Ok((name.clone(), renamed(server, name, places, &new)?)))
        .collect::<Answer<_>>()?;
    let changed = Changed { texts: &texts, rest: Overlay(&server.open) };
    for name in &names {
        let affected = server.open[name]
            .analysis
            .as_ref()
            .is_some_and(|a| a.sources.iter().any(|s| found.contains_key(&s.name)));
        if affected && !keeps_meaning(name, &changed, &found, (&file, definition.start), &new) {
            return refuse(format!("`{new}` means something else already"));
        }
    }
    let mut changes: HashMap<Uri, Vec<TextEdit>> = HashMap::new();
    for (name, places) in &found {
        let Some((uri, text)) = document(server, name) else { continue };
        let edit = |&(start, end): &(u32, u32)| {
            let range = lsp_types::Range::new(text.position(start as usize), text.position(end as usize));
            TextEdit::new(range, new.clone())
        };
        changes.insert(uri, places.iter().map(edit).collect());
    }
    Ok(Some(WorkspaceEdit { changes: Some(changes), ..Default::default() }))
}

fn broken(analysis: &Analysis) -> bool {
    analysis.diagnostics.iter().any(|d| d.severity == Severity::Error)
}

/// Places by file of what is defined at a place.
fn places(analysis: &Analysis, file: &str, start: u32) -> BTreeMap<String, BTreeSet<(u32, u32)>> {
    let mut places: BTreeMap<String, BTreeSet<(u32, u32)>> = BTreeMap::new();
    let here = |span: Span| span.start == start && analysis.sources.get(span.source).name == file;
    if let Some(meaning) = analysis.meaning_defined(here) {
        for span in analysis.mentions_of(meaning) {
            let name = analysis.sources.get(span.source).name.clone();
            places.entry(name).or_default().insert((span.start, span.end));
        }
    }
    places
}

fn document(server: &Server, name: &str) -> Option<(Uri, super::document::Text)> {
    match server.open.get(name) {
        Some(document) => Some((document.uri.clone(), document.text.clone())),
        None => {
            let text = Overlay(&server.open).read(name).ok()?;
            Some((uri::of_file(std::path::Path::new(name))?, super::document::Text::new(text)))
        }
    }
}

/// A file's text with the new name.
fn renamed(server: &Server, name: &str, places: &BTreeSet<(u32, u32)>, new: &str) -> Answer<String> {
    let Some((_, text)) = document(server, name) else {
        return Err(Refused(ErrorCode::RequestFailed, format!("cannot read {name}")));
    };
    let mut text = text.text;
    for &(start, end) in places.iter().rev() {
        text.replace_range(start as usize..end as usize, new);
    }
    Ok(text)
}

/// Whether the renamed program means the same: the same places name the same thing, and nothing is wrong.
fn keeps_meaning(
    name: &str,
    changed: &Changed,
    found: &BTreeMap<String, BTreeSet<(u32, u32)>>,
    (file, start): (&str, u32),
    new: &str,
) -> bool {
    let Ok(text) = changed.read(name) else { return false };
    let moved = |name: &str, at: u32| {
        let before = found.get(name).into_iter().flatten().filter(|place| place.0 < at);
        before.fold(i64::from(at), |at, (start, end)| at + new.len() as i64 - i64::from(end - start)) as u32
    };
    let analysis = analyse(Source::new(name, text), changed);
    let after = places(&analysis, file, moved(file, start));
    let in_program: BTreeSet<&str> = analysis.sources.iter().map(|s| s.name.as_str()).collect();
    let expected: BTreeMap<String, BTreeSet<(u32, u32)>> = (found.iter())
        .filter(|(name, _)| in_program.contains(name.as_str()))
        .map(|(name, places)| {
            let moved = places.iter().map(|(start, _)| moved(name, *start));
            (name.clone(), moved.map(|start| (start, start + new.len() as u32)).collect())
        })
        .collect();
    // A document may use a file without a name that another takes from it.
    !broken(&analysis)
        && after.iter().all(|(name, places)| expected.get(name).is_some_and(|e| places.is_subset(e)))
        && after.get(name).map_or(0, BTreeSet::len) == expected.get(name).map_or(0, BTreeSet::len)
}

/// Files as they will be.
struct Changed<'a> {
    texts: &'a BTreeMap<String, String>,
    rest: Overlay<'a>,
}

impl Files for Changed<'_> {
    fn read(&self, name: &str) -> Result<String, String> {
        match self.texts.get(name) {
            Some(text) => Ok(text.clone()),
            None => self.rest.read(name),
        }
    }
}
