//! Values from the command line: one expression, checked against a type.

use crate::diagnostic::{Report, Severity};
use crate::infer::{Body, Env};
use crate::parse;
use crate::resolve::scope::Scopes;
use crate::resolve::types::Names;
use crate::source::{Source, Sources};
use crate::typed::{Expr, Local, Module, Type};

/// A checked argument; it may bind locals of its own.
#[derive(Clone, Debug)]
pub struct Argument {
    pub expr: Expr,
    pub locals: Vec<Local>,
}

/// Parses one expression, such as `25`, `-3`, `vec3(1, 2, 3)`, `Some(3)` or the name of a function, that
/// may use everything the module defines.
pub fn parse_arguments(module: &Module, text: &str, expected: &Type) -> Result<Argument, Report> {
    let mut sources = Sources::default();
    let id = sources.add(Source::new("<argument>", text));
    // Both trees are bounded; the stack is for the deepest.
    let (module, text, expected) = (module.clone(), text.to_owned(), expected.clone());
    let (argument, diagnostics) = crate::front::on_large_stack(move || {
        let parsed = parse::expression(id, &text);
        if !parsed.diagnostics.is_empty() {
            return (None, parsed.diagnostics);
        }
        let names = Names {
            scopes: Scopes::of_module(&module),
            structs: module.structs.iter().map(|s| s.generics.len()).collect(),
            enums: module.enums.iter().map(|e| e.generics.len()).collect(),
            ..Names::default()
        };
        let env = Env::finished(&module, &names);
        let Body { expr, locals, diagnostics } =
            env.expression(0, &parsed.tree, Some((&expected, parsed.tree.span)));
        (Some(Argument { expr, locals }), diagnostics)
    });
    match argument {
        Some(argument) if diagnostics.iter().all(|d| d.severity != Severity::Error) => Ok(argument),
        _ => Err(Report { sources, diagnostics }),
    }
}
