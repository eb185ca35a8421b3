//! Visits the parts of typed expressions.

use crate::typed::{Expr, ExprKind};

/// Calls `visit` with an expression and everything below it.
pub fn walk<'a>(e: &'a Expr, visit: &mut dyn FnMut(&'a Expr)) {
    visit(e);
    for_each_part(e, &mut |part| walk(part, visit));
}

/// Calls `visit` with each direct part.
pub fn for_each_part<'a>(e: &'a Expr, visit: &mut dyn FnMut(&'a Expr)) {
    use ExprKind::*;
    match &e.kind {
        Literal(_) | Local(_) | Const(_) | Param(_) | Raster(_) | Function(..) | Builtin(_)
        | VariantFunction(..) | StructFunction(_) => {}
        Lambda(_, e) | Unary(_, e) | Field(e, _) | Swizzle(e, _) | Derivative(e) => visit(e),
        Binary(_, a, b) | And(a, b) | Or(a, b) | Index(a, b) => {
            visit(a);
            visit(b);
        }
        Call(f, args) => {
            visit(f);
            args.iter().for_each(visit);
        }
        Tuple(items) | Array(items) | Struct(_, items) | Variant(_, _, items) => items.iter().for_each(visit),
        With(base, fields) => {
            visit(base);
            fields.iter().for_each(|(_, value)| visit(value));
        }
        If(a, b, c) => [a, b, c].into_iter().for_each(|e| visit(e)),
        Match(e, arms) => {
            visit(e);
            for arm in arms {
                arm.guard.iter().for_each(&mut *visit);
                visit(&arm.value);
            }
        }
        Block(lets, value) => {
            lets.iter().for_each(|l| visit(&l.value));
            visit(value);
        }
        Range(_, form) => {
            visit(&form.lo);
            visit(&form.hi);
            form.init.iter().for_each(&mut *visit);
            visit(&form.f);
        }
    }
}
