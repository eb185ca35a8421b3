//! Answers about one place or one document.

use super::publish::Places;
use super::server::{Answer, Document, Overlay, Refused, Server};
use super::uri;
use ghyll_compiler::analysis::complete::{self, Candidate, CandidateKind};
use ghyll_compiler::analysis::{Analysis, Description, Symbol, SymbolKind};
use ghyll_compiler::format;
use ghyll_compiler::source::{Source, SourceId};
use lsp_server::ErrorCode;
use lsp_types::{
    CompletionItem, CompletionItemKind, CompletionParams, CompletionResponse, DocumentFormattingParams,
    DocumentHighlight, DocumentHighlightParams, DocumentSymbol, DocumentSymbolParams, DocumentSymbolResponse,
    Documentation, GotoDefinitionParams, GotoDefinitionResponse, Hover, HoverContents, HoverParams, Location,
    MarkupContent, MarkupKind, SymbolInformation, TextDocumentPositionParams, TextEdit, Uri,
};

/// The user's own text.
pub const OWN: SourceId = SourceId(0);

/// An open document with what is known about it.
pub fn open<'s>(server: &'s mut Server, uri: &Uri) -> Answer<(&'s Document, &'s Analysis)> {
    let name = uri::name(uri);
    if !server.open.contains_key(&name) {
        return Err(Refused(ErrorCode::InvalidParams, format!("`{}` is not open", uri.as_str())));
    }
    let analysed = server.analysed(&name);
    analysed.ok_or_else(|| Refused(ErrorCode::RequestFailed, "the document cannot be analysed".into()))
}

/// The same with the byte of a position.
pub fn place<'s>(
    server: &'s mut Server,
    at: &TextDocumentPositionParams,
) -> Answer<(&'s Document, &'s Analysis, u32)> {
    let (document, analysis) = open(server, &at.text_document.uri)?;
    Ok((document, analysis, document.text.byte(at.position) as u32))
}

pub fn hover(server: &mut Server, params: HoverParams) -> Answer<Option<Hover>> {
    let (document, analysis, at) = place(server, &params.text_document_position_params)?;
    let text = &document.text.text;
    let (span, description) = match analysis.mention_at(OWN, at) {
        Some(mention) => {
            let name = &text[mention.span.start as usize..mention.span.end as usize];
            (mention.span, analysis.describe(name, mention.meaning, &mention.ty, mention.span))
        }
        None => {
            let blank = text[at as usize..].chars().next().is_none_or(char::is_whitespace);
            let Some((span, ty)) = analysis.type_at(OWN, at).filter(|_| !blank) else { return Ok(None) };
            (span, Description { signature: analysis.show(ty, span), text: String::new() })
        }
    };
    let contents = HoverContents::Markup(markup(&description));
    Ok(Some(Hover { contents, range: Some(document.text.range(span)) }))
}

fn markup(description: &Description) -> MarkupContent {
    let Description { signature, text } = description;
    let rest = if text.is_empty() { String::new() } else { format!("\n{text}\n") };
    MarkupContent { kind: MarkupKind::Markdown, value: format!("```ghyll\n{signature}\n```\n{rest}") }
}

pub fn definition(
    server: &mut Server,
    params: GotoDefinitionParams,
) -> Answer<Option<GotoDefinitionResponse>> {
    let (document, analysis, at) = place(server, &params.text_document_position_params)?;
    let found = analysis.mention_at(OWN, at).and_then(|mention| analysis.definition(mention.meaning));
    let location = found.and_then(|span| match span.source {
        OWN => Some(Location::new(document.uri.clone(), document.text.range(span))),
        _ => Places::new(analysis).location(span),
    });
    Ok(location.map(GotoDefinitionResponse::Scalar))
}

pub fn highlights(
    server: &mut Server,
    params: DocumentHighlightParams,
) -> Answer<Option<Vec<DocumentHighlight>>> {
    let (document, analysis, at) = place(server, &params.text_document_position_params)?;
    let Some(mention) = analysis.mention_at(OWN, at) else { return Ok(None) };
    let own = analysis.mentions_of(mention.meaning).filter(|span| span.source == OWN);
    Ok(Some(own.map(|span| DocumentHighlight { range: document.text.range(span), kind: None }).collect()))
}

pub fn symbols(server: &mut Server, params: DocumentSymbolParams) -> Answer<Option<DocumentSymbolResponse>> {
    let nested = server.can.nested_symbols;
    let (document, analysis) = open(server, &params.text_document.uri)?;
    let symbols = analysis.symbols();
    Ok(Some(match nested {
        true => DocumentSymbolResponse::Nested(symbols.iter().map(|s| self::nested(document, s)).collect()),
        false => {
            let all = symbols
                .iter()
                .flat_map(|s| std::iter::once((s, None)).chain(s.parts.iter().map(move |p| (p, Some(s)))));
            DocumentSymbolResponse::Flat(all.map(|(symbol, of)| flat(document, symbol, of)).collect())
        }
    }))
}

