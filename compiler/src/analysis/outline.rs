//! The items of a text.

use super::Analysis;
use crate::ast::{Expr, Item, Name};
use crate::source::{SourceId, Span};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SymbolKind {
    Const,
    Param,
    Raster,
    Struct,
    Enum,
    Alias,
    Function,
    Field,
    Variant,
}

/// An item with its parts.
#[derive(Clone, Debug, PartialEq)]
pub struct Symbol {
    pub name: String,
    pub kind: SymbolKind,
    /// The line of the name up to the end of the item.
    pub whole: Span,
    /// The name.
    pub at: Span,
    pub parts: Vec<Symbol>,
}

impl Analysis {
    /// The user's items, in order.
    pub fn symbols(&self) -> Vec<Symbol> {
        let items = self.files.first().into_iter().flat_map(|file| &file.items);
        items.filter_map(|item| self.symbol(item)).collect()
    }

    fn symbol(&self, item: &Item) -> Option<Symbol> {
        let leaf = |name: &Name, end: Span, kind| Symbol {
            name: name.text.clone(),
            kind,
            whole: name.span.to(end),
            at: name.span,
            parts: Vec::new(),
        };
        let plain = |name: &Name, end: Span, kind| self.item(leaf(name, end, kind));
        let last = |e: &Expr| e.span;
        Some(match item {
            Item::Use(_) | Item::UseFile(_) => return None,
            Item::Const(c) => plain(&c.name, last(&c.value), SymbolKind::Const),
            Item::Param(p) => {
                let end = p.range.as_ref().map_or(last(&p.default), |(_, hi)| last(hi).to(last(&p.default)));
                plain(&p.name, end, SymbolKind::Param)
            }
            Item::Raster(r) => plain(&r.name, r.ty.span, SymbolKind::Raster),
            Item::Alias(a) => plain(&a.name, a.ty.span, SymbolKind::Alias),
            Item::Function(f) => plain(&f.name, f.result.span.to(last(&f.body)), SymbolKind::Function),
            Item::Struct(s) => {
                let parts: Vec<Symbol> =
                    s.fields.iter().map(|(name, ty)| leaf(name, ty.span, SymbolKind::Field)).collect();
                let end = parts.last().map_or(s.name.span, |part| part.whole);
                Symbol { parts, ..plain(&s.name, end, SymbolKind::Struct) }
            }
            Item::Enum(e) => {
                let end =
                    |name: &Name, fields: &[crate::ast::Type]| fields.last().map_or(name.span, |ty| ty.span);
                let parts: Vec<Symbol> = (e.variants.iter())
                    .map(|(name, fields)| leaf(name, end(name, fields), SymbolKind::Variant))
                    .collect();
                let end = parts.last().map_or(e.name.span, |part| part.whole);
                Symbol { parts, ..plain(&e.name, end, SymbolKind::Enum) }
            }
        })
    }

    /// An item begins where its line does.
    fn item(&self, symbol: Symbol) -> Symbol {
        let text = &self.sources.get(SourceId(0)).text;
        let line = text[..symbol.at.start as usize].rfind('\n').map_or(0, |end| end + 1);
        Symbol { whole: Span { start: line as u32, ..symbol.whole }, ..symbol }
    }
}
