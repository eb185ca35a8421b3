//! Expressions.

use super::constant::has_only_constants;
use super::value::{Capture, Closure, Lambda, Value};
use super::value::{MOST_WEIGHT, weight_of};
use super::{Env, Lower, WORK_LIMIT};
use crate::core::{Atom, Const, Op, Prim, Scalar};
use crate::source::Span;
use crate::typed::{BinaryOp, Expr, ExprKind, Let, Literal, LocalId, ParamId, Type, UnaryOp};
use rustc_hash::FxHashMap;
use smallvec::smallvec;
use std::collections::BTreeMap;

/// Enums whose words were compared already, type by type: variants may hold the same words of one enum many times over.
type Compared = FxHashMap<(Type, Vec<Atom>), Atom>;

impl<'m> Lower<'m> {
    pub(super) fn expr(&mut self, expr: &'m Expr, env: &mut Env<'m>) -> Value<'m> {
        if self.too_large() {
            return self.standing_in(&env.ty(&expr.ty));
        }
        match &expr.kind {
            ExprKind::Literal(literal) => Value::constant(constant(*literal)),
            ExprKind::Local(id) => env.get(*id),
            ExprKind::Const(id) => self.constant(*id),
            ExprKind::Param(id) => {
                self.reach.params.insert(*id);
                self.param(*id)
            }
            ExprKind::Raster(id) => Value::function(Closure::Raster(*id)),
            ExprKind::Function(id, types) => {
                Value::function(Closure::Function(*id, types.iter().map(|t| env.ty(t)).collect()))
            }
            ExprKind::Builtin(builtin) => Value::function(Closure::Builtin(*builtin)),
            ExprKind::VariantFunction(_, tag) => Value::function(Closure::Variant(*tag)),
            ExprKind::StructFunction(_) => Value::function(Closure::Struct),
            ExprKind::Lambda(params, body) => {
                let mut free = BTreeMap::new();
                super::call::free_locals(body, &mut free);
                let capture = |(local, ty): (&LocalId, &&Type)| {
                    let value = env.locals.get(local)?.clone();
                    Some(Capture { local: *local, ty: env.ty(ty), value })
                };
                let captures: Vec<Capture> = free.iter().filter_map(capture).collect();
                let weight = weight_of(&captures);
                if weight > MOST_WEIGHT {
                    self.work(WORK_LIMIT);
                    return Value::Never;
                }
                Value::function(Closure::Lambda(Lambda {
                    params,
                    body,
                    captures,
                    weight,
                    types: env.types.clone(),
                }))
            }
            ExprKind::Call(callee, args) => self.call(expr, callee, args, env),
            ExprKind::Unary(op, a) => self.unary(*op, a, env),
            ExprKind::Binary(op, a, b) => self.binary(*op, a, b, env),
            ExprKind::And(a, b) => self.short_circuit(a, b, false, env),
            ExprKind::Or(a, b) => self.short_circuit(a, b, true, env),
            ExprKind::Tuple(items) | ExprKind::Array(items) | ExprKind::Struct(_, items) => {
                Value::Group(items.iter().map(|e| self.expr(e, env)).collect())
            }
            ExprKind::With(base, updates) => {
                let mut items = self.expr(base, env).items().to_vec();
                for (field, value) in updates {
                    items[*field as usize] = self.expr(value, env);
                }
                Value::Group(items.into())
            }
            ExprKind::Variant(_, tag, fields) => {
                Value::Variant(*tag, fields.iter().map(|e| self.expr(e, env)).collect())
            }
            ExprKind::Field(base, at) => self.expr(base, env).items()[*at as usize].clone(),
            ExprKind::Swizzle(base, parts) => {
                let base = self.expr(base, env);
                let mut picked: Vec<Value> =
                    parts.iter().map(|c| base.items()[*c as usize].clone()).collect();
                if picked.len() == 1 { picked.swap_remove(0) } else { Value::Group(picked.into()) }
            }
            ExprKind::Index(base, index) => self.index(expr, base, index, env),
            ExprKind::If(cond, yes, no) => {
                let cond = self.expr(cond, env).atom();
                let ty = env.ty(&expr.ty);
                self.branch(cond, &ty, expr.span, env, |l, env| l.expr(yes, env), |l, env| l.expr(no, env))
            }
            ExprKind::Match(scrutinee, arms) => self.matching(expr, scrutinee, arms, env),
            ExprKind::Block(lets, value) => self.scope(lets, value, env),
            ExprKind::Range(op, form) => self.range(expr, *op, form, env),
            ExprKind::Derivative(f) => Value::function(Closure::Derivative(self.expr(f, env))),
        }
    }

    fn scope(&mut self, lets: &'m [Let], value: &'m Expr, env: &mut Env<'m>) -> Value<'m> {
        for binding in lets {
            // What is refused needs no values for its names, which may be long.
            if self.too_large() {
                break;
            }
            let bound = self.expr(&binding.value, env);
            let ty = env.ty(&binding.value.ty);
            self.bind(&binding.pattern, &bound, &ty, env);
        }
        self.expr(value, env)
    }

    /// The placeholder of what is not lowered any more, the same one again where as many follow each other.
    fn standing_in(&mut self, ty: &Type) -> Value<'m> {
        match &self.stand_in {
            Some((of, value)) if of == ty => value.clone(),
            _ => {
                let value = self.placeholder(ty);
                self.stand_in = Some((ty.clone(), value.clone()));
                value
            }
        }
    }

    /// A value that stands in after an error, or for one that is not known to come at all.
    pub(super) fn placeholder(&self, ty: &Type) -> Value<'m> {
        match self.layouts.scalars(ty) {
            Some(scalars) => {
                let mut zeros = scalars.into_iter().map(|s| Atom::Const(Const::from_word(s, 0)));
                self.unflatten(ty, &mut zeros)
            }
            None => match self.layouts.items(ty) {
                Some(items) => Value::Group(items.iter().map(|t| self.placeholder(t)).collect()),
                None => Value::Never,
            },
        }
    }

    fn param(&mut self, id: ParamId) -> Value<'m> {
        let definition = &self.module.params[id.0 as usize];
        if let Some(first) = self.live.get(&id).copied() {
            if self.slots.contains_key(&id) {
                return self.slot_value(id, first);
            }
            let scalars = self.layouts.scalars(&definition.ty).expect("live parameters are first order");
            let mut words = Vec::with_capacity(scalars.len());
            for (at, scalar) in scalars.iter().enumerate() {
                words.push(self.emit(Op::Live(first + at as u32), &[*scalar])[0]);
            }
            return self.unflatten(&definition.ty, &mut words.into_iter());
        }
        self.fixed(id)
    }

    /// The parameter's value, fixed now.
    pub(super) fn fixed(&mut self, id: ParamId) -> Value<'m> {
        if let Some(known) = self.fixed.get(&id) {
            return known.clone();
        }
        let settings = self.settings;
        let value = match settings.set.get(&id) {
            Some(setting) => &setting.value,
            None => &self.module.params[id.0 as usize].default,
        };
        let value = self.expr(value, &mut Env::default());
        if has_only_constants(&value) {
            self.fixed.insert(id, value.clone());
        }
        value
    }

    fn unary(&mut self, op: UnaryOp, a: &'m Expr, env: &mut Env<'m>) -> Value<'m> {
        let prim = match op {
            UnaryOp::Neg => Prim::Neg,
            UnaryOp::Not => Prim::Not,
        };
        let value = self.expr(a, env);
        self.map(&value, &mut |l, atom| {
            let scalar = l.scalar_of(atom);
            l.prim(prim, scalar, smallvec![atom])
        })
    }

    /// Applies a scalar operation to every atom of a product.
    pub(super) fn map(
        &mut self,
        value: &Value<'m>,
        f: &mut impl FnMut(&mut Self, Atom) -> Atom,
    ) -> Value<'m> {
        match value {
            Value::Group(items) => Value::Group(items.iter().map(|v| self.map(v, f)).collect()),
            value => Value::Atom(f(self, value.atom())),
        }
    }

    fn binary(&mut self, op: BinaryOp, a: &'m Expr, b: &'m Expr, env: &mut Env<'m>) -> Value<'m> {
        let (ta, tb) = (env.ty(&a.ty), env.ty(&b.ty));
        let a = self.expr(a, env);
        let b = self.expr(b, env);
        match op {
            BinaryOp::Eq => self.equal(&a, &b, &ta),
            BinaryOp::Ne => {
                let equal = self.equal(&a, &b, &ta).atom();
                Value::Atom(self.prim(Prim::Not, Scalar::Bool, smallvec![equal]))
            }
            BinaryOp::Mul if matches!(ta, Type::Mat(_)) || matches!(tb, Type::Mat(_)) => {
                self.matrix_product(&a, &ta, &b, &tb)
            }
            _ => {
                let (prim, swap) = primitive(op);
                if swap { self.zip(prim, &b, &a) } else { self.zip(prim, &a, &b) }
            }
        }
    }

    /// Componentwise; a scalar goes with every component.
    pub(super) fn zip(&mut self, prim: Prim, a: &Value<'m>, b: &Value<'m>) -> Value<'m> {
        match (a, b) {
            (Value::Group(xs), Value::Group(ys)) => {
                Value::Group(xs.iter().zip(ys.iter()).map(|(x, y)| self.zip(prim, x, y)).collect())
            }
            (Value::Group(xs), y) => Value::Group(xs.iter().map(|x| self.zip(prim, x, y)).collect()),
            (x, Value::Group(ys)) => Value::Group(ys.iter().map(|y| self.zip(prim, x, y)).collect()),
            (x, y) => {
                let scalar = self.scalar_of(x.atom());
                Value::Atom(self.prim(prim, scalar, smallvec![x.atom(), y.atom()]))
            }
        }
    }

    /// Structural equality: every pair of words is equal.
    fn equal(&mut self, a: &Value<'m>, b: &Value<'m>, ty: &Type) -> Value<'m> {
        self.equal_once(a, b, ty, &mut Compared::default())
    }

    fn equal_once(&mut self, a: &Value<'m>, b: &Value<'m>, ty: &Type, compared: &mut Compared) -> Value<'m> {
        let (mut xs, mut ys) = (Vec::new(), Vec::new());
        self.equality_words(a, b, ty, (&mut xs, &mut ys), compared);
        let mut all = Atom::Const(Const::Bool(true));
        for (x, y) in xs.into_iter().zip(ys) {
            let scalar = self.scalar_of(x);
            let same = self.prim(Prim::Eq, scalar, smallvec![x, y]);
            all = self.prim(Prim::And, Scalar::Bool, smallvec![all, same]);
        }
        Value::Atom(all)
    }

    /// The words to compare one by one. Enums are compared variant by variant, for a payload may hold floats as bits.
    fn equality_words(
        &mut self,
        a: &Value<'m>,
        b: &Value<'m>,
        ty: &Type,
        (xs, ys): (&mut Vec<Atom>, &mut Vec<Atom>),
        compared: &mut Compared,
    ) {
        // Constants are compared without any operation.
        self.work(1);
        if self.too_large() {
            return;
        }
        if let Type::Enum(id, _) = ty {
            let (ta, pa) = self.enum_words(a, ty);
            let (tb, pb) = self.enum_words(b, ty);
            let words = (ty.clone(), [&[ta, tb], pa.as_slice(), pb.as_slice()].concat());
            if let Some(same) = compared.get(&words) {
                xs.push(*same);
                ys.push(Atom::Const(Const::Bool(true)));
                return;
            }
            let mut all = self.prim(Prim::Eq, Scalar::I32, smallvec![ta, tb]);
            for tag in 0..self.module.enums[id.0 as usize].variants.len() as u32 {
                let types = self.layouts.fields(ty, tag);
                if types.is_empty() {
                    continue;
                }
                let fields_a = self.unpack(ty, tag, &pa);
                let fields_b = self.unpack(ty, tag, &pb);
                let group = Type::Tuple(types.iter().cloned().collect());
                let (fields_a, fields_b) = (Value::Group(fields_a.into()), Value::Group(fields_b.into()));
                let same = self.equal_once(&fields_a, &fields_b, &group, compared).atom();
                let tag_atom = Atom::Const(Const::I32(tag as i32));
                let other = self.prim(Prim::Ne, Scalar::I32, smallvec![ta, tag_atom]);
                let held = self.prim(Prim::Or, Scalar::Bool, smallvec![other, same]);
                all = self.prim(Prim::And, Scalar::Bool, smallvec![all, held]);
            }
            compared.insert(words, all);
            xs.push(all);
            ys.push(Atom::Const(Const::Bool(true)));
            return;
        }
        match self.layouts.items(ty) {
            Some(items) => {
                for ((a, b), t) in a.items().iter().zip(b.items()).zip(items.iter()) {
                    self.equality_words(a, b, t, (xs, ys), compared);
                }
            }
            None => {
                xs.push(a.atom());
                ys.push(b.atom());
            }
        }
    }

    /// Tag and payload of an enum's value, packed if its variant is known.
    pub(super) fn enum_words(&mut self, value: &Value<'m>, ty: &Type) -> (Atom, Vec<Atom>) {
        let mut words = Vec::new();
        self.flatten(value, ty, &mut words);
        let payload = words.split_off(1);
        (words[0], payload)
    }

    fn short_circuit(&mut self, a: &'m Expr, b: &'m Expr, on: bool, env: &mut Env<'m>) -> Value<'m> {
        let first = self.expr(a, env).atom();
        let known = Value::constant(Const::Bool(on));
        let (span, ty) = (a.span, Type::Bool);
        if on {
            self.branch(first, &ty, span, env, |_, _| known, |l, env| l.expr(b, env))
        } else {
            self.branch(first, &ty, span, env, |l, env| l.expr(b, env), |_, _| known)
        }
    }

    /// `if`, of which only one side is made when the condition is known.
    pub(super) fn branch(
        &mut self,
        cond: Atom,
        ty: &Type,
        span: Span,
        env: &mut Env<'m>,
        yes: impl FnOnce(&mut Self, &mut Env<'m>) -> Value<'m>,
        no: impl FnOnce(&mut Self, &mut Env<'m>) -> Value<'m>,
    ) -> Value<'m> {
        if let Atom::Const(Const::Bool(known)) = cond {
            return if known { yes(self, env) } else { no(self, env) };
        }
        // Names of one side mean nothing on the other: every local has an id of its own.
        let yes = self.block(|l| yes(l, env));
        let no = self.block(|l| no(l, env));
        self.meet(cond, ty, span, yes, no)
    }

    fn index(&mut self, expr: &'m Expr, base: &'m Expr, index: &'m Expr, env: &mut Env<'m>) -> Value<'m> {
        let ty = env.ty(&expr.ty);
        let base = self.expr(base, env);
        let at = self.expr(index, env).atom();
        let at = match self.scalar_of(at) {
            // Clamp as unsigned first: an index of 2^31 and more means the last element.
            Scalar::U32 => {
                let last = Atom::Const(Const::U32(base.items().len() as u32 - 1));
                let low = self.prim(Prim::Min, Scalar::U32, smallvec![at, last]);
                self.prim(Prim::ToI32, Scalar::U32, smallvec![low])
            }
            _ => at,
        };
        let items = base.items().to_vec();
        if let Atom::Const(Const::I32(i)) = at {
            return items[i.clamp(0, items.len() as i32 - 1) as usize].clone();
        }
        let mut like = items[0].clone();
        for item in &items[1..] {
            like = self.join_any(&like, item, &ty, expr.span);
        }
        let rows: Vec<Vec<Atom>> = items.iter().map(|item| self.words_like(item, &like, &ty)).collect();
        let mut words = Vec::new();
        for column in 0..rows[0].len() {
            let mut operands = vec![at];
            operands.extend(rows.iter().map(|row| row[column]));
            let scalar = self.scalar_of(rows[0][column]);
            words.push(self.prim(Prim::Index, scalar, operands.into()));
        }
        self.rebuild(&like, &ty, &mut words.into_iter())
    }
}

