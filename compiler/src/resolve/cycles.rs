//! Data types must not contain themselves: a value has a fixed number of stream words.

use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::source::Span;
use crate::typed::{EnumId, Module, StructId, Type};

/// Reports every cycle once and cuts it, so that later phases end.
pub fn check(module: &mut Module, out: &mut Vec<Diagnostic>) {
    let mut search = Search { module, state: Vec::new(), path: Vec::new(), found: Vec::new() };
    let n = search.module.structs.len() + search.module.enums.len();
    search.state = vec![State::New; n];
    for node in 0..n {
        search.visit(node);
    }
    let cycles = search.found;
    for cycle in cycles {
        out.push(describe(module, &cycle));
        for &node in &cycle {
            cut(module, node, &cycle);
        }
    }
}

#[derive(Clone, Copy, PartialEq)]
enum State {
    New,
    Open,
    Done,
}

/// Depth-first search over structs (first) and enums.
struct Search<'a> {
    module: &'a Module,
    state: Vec<State>,
    path: Vec<usize>,
    found: Vec<Vec<usize>>,
}

impl Search<'_> {
    fn visit(&mut self, node: usize) {
        match self.state[node] {
            State::Done => {}
            State::Open => {
                let start = self.path.iter().position(|&p| p == node).expect("an open node is on the path");
                self.found.push(self.path[start..].to_vec());
            }
            State::New => {
                self.state[node] = State::Open;
                self.path.push(node);
                let mut parts = Vec::new();
                for_each_field(self.module, node, &mut |ty| mentioned(self.module, ty, &mut parts));
                for part in parts {
                    self.visit(part);
                }
                self.path.pop();
                self.state[node] = State::Done;
            }
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
    let path: Vec<&str> =
        cycle.iter().chain(cycle.first()).map(|&node| name_and_span(module, node).0).collect();
    let mut diagnostic =
        Diagnostic::error(codes::RECURSIVE_TYPE, span, format!("the type `{name}` contains itself"))
            .label(path.join(" -> "))
            .help("a value has a fixed number of stream words, so it cannot hold another of its own type; use an array with a limit, or a function");
    for &node in &cycle[1..] {
        let (other, at) = name_and_span(module, node);
        diagnostic = diagnostic.also(at, format!("by way of `{other}`"));
    }
    diagnostic
}

/// Replaces fields that lead round the cycle.
fn cut(module: &mut Module, node: usize, cycle: &[usize]) {
    let leads_round = |module: &Module, ty: &Type| {
        let mut parts = Vec::new();
        mentioned(module, ty, &mut parts);
        parts.iter().any(|p| cycle.contains(p))
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
