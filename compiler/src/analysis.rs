//! What an editor asks of a program, which may be wrong: what each name means, the type of each expression, what could stand
//! at a place. The trees are those that error recovery leaves, so one mistake hides little of a text.

pub mod complete;
mod describe;
mod manual;
pub(crate) mod notes;
mod outline;

pub use describe::Description;
pub use manual::described;
pub use notes::{Meaning, Mention};
pub use outline::{Symbol, SymbolKind};

use crate::ast::{self, Item};
use crate::compile::{self, Options};
use crate::diagnostic::{Diagnostic, Severity};
use crate::front::{self, Checked, on_large_stack};
use crate::infer::show::show_type;
use crate::resolve::declare::declare;
use crate::resolve::load::{File, Loaded, load};
use crate::source::{Files, Source, SourceId, Sources, Span};
use crate::typed::{Module, Type};
use notes::Notes;
use std::collections::HashMap;

/// What is known about a program. The user's text is source 0.
pub struct Analysis {
    pub sources: Sources,
    /// Those of `ghyll check`, in its order.
    pub diagnostics: Vec<Diagnostic>,
    module: Module,
    /// Trees and library modules by source.
    files: Vec<File>,
    /// In the order of the texts.
    mentions: Vec<Mention>,
    types: Vec<(Span, Type)>,
    /// Where struct fields, variants and aliases are defined, by the name of the whole.
    parts: HashMap<Span, Vec<Span>>,
}

/// Analyses a program; `files` has the modules that it names by path.
pub fn analyse(source: Source, files: &dyn Files) -> Analysis {
    on_large_stack(|| {
        let (mut analysis, _) = Analysis::of(source, files, Notes::default());
        analysis.reach();
        analysis
    })
}

impl Analysis {
    fn of(source: Source, files: &dyn Files, notes: Notes) -> (Analysis, Notes) {
        let Loaded { sources, files, diagnostics, .. } = load(source, files);
        let (module, found, notes) = front::check(&files, declare(&files, Some(notes)));
        let mut notes = notes.unwrap_or_default();
        // As in `front`: after syntax errors the others may be consequences.
        let diagnostics = front::ordered(if diagnostics.is_empty() { found } else { diagnostics });
        let mut analysis = Analysis {
            sources,
            diagnostics,
            module,
            files,
            mentions: std::mem::take(&mut notes.mentions),
            types: std::mem::take(&mut notes.types),
            parts: HashMap::new(),
        };
        analysis.definitions();
        let place = |span: Span| (span.source, span.start, span.end);
        analysis.mentions.sort_by_key(|mention| place(mention.span));
        analysis.mentions.dedup_by(|a, b| a.span == b.span && a.meaning == b.meaning);
        (analysis, notes)
    }

    /// What only specialisation finds.
    fn reach(&mut self) {
        if self.diagnostics.iter().any(|d| d.severity == Severity::Error) {
            return;
        }
        let checked = Checked {
            module: std::mem::take(&mut self.module),
            sources: std::mem::take(&mut self.sources),
            warnings: Vec::new(),
        };
        if let Ok(found) = compile::reach(&checked, &Options::default()) {
            self.diagnostics.extend(found);
        }
        (self.module, self.sources) = (checked.module, checked.sources);
    }

    /// Names where they are defined are mentions too.
    fn definitions(&mut self) {
        let mut notes = Notes::default();
        let module = &self.module;
        module.functions.iter().enumerate().for_each(|(i, f)| {
            notes.mention(f.span, Meaning::Function(crate::typed::FunctionId(i as u32)), Type::Error)
        });
        for (i, c) in module.consts.iter().enumerate() {
            notes.mention(c.span, Meaning::Const(crate::typed::ConstId(i as u32)), c.ty.clone());
        }
        for (i, p) in module.params.iter().enumerate() {
            notes.mention(p.span, Meaning::Param(crate::typed::ParamId(i as u32)), p.ty.clone());
        }
        for (i, r) in module.rasters.iter().enumerate() {
            notes.mention(r.span, Meaning::Raster(crate::typed::RasterId(i as u32)), Type::Error);
        }
        let structs: HashMap<Span, u32> = module.structs.iter().map(|s| s.span).zip(0..).collect();
        let enums: HashMap<Span, u32> = module.enums.iter().map(|e| e.span).zip(0..).collect();
        for file in &self.files {
            let mut modules = file.used.iter();
            for item in &file.items {
                match item {
                    Item::Use(name) | Item::UseFile(name) => {
                        if let Some(Some(used)) = modules.next() {
                            notes.mention(name.span, Meaning::Module(SourceId(*used as u32)), Type::Error);
                        }
                    }
                    Item::Alias(a) => {
                        notes.mention(a.name.span, Meaning::Alias(a.name.span), Type::Error);
                    }
                    Item::Struct(s) => {
                        let Some(id) = structs.get(&s.name.span).map(|i| crate::typed::StructId(*i)) else {
                            continue;
                        };
                        notes.mention(s.name.span, Meaning::Struct(id), Type::Error);
                        let fields: Vec<Span> = s.fields.iter().map(|(name, _)| name.span).collect();
                        for (i, span) in fields.iter().enumerate() {
                            notes.mention(*span, Meaning::Field(id, i as u32), Type::Error);
                        }
                        self.parts.insert(s.name.span, fields);
                    }
                    Item::Enum(e) => {
                        let Some(id) = enums.get(&e.name.span).map(|i| crate::typed::EnumId(*i)) else {
                            continue;
                        };
                        notes.mention(e.name.span, Meaning::Enum(id), Type::Error);
                        let variants: Vec<Span> = e.variants.iter().map(|(name, _)| name.span).collect();
                        for (i, span) in variants.iter().enumerate() {
                            notes.mention(*span, Meaning::Variant(id, i as u32), Type::Error);
                        }
                        self.parts.insert(e.name.span, variants);
                    }
                    _ => {}
                }
            }
        }
        self.mentions.extend(notes.mentions);
    }