pub(super) fn constant(literal: Literal) -> Const {
    match literal {
        Literal::Bool(b) => Const::Bool(b),
        Literal::I32(i) => Const::I32(i),
        Literal::U32(u) => Const::U32(u),
        Literal::F32(x) => Const::f32(x as f32),
    }
}

/// The scalar operation of an operator, and whether its operands swap places.
fn primitive(op: BinaryOp) -> (Prim, bool) {
    match op {
        BinaryOp::Add => (Prim::Add, false),
        BinaryOp::Sub => (Prim::Sub, false),
        BinaryOp::Mul => (Prim::Mul, false),
        BinaryOp::Div => (Prim::Div, false),
        BinaryOp::Rem => (Prim::Rem, false),
        BinaryOp::BitAnd => (Prim::And, false),
        BinaryOp::BitOr => (Prim::Or, false),
        BinaryOp::BitXor => (Prim::Xor, false),
        BinaryOp::Shl => (Prim::Shl, false),
        BinaryOp::Shr => (Prim::Shr, false),
        BinaryOp::Eq => (Prim::Eq, false),
        BinaryOp::Ne => (Prim::Ne, false),
        BinaryOp::Lt => (Prim::Lt, false),
        BinaryOp::Le => (Prim::Le, false),
        BinaryOp::Gt => (Prim::Lt, true),
        BinaryOp::Ge => (Prim::Le, true),
    }
}