// The field `deprecated` is deprecated itself, but has to be given.
#[allow(deprecated)]
fn nested(document: &Document, symbol: &Symbol) -> DocumentSymbol {
    let parts: Vec<DocumentSymbol> = symbol.parts.iter().map(|part| nested(document, part)).collect();
    DocumentSymbol {
        name: symbol.name.clone(),
        detail: None,
        kind: kind(symbol.kind),
        tags: None,
        deprecated: None,
        range: document.text.range(symbol.whole),
        selection_range: document.text.range(symbol.at),
        children: (!parts.is_empty()).then_some(parts),
    }
}

#[allow(deprecated)]
fn flat(document: &Document, symbol: &Symbol, of: Option<&Symbol>) -> SymbolInformation {
    SymbolInformation {
        name: symbol.name.clone(),
        kind: kind(symbol.kind),
        tags: None,
        deprecated: None,
        location: Location::new(document.uri.clone(), document.text.range(symbol.whole)),
        container_name: of.map(|whole| whole.name.clone()),
    }
}

fn kind(kind: SymbolKind) -> lsp_types::SymbolKind {
    match kind {
        SymbolKind::Const => lsp_types::SymbolKind::CONSTANT,
        SymbolKind::Param => lsp_types::SymbolKind::VARIABLE,
        SymbolKind::Raster => lsp_types::SymbolKind::ARRAY,
        SymbolKind::Struct => lsp_types::SymbolKind::STRUCT,
        SymbolKind::Enum => lsp_types::SymbolKind::ENUM,
        SymbolKind::Alias => lsp_types::SymbolKind::TYPE_PARAMETER,
        SymbolKind::Function => lsp_types::SymbolKind::FUNCTION,
        SymbolKind::Field => lsp_types::SymbolKind::FIELD,
        SymbolKind::Variant => lsp_types::SymbolKind::ENUM_MEMBER,
    }
}

pub fn completion(server: &mut Server, params: CompletionParams) -> Answer<Option<CompletionResponse>> {
    let at = &params.text_document_position;
    let name = uri::name(&at.text_document.uri);
    let Some(document) = server.open.get(&name) else {
        return Err(Refused(
            ErrorCode::InvalidParams,
            format!("`{}` is not open", at.text_document.uri.as_str()),
        ));
    };
    let source = Source::new(name, document.text.text.clone());
    let found = complete::complete(source, document.text.byte(at.position), &Overlay(&server.open));
    let items = found.iter().enumerate().map(|(i, candidate)| item(i, candidate)).collect();
    Ok(Some(CompletionResponse::Array(items)))
}

fn item(order: usize, candidate: &Candidate) -> CompletionItem {
    let kind = match candidate.kind {
        CandidateKind::Local => CompletionItemKind::VARIABLE,
        CandidateKind::Function => CompletionItemKind::FUNCTION,
        CandidateKind::Constant => CompletionItemKind::CONSTANT,
        CandidateKind::Param => CompletionItemKind::PROPERTY,
        CandidateKind::Struct => CompletionItemKind::STRUCT,
        CandidateKind::Enum => CompletionItemKind::ENUM,
        CandidateKind::Variant => CompletionItemKind::ENUM_MEMBER,
        CandidateKind::Field => CompletionItemKind::FIELD,
        CandidateKind::Type => CompletionItemKind::CLASS,
        CandidateKind::Keyword => CompletionItemKind::KEYWORD,
        CandidateKind::Module => CompletionItemKind::MODULE,
    };
    let Description { signature, text } = &candidate.description;
    let documentation = (!text.is_empty()).then(|| {
        Documentation::MarkupContent(MarkupContent { kind: MarkupKind::Markdown, value: text.clone() })
    });
    CompletionItem {
        label: candidate.word.clone(),
        kind: Some(kind),
        detail: (!signature.is_empty()).then(|| signature.clone()),
        documentation,
        // Editors sort by the label else; what is nearest comes first here.
        sort_text: Some(format!("{order:05}")),
        ..CompletionItem::default()
    }
}

/// The whole text in the usual layout; nothing for a text that is no program.
pub fn formatting(server: &mut Server, params: DocumentFormattingParams) -> Answer<Option<Vec<TextEdit>>> {
    let (document, _) = open(server, &params.text_document.uri)?;
    let text = &document.text.text;
    let Ok(formatted) = format::format(OWN, text) else { return Ok(None) };
    let edit = TextEdit::new(document.text.whole(), formatted);
    Ok(Some(if edit.new_text == *text { Vec::new() } else { vec![edit] }))
}
