//! Patterns: a chain of tests, first arm that fits. What is known of the value now drops arms now.

use super::value::Value;
use super::words::dissect_any;
use super::{Env, Lower};
use crate::core::{Atom, Const, Op, Prim, Scalar};
use crate::layout::Items;
use crate::source::Span;
use crate::typed::{Arm, Expr, LocalId, Pattern, PatternKind, Type};
use smallvec::smallvec;
use std::collections::BTreeMap;

/// Arms that become branches in each other; more are numbered.
const MOST_NESTED: usize = 24;

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
        if has_never(&value) {
            return self.placeholder(&env.ty(&expr.ty));
        }
        match arms.len() <= MOST_NESTED {
            true => self.arms(expr, &value, &scrutinee_type, arms, env),
            false => self.many_arms(expr, &value, &scrutinee_type, arms, env),
        }
    }

    /// Finds the number of the arm that fits, then branches over the numbers, so that branches nest little.
    fn many_arms(
        &mut self,
        expr: &'m Expr,
        value: &Value<'m>,
        value_type: &Type,
        arms: &'m [Arm],
        env: &mut Env<'m>,
    ) -> Value<'m> {
        let mut possible: Vec<(&'m Arm, Atom)> = Vec::new();
        for arm in arms {
            let fits = self.test(&arm.pattern, value, value_type);
            if fits != FALSE {
                possible.push((arm, fits));
            }
            if fits == TRUE && arm.guard.is_none() {
                break;
            }
        }
        // No arm fits a value that holds one which never comes.
        if possible.is_empty() {
            possible.extend(arms.last().map(|arm| (arm, TRUE)));
        }
        let last = possible.len() - 1;
        let number = |at: usize| Atom::Const(Const::I32(at as i32));
        let mut found = number(last);
        if possible.iter().all(|(arm, _)| arm.guard.is_none()) {
            for (at, (_, fits)) in possible[..last].iter().enumerate().rev() {
                found = self.pick_atom(*fits, number(at), found);
            }
        } else {
            // A guard is evaluated only where no arm before fits.
            let mut open = TRUE;
            for (at, (arm, fits)) in possible[..last].iter().enumerate() {
                let mut cond = self.prim(Prim::And, Scalar::Bool, smallvec![*fits, open]);
                if let Some(guard) = &arm.guard {
                    cond = self.guarded(cond, arm, guard, value, value_type, env);
                }
                found = self.pick_atom(cond, number(at), found);
                let other = self.prim(Prim::Not, Scalar::Bool, smallvec![cond]);
                open = self.prim(Prim::And, Scalar::Bool, smallvec![open, other]);
            }
        }
        let arms: Vec<&Arm> = possible.into_iter().map(|(arm, _)| arm).collect();
        self.numbered(expr, (value, value_type), (0, &arms), found, env)
    }

    /// The arm with this number, the first one having the number `first`.
    fn numbered(
        &mut self,
        expr: &'m Expr,
        (value, value_type): (&Value<'m>, &Type),
        (first, arms): (usize, &[&'m Arm]),
        number: Atom,
        env: &mut Env<'m>,
    ) -> Value<'m> {
        if let [arm] = arms {
            self.bind(&arm.pattern, value, value_type, env);
            return self.expr(&arm.value, env);
        }
        let (low, high) = arms.split_at(arms.len() / 2);
        let middle = first + low.len();
        let is_low = vec![number, Atom::Const(Const::I32(middle as i32))];
        let is_low = self.prim(Prim::Lt, Scalar::I32, is_low.into());
        let ty = env.ty(&expr.ty);
        let of = (value, value_type);
        let lower = |l: &mut Self, env: &mut Env<'m>| l.numbered(expr, of, (first, low), number, env);
        let upper = |l: &mut Self, env: &mut Env<'m>| l.numbered(expr, of, (middle, high), number, env);
        self.branch(is_low, &ty, expr.span, env, lower, upper)
    }

    /// Does the value fit (`fits`) and the guard hold, which sees the pattern's names?
    fn guarded(
        &mut self,
        fits: Atom,
        arm: &'m Arm,
        guard: &'m Expr,
        value: &Value<'m>,
        value_type: &Type,
        env: &mut Env<'m>,
    ) -> Atom {
        let with_names = |l: &mut Self, env: &mut Env<'m>| {
            l.bind(&arm.pattern, value, value_type, env);
            l.expr(guard, env)
        };
        let never = Value::constant(Const::Bool(false));
        self.branch(fits, &Type::Bool, guard.span, env, with_names, |_, _| never).atom()
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
            self.bind(&arm.pattern, value, value_type, env);
            return self.expr(&arm.value, env);
        }
        if fits == FALSE {
            return self.arms(expr, value, value_type, rest, env);
        }

        let cond = match &arm.guard {
            Some(guard) => self.guarded(fits, arm, guard, value, value_type, env),
            None => fits,
        };
        let ty = env.ty(&expr.ty);
        let taken = |l: &mut Self, env: &mut Env<'m>| {
            l.bind(&arm.pattern, value, value_type, env);
            l.expr(&arm.value, env)
        };
        let others = |l: &mut Self, env: &mut Env<'m>| l.arms(expr, value, value_type, rest, env);
        self.branch(cond, &ty, expr.span, env, taken, others)
    }

    /// A Bool atom: does `value` fit?
    fn test(&mut self, pattern: &Pattern, value: &Value<'m>, ty: &Type) -> Atom {
        match &pattern.kind {
            PatternKind::Wild | PatternKind::Bind(_) => TRUE,
            PatternKind::Literal(literal) => {
                let constant = super::expr::constant(*literal);
                self.prim(Prim::Eq, constant.scalar(), smallvec![value.atom(), Atom::Const(constant)])
            }
            PatternKind::Tuple(items) | PatternKind::Struct(_, items) => {
                let types = self.layouts.items(ty).expect("a product pattern has a product type");
                self.test_all(items, value.items(), &types)
            }
            PatternKind::Variant(_, tag, fields) => {
                let Some((same, values, types)) = self.variant(*tag, value, ty) else { return FALSE };
                let inner = self.test_all(fields, &values, &types);
                self.prim(Prim::And, Scalar::Bool, smallvec![same, inner])
            }
            PatternKind::Or(choices) => {
                let mut any = FALSE;
                for choice in choices {
                    let fits = self.test(choice, value, ty);
                    any = self.prim(Prim::Or, Scalar::Bool, smallvec![any, fits]);
                }
                any
            }
        }
    }

    fn test_all(&mut self, patterns: &[Pattern], values: &[Value<'m>], types: &Items) -> Atom {
        let mut all = TRUE;
        for ((pattern, value), ty) in patterns.iter().zip(values).zip(types.iter()) {
            let fits = self.test(pattern, value, ty);
            all = self.prim(Prim::And, Scalar::Bool, smallvec![all, fits]);
        }
        all
    }

    /// A value looked at as variant `tag`: whether it is (a Bool), its fields then, their types. `None` if it cannot be.
    fn variant<'t>(
        &mut self,
        tag: u32,
        value: &Value<'m>,
        ty: &'t Type,
    ) -> Option<(Atom, Vec<Value<'m>>, Items<'t>)>
    where
        'm: 't,
    {
        let types = self.layouts.fields(ty, tag);
        let is = |l: &mut Self, tags: Atom, wanted: u32| {
            l.prim(Prim::Eq, Scalar::I32, smallvec![tags, Atom::Const(Const::I32(wanted as i32))])
        };
        Some(match value {
            Value::Variant(known, fields) if *known == tag => (TRUE, fields.clone(), types),
            Value::Variant(..) => return None,
            Value::Enum(tags, payload) => {
                let fields = self.unpack(ty, tag, payload);
                (is(self, *tags, tag), fields, types)
            }
            Value::Choice(candidates, tags, payload) => {
                let has_tag = |c: &Value| matches!(c, Value::Variant(known, _) if *known == tag);
                let at = candidates.iter().position(has_tag)?;
                let Value::Variant(_, fields) = self.candidate(&candidates[at], payload) else {
                    unreachable!("candidates of an enum are variants")
                };
                (is(self, *tags, at as u32), fields, types)
            }
            Value::Never => return None,
            other => unreachable!("an enum's value is tagged, not {other:?}"),
        })
    }

    /// Binds the names of a pattern that fits.
    pub(super) fn bind(&mut self, pattern: &Pattern, value: &Value<'m>, ty: &Type, env: &mut Env<'m>) {
        match &pattern.kind {
            PatternKind::Wild | PatternKind::Literal(_) => {}
            PatternKind::Bind(id) => {
                env.locals.insert(*id, value.clone());
            }
            PatternKind::Tuple(items) | PatternKind::Struct(_, items) => {
                let types = self.layouts.items(ty).expect("a product pattern has a product type");
                for ((item, value), ty) in items.iter().zip(value.items()).zip(types.iter()) {
                    self.bind(item, value, ty, env);
                }
            }
            PatternKind::Variant(_, tag, fields) => {
                let Some((_, values, types)) = self.variant(*tag, value, ty) else {
                    return self.bind_never(pattern, env);
                };
                for ((field, value), ty) in fields.iter().zip(&values).zip(types.iter()) {
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
        let types = bound_types(last);
        for choice in before.iter().rev() {
            let mut own = Env { locals: Default::default(), types: env.types.clone() };
            self.bind(choice, value, ty, &mut own);
            own.locals.retain(|id, value| bound.locals.get(id).is_none_or(|other| !is_same(value, other)));
            // Most alternatives bind the same parts, whichever of them fits.
            if own.locals.is_empty() {
                continue;
            }
            let fits = self.test(choice, value, ty);
            if fits == FALSE {
                continue;
            }
            for (id, value) in own.locals {
                let joined = match (bound.locals.get(&id).cloned(), types.get(&id)) {
                    (Some(other), Some(ty)) if fits != TRUE => {
                        self.pick(fits, &value, &other, &env.ty(ty), choice.span)
                    }
                    _ => value,
                };
                bound.locals.insert(id, joined);
            }
        }
        env.locals.extend(bound.locals);
    }

    /// `select` over the words of two values.
    fn pick(&mut self, cond: Atom, yes: &Value<'m>, no: &Value<'m>, ty: &Type, span: Span) -> Value<'m> {
        let like = self.join_any(yes, no, ty, span);
        let yes = self.words_like(yes, &like, ty);
        let no = self.words_like(no, &like, ty);
        let words: Vec<Atom> = yes.into_iter().zip(no).map(|(y, n)| self.pick_atom(cond, y, n)).collect();
        self.rebuild(&like, ty, &mut words.into_iter())
    }

    /// Binds the names of a pattern that cannot fit.
    fn bind_never(&mut self, pattern: &Pattern, env: &mut Env<'m>) {
        for (id, ty) in bound_types(pattern) {
            let value = self.placeholder(&env.ty(ty));
            env.locals.insert(id, value);
        }
    }

    fn pick_atom(&mut self, cond: Atom, yes: Atom, no: Atom) -> Atom {
        match cond {
            _ if yes == no => return yes,
            TRUE => return yes,
            FALSE => return no,
            _ => {}
        }
        let scalar = self.scalar_of(yes);
        self.emit(Op::Prim(Prim::Select, scalar, smallvec![no, yes, cond]), &[scalar])[0]
    }
}

/// Names that a pattern binds.
fn bound_types(pattern: &Pattern) -> BTreeMap<LocalId, &Type> {
    let mut found = BTreeMap::new();
    let mut pending = vec![pattern];
    while let Some(pattern) = pending.pop() {
        match &pattern.kind {
            PatternKind::Bind(id) => {
                found.insert(*id, &pattern.ty);
            }
            PatternKind::Tuple(parts)
            | PatternKind::Struct(_, parts)
            | PatternKind::Variant(_, _, parts)
            | PatternKind::Or(parts) => pending.extend(parts),
            PatternKind::Wild | PatternKind::Literal(_) => {}
        }
    }
    found
}

fn is_same(a: &Value, b: &Value) -> bool {
    let (mut xs, mut ys) = (Vec::new(), Vec::new());
    dissect_any(a, &mut xs) == dissect_any(b, &mut ys) && xs == ys
}

/// Is the value, or a part of it, one that is not known to come at all?
fn has_never(value: &Value) -> bool {
    match value {
        Value::Never => true,
        Value::Group(items) => items.iter().any(has_never),
        _ => false,
    }
}

const TRUE: Atom = Atom::Const(Const::Bool(true));
const FALSE: Atom = Atom::Const(Const::Bool(false));
