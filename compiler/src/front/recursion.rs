//! What only the whole program shows: constants and parameters that need their own value, constants that
//! read parameters, recursive functions marked `@inline`, generic functions whose type arguments grow from
//! call to call, and functions handed to generic functions that compare.

use std::collections::{HashMap, HashSet};

use super::walk::walk;
use crate::builtins::Builtin;
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::resolve::size::holds_function;
use crate::source::Span;
use crate::typed::{BinaryOp, ConstId, Expr, ExprKind, FunctionId, Module, ParamId, Type};

pub fn check(module: &Module, out: &mut Vec<Diagnostic>) {
    let values = Values::of(module);
    for i in 0..module.consts.len() {
        values.check(Node::Const(ConstId(i as u32)), out);
    }
    for i in 0..module.params.len() {
        values.check(Node::Param(ParamId(i as u32)), out);
    }
    for (i, f) in module.functions.iter().enumerate().filter(|(_, f)| f.attributes.inline) {
        values.check_inline(FunctionId(i as u32), &f.name, f.span, out);
    }
    growing(module, out);
    compared_functions(module, out);
}

#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Node {
    Const(ConstId),
    Param(ParamId),
    Function(FunctionId),
}

/// What the value of each item needs.
struct Values<'a> {
    module: &'a Module,
    needs: HashMap<Node, Vec<(Node, Span)>>,
}

impl<'a> Values<'a> {
    fn of(module: &'a Module) -> Values<'a> {
        let mut needs = HashMap::new();
        for (i, c) in module.consts.iter().enumerate() {
            needs.insert(Node::Const(ConstId(i as u32)), uses(&c.value));
        }
        for (i, p) in module.params.iter().enumerate() {
            needs.insert(Node::Param(ParamId(i as u32)), uses(&p.default));
        }
        for (i, f) in module.functions.iter().enumerate() {
            needs.insert(Node::Function(FunctionId(i as u32)), uses(&f.body));
        }
        Values { module, needs }
    }

    fn name_and_span(&self, node: Node) -> (&str, Span) {
        match node {
            Node::Const(id) => {
                (&self.module.consts[id.0 as usize].name, self.module.consts[id.0 as usize].span)
            }
            Node::Param(id) => {
                (&self.module.params[id.0 as usize].name, self.module.params[id.0 as usize].span)
            }
            Node::Function(id) => {
                (&self.module.functions[id.0 as usize].name, self.module.functions[id.0 as usize].span)
            }
        }
    }

    /// Items that evaluating one item may evaluate, and where. A function that is only named is not run.
    fn evaluated(&self, start: Node) -> impl Iterator<Item = (Node, Span)> + '_ {
        let is_function_value = match start {
            Node::Const(id) => matches!(self.module.consts[id.0 as usize].ty, Type::Fn(..)),
            Node::Param(id) => matches!(self.module.params[id.0 as usize].ty, Type::Fn(..)),
            Node::Function(_) => false,
        };
        let own = self.needs.get(&start).map_or(&[][..], Vec::as_slice);
        own.iter().copied().filter(move |(node, _)| !(is_function_value && matches!(node, Node::Function(_))))
    }

    /// Whether evaluating `from` may evaluate something, and what.
    fn find(&self, from: Node, wanted: impl Fn(Node) -> bool) -> Option<Node> {
        let mut seen = HashSet::new();
        let mut work = vec![from];
        while let Some(node) = work.pop() {
            if wanted(node) {
                return Some(node);
            }
            if seen.insert(node) {
                work.extend(self.evaluated(node).map(|(next, _)| next));
            }
        }
        None
    }

    fn check(&self, item: Node, out: &mut Vec<Diagnostic>) {
        let (name, span) = self.name_and_span(item);
        for (node, used) in self.evaluated(item) {
            if self.find(node, |n| n == item).is_some() {
                out.push(
                    Diagnostic::error(codes::CYCLIC_CONSTANT, span, format!("`{name}` needs its own value"))
                        .also(used, "by way of this")
                        .help("constants and defaults are computed before the program runs, so they cannot refer to each other in a cycle"),
                );
                return;
            }
            let constant = matches!(item, Node::Const(_));
            if let (true, Some(param)) = (constant, self.find(node, |n| matches!(n, Node::Param(_)))) {
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

    fn check_inline(&self, id: FunctionId, name: &str, span: Span, out: &mut Vec<Diagnostic>) {
        let own = Node::Function(id);
        let Some((_, used)) = self.evaluated(own).find(|(node, _)| self.find(*node, |n| n == own).is_some())
        else {
            return;
        };
        let title = format!("`{name}` is recursive, so `@inline` cannot be followed");
        out.push(
            Diagnostic::error(codes::INLINE_RECURSION, span, title)
                .also(used, "leads back to it")
                .help("remove `@inline`"),
        );
    }
}

fn uses(e: &Expr) -> Vec<(Node, Span)> {
    let mut nodes = Vec::new();
    walk(e, &mut |e| match e.kind {
        ExprKind::Const(id) => nodes.push((Node::Const(id), e.span)),
        ExprKind::Param(id) => nodes.push((Node::Param(id), e.span)),
        ExprKind::Function(id, _) => nodes.push((Node::Function(id), e.span)),
        _ => {}
    });
    nodes
}

/// A type parameter of a function.
type Slot = (u32, u32);

/// Type parameters flow from caller to callee. A cycle on which a type grows has no end of instances.
fn growing(module: &Module, out: &mut Vec<Diagnostic>) {
    let mut flows: HashMap<Slot, Vec<Slot>> = HashMap::new();
    let mut grows: Vec<(Slot, Slot, Span)> = Vec::new();
    for (caller, f) in module.functions.iter().enumerate().filter(|(_, f)| !f.generics.is_empty()) {
        walk(&f.body, &mut |e| {
            let ExprKind::Function(callee, args) = &e.kind else { return };
            for (i, arg) in args.iter().enumerate() {
                let mut params = Vec::new();
                mentioned(arg, &mut params);
                for param in params {
                    let (from, to) = ((caller as u32, param), (callee.0, i as u32));
                    flows.entry(from).or_default().push(to);
                    if !matches!(arg, Type::Param(_)) {
                        grows.push((from, to, e.span));
                    }
                }
            }
        });
    }
    let mut reported = HashSet::new();
    for (from, to, span) in grows {
        if reaches(&flows, to, from) && reported.insert(from.0) {
            let f = &module.functions[from.0 as usize];
            let title = format!("polymorphic recursion: `{}` calls itself with ever larger types", f.name);
            out.push(
                Diagnostic::error(codes::POLYMORPHIC_RECURSION, span, title)
                    .label(format!("here `{}` is part of a larger type", f.generics[from.1 as usize]))
                    .also(f.span, "defined here")
                    .help("each combination of types becomes a function of its own, and there would be no end of them"),
            );
        }
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
    loop {
        let before = compared.len();
        for (caller, callee, args, _) in &uses {
            for (i, arg) in args.iter().enumerate() {
                if compared.contains(&(callee.0, i as u32)) {
                    compare(&mut compared, *caller, arg);
                }
            }
        }
        if compared.len() == before {
            break;
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

fn reaches(flows: &HashMap<Slot, Vec<Slot>>, from: Slot, to: Slot) -> bool {
    let mut seen = HashSet::new();
    let mut work = vec![from];
    while let Some(slot) = work.pop() {
        if slot == to {
            return true;
        }
        if seen.insert(slot) {
            work.extend(flows.get(&slot).into_iter().flatten());
        }
    }
    false
}
