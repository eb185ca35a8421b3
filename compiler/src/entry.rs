//! Which functions can be entries, and as what (LANGUAGE.md, section 8).

use crate::codes;
use crate::compile::EntryKind;
use crate::diagnostic::Diagnostic;
use crate::front::walk::walk;
use crate::layout;
use crate::typed::{ExprKind, Function, FunctionId, Module, Type};

/// Names that a host runs without being told, with what each must be.
const ROLES: &[(&str, EntryKind)] =
    &[("main", EntryKind::Value), ("pixel", EntryKind::Image), ("map", EntryKind::Image)];

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
    if kind == EntryKind::Image {
        let error = || {
            let title = format!("`{name}` is not an image entry");
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
    let named = ROLES.iter().filter_map(|(name, kind)| Some((module.function(name)?, *kind)));
    let (fitting, others): (Vec<_>, Vec<_>) =
        named.partition(|(id, kind)| misfit(module, *id, *kind).is_none());
    if !fitting.is_empty() {
        return (fitting.into_iter().map(|(id, _)| id).collect(), Vec::new());
    }
    let meant = |id: &FunctionId| module.functions[id.0 as usize].name != "map" && !is_called(module, *id);
    let misfits = others.iter().filter(|(id, _)| meant(id));
    let misfits = misfits.filter_map(|(id, kind)| misfit(module, *id, *kind)).collect();
    let ids = (0..module.functions.len() as u32).map(FunctionId);
    let own = |id: &FunctionId| !module.functions[id.0 as usize].library;
    let eligible = ids.filter(|id| own(id) && misfit(module, *id, EntryKind::Value).is_none()).collect();
    (eligible, misfits)
}

/// Whether another of the user's functions mentions this one.
fn is_called(module: &Module, id: FunctionId) -> bool {
    let mentions = |f: &Function| {
        let mut found = false;
        walk(&f.body, &mut |e| found |= matches!(&e.kind, ExprKind::Function(callee, _) if *callee == id));
        found
    };
    let others = module.functions.iter().enumerate().filter(|(i, f)| *i != id.0 as usize && !f.library);
    others.map(|(_, f)| f).any(mentions)
}
