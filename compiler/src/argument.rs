//! Values from the command line: one expression, checked against a type.

use crate::diagnostic::{Diagnostic, Report, Severity};
use crate::front::on_large_stack;
use crate::infer::{Body, Env};
use crate::parse;
use crate::resolve::scope::Scopes;
use crate::resolve::types::Names;
use crate::source::{Source, SourceId, Sources};
use crate::typed::{Expr, Local, Module, Type};

/// A checked argument; it may bind locals of its own.
#[derive(Clone, Debug)]
pub struct Argument {
    pub expr: Expr,
    pub locals: Vec<Local>,
}

/// Parses one expression of any type, as [`parse_arguments`].
pub fn parse_expression(module: &Module, text: &str) -> Result<Argument, Report> {
    parse_one(module, text, None)
}

/// Parses one expression, such as `25`, `-3`, `vec3(1, 2, 3)`, `Some(3)` or the name of a function, that
/// may use everything the module defines. Places in the result and in the report are places in `text`.
pub fn parse_arguments(module: &Module, text: &str, expected: &Type) -> Result<Argument, Report> {
    parse_one(module, text, Some(expected))
}

fn parse_one(module: &Module, text: &str, expected: Option<&Type>) -> Result<Argument, Report> {
    let mut sources = Sources::default();
    let id = sources.add(Source::new("<argument>", text));
    // Both trees are bounded; the stack is for the deepest.
    let checked = on_large_stack(|| {
        // A number of its own tells the places in the argument from those in the module.
        let apart = SourceId(u32::MAX);
        check(module, text, expected, id).map_err(|_| check(module, text, expected, apart).err())
    });
    checked.map_err(|diagnostics| {
        let diagnostics = diagnostics.unwrap_or_default().into_iter().map(|d| within(d, id)).collect();
        Report { sources, diagnostics }
    })
}

fn check(
    module: &Module,
    text: &str,
    expected: Option<&Type>,
    id: SourceId,
) -> Result<Argument, Vec<Diagnostic>> {
    let parsed = parse::expression(id, text);
    if !parsed.diagnostics.is_empty() {
        return Err(parsed.diagnostics);
    }
    let names = Names {
        scopes: Scopes::of_module(module),
        structs: module.structs.iter().map(|s| s.generics.len()).collect(),
        enums: module.enums.iter().map(|e| e.generics.len()).collect(),
        ..Names::default()
    };
    let env = Env::finished(module, &names);
    let Body { expr, locals, diagnostics } =
        env.expression(0, &parsed.tree, expected.map(|ty| (ty, parsed.tree.span)));
    match diagnostics.iter().any(|d| d.severity == Severity::Error) {
        true => Err(diagnostics),
        false => Ok(Argument { expr, locals }),
    }
}

/// The diagnostic with places in the argument only.
fn within(mut diagnostic: Diagnostic, id: SourceId) -> Diagnostic {
    let own = diagnostic.primary.0.source;
    diagnostic.secondary.retain(|(span, _)| span.source == own);
    let places = diagnostic.secondary.iter_mut().chain([&mut diagnostic.primary]);
    places.for_each(|(span, _)| span.source = id);
    diagnostic
}
