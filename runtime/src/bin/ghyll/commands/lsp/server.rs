//! What the server knows: the open documents and what was found about them.

use super::document::Text;
use super::transport::Outgoing;
use super::{answer, publish, rename, uri};
use ghyll_compiler::analysis::{Analysis, analyse};
use ghyll_compiler::source::{Files, Source};
use ghyll_runtime::files::Disk;
use lsp_server::{ErrorCode, Message, Notification, Request, Response};
use lsp_types::notification::{self, Notification as _};
use lsp_types::request::{self, Request as _};
use lsp_types::{
    ClientCapabilities, CompletionOptions, HoverProviderCapability, InitializeParams, InitializeResult,
    OneOf, RenameOptions, ServerCapabilities, ServerInfo, TextDocumentSyncCapability, TextDocumentSyncKind,
    Uri,
};
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::Sender;

pub struct Server {
    to_editor: Sender<Outgoing>,
    /// By the name that the compiler gets.
    pub open: BTreeMap<String, Document>,
    pub can: Abilities,
    pub published: publish::Published,
}

pub struct Document {
    pub uri: Uri,
    pub version: i32,
    pub text: Text,
    /// Of the text as it is, or nothing.
    pub analysis: Option<Analysis>,
    /// Whether what the editor shows is older than the text.
    stale: bool,
}

/// What the editor can show.
#[derive(Clone, Copy, Debug, Default)]
pub struct Abilities {
    pub nested_symbols: bool,
    pub related: bool,
    pub code_links: bool,
}

/// Why a request has no answer.
pub struct Refused(pub ErrorCode, pub String);

pub type Answer<T> = Result<T, Refused>;

impl Server {
    pub fn new(params: &Value, to_editor: Sender<Outgoing>) -> Result<Server, String> {
        let params: InitializeParams =
            serde_json::from_value(params.clone()).map_err(|e| format!("`initialize` is malformed: {e}"))?;
        let can = Abilities::of(&params.capabilities);
        Ok(Server { to_editor, open: BTreeMap::new(), can, published: Default::default() })
    }

    pub fn has_work(&self) -> bool {
        self.open.values().any(|document| document.stale)
    }

    /// Analyses a document whose diagnostics the editor does not have yet, and tells them.
    pub fn work(&mut self) {
        let Some(name) = self.open.iter().find(|(_, d)| d.stale).map(|(name, _)| name.clone()) else {
            return;
        };
        if let Some(document) = self.open.get_mut(&name) {
            document.stale = false;
        }
        if self.analysed(&name).is_some() {
            self.publish(&name);
        }
    }

    fn publish(&mut self, name: &str) {
        for params in publish::diagnostics(self, name) {
            self.tell(notification::PublishDiagnostics::METHOD, params);
        }
    }

    fn tell(&self, method: &str, params: impl serde::Serialize) {
        let notification = Notification::new(method.into(), params);
        // If nobody listens any more, the next read ends the session.
        let _ = self.to_editor.send(Outgoing::Message(Message::Notification(notification)));
    }

    /// What is known about an open document, as its text is now.
    pub fn analysed(&mut self, name: &str) -> Option<(&Document, &Analysis)> {
        if self.open.get(name)?.analysis.is_none() {
            let source = Source::new(name, self.open[name].text.text.clone());
            // A defect of the compiler is no reason to take the editor's help away.
            let analysis = catch_unwind(AssertUnwindSafe(|| analyse(source, &Overlay(&self.open)))).ok();
            self.open.get_mut(name)?.analysis = analysis;
        }
        let document = self.open.get(name)?;
        Some((document, document.analysis.as_ref()?))
    }

    pub fn notified(&mut self, notification: Notification) {
        let Notification { method, params } = notification;
        match method.as_str() {
            notification::DidOpenTextDocument::METHOD => {
                let Some(params) = read::<lsp_types::DidOpenTextDocumentParams>(params) else { return };
                let item = params.text_document;
                let name = uri::name(&item.uri);
                let (text, analysis) = (Text::new(item.text), None);
                let document = Document { uri: item.uri, version: item.version, text, analysis, stale: true };
                self.open.insert(name.clone(), document);
                self.changed(&name);
            }
            notification::DidChangeTextDocument::METHOD => {
                let Some(params) = read::<lsp_types::DidChangeTextDocumentParams>(params) else { return };
                let name = uri::name(&params.text_document.uri);
                let Some(document) = self.open.get_mut(&name) else { return };
                document.version = params.text_document.version;
                let text = std::mem::take(&mut document.text);
                document.text = params.content_changes.into_iter().fold(text, Text::changed);
                self.changed(&name);
            }
            notification::DidCloseTextDocument::METHOD => {
                let Some(params) = read::<lsp_types::DidCloseTextDocumentParams>(params) else { return };
                let name = uri::name(&params.text_document.uri);
                for params in publish::withdrawn(self, &name) {
                    self.tell(notification::PublishDiagnostics::METHOD, params);
                }
                self.open.remove(&name);
                self.changed(&name);
            }
            // Files that are not open may be others now.
            notification::DidSaveTextDocument::METHOD | notification::DidChangeWatchedFiles::METHOD => {
                self.open.values_mut().for_each(Document::forget);
            }
            _ => {}
        }
    }

