//! Names explained: how something is declared, and what its comment or the manual says of it.

use super::{Analysis, Meaning, manual};
use crate::ast::{self, Item};
use crate::infer::{forms, show::show_type};
use crate::source::{SourceId, Span};
use crate::typed::{Function, Module, Type};

/// A declaration as it would be written, and a text in Markdown that may be empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Description {
    pub signature: String,
    pub text: String,
}

impl Analysis {
    /// What something is; `ty` is its type where it was mentioned, if that is known.
    pub fn describe(&self, name: &str, meaning: Meaning, ty: &Type, at: Span) -> Description {
        let module = &self.module;
        let shown =
            |ty: &Type| if *ty == Type::Error { String::new() } else { format!(": {}", self.show(ty, at)) };
        let comment = || self.definition(meaning).map(|span| self.comment(span)).unwrap_or_default();
        let signature = match meaning {
            Meaning::Local(_) => {
                return Description { signature: format!("{name}{}", shown(ty)), text: String::new() };
            }
            Meaning::Function(id) => {
                let function = &module.functions[id.0 as usize];
                let signature = signature(module, function);
                let text = match (comment(), function.library) {
                    (text, true) if text.is_empty() => {
                        manual::row(name).map(|row| row.text.clone()).unwrap_or_default()
                    }
                    (text, _) => text,
                };
                return Description { signature, text };
            }
            Meaning::Const(id) => {
                let value = self.constant(module.consts[id.0 as usize].span).unwrap_or_default();
                format!("const {name}{}{value}", shown(&module.consts[id.0 as usize].ty))
            }
            Meaning::Param(id) => {
                let declared = self.param(module.params[id.0 as usize].span).unwrap_or_default();
                format!("param {name}{}{declared}", shown(&module.params[id.0 as usize].ty))
            }
            Meaning::Raster(id) => format!("raster {name}{}", shown(&module.rasters[id.0 as usize].ty)),
            Meaning::Struct(id) => {
                let s = &module.structs[id.0 as usize];
                let fields = s
                    .fields
                    .iter()
                    .map(|(field, ty)| format!("{field}: {}", show_type(module, &s.generics, ty)));
                format!("struct {}{}({})", s.name, list(&s.generics), fields.collect::<Vec<_>>().join(", "))
            }
            Meaning::Enum(id) => {
                let e = &module.enums[id.0 as usize];
                let variants: Vec<String> = (0..e.variants.len()).map(|i| self.variant(id.0, i)).collect();
                format!("enum {}{} {{ {} }}", e.name, list(&e.generics), variants.join(", "))
            }
            Meaning::Variant(id, index) => {
                let e = &module.enums[id.0 as usize];
                format!("{} // of enum {}{}", self.variant(id.0, index as usize), e.name, list(&e.generics))
            }
            Meaning::Field(id, index) => {
                let s = &module.structs[id.0 as usize];
                let Some((field, declared)) = s.fields.get(index as usize) else {
                    return Description::default();
                };
                let ty = match ty {
                    Type::Error => show_type(module, &s.generics, declared),
                    ty => self.show(ty, at),
                };
                format!("{field}: {ty} // of struct {}{}", s.name, list(&s.generics))
            }
            Meaning::Alias(span) => self.alias(span).unwrap_or_else(|| format!("type {name}")),
            Meaning::Builtin(_) => return from_manual(name),
            Meaning::Form(form) => {
                let text =
                    "A form of the language; its function is part of the program, not a value.".to_owned();
                return Description { signature: forms::example(form).trim_matches('`').to_owned(), text };
            }
            Meaning::Module(source) => {
                let text = self.module_comment(source);
                return Description { signature: format!("use {}", self.sources.get(source).name), text };
            }
        };
        Description { signature, text: comment() }
    }

    fn variant(&self, id: u32, index: usize) -> String {
        let e = &self.module.enums[id as usize];
        let Some(variant) = e.variants.get(index) else { return String::new() };
        let fields: Vec<String> =
            variant.fields.iter().map(|ty| show_type(&self.module, &e.generics, ty)).collect();
        if fields.is_empty() {
            variant.name.clone()
        } else {
            format!("{}({})", variant.name, fields.join(", "))
        }
    }

