//! Calls: of functions by specialisation, of lambdas by putting their body in place.

use super::shape::Shape;
use super::value::{Closure, Value};
use super::words::dissect_any;
use super::{Env, INLINE_DEPTH_LIMIT, Lower};
use crate::core::{Atom, Const};
use crate::intrinsics::Reading;
use crate::source::Span;
use crate::typed::{Expr, ExprKind, FunctionId, LocalId, Type};
use std::collections::BTreeMap;
use std::rc::Rc;

/// One application: arguments and their types, the type of the result, the place.
#[derive(Clone)]
pub(super) struct Application<'a, 'm> {
    pub args: Vec<Value<'m>>,
    pub params: &'a [Type],
    pub result: &'a Type,
    pub span: Span,
}

/// What is called.
#[derive(Clone)]
pub(super) enum Callee<'m> {
    Function(FunctionId, Vec<Type>),
    /// A lambda, or a choice between functions.
    Value(Value<'m>),
}

/// A body that is being lowered, and what it was entered with.
pub(super) struct Frame {
    head: Head,
    shapes: Vec<Shape>,
    words: Vec<Atom>,
    /// Blocks open at its start.
    open: usize,
}

#[derive(PartialEq)]
enum Head {
    Function(FunctionId, Vec<Type>),
    Value(Shape),
}

impl Frame {
    /// A body entered with `open` blocks around it.
    pub fn new(callee: &Callee, at: &Application, open: usize) -> Frame {
        let mut words = Vec::new();
        let mut shapes: Vec<Shape> = at.args.iter().map(|a| dissect_any(a, &mut words)).collect();
        let head = match callee {
            Callee::Function(id, types) => Head::Function(*id, types.clone()),
            Callee::Value(value) => {
                shapes.push(dissect_any(value, &mut words));
                Head::Value(super::choice::head(value))
            }
        };
        Frame { head, shapes, words, open }
    }

    /// Does putting the same body in place once more, for `next`, come to an end as far as can be told? Behind a test that
    /// only the machine decides less must be left to do; else it is enough that something known now has changed.
    fn leads_to(&self, next: &Frame) -> bool {
        let size = |shapes: &[Shape]| shapes.iter().map(Shape::size).sum::<usize>();
        if next.open > self.open {
            return size(&next.shapes) < size(&self.shapes);
        }
        let is_new = |(a, b): (&Atom, &Atom)| match (a, b) {
            (Atom::Const(a), Atom::Const(b)) => a != b,
            _ => false,
        };
        self.shapes != next.shapes || self.words.iter().zip(&next.words).any(is_new)
    }
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
        let params: Vec<Type> = args.iter().map(|a| env.ty(&a.ty)).collect();
        let args = args.iter().map(|a| self.expr(a, env)).collect();
        let result = env.ty(&expr.ty);
        let at = Application { args, params: &params, result: &result, span: expr.span };
        self.apply(&callee, at)
    }

    pub(super) fn apply(&mut self, callee: &Value<'m>, at: Application<'_, 'm>) -> Value<'m> {
        if self.too_large() {
            return self.placeholder(at.result);
        }
        let closure = match callee {
            Value::Function(closure) => closure,
            Value::Choice(..) => return self.invoke(Callee::Value(callee.clone()), at),
            Value::Never => return self.placeholder(at.result),
            _ => unreachable!("the front end checked the callee's type"),
        };
        match &**closure {
            Closure::Function(id, types) => match self.settings.baked.get(id) {
                Some(slot) => self.layer(*slot, &at.args[0], at.result),
                None => self.invoke(Callee::Function(*id, types.clone()), at),
            },
            Closure::Builtin(builtin) => self.builtin(*builtin, at),
            Closure::Variant(tag) => Value::Variant(*tag, at.args),
            Closure::Struct => Value::Group(at.args.into()),
            Closure::Raster(id) => self.layer(id.0, &at.args[0], at.result),
            Closure::Derivative(f) => self.slope(f, at),
            Closure::Lambda(_) => self.invoke(Callee::Value(callee.clone()), at),
        }
    }

    /// Calls a specialisation or puts the body in place. Lambdas and what yields functions are put in place where that
    /// ends, so that more is known after the call; functions that only the machine knows are called, which keeps the
    /// tests of the tag in one place.
    fn invoke(&mut self, callee: Callee<'m>, at: Application<'_, 'm>) -> Value<'m> {
        let first_order = self.layouts.is_data(at.result);
        let apart = match &callee {
            Callee::Function(id, _) => first_order || self.module.functions[id.0 as usize].attributes.task,
            Callee::Value(value) => first_order && matches!(value, Value::Choice(..)),
        };
        let frame = Frame::new(&callee, &at, self.builder.open.len());
        let goes_round = |f: &Frame| !f.leads_to(&frame);
        if apart
            || self.frames.len() > INLINE_DEPTH_LIMIT
            || self.frames.iter().rev().find(|f| f.head == frame.head).is_some_and(goes_round)
        {
            return self.call_specialised(&callee, &at);
        }
        self.spend(1);
        self.frames.push(frame);
        let value = match &callee {
            Callee::Function(id, types) => self.enter_function(*id, types, at.args),
            Callee::Value(value) => self.enter(value, at),
        };
        self.frames.pop();
        value
    }

    /// Reads a data layer at a position.
    fn layer(&mut self, slot: u32, position: &Value<'m>, result: &Type) -> Value<'m> {
        let components = self.layouts.scalars(result).map_or(0, |s| s.len());
        let intrinsic = Reading::Value.of(components).expect("a layer holds 1 to 4 floats");
        let slot = Value::constant(Const::U32(slot));
        self.intrinsic(intrinsic, &[slot, position.clone()], result)
    }

    /// The body of a top-level function, here.
    pub(super) fn enter_function(
        &mut self,
        id: FunctionId,
        types: &[Type],
        args: Vec<Value<'m>>,
    ) -> Value<'m> {
        self.reach.functions.insert(id);
        let definition = &self.module.functions[id.0 as usize];
        let mut env = Env { locals: BTreeMap::new(), types: Rc::new(types.to_vec()) };
        env.bind(&definition.params, args);
        self.expr(&definition.body, &mut env)
    }

    /// The body of a lambda, or the tests that find the function that is called, here.
    pub(super) fn enter(&mut self, callee: &Value<'m>, at: Application<'_, 'm>) -> Value<'m> {
        match callee {
            Value::Choice(candidates, tag, payload) => {
                self.dispatch((candidates, *tag, payload), at.result, at.span, &mut |l, candidate| {
                    l.apply(&candidate, at.clone())
                })
            }
            Value::Function(closure) => {
                let Some(lambda) = closure.lambda() else { return self.apply(callee, at) };
                let locals = lambda.captures.iter().map(|c| (c.local, c.value.clone())).collect();
                let mut env = Env { locals, types: lambda.types.clone() };
                env.bind(lambda.params, at.args);
                self.expr(lambda.body, &mut env)
            }
            _ => unreachable!("only functions are called"),
        }
    }
}

/// Every local that `expr` mentions, and its type.
pub(super) fn free_locals<'m>(expr: &'m Expr, found: &mut BTreeMap<LocalId, &'m Type>) {
    let mut pending = vec![expr];
    while let Some(expr) = pending.pop() {
        match &expr.kind {
            ExprKind::Local(id) => {
                found.insert(*id, &expr.ty);
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
