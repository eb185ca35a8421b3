//! What only the whole program shows: constants and parameters that need their own value, constants that
//! read parameters, recursive functions marked `@inline`, generic functions whose type arguments grow from
//! call to call, and functions handed to generic functions that compare.

use std::collections::{HashMap, HashSet};

use super::components::components;
use super::walk::walk;
use crate::builtins::Builtin;
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::resolve::size::holds_function;
use crate::source::Span;
use crate::typed::{BinaryOp, Expr, ExprKind, FunctionId, Module, Type};

pub fn check(module: &Module, out: &mut Vec<Diagnostic>) {
    let values = Values::of(module);
    let (consts, params) = (module.consts.len(), module.params.len());
    for node in 0..consts + params {
        values.check(node, out);
    }
    for (i, f) in module.functions.iter().enumerate().filter(|(_, f)| f.attributes.inline) {
        values.check_inline(consts + params + i, &f.name, f.span, out);
    }
    growing(module, out);
    compared_functions(module, out);
}

/// What the value of each item needs: constants first, then parameters, then functions.
struct Values<'a> {
    module: &'a Module,
    /// Items that evaluating one item may evaluate, and where. A function that is only named is not run.
    needs: Vec<Vec<(usize, Span)>>,
    component: Vec<usize>,
    /// A parameter that evaluating an item may read.
    reads: Vec<Option<usize>>,
}

