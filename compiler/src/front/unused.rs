//! Items that nothing uses. What is only a help for others to read is left alone: names that begin with `_`, and
//! whatever the host may ask for by name, which is every function that could be an entry.

use std::collections::HashSet;

use super::walk::walk;
use crate::ast::Item;
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::entry::EntryKind;
use crate::entry::misfit;
use crate::resolve::load::{File, USER};
use crate::resolve::scope::{Scopes, Value};
use crate::typed::{Expr, ExprKind, FunctionId, Module, ParamId, Type};

/// Entries that are asked for without a name.
const ENTRIES: [&str; 3] = ["main", "pixel", "map"];

pub fn check(files: &[File], scopes: &Scopes, module: &Module, out: &mut Vec<Diagnostic>) {
    modules(files, scopes, out);
    params(scopes, module, out);
    // A file without entries is there for others.
    if ENTRIES.iter().any(|name| module.function(name).is_some()) {
        functions(module, out);
    }
}

/// `use` of a module of which the file needs nothing, or for the second time.
fn modules(files: &[File], scopes: &Scopes, out: &mut Vec<Diagnostic>) {
    for (index, file) in files.iter().enumerate().filter(|(_, f)| !f.library()) {
        let mut seen = HashSet::new();
        let uses = file.items.iter().filter_map(|item| match item {
            Item::Use(name) | Item::UseFile(name) => Some(name),
            _ => None,
        });
        for (name, used) in uses.zip(&file.used) {
            let Some(used) = used else { continue };
            let title = match (seen.insert(*used), scopes.is_used(index, *used)) {
                (true, true) => continue,
                (true, false) => format!("nothing here is from the module `{}`", name.text),
                (false, _) => format!("the module `{}` is used twice", name.text),
            };
            out.push(Diagnostic::warning(codes::UNUSED_MODULE, name.span, title).help("remove this line"));
        }
    }
}

fn params(scopes: &Scopes, module: &Module, out: &mut Vec<Diagnostic>) {
    for (i, param) in module.params.iter().enumerate() {
        let read = scopes.is_read(Value::Param(ParamId(i as u32)));
        if !read && !param.name.starts_with('_') && !module.is_library(param.span) {
            let title = format!("nothing reads the parameter `{}`", param.name);
            out.push(
                Diagnostic::warning(codes::UNUSED_PARAM, param.span, title)
                    .label("setting it changes nothing")
                    .help(format!("remove it, or call it `_{}`", param.name)),
            );
        }
    }
}

/// Helpers in the program's own file that no entry reaches.
fn functions(module: &Module, out: &mut Vec<Diagnostic>) {
    let mut open: Vec<FunctionId> = Vec::new();
    let named = |e: &Expr, open: &mut Vec<FunctionId>| {
        walk(e, &mut |e| {
            if let ExprKind::Function(id, _) = e.kind {
                open.push(id);
            }
        });
    };
    module.consts.iter().for_each(|c| named(&c.value, &mut open));
    module.params.iter().for_each(|p| named(&p.default, &mut open));
    let own = |id: FunctionId| module.functions[id.0 as usize].span.source.0 as usize == USER;
    let slots: HashSet<&Type> = module.params.iter().map(|p| &p.ty).collect();
    for id in (0..module.functions.len() as u32).map(FunctionId).filter(|id| own(*id)) {
        let f = &module.functions[id.0 as usize];
        let ty = Type::Fn(f.param_types().cloned().collect(), Box::new(f.result.clone()));
        let entry = ENTRIES.contains(&f.name.as_str()) || misfit(module, id, EntryKind::Value).is_none();
        if entry || slots.contains(&ty) {
            open.push(id);
        }
    }
    let mut reached = vec![false; module.functions.len()];
    while let Some(id) = open.pop() {
        if !std::mem::replace(&mut reached[id.0 as usize], true) {
            named(&module.functions[id.0 as usize].body, &mut open);
        }
    }
    for (i, f) in module.functions.iter().enumerate() {
        if !reached[i] && own(FunctionId(i as u32)) && !f.name.starts_with('_') {
            let title = format!("nothing calls `{}`", f.name);
            out.push(
                Diagnostic::warning(codes::UNUSED_FUNCTION, f.span, title)
                    .label("no entry leads here")
                    .help(format!("remove it, or call it `_{}`", f.name)),
            );
        }
    }
}
