//! The tree as source text: [`crate::parse`] gives the same tree again, places aside.
//!
//! Parentheses stand only where the tree needs them, or where an operand that ends in a brace would be hard to read.
//! Trees with errors are not to be printed. How lines are broken is left to `pretty`.

mod expression;
mod pattern;

use crate::ast::*;
use crate::front::on_large_stack;
use crate::typed::Attributes;
use pretty::RcDoc;

/// Columns of a line where there is a choice.
const WIDTH: usize = 100;
const INDENT: isize = 4;

type Doc<'a> = RcDoc<'a>;

/// A whole text.
pub fn file(file: &[Item]) -> String {
    on_large_stack(|| {
        let mut text = String::new();
        let mut before: Option<(&Item, bool)> = None;
        for item in file {
            let printed = render(&item_doc(item));
            let single = !printed.contains('\n');
            // Lines of one kind stay together.
            let together = single
                && before.is_some_and(|(last, one_line)| {
                    one_line && std::mem::discriminant(last) == std::mem::discriminant(item)
                });
            if before.is_some() && !together {
                text.push('\n');
            }
            text.push_str(&printed);
            text.push('\n');
            before = Some((item, single));
        }
        text
    })
}

/// One expression.
pub fn expression(e: &Expr) -> String {
    on_large_stack(|| render(&expression::expr(e)))
}

/// Whether two texts are the same program: their trees, places aside.
pub fn same_tree(a: &[Item], b: &[Item]) -> bool {
    on_large_stack(|| bare(&a) == bare(&b))
}

/// The tree without its places.
fn bare(tree: &impl std::fmt::Debug) -> String {
    let text = format!("{tree:?}");
    let mut parts = text.split("Span {");
    let mut bare = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        bare.push_str(part.split_once('}').map_or("", |(_, rest)| rest));
    }
    bare
}

fn render(doc: &Doc) -> String {
    doc.pretty(WIDTH).to_string()
}

fn text<'a>(text: impl Into<std::borrow::Cow<'a, str>>) -> Doc<'a> {
    RcDoc::text(text)
}

fn name(name: &Name) -> Doc<'_> {
    text(name.text.as_str())
}

/// `open a, b, c close`, one to a line with a comma behind the last where they do not fit.
fn list<'a>(open: &'static str, items: impl IntoIterator<Item = Doc<'a>>, close: &'static str) -> Doc<'a> {
    let separator = text(",").append(Doc::line());
    let items = Doc::intersperse(items, separator);
    let comma = text(",").flat_alt(Doc::nil());
    let inner = Doc::line_().append(items).append(comma).nest(INDENT);
    text(open).append(inner).append(Doc::line_()).append(close).group()
}

/// `open a, b, c close` on one line.
fn row<'a>(open: &'static str, items: impl IntoIterator<Item = Doc<'a>>, close: &'static str) -> Doc<'a> {
    text(open).append(Doc::intersperse(items, text(", "))).append(close)
}

fn item_doc(item: &Item) -> Doc<'_> {
    match item {
        Item::Use(module) => text("use ").append(name(module)).append(";"),
        Item::UseFile(path) => text("use \"").append(name(path)).append("\";"),
        Item::Const(c) => {
            let note = c.ty.as_ref().map_or(Doc::nil(), |ty| text(": ").append(type_doc(ty)));
            text("const ")
                .append(name(&c.name))
                .append(note)
                .append(expression::defined(&c.value))
                .append(";")
        }
        Item::Param(p) => {
            let range = p.range.as_ref().map_or(Doc::nil(), |(lo, hi)| {
                text(" in ").append(expression::expr(lo)).append("..").append(expression::expr(hi))
            });
            let head = text("param ").append(typed(&p.name, &p.ty));
            head.append(expression::defined(&p.default)).append(range).append(";")
        }
        Item::Raster(r) => text("raster ").append(typed(&r.name, &r.ty)).append(";"),
        Item::Struct(s) => {
            let fields = s.fields.iter().map(|(field, ty)| typed(field, ty));
            text("struct ")
                .append(name(&s.name))
                .append(generics(&s.generics))
                .append(list("(", fields, ")"))
                .append(";")
        }
        Item::Enum(e) => {
            let variants = e.variants.iter().map(|(variant, fields)| match fields.is_empty() {
                true => name(variant),
                false => name(variant).append(row("(", fields.iter().map(type_doc), ")")),
            });
            let variants = Doc::intersperse(variants, text(",").append(Doc::line()));
            let comma = text(",").flat_alt(Doc::nil());
            let inner = Doc::line().append(variants).append(comma).nest(INDENT).append(Doc::line());
            let head = text("enum ").append(name(&e.name)).append(generics(&e.generics));
            head.append(text(" {").append(inner).append("}").group())
        }
        Item::Alias(a) => text("type ")
            .append(name(&a.name))
            .append(generics(&a.generics))
            .append(" = ")
            .append(type_doc(&a.ty))
            .append(";"),
        Item::Function(f) => function(f),
    }
}

fn function(f: &Function) -> Doc<'_> {
    let Attributes { task, inline, bake } = f.attributes;
    let marks = [(task, "@task "), (inline, "@inline "), (bake, "@bake ")];
    let marks: String = marks.iter().filter(|(set, _)| *set).map(|(_, mark)| *mark).collect();
    let params = f.params.iter().map(|(param, ty)| typed(param, ty));
    let head = text(marks)
        .append("fn ")
        .append(name(&f.name))
        .append(generics(&f.generics))
        .append(list("(", params, ")"))
        .append(" -> ")
        .append(type_doc(&f.result));
    match f.body.kind {
        ExprKind::Block(..) => head.append(" ").append(expression::expr(&f.body)),
        _ => head.append(expression::defined(&f.body)).append(";"),
    }
}

fn generics(names: &[Name]) -> Doc<'_> {
    match names {
        [] => Doc::nil(),
        _ => row("<", names.iter().map(name), ">"),
    }
}

fn typed<'a>(of: &'a Name, ty: &'a Type) -> Doc<'a> {
    name(of).append(": ").append(type_doc(ty))
}

fn type_doc(ty: &Type) -> Doc<'_> {
    match &ty.kind {
        TypeKind::Error => text("_"),
        TypeKind::Named(of, arguments) if arguments.is_empty() => text(of.as_str()),
        TypeKind::Named(of, arguments) => {
            text(of.as_str()).append(row("<", arguments.iter().map(type_doc), ">"))
        }
        TypeKind::Tuple(items) => row("(", items.iter().map(type_doc), ")"),
        TypeKind::Array(item, n) => {
            text("[").append(type_doc(item)).append("; ").append(expression::expr(n)).append("]")
        }
        TypeKind::Fn(params, result) => {
            row("fn(", params.iter().map(type_doc), ")").append(" -> ").append(type_doc(result))
        }
    }
}

#[cfg(test)]
mod tests;
