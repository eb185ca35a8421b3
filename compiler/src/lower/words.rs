//! Values to and from machine words. What is static in a value stays out of its words and is its shape.

use super::Lower;
use super::shape::Shape;
use super::value::{Closure, Value};
use crate::core::{Atom, Const, Prim, Scalar};
use crate::typed::Type;
use smallvec::smallvec;
use std::rc::Rc;

impl<'m> Lower<'m> {
    /// Splits a value into its static shape and the machine words it carries.
    pub fn dissect(&mut self, value: &Value<'m>, ty: &Type, words: &mut Vec<Atom>) -> Shape {
        if self.layouts.is_data(ty) {
            self.flatten(value, ty, words);
            return Shape::Words;
        }
        match (value, ty) {
            (Value::Group(items), _) => {
                let types = self.layouts.items(ty).expect("a group has a product type");
                Shape::Group(items.iter().zip(types.iter()).map(|(v, t)| self.dissect(v, t, words)).collect())
            }
            (Value::Variant(tag, fields), Type::Enum(..)) => {
                let types = self.layouts.fields(ty, *tag);
                let shapes =
                    fields.iter().zip(types.iter()).map(|(v, t)| self.dissect(v, t, words)).collect();
                Shape::Variant(*tag, shapes)
            }
            _ => dissect_any(value, words),
        }
    }

