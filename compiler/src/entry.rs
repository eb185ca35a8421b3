//! Which functions can be entries, and as what (LANGUAGE.md, section 8).

use crate::codes;
use crate::compile::{CompileError, Options};
use crate::diagnostic::{Diagnostic, Report};
use crate::front::Checked;
use crate::front::walk::walk;
use crate::layout;
use crate::resolve::load::USER;
use crate::source::{SourceId, Span};
use crate::typed::{ExprKind, Function, FunctionId, Module, Type};

/// LANGUAGE.md, section 8.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EntryKind {
    Value,
    Image,
    /// One value for each sample of the field.
    Map,
}

impl EntryKind {
    /// Name of the entry where the host names none.
    fn entry(self) -> &'static str {
        match self {
            EntryKind::Value => "main",
            EntryKind::Image => "pixel",
            EntryKind::Map => "map",
        }
    }

    /// The command that takes such an entry.
    fn command(self) -> &'static str {
        match self {
            EntryKind::Value => "run",
            EntryKind::Image => "render",
            EntryKind::Map => "map",
        }
    }

    const ALL: [EntryKind; 3] = [EntryKind::Value, EntryKind::Image, EntryKind::Map];
}

/// The entry and what it is.
pub(crate) fn find(checked: &Checked, options: &Options) -> Result<(FunctionId, EntryKind), CompileError> {
    let module = &checked.module;
    let names: Vec<&str> = match (&options.entry, options.want) {
        (Some(name), _) => vec![name.as_str()],
        (None, Some(kind)) => vec![kind.entry()],
        (None, None) => EntryKind::ALL.map(EntryKind::entry).to_vec(),
    };
    let mut misfits = Vec::new();
    for name in &names {
        let Some(id) = module.function(name) else { continue };
        let kind = options.want.unwrap_or(match *name {
            "map" if is_image(module, id) => EntryKind::Map,
            "main" => EntryKind::Value,
            _ if is_image(module, id) => EntryKind::Image,
            _ => EntryKind::Value,
        });
        match misfit(module, id, kind) {
            None => return Ok((id, kind)),
            Some(misfit) => misfits.push(misfit),
        }
    }
    if !misfits.is_empty() {
        let sources = checked.sources.clone();
        return Err(CompileError::Program(Report { sources, diagnostics: misfits }));
    }
    // Nothing could be asked for: the file is wrong, not the question.
    if options.entry.is_none() && module.functions.iter().all(|f| f.library) {
        let names: Vec<String> = names.iter().map(|name| format!("`fn {name}`")).collect();
        let title = format!("the program has no {}: it defines no function", names.join(", "));
        let start = Span::new(SourceId(USER as u32), 0, 0);
        let diagnostic = Diagnostic::error(codes::NOT_AN_ENTRY, start, title)
            .help("write `fn main() -> f32 = ..;` or `fn pixel(p: vec2) -> vec3 = ..;`");
        let sources = checked.sources.clone();
        return Err(CompileError::Program(Report { sources, diagnostics: vec![diagnostic] }));
    }
    Err(CompileError::Request(absent(module, options)))
}

/// No function has the entry's name.
fn absent(module: &Module, options: &Options) -> String {
    match (&options.entry, options.want) {
        (Some(name), _) => {
            let mut have: Vec<&str> =
                module.functions.iter().filter(|f| !f.library).map(|f| f.name.as_str()).collect();
            have.truncate(8);
            format!("there is no function `{name}` (the program has: {})", have.join(", "))
        }
        (None, Some(kind)) => {
            let form = if kind == EntryKind::Value { "" } else { "(p: vec2) -> vec3" };
            let other = EntryKind::ALL.into_iter().find(|kind| module.function(kind.entry()).is_some());
            let hint = other.map_or(String::new(), |other| {
                format!("it has `fn {}`: use `ghyll {}`, or ", other.entry(), other.command())
            });
            format!("the program has no `fn {}{form}`; {hint}name an entry with --entry NAME", kind.entry())
        }
        (None, None) => {
            "the program has none of `fn main`, `fn pixel` and `fn map`; name an entry with --entry NAME"
                .into()
        }
    }
}

