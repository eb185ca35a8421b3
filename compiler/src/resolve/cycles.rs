//! Data types must not contain themselves: a value has a fixed number of stream words.

use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::front::components::{MOST_SHOWN, components, on_cycles, shown, way_round};
use crate::source::Span;
use crate::typed::{EnumId, Module, StructId, Type};

/// Reports a cycle of each group of types that contain each other, and cuts them, so that later phases end.
pub fn check(module: &mut Module, out: &mut Vec<Diagnostic>) {
    let nodes = 0..module.structs.len() + module.enums.len();
    let parts = |node| {
        let mut parts = Vec::new();
        for_each_field(module, node, &mut |ty| mentioned(module, ty, &mut parts));
        parts
    };
    let successors: Vec<Vec<usize>> = nodes.clone().map(parts).collect();
    let component = components(&successors);
    for start in on_cycles(&successors, &component) {
        out.push(describe(module, &way_round(&successors, &component, start)));
    }
    for node in nodes {
        if successors[node].iter().any(|&part| component[part] == component[node]) {
            cut(module, node, &component);
        }
    }
}

fn for_each_field(module: &Module, node: usize, visit: &mut dyn FnMut(&Type)) {
    match module.structs.get(node) {
        Some(s) => s.fields.iter().for_each(|(_, ty)| visit(ty)),
        None => {
            let variants = &module.enums[node - module.structs.len()].variants;
            variants.iter().flat_map(|v| &v.fields).for_each(visit);
        }
    }
}

fn mentioned(module: &Module, ty: &Type, into: &mut Vec<usize>) {
    let (own, args): (Option<usize>, &[Type]) = match ty {
        Type::Struct(StructId(i), args) => (Some(*i as usize), args),
        Type::Enum(EnumId(i), args) => (Some(module.structs.len() + *i as usize), args),
        Type::Tuple(items) => (None, items),
        Type::Array(item, _) => (None, std::slice::from_ref(&**item)),
        Type::Fn(params, result) => {
            mentioned(module, result, into);
            (None, params)
        }
        _ => (None, &[]),
    };
    into.extend(own);
    args.iter().for_each(|t| mentioned(module, t, into));
}

/// What stands between a field and the type `node` that it mentions, if it is not of that type itself.
fn around(module: &Module, ty: &Type, node: usize) -> Option<String> {
    let own = match ty {
        Type::Struct(StructId(i), _) => Some(*i as usize),
        Type::Enum(EnumId(i), _) => Some(module.structs.len() + *i as usize),
        _ => None,
    };
    let mut parts = Vec::new();
    mentioned(module, ty, &mut parts);
    if own == Some(node) || !parts.contains(&node) {
        return None;
    }
    Some(match own {
        Some(own) => format!("`{}`", name_and_span(module, own).0),
        None => match ty {
            Type::Array(..) => "an array",
            Type::Fn(..) => "the type of a function",
            _ => "a tuple",
        }
        .to_owned(),
    })
}

fn name_and_span(module: &Module, node: usize) -> (&str, Span) {
    match module.structs.get(node) {
        Some(s) => (&s.name, s.span),
        None => {
            let e = &module.enums[node - module.structs.len()];
            (&e.name, e.span)
        }
    }
}

fn describe(module: &Module, cycle: &[usize]) -> Diagnostic {
    let (name, span) = name_and_span(module, cycle[0]);
    let next = *cycle.get(1).unwrap_or(&cycle[0]);
    let mut within = None;
    for_each_field(module, cycle[0], &mut |ty| {
        within = within.take().or_else(|| around(module, ty, next));
    });
    let within = within.map_or(String::new(), |around| format!(", within {around}"));
    let mut diagnostic =
        Diagnostic::error(codes::RECURSIVE_TYPE, span, format!("the type `{name}` contains itself"))
            .label(shown(cycle, |node| name_and_span(module, node).0) + &within)
            .help("a value has a fixed number of stream words, so it cannot hold another of its own type; use an array with a limit, or a function");
    for &node in cycle[1..].iter().take(MOST_SHOWN) {
        let (other, at) = name_and_span(module, node);
        diagnostic = diagnostic.also(at, format!("by way of `{other}`"));
    }
    diagnostic
}

/// Replaces fields that lead round a cycle.
fn cut(module: &mut Module, node: usize, component: &[usize]) {
    let leads_round = |module: &Module, ty: &Type| {
        let mut parts = Vec::new();
        mentioned(module, ty, &mut parts);
        parts.iter().any(|p| component[*p] == component[node])
    };
    let mut fields: Vec<bool> = Vec::new();
    for_each_field(module, node, &mut |ty| fields.push(leads_round(module, ty)));
    let mut bad = fields.into_iter();
    let structs = module.structs.len();
    if node < structs {
        for (_, ty) in &mut module.structs[node].fields {
            if bad.next() == Some(true) {
                *ty = Type::Error;
            }
        }
    } else {
        for ty in module.enums[node - structs].variants.iter_mut().flat_map(|v| &mut v.fields) {
            if bad.next() == Some(true) {
                *ty = Type::Error;
            }
        }
    }
}