    /// The `///` lines above a definition.
    fn comment(&self, definition: Span) -> String {
        let text = &self.sources.get(definition.source).text;
        let before = text.get(..definition.start as usize).unwrap_or_default();
        let mut lines: Vec<&str> = Vec::new();
        // The line of the name itself may begin with attributes and `fn`.
        for line in before.lines().rev().skip(usize::from(!before.ends_with('\n'))) {
            match line.trim() {
                comment if comment.starts_with("///") => lines.push(comment.trim_start_matches('/').trim()),
                attribute if attribute.starts_with('@') && lines.is_empty() => {}
                _ => break,
            }
        }
        lines.reverse();
        lines.join("\n")
    }

    /// The comment at the beginning of a text.
    fn module_comment(&self, source: SourceId) -> String {
        let text = &self.sources.get(source).text;
        let lines = text.lines().map_while(|line| line.trim().strip_prefix("//"));
        lines.map(|line| line.trim_start_matches('/').trim()).collect::<Vec<_>>().join("\n")
    }

    fn items(&self, span: Span) -> impl Iterator<Item = &Item> {
        self.files.get(span.source.0 as usize).into_iter().flat_map(|file| &file.items)
    }

    /// ` = value` of a constant, if it is short.
    fn constant(&self, span: Span) -> Option<String> {
        let found = self.items(span).find_map(|item| match item {
            Item::Const(c) if c.name.span == span => Some(c.value.span),
            _ => None,
        });
        Some(format!(" = {}", self.short(found?)?))
    }

    /// ` = default in lo..hi` of a parameter.
    fn param(&self, span: Span) -> Option<String> {
        let param: &ast::Param = self.items(span).find_map(|item| match item {
            Item::Param(p) if p.name.span == span => Some(p),
            _ => None,
        })?;
        let default = format!(" = {}", self.short(param.default.span)?);
        let Some((lo, hi)) = &param.range else { return Some(default) };
        Some(format!("{default} in {}..{}", self.short(lo.span)?, self.short(hi.span)?))
    }

    fn alias(&self, span: Span) -> Option<String> {
        self.items(span).find_map(|item| match item {
            Item::Alias(a) if a.name.span == span => {
                let generics: Vec<String> = a.generics.iter().map(|name| name.text.clone()).collect();
                Some(format!("type {}{} = {}", a.name.text, list(&generics), self.text(a.ty.span)))
            }
            _ => None,
        })
    }

    /// The text of an expression that fits in a line.
    fn short(&self, span: Span) -> Option<&str> {
        const LONGEST: usize = 60;
        let text = self.text(span);
        (text.len() <= LONGEST && !text.contains('\n')).then_some(text)
    }
}

fn list(generics: &[String]) -> String {
    if generics.is_empty() { String::new() } else { format!("<{}>", generics.join(", ")) }
}

/// A function as it is declared.
fn signature(module: &Module, function: &Function) -> String {
    let mut attributes = function.attributes;
    let given = crate::typed::Attributes::NAMES
        .into_iter()
        .filter(|name| attributes.flag(name).is_some_and(|flag| *flag));
    let given: String = given.map(|name| format!("@{name} ")).collect();
    let show = |ty: &Type| show_type(module, &function.generics, ty);
    let params: Vec<String> = (function.params.iter())
        .filter_map(|id| function.locals.get(id.0 as usize))
        .map(|local| format!("{}: {}", local.name, show(&local.ty)))
        .collect();
    let (name, generics) = (&function.name, list(&function.generics));
    format!("{given}fn {name}{generics}({}) -> {}", params.join(", "), show(&function.result))
}

fn from_manual(name: &str) -> Description {
    let row = manual::row(name);
    row.map(|row| Description { signature: row.signature.clone(), text: row.text.clone() })
        .unwrap_or_default()
}