    /// The name at a place, or the one that ends there.
    pub fn mention_at(&self, source: SourceId, at: u32) -> Option<&Mention> {
        let end = self.mentions.partition_point(|m| (m.span.source, m.span.start) <= (source, at));
        // Names do not overlap, but two mentions may have one place.
        self.mentions[..end].iter().rev().take(8).find(|m| m.span.source == source && at <= m.span.end)
    }

    /// The smallest expression around a place, with its type.
    pub fn type_at(&self, source: SourceId, at: u32) -> Option<(Span, &Type)> {
        let around = |span: &Span| span.source == source && span.start <= at && at < span.end;
        let all = self.types.iter().filter(|(span, _)| around(span));
        all.min_by_key(|(span, _)| span.end - span.start).map(|(span, ty)| (*span, ty))
    }

    /// Every place that means the same, its definition among them.
    pub fn mentions_of(&self, meaning: Meaning) -> impl Iterator<Item = Span> {
        self.mentions.iter().filter(move |m| m.meaning == meaning).map(|m| m.span)
    }

    /// Where something is defined: the place of its name.
    pub fn definition(&self, meaning: Meaning) -> Option<Span> {
        let part = |whole: Span, index: u32| self.parts.get(&whole)?.get(index as usize).copied();
        let module = &self.module;
        Some(match meaning {
            Meaning::Local(span) | Meaning::Alias(span) => span,
            Meaning::Function(id) => module.functions[id.0 as usize].span,
            Meaning::Const(id) => module.consts[id.0 as usize].span,
            Meaning::Param(id) => module.params[id.0 as usize].span,
            Meaning::Raster(id) => module.rasters[id.0 as usize].span,
            Meaning::Struct(id) => module.structs[id.0 as usize].span,
            Meaning::Enum(id) => module.enums[id.0 as usize].span,
            Meaning::Variant(id, index) => part(module.enums[id.0 as usize].span, index)?,
            Meaning::Field(id, index) => part(module.structs[id.0 as usize].span, index)?,
            Meaning::Module(source) => Span { source, start: 0, end: 0 },
            Meaning::Builtin(_) | Meaning::Form(_) => return None,
        })
    }

    /// What is defined at a place.
    pub fn meaning_defined(&self, at: impl Fn(Span) -> bool) -> Option<Meaning> {
        let own = |m: &&Mention| at(m.span) && self.definition(m.meaning) == Some(m.span);
        self.mentions.iter().find(own).map(|m| m.meaning)
    }

    /// Whether a text is one of the library's, which is part of the compiler.
    pub fn is_library(&self, source: SourceId) -> bool {
        self.files.get(source.0 as usize).is_some_and(File::library)
    }

    /// A type as it is written, at a place.
    pub fn show(&self, ty: &Type, at: Span) -> String {
        show_type(&self.module, self.generics(at), ty)
    }

    /// Type parameters of the function around a place.
    fn generics(&self, at: Span) -> &[String] {
        let inside = |f: &&ast::Function| {
            f.name.span.start <= at.start && at.end <= f.body.span.end.max(f.result.span.end)
        };
        let functions = self.files.get(at.source.0 as usize).into_iter().flat_map(|file| &file.items);
        let found = functions.filter_map(|item| match item {
            Item::Function(f) => Some(f),
            _ => None,
        });
        let Some(found) = found.into_iter().find(inside) else { return &[] };
        let declared = self.module.functions.iter().find(|f| f.span == found.name.span);
        declared.map_or(&[], |f| &f.generics)
    }

    fn text(&self, span: Span) -> &str {
        self.sources.get(span.source).text.get(span.start as usize..span.end as usize).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests;