    /// What uses a document is to be looked at again.
    fn changed(&mut self, name: &str) {
        for (own, document) in &mut self.open {
            let uses = document.analysis.as_ref().is_none_or(|a| a.sources.iter().any(|s| s.name == name));
            // A file that could not be read may be there now.
            let lacks = document.analysis.as_ref().is_some_and(|a| !a.diagnostics.is_empty());
            if own == name || uses || lacks {
                document.forget();
            }
        }
    }

    pub fn answer(&mut self, request: Request) -> Response {
        let Request { id, method, params } = request;
        let answer = catch_unwind(AssertUnwindSafe(|| self.dispatch(&method, params)));
        let failed = |_| Err(Refused(ErrorCode::InternalError, "the server has a defect".into()));
        match answer.unwrap_or_else(failed) {
            Ok(value) => Response::new_ok(id, value),
            Err(Refused(code, text)) => Response::new_err(id, code as i32, text),
        }
    }

    fn dispatch(&mut self, method: &str, params: Value) -> Answer<Value> {
        match method {
            request::HoverRequest::METHOD => {
                with::<request::HoverRequest>(params, |p| answer::hover(self, p))
            }
            request::GotoDefinition::METHOD => {
                with::<request::GotoDefinition>(params, |p| answer::definition(self, p))
            }
            request::References::METHOD => {
                with::<request::References>(params, |p| rename::references(self, p))
            }
            request::DocumentHighlightRequest::METHOD => {
                with::<request::DocumentHighlightRequest>(params, |p| answer::highlights(self, p))
            }
            request::DocumentSymbolRequest::METHOD => {
                with::<request::DocumentSymbolRequest>(params, |p| answer::symbols(self, p))
            }
            request::Completion::METHOD => {
                with::<request::Completion>(params, |p| answer::completion(self, p))
            }
            request::Formatting::METHOD => {
                with::<request::Formatting>(params, |p| answer::formatting(self, p))
            }
            request::PrepareRenameRequest::METHOD => {
                with::<request::PrepareRenameRequest>(params, |p| rename::prepare(self, p))
            }
            request::Rename::METHOD => with::<request::Rename>(params, |p| rename::rename(self, p)),
            _ => Err(Refused(ErrorCode::MethodNotFound, format!("there is no method `{method}` here"))),
        }
    }
}

impl Document {
    fn forget(&mut self) {
        self.analysis = None;
        self.stale = true;
    }
}

impl Abilities {
    fn of(client: &ClientCapabilities) -> Abilities {
        let documents = client.text_document.as_ref();
        let symbols = documents.and_then(|d| d.document_symbol.as_ref());
        let diagnostics = documents.and_then(|d| d.publish_diagnostics.as_ref());
        Abilities {
            nested_symbols: symbols.and_then(|s| s.hierarchical_document_symbol_support).unwrap_or(false),
            related: diagnostics.and_then(|d| d.related_information).unwrap_or(false),
            code_links: diagnostics.and_then(|d| d.code_description_support).unwrap_or(false),
        }
    }
}

/// Open documents hide files.
pub struct Overlay<'a>(pub &'a BTreeMap<String, Document>);

impl Files for Overlay<'_> {
    fn read(&self, name: &str) -> Result<String, String> {
        match self.0.get(name) {
            Some(document) => Ok(document.text.text.clone()),
            None => Disk.read(name),
        }
    }
}

fn read<T: DeserializeOwned>(params: Value) -> Option<T> {
    // A notification has no answer that could say what is wrong with it.
    serde_json::from_value(params).ok()
}

fn with<R: request::Request>(
    params: Value,
    answer: impl FnOnce(R::Params) -> Answer<R::Result>,
) -> Answer<Value> {
    let wrong = |e| Refused(ErrorCode::InvalidParams, format!("`{}` is malformed: {e}", R::METHOD));
    let result = answer(serde_json::from_value(params).map_err(wrong)?)?;
    serde_json::to_value(result).map_err(|e| Refused(ErrorCode::InternalError, e.to_string()))
}

pub fn capabilities() -> InitializeResult {
    let triggers = [".", "@"].map(str::to_owned).to_vec();
    let completion = CompletionOptions { trigger_characters: Some(triggers), ..Default::default() };
    let rename =
        RenameOptions { prepare_provider: Some(true), work_done_progress_options: Default::default() };
    let capabilities = ServerCapabilities {
        text_document_sync: Some(TextDocumentSyncCapability::Options(lsp_types::TextDocumentSyncOptions {
            open_close: Some(true),
            change: Some(TextDocumentSyncKind::INCREMENTAL),
            save: Some(lsp_types::TextDocumentSyncSaveOptions::Supported(true)),
            ..Default::default()
        })),
        hover_provider: Some(HoverProviderCapability::Simple(true)),
        definition_provider: Some(OneOf::Left(true)),
        references_provider: Some(OneOf::Left(true)),
        document_highlight_provider: Some(OneOf::Left(true)),
        document_symbol_provider: Some(OneOf::Left(true)),
        completion_provider: Some(completion),
        document_formatting_provider: Some(OneOf::Left(true)),
        rename_provider: Some(OneOf::Right(rename)),
        ..Default::default()
    };
    let (name, version) = ("ghyll".to_owned(), Some(env!("CARGO_PKG_VERSION").to_owned()));
    InitializeResult { capabilities, server_info: Some(ServerInfo { name, version }) }
}