    /// The value of `dissect`'s shape again, its words taken from `words`.
    pub fn rebuild(&self, like: &Value<'m>, ty: &Type, words: &mut impl Iterator<Item = Atom>) -> Value<'m> {
        if self.layouts.is_data(ty) {
            return self.unflatten(ty, words);
        }
        match (like, ty) {
            (Value::Group(items), _) => {
                let types = self.layouts.items(ty).expect("a group has a product type");
                Value::Group(items.iter().zip(types.iter()).map(|(v, t)| self.rebuild(v, t, words)).collect())
            }
            (Value::Variant(tag, fields), Type::Enum(..)) => {
                let types = self.layouts.fields(ty, *tag);
                let fields =
                    fields.iter().zip(types.iter()).map(|(v, t)| self.rebuild(v, t, words)).collect();
                Value::Variant(*tag, fields)
            }
            (like, _) => rebuild_any(like, words),
        }
    }

    /// The value with typed zeros for its words. It may come from a block that has ended: what packing it takes is
    /// thrown away.
    pub fn outline(&mut self, value: &Value<'m>, ty: &Type) -> Value<'m> {
        let mut words = Vec::new();
        self.reopen(Vec::new(), |l| l.dissect(value, ty, &mut words));
        let mut zeros = words.into_iter().map(|a| zero(self.scalar_of(a))).collect::<Vec<_>>().into_iter();
        self.rebuild(value, ty, &mut zeros)
    }

    /// As `outline`, for captures.
    pub fn outline_any(&self, value: &Value<'m>) -> Value<'m> {
        let mut words = Vec::new();
        words_of(value, &mut words);
        rebuild_any(value, &mut words.into_iter().map(|a| zero(self.scalar_of(a))))
    }

    /// A first-order value of type `ty` with typed zeros for its words.
    pub fn zeros(&self, ty: &Type) -> Option<Value<'m>> {
        let scalars = self.layouts.scalars(ty)?;
        Some(self.unflatten(ty, &mut scalars.into_iter().map(zero)))
    }

    /// Appends the words of a first-order value (`layout.rs`).
    pub fn flatten(&mut self, value: &Value<'m>, ty: &Type, words: &mut Vec<Atom>) {
        match value {
            Value::Atom(atom) => words.push(*atom),
            Value::Enum(tag, payload) => {
                words.push(*tag);
                words.extend(payload);
            }
            Value::Group(items) => {
                let types = self.layouts.items(ty).expect("a group has a product type");
                for (item, ty) in items.iter().zip(types.iter()) {
                    self.flatten(item, ty, words);
                }
            }
            Value::Variant(tag, fields) => {
                let (tag_atom, payload) = self.pack(ty, *tag, fields);
                words.push(tag_atom);
                words.extend(payload);
            }
            Value::Function(_) | Value::Choice(..) | Value::Never => {
                unreachable!("first-order values hold no functions")
            }
        }
    }

    /// Tag and payload words of a variant.
    fn pack(&mut self, ty: &Type, tag: u32, fields: &[Value<'m>]) -> (Atom, Vec<Atom>) {
        let target = self.layouts.payload(ty).expect("first-order payload");
        let mut own = Vec::new();
        for (field, ty) in fields.iter().zip(self.layouts.fields(ty, tag).iter()) {
            self.flatten(field, ty, &mut own);
        }
        let mut payload = Vec::with_capacity(target.len());
        for (at, scalar) in target.iter().enumerate() {
            payload.push(match own.get(at) {
                Some(atom) => self.as_word(*atom, *scalar),
                None => zero(*scalar),
            });
        }
        (Atom::Const(Const::I32(tag as i32)), payload)
    }

    /// A first-order value from its words.
    pub fn unflatten(&self, ty: &Type, words: &mut impl Iterator<Item = Atom>) -> Value<'m> {
        let mut next = || words.next().expect("as many words as the type has");
        if let Some(items) = self.layouts.items(ty) {
            return Value::Group(items.iter().map(|t| self.unflatten(t, words)).collect());
        }
        if let Type::Enum(..) = ty {
            let payload = self.layouts.payload(ty).expect("first-order payload");
            let tag = next();
            let payload = payload.iter().map(|_| next()).collect();
            return Value::Enum(tag, payload);
        }
        Value::Atom(next())
    }

    /// Fields of variant `tag` of an enum that only the machine knows.
    pub fn unpack(&mut self, ty: &Type, tag: u32, payload: &[Atom]) -> Vec<Value<'m>> {
        let types = self.layouts.fields(ty, tag);
        let scalars = types.iter().flat_map(|t| self.layouts.scalars(t).expect("first-order payload"));
        let scalars: Vec<Scalar> = scalars.collect();
        let words: Vec<Atom> = payload.iter().zip(&scalars).map(|(a, s)| self.as_word(*a, *s)).collect();
        let mut words = words.into_iter();
        types.iter().map(|t| self.unflatten(t, &mut words)).collect()
    }

    /// The same bits as another scalar.
    pub fn as_word(&mut self, atom: Atom, target: Scalar) -> Atom {
        let from = self.scalar_of(atom);
        match (from, target) {
            (from, to) if from == to => atom,
            (Scalar::Bool, _) => self.prim(Prim::ToU32, Scalar::Bool, smallvec![atom]),
            (from, Scalar::Bool) => self.prim(Prim::ToBool, from, smallvec![atom]),
            (from, Scalar::I32) => self.prim(Prim::BitcastI32, from, smallvec![atom]),
            (from, Scalar::U32) => self.prim(Prim::BitcastU32, from, smallvec![atom]),
            (from, Scalar::F32) => self.prim(Prim::BitcastF32, from, smallvec![atom]),
        }
    }
}

pub fn zero(scalar: Scalar) -> Atom {
    Atom::Const(Const::from_word(scalar, 0))
}

/// As `Lower::dissect`, for captures and candidates: their structure is in the value, no type is needed.
pub fn dissect_any(value: &Value, words: &mut Vec<Atom>) -> Shape {
    match value {
        Value::Atom(atom) => {
            words.push(*atom);
            Shape::Words
        }
        Value::Enum(tag, payload) => {
            words.push(*tag);
            words.extend(payload);
            Shape::Words
        }
        Value::Group(items) => Shape::Group(items.iter().map(|v| dissect_any(v, words)).collect()),
        Value::Variant(tag, fields) => {
            Shape::Variant(*tag, fields.iter().map(|v| dissect_any(v, words)).collect())
        }
        Value::Function(closure) => dissect_closure(closure, words),
        Value::Choice(candidates, tag, payload) => {
            words.push(*tag);
            words.extend(payload);
            Shape::Choice(candidates.iter().map(shape).collect())
        }
        Value::Never => Shape::Never,
    }
}

/// The machine words of a value, as [`dissect_any`] finds them.
pub fn words_of(value: &Value, words: &mut Vec<Atom>) {
    match value {
        Value::Atom(atom) => words.push(*atom),
        Value::Enum(tag, payload) | Value::Choice(_, tag, payload) => {
            words.push(*tag);
            words.extend(payload);
        }
        Value::Group(items) => items.iter().for_each(|v| words_of(v, words)),
        Value::Variant(_, fields) => fields.iter().for_each(|v| words_of(v, words)),
        Value::Function(closure) => match &**closure {
            Closure::Lambda(lambda) => lambda.captures.iter().for_each(|c| words_of(&c.value, words)),
            Closure::Derivative(f) => words_of(f, words),
            _ => {}
        },
        Value::Never => {}
    }
}

fn dissect_closure(closure: &Closure, words: &mut Vec<Atom>) -> Shape {
    match closure {
        Closure::Function(id, types) => Shape::Function(*id, types.clone()),
        Closure::Builtin(builtin) => Shape::Builtin(*builtin),
        Closure::Raster(id) => Shape::Raster(id.0),
        Closure::Variant(tag) => Shape::VariantFunction(*tag),
        Closure::Struct => Shape::StructFunction,
        Closure::Lambda(lambda) => {
            let shapes = lambda.captures.iter().map(|c| dissect_any(&c.value, words)).collect();
            Shape::Lambda(lambda.identity(), Rc::clone(&lambda.types), shapes)
        }
        Closure::Derivative(f) => Shape::Derivative(Box::new(dissect_any(f, words))),
    }
}

/// What is static in a value.
pub fn shape(value: &Value) -> Shape {
    dissect_any(value, &mut Vec::new())
}

/// The value of `dissect_any`'s shape again.
pub fn rebuild_any<'m>(like: &Value<'m>, words: &mut impl Iterator<Item = Atom>) -> Value<'m> {
    match like {
        Value::Group(items) => Value::Group(items.iter().map(|v| rebuild_any(v, words)).collect()),
        Value::Variant(tag, fields) => {
            Value::Variant(*tag, fields.iter().map(|v| rebuild_any(v, words)).collect())
        }
        Value::Function(closure) => match &**closure {
            Closure::Lambda(lambda) => {
                lambda.with(lambda.captures.iter().map(|c| rebuild_any(&c.value, words)))
            }
            Closure::Derivative(f) => Value::function(Closure::Derivative(rebuild_any(f, words))),
            _ => like.clone(),
        },
        Value::Atom(_) => Value::Atom(next(words)),
        Value::Enum(_, payload) => {
            let tag = next(words);
            Value::Enum(tag, payload.iter().map(|_| next(words)).collect())
        }
        Value::Choice(candidates, _, payload) => {
            let tag = next(words);
            Value::Choice(Rc::clone(candidates), tag, payload.iter().map(|_| next(words)).collect())
        }
        Value::Never => Value::Never,
    }
}

fn next(words: &mut impl Iterator<Item = Atom>) -> Atom {
    words.next().expect("as many words as were dissected")
}