/// `fn(vec2) -> T`, T of one to four floats.
pub fn is_image(module: &Module, id: FunctionId) -> bool {
    let function = &module.functions[id.0 as usize];
    let params: Vec<&Type> = function.param_types().collect();
    params == [&Type::Vec(2)] && matches!(function.result, Type::F32 | Type::Vec(_))
}

/// Why a function cannot be an entry of a kind, if it cannot.
pub fn misfit(module: &Module, id: FunctionId, kind: EntryKind) -> Option<Diagnostic> {
    let function = &module.functions[id.0 as usize];
    let name = &function.name;
    if kind != EntryKind::Value {
        let what = if kind == EntryKind::Map { "a map" } else { "an image" };
        let error = || {
            let title = format!("`{name}` is not {what} entry");
            Diagnostic::error(codes::NOT_AN_ENTRY, function.span, title)
                .label("takes or yields something else")
                .help(format!("write `fn {name}(p: vec2) -> T`, T one of f32, vec2, vec3 and vec4"))
        };
        return (!is_image(module, id)).then(error);
    }
    let words = |ty: &Type| layout::scalars(module, ty).is_some();
    let label = if !function.generics.is_empty() {
        "it has type parameters"
    } else if !function.param_types().all(words) {
        "it takes a function"
    } else if !words(&function.result) {
        "its value cannot be printed"
    } else {
        return None;
    };
    let error = Diagnostic::error(codes::NOT_AN_ENTRY, function.span, format!("`{name}` cannot be an entry"));
    Some(
        error
            .label(label)
            .help("an entry takes and yields numbers, vectors, tuples, arrays, structs and enums"),
    )
}

/// The functions that a host may run without being told, as far as they have the shape of their role. Where none
/// has, every function that could be an entry, and what is wrong with a `main` or `pixel` that nothing else calls.
pub fn asked_for(module: &Module) -> (Vec<FunctionId>, Vec<Diagnostic>) {
    let named = EntryKind::ALL.into_iter().filter_map(|kind| Some((module.function(kind.entry())?, kind)));
    let (fitting, others): (Vec<_>, Vec<_>) =
        named.partition(|(id, kind)| misfit(module, *id, *kind).is_none());
    if !fitting.is_empty() {
        return (fitting.into_iter().map(|(id, _)| id).collect(), Vec::new());
    }
    let meant = |id: &FunctionId| module.functions[id.0 as usize].name != "map" && !is_called(module, *id);
    let misfits = others.iter().filter(|(id, _)| meant(id));
    let misfits = misfits.filter_map(|(id, kind)| misfit(module, *id, *kind)).collect();
    (covering(module), misfits)
}

/// Functions that could be entries; what one of them leads to is not named again.
fn covering(module: &Module) -> Vec<FunctionId> {
    let callees: Vec<Vec<usize>> = module.functions.iter().map(callees).collect();
    let mut called = vec![false; callees.len()];
    for (caller, callees) in callees.iter().enumerate() {
        callees.iter().filter(|callee| **callee != caller).for_each(|&callee| called[callee] = true);
    }
    let mut reached = vec![false; callees.len()];
    let mut found = Vec::new();
    for only_uncalled in [true, false] {
        for (i, f) in module.functions.iter().enumerate() {
            let id = FunctionId(i as u32);
            let taken = f.library || reached[i] || only_uncalled && called[i];
            if taken || misfit(module, id, EntryKind::Value).is_some() {
                continue;
            }
            found.push(id);
            let mut open = vec![i];
            while let Some(next) = open.pop() {
                if !std::mem::replace(&mut reached[next], true) {
                    open.extend(&callees[next]);
                }
            }
        }
    }
    found
}

fn callees(f: &Function) -> Vec<usize> {
    let mut found = Vec::new();
    walk(&f.body, &mut |e| {
        if let ExprKind::Function(id, _) = &e.kind {
            found.push(id.0 as usize);
        }
    });
    found
}

/// Whether another of the user's functions mentions this one.
fn is_called(module: &Module, id: FunctionId) -> bool {
    let mentions = |f: &Function| callees(f).contains(&(id.0 as usize));
    let others = module.functions.iter().enumerate().filter(|(i, f)| *i != id.0 as usize && !f.library);
    others.map(|(_, f)| f).any(mentions)
}
