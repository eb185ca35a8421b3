//! Patterns: a chain of tests, first arm that fits. What is known of the value now drops arms now.

use super::value::Value;
use super::{Env, Lower};
use crate::core::{Atom, Const, Op, Prim, Scalar};
use crate::layout;
use crate::typed::{Arm, Expr, Pattern, PatternKind, Type};

impl<'m> Lower<'m> {
    pub(super) fn matching(
        &mut self,
        expr: &'m Expr,
        scrutinee: &'m Expr,
        arms: &'m [Arm],
        env: &mut Env<'m>,
    ) -> Value<'m> {
        let scrutinee_type = env.ty(&scrutinee.ty);
        let value = self.expr(scrutinee, env);
        self.arms(expr, &value, &scrutinee_type, arms, env)
    }

    fn arms(
        &mut self,
        expr: &'m Expr,
        value: &Value<'m>,
        value_type: &Type,
        arms: &'m [Arm],
        env: &mut Env<'m>,
    ) -> Value<'m> {
        let (arm, rest) = arms.split_first().expect("the front end checked that the arms are exhaustive");
        let fits = self.test(&arm.pattern, value, value_type);
        if rest.is_empty() || fits == TRUE && arm.guard.is_none() {
            let mut inner = env.clone();
            self.bind(&arm.pattern, value, value_type, &mut inner);
            return self.expr(&arm.value, &mut inner);
        }
        if fits == FALSE {
            return self.arms(expr, value, value_type, rest, env);
        }

        // With a guard the condition is `fits && guard`, the guard seeing the pattern's names.
        let mut cond = fits;
        if let Some(guard) = &arm.guard {
            let never = Value::constant(Const::Bool(false));
            let with_names = |l: &mut Self, env: &mut Env<'m>| {
                l.bind(&arm.pattern, value, value_type, env);
                l.expr(guard, env)
            };
            cond =
                self.branch(fits, &Type::Bool, guard.span, &mut env.clone(), with_names, |_, _| never).atom();
        }
        let ty = env.ty(&expr.ty);
        let taken = |l: &mut Self, env: &mut Env<'m>| {
            l.bind(&arm.pattern, value, value_type, env);
            l.expr(&arm.value, env)
        };
        let others = |l: &mut Self, env: &mut Env<'m>| l.arms(expr, value, value_type, rest, env);
        self.branch(cond, &ty, expr.span, &mut env.clone(), taken, others)
    }

    /// A Bool atom: does `value` fit?
    fn test(&mut self, pattern: &Pattern, value: &Value<'m>, ty: &Type) -> Atom {
        match &pattern.kind {
            PatternKind::Wild | PatternKind::Bind(_) => TRUE,
            PatternKind::Literal(literal) => {
                let constant = super::expr::constant(*literal);
                self.prim(Prim::Eq, constant.scalar(), vec![value.atom(), Atom::Const(constant)])
            }
            PatternKind::Tuple(items) | PatternKind::Struct(_, items) => {
                let types = layout::items(self.module, ty).expect("a product pattern has a product type");
                self.test_all(items, value.items(), &types)
            }
            PatternKind::Variant(id, tag, fields) => match value {
                Value::Variant(known, _) if known != tag => FALSE,
                _ => {
                    let (tags, values, types) = self.variant(*id, *tag, value, ty);
                    let wanted = Atom::Const(Const::I32(*tag as i32));
                    let same = self.prim(Prim::Eq, Scalar::I32, vec![tags, wanted]);
                    let inner = self.test_all(fields, &values, &types);
                    self.prim(Prim::And, Scalar::Bool, vec![same, inner])
                }
            },
            PatternKind::Or(choices) => {
                let mut any = FALSE;
                for choice in choices {
                    let fits = self.test(choice, value, ty);
                    any = self.prim(Prim::Or, Scalar::Bool, vec![any, fits]);
                }
                any
            }
        }
    }

    fn test_all(&mut self, patterns: &[Pattern], values: &[Value<'m>], types: &[Type]) -> Atom {
        let mut all = TRUE;
        for ((pattern, value), ty) in patterns.iter().zip(values).zip(types) {
            let fits = self.test(pattern, value, ty);
            all = self.prim(Prim::And, Scalar::Bool, vec![all, fits]);
        }
        all
    }

    /// Tag, fields and field types of a value looked at as variant `tag`.
    fn variant(
        &mut self,
        id: crate::typed::EnumId,
        tag: u32,
        value: &Value<'m>,
        ty: &Type,
    ) -> (Atom, Vec<Value<'m>>, Vec<Type>) {
        let Type::Enum(_, args) = ty else { unreachable!("a variant pattern has an enum type") };
        let types = layout::variants(self.module, id, args).swap_remove(tag as usize);
        match value {
            Value::Variant(known, fields) => (Atom::Const(Const::I32(*known as i32)), fields.clone(), types),
            Value::Enum(tags, payload) => {
                let fields = self.unpack(id, args, tag, payload);
                (*tags, fields, types)
            }
            other => unreachable!("an enum's value is tagged, not {other:?}"),
        }
    }

    /// Binds the names of a pattern that fits.
    pub(super) fn bind(&mut self, pattern: &Pattern, value: &Value<'m>, ty: &Type, env: &mut Env<'m>) {
        match &pattern.kind {
            PatternKind::Wild | PatternKind::Literal(_) => {}
            PatternKind::Bind(id) => {
                env.locals.insert(*id, value.clone());
            }
            PatternKind::Tuple(items) | PatternKind::Struct(_, items) => {
                let types = layout::items(self.module, ty).expect("a product pattern has a product type");
                for ((item, value), ty) in items.iter().zip(value.items()).zip(&types) {
                    self.bind(item, value, ty, env);
                }
            }
            PatternKind::Variant(id, tag, fields) => {
                if matches!(value, Value::Variant(known, _) if known != tag) {
                    return;
                }
                let (_, values, types) = self.variant(*id, *tag, value, ty);
                for ((field, value), ty) in fields.iter().zip(&values).zip(&types) {
                    self.bind(field, value, ty, env);
                }
            }
            PatternKind::Or(choices) => self.bind_choice(choices, value, ty, env),
        }
    }

    /// Binds the names of the first alternative that fits.
    fn bind_choice(&mut self, choices: &[Pattern], value: &Value<'m>, ty: &Type, env: &mut Env<'m>) {
        let (last, before) = choices.split_last().expect("an or-pattern has alternatives");
        let mut bound = Env { locals: Default::default(), types: env.types.clone() };
        self.bind(last, value, ty, &mut bound);
        for choice in before.iter().rev() {
            let fits = self.test(choice, value, ty);
            if fits == FALSE {
                continue;
            }
            let mut own = Env { locals: Default::default(), types: env.types.clone() };
            self.bind(choice, value, ty, &mut own);
            for (id, value) in own.locals {
                let joined = match bound.locals.get(&id) {
                    Some(other) if fits != TRUE => self.pick(fits, &value, other),
                    _ => value,
                };
                bound.locals.insert(id, joined);
            }
        }
        env.locals.extend(bound.locals);
    }

    /// `select` over the words of two values of one form.
    fn pick(&mut self, cond: Atom, yes: &Value<'m>, no: &Value<'m>) -> Value<'m> {
        match (yes, no) {
            (Value::Group(xs), Value::Group(ys)) => {
                Value::Group(xs.iter().zip(ys).map(|(x, y)| self.pick(cond, x, y)).collect())
            }
            (Value::Enum(tx, xs), Value::Enum(ty, ys)) => {
                let tag = self.pick_atom(cond, *tx, *ty);
                Value::Enum(tag, xs.iter().zip(ys).map(|(x, y)| self.pick_atom(cond, *x, *y)).collect())
            }
            (Value::Atom(x), Value::Atom(y)) => Value::Atom(self.pick_atom(cond, *x, *y)),
            // Known variants and functions: alternatives of a value known now were decided by `test`.
            (known, _) => known.clone(),
        }
    }

    fn pick_atom(&mut self, cond: Atom, yes: Atom, no: Atom) -> Atom {
        if yes == no {
            return yes;
        }
        let scalar = self.scalar_of(yes);
        self.emit(Op::Prim(Prim::Select, scalar, vec![no, yes, cond]), &[scalar])[0]
    }
}

const TRUE: Atom = Atom::Const(Const::Bool(true));
const FALSE: Atom = Atom::Const(Const::Bool(false));