impl<'a> Values<'a> {
    fn of(module: &'a Module) -> Values<'a> {
        let is_function = |ty: &Type| matches!(ty, Type::Fn(..));
        let consts = module.consts.iter().map(|c| uses(module, &c.value, is_function(&c.ty)));
        let params = module.params.iter().map(|p| uses(module, &p.default, is_function(&p.ty)));
        let functions = module.functions.iter().map(|f| uses(module, &f.body, false));
        let needs: Vec<Vec<(usize, Span)>> = consts.chain(params).chain(functions).collect();
        let successors: Vec<Vec<usize>> =
            needs.iter().map(|used| used.iter().map(|(node, _)| *node).collect()).collect();
        let component = components(&successors);
        let mut values = Values { module, reads: vec![None; needs.len()], needs, component };
        values.readers();
        values
    }

    /// Finds what reads parameters, from these back to where they are used.
    fn readers(&mut self) {
        let mut users = vec![Vec::new(); self.needs.len()];
        for (user, needs) in self.needs.iter().enumerate() {
            needs.iter().for_each(|(used, _)| users[*used].push(user));
        }
        let first = self.module.consts.len();
        let mut open: Vec<(usize, usize)> =
            (first..first + self.module.params.len()).map(|p| (p, p)).collect();
        while let Some((node, param)) = open.pop() {
            if self.reads[node].is_none() {
                self.reads[node] = Some(param);
                open.extend(users[node].iter().map(|user| (*user, param)));
            }
        }
    }

    fn name_and_span(&self, node: usize) -> (&str, Span) {
        let (consts, params) = (&self.module.consts, &self.module.params);
        if let Some(c) = consts.get(node) {
            return (&c.name, c.span);
        }
        match params.get(node - consts.len()) {
            Some(p) => (&p.name, p.span),
            None => {
                let f = &self.module.functions[node - consts.len() - params.len()];
                (&f.name, f.span)
            }
        }
    }

    fn check(&self, item: usize, out: &mut Vec<Diagnostic>) {
        let (name, span) = self.name_and_span(item);
        for &(node, used) in &self.needs[item] {
            if self.component[node] == self.component[item] {
                out.push(
                    Diagnostic::error(codes::CYCLIC_CONSTANT, span, format!("`{name}` needs its own value"))
                        .also(used, "by way of this")
                        .help("constants and defaults are computed before the program runs, so they cannot refer to each other in a cycle"),
                );
                return;
            }
            let constant = item < self.module.consts.len();
            if let (true, Some(param)) = (constant, self.reads[node]) {
                let (param, at) = self.name_and_span(param);
                let title = format!("the constant `{name}` reads the parameter `{param}`");
                out.push(
                    Diagnostic::error(codes::CONSTANT_PARAM, used, title)
                        .also(at, "set by the host")
                        .help("a constant never changes: make it a function without parameters"),
                );
                return;
            }
        }
    }

    fn check_inline(&self, own: usize, name: &str, span: Span, out: &mut Vec<Diagnostic>) {
        let back = |(node, _): &&(usize, Span)| self.component[*node] == self.component[own];
        let Some((_, used)) = self.needs[own].iter().find(back) else { return };
        let title = format!("`{name}` is recursive, so `@inline` cannot be followed");
        out.push(
            Diagnostic::error(codes::INLINE_RECURSION, span, title)
                .also(*used, "leads back to it")
                .help("remove `@inline`"),
        );
    }
}

/// Items that an expression mentions; but for functions where its value is one.
fn uses(module: &Module, e: &Expr, is_function: bool) -> Vec<(usize, Span)> {
    let (consts, params) = (module.consts.len(), module.params.len());
    let mut nodes = Vec::new();
    walk(e, &mut |e| match e.kind {
        ExprKind::Const(id) => nodes.push((id.0 as usize, e.span)),
        ExprKind::Param(id) => nodes.push((consts + id.0 as usize, e.span)),
        ExprKind::Function(id, _) if !is_function => {
            nodes.push((consts + params + id.0 as usize, e.span));
        }
        _ => {}
    });
    nodes
}

/// A type parameter of a function.
type Slot = (u32, u32);

/// Type parameters flow from caller to callee. A cycle on which a type grows has no end of instances.
fn growing(module: &Module, out: &mut Vec<Diagnostic>) {
    let mut slots = Slots::default();
    let mut grows: Vec<(usize, usize, Slot, Span)> = Vec::new();
    for (caller, f) in module.functions.iter().enumerate().filter(|(_, f)| !f.generics.is_empty()) {
        walk(&f.body, &mut |e| {
            let ExprKind::Function(callee, args) = &e.kind else { return };
            for (i, arg) in args.iter().enumerate() {
                let mut params = Vec::new();
                mentioned(arg, &mut params);
                for param in params {
                    let own = (caller as u32, param);
                    let (from, to) = (slots.number(own), slots.number((callee.0, i as u32)));
                    slots.successors[from].push(to);
                    if !matches!(arg, Type::Param(_)) {
                        grows.push((from, to, own, e.span));
                    }
                }
            }
        });
    }
    let component = components(&slots.successors);
    let mut reported = HashSet::new();
    for (from, to, slot, span) in grows {
        if component[from] == component[to] && reported.insert(slot.0) {
            let f = &module.functions[slot.0 as usize];
            let title = format!("polymorphic recursion: `{}` calls itself with ever larger types", f.name);
            out.push(
                Diagnostic::error(codes::POLYMORPHIC_RECURSION, span, title)
                    .label(format!("here `{}` is part of a larger type", f.generics[slot.1 as usize]))
                    .also(f.span, "defined here")
                    .help("each combination of types becomes a function of its own, and there would be no end of them"),
            );
        }
    }
}

/// Slots by number, and where the types in them go.
#[derive(Default)]
struct Slots {
    numbers: HashMap<Slot, usize>,
    successors: Vec<Vec<usize>>,
}

impl Slots {
    fn number(&mut self, slot: Slot) -> usize {
        let next = self.successors.len();
        let number = *self.numbers.entry(slot).or_insert(next);
        if number == next {
            self.successors.push(Vec::new());
        }
        number
    }
}

/// Generic functions may compare values of a type parameter; then it must not be a function type.
fn compared_functions(module: &Module, out: &mut Vec<Diagnostic>) {
    let mut compared: HashSet<Slot> = HashSet::new();
    let mut uses: Vec<(u32, FunctionId, &[Type], Span)> = Vec::new();
    for (i, f) in module.functions.iter().enumerate() {
        walk(&f.body, &mut |e| match &e.kind {
            ExprKind::Binary(BinaryOp::Eq | BinaryOp::Ne, side, _) => {
                compare(&mut compared, i as u32, &side.ty)
            }
            ExprKind::Builtin(Builtin::Select) => compare(&mut compared, i as u32, &e.ty),
            ExprKind::Function(id, args) if !args.is_empty() => uses.push((i as u32, *id, args, e.span)),
            _ => {}
        });
    }
    // From what is compared back to the type arguments put there.
    let mut callers: HashMap<u32, Vec<usize>> = HashMap::new();
    for (at, (_, callee, ..)) in uses.iter().enumerate() {
        callers.entry(callee.0).or_default().push(at);
    }
    let mut open: Vec<Slot> = compared.iter().copied().collect();
    while let Some((callee, i)) = open.pop() {
        for at in callers.get(&callee).into_iter().flatten() {
            let (caller, _, args, _) = uses[*at];
            let mut params = Vec::new();
            args.get(i as usize).into_iter().for_each(|arg| mentioned(arg, &mut params));
            let found = params.into_iter().map(|param| (caller, param));
            open.extend(found.filter(|slot| compared.insert(*slot)));
        }
    }
    for (_, callee, args, span) in uses {
        let bad = (0..args.len())
            .find(|&i| compared.contains(&(callee.0, i as u32)) && holds_function(module, &args[i]));
        if let Some(i) = bad {
            let f = &module.functions[callee.0 as usize];
            let title = format!(
                "`{}` compares values of type `{}`, which holds a function here",
                f.name, f.generics[i]
            );
            out.push(
                Diagnostic::error(codes::EQUALITY, span, title)
                    .also(f.span, "defined here")
                    .help("functions cannot be compared; pass data"),
            );
        }
    }
}

fn compare(compared: &mut HashSet<Slot>, function: u32, ty: &Type) {
    let mut params = Vec::new();
    mentioned(ty, &mut params);
    compared.extend(params.into_iter().map(|param| (function, param)));
}

fn mentioned(ty: &Type, into: &mut Vec<u32>) {
    match ty {
        Type::Param(i) if !into.contains(i) => into.push(*i),
        Type::Tuple(items) | Type::Struct(_, items) | Type::Enum(_, items) => {
            items.iter().for_each(|t| mentioned(t, into));
        }
        Type::Array(item, _) => mentioned(item, into),
        Type::Fn(params, result) => {
            params.iter().for_each(|t| mentioned(t, into));
            mentioned(result, into);
        }
        _ => {}
    }
}
