//! Calls: of functions by specialisation, of lambdas by putting their body in place.

use super::value::{Closure, Value};
use super::{Env, INLINE_DEPTH_LIMIT, Lower, unsupported};
use crate::core::Op;
use crate::layout;
use crate::source::Span;
use crate::typed::{Expr, ExprKind, FunctionId, LocalId, Type};
use std::collections::BTreeSet;
use std::rc::Rc;

/// One application: arguments, the type of the result, the place.
pub(super) struct Application<'a, 'm> {
    pub args: Vec<Value<'m>>,
    pub result: &'a Type,
    pub span: Span,
}

impl<'m> Lower<'m> {
    pub(super) fn call(
        &mut self,
        expr: &'m Expr,
        callee: &'m Expr,
        args: &'m [Expr],
        env: &mut Env<'m>,
    ) -> Value<'m> {
        let callee = self.expr(callee, env);
        let args = args.iter().map(|a| self.expr(a, env)).collect();
        let result = env.ty(&expr.ty);
        let at = Application { args, result: &result, span: expr.span };
        self.apply(&callee, at)
    }

    pub(super) fn apply(&mut self, callee: &Value<'m>, at: Application<'_, 'm>) -> Value<'m> {
        if self.too_large() {
            return self.placeholder(at.result);
        }
        let Value::Function(closure) = callee else {
            unreachable!("the front end checked the callee's type")
        };
        match &**closure {
            Closure::Function(id, types) => self.call_function(*id, types, at),
            Closure::Builtin(builtin) => self.builtin(*builtin, at),
            Closure::Variant(tag) => Value::Variant(*tag, at.args),
            Closure::Struct => Value::Group(at.args),
            Closure::Raster(id) => {
                let name = &self.module.rasters[id.0 as usize].name;
                self.error(unsupported(
                    "E0905",
                    at.span,
                    format!("rasters are not supported yet: `{name}`"),
                    "use a parameter or a function of the position instead",
                ));
                self.placeholder(at.result)
            }
            Closure::Lambda { params, body, captures, types } => {
                let mut env = Env { locals: captures.clone(), types: types.clone() };
                self.locals_bound(&mut env, params, at.args);
                self.inline(body, &mut env, at.span, at.result)
            }
        }
    }

    fn call_function(&mut self, id: FunctionId, types: &[Type], at: Application<'_, 'm>) -> Value<'m> {
        let definition = &self.module.functions[id.0 as usize];
        let Some(results) = layout::scalars(self.module, at.result) else {
            // A function that yields functions is known only by its body.
            let mut env = Env { locals: Default::default(), types: Rc::new(types.to_vec()) };
            self.locals_bound(&mut env, &definition.params, at.args);
            return self.inline(&definition.body, &mut env, at.span, at.result);
        };
        let (id, words) = self.specialise(id, types.to_vec(), at.args, at.span);
        let words = self.emit(Op::Call(id, words), &results);
        self.unflatten(at.result, &mut words.into_iter())
    }

    fn inline(&mut self, body: &'m Expr, env: &mut Env<'m>, span: Span, result: &Type) -> Value<'m> {
        if self.inlined == INLINE_DEPTH_LIMIT {
            self.error(unsupported(
                "E0901",
                span,
                "recursion through function values chosen at run time is not supported yet",
                "let a top-level function call itself and pass plain values",
            ));
            return self.placeholder(result);
        }
        self.inlined += 1;
        let value = self.expr(body, env);
        self.inlined -= 1;
        value
    }
}

/// Every local that `expr` mentions.
pub(super) fn free_locals(expr: &Expr, found: &mut BTreeSet<LocalId>) {
    let mut pending = vec![expr];
    while let Some(expr) = pending.pop() {
        match &expr.kind {
            ExprKind::Local(id) => {
                found.insert(*id);
            }
            ExprKind::Literal(_)
            | ExprKind::Const(_)
            | ExprKind::Param(_)
            | ExprKind::Raster(_)
            | ExprKind::Function(..)
            | ExprKind::Builtin(_)
            | ExprKind::VariantFunction(..)
            | ExprKind::StructFunction(_) => {}
            ExprKind::Lambda(_, e)
            | ExprKind::Unary(_, e)
            | ExprKind::Field(e, _)
            | ExprKind::Swizzle(e, _)
            | ExprKind::Derivative(e) => pending.push(e),
            ExprKind::Binary(_, a, b) | ExprKind::And(a, b) | ExprKind::Or(a, b) | ExprKind::Index(a, b) => {
                pending.extend([&**a, &**b]);
            }
            ExprKind::Call(f, args) => {
                pending.push(f);
                pending.extend(args);
            }
            ExprKind::Tuple(items)
            | ExprKind::Array(items)
            | ExprKind::Struct(_, items)
            | ExprKind::Variant(_, _, items) => pending.extend(items),
            ExprKind::With(base, updates) => {
                pending.push(base);
                pending.extend(updates.iter().map(|(_, e)| e));
            }
            ExprKind::If(c, a, b) => pending.extend([&**c, &**a, &**b]),
            ExprKind::Match(e, arms) => {
                pending.push(e);
                for arm in arms {
                    pending.extend(&arm.guard);
                    pending.push(&arm.value);
                }
            }
            ExprKind::Block(lets, value) => {
                pending.extend(lets.iter().map(|l| &l.value));
                pending.push(value);
            }
            ExprKind::Range(_, form) => {
                pending.extend([&form.lo, &form.hi, &form.f]);
                pending.extend(&form.init);
            }
        }
    }
}
