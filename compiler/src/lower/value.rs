//! Values while lowering: what is known now (functions, variants) and what the machine will know (atoms).

use super::Lower;
use crate::builtins::Builtin;
use crate::core::{Atom, Const, Prim, Scalar};
use crate::layout;
use crate::typed::{EnumId, Expr, FunctionId, LocalId, RasterId, Type};
use std::collections::BTreeMap;
use std::rc::Rc;

#[derive(Clone, Debug)]
pub enum Value<'m> {
    Atom(Atom),
    /// Vector, matrix, tuple, struct or array.
    Group(Vec<Value<'m>>),
    /// An enum whose variant only the machine knows: tag and payload words.
    Enum(Atom, Vec<Atom>),
    /// An enum whose variant is known now.
    Variant(u32, Vec<Value<'m>>),
    Function(Rc<Closure<'m>>),
}

/// A function value known at compile time.
#[derive(Clone, Debug)]
pub enum Closure<'m> {
    Function(FunctionId, Vec<Type>),
    Builtin(Builtin),
    Raster(RasterId),
    Variant(u32),
    Struct,
    Lambda { params: &'m [LocalId], body: &'m Expr, captures: Captures<'m>, types: Rc<Vec<Type>> },
}

pub type Captures<'m> = BTreeMap<LocalId, Value<'m>>;

/// What specialisation keys on: the statically known part of an argument.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Shape {
    /// Machine words only.
    Words,
    Group(Vec<Shape>),
    Variant(u32, Vec<Shape>),
    Function(FunctionId, Vec<String>),
    Builtin(Builtin),
    Raster(u32),
    VariantFunction(u32),
    StructFunction,
    /// Address of the body tells lambdas apart.
    Lambda(usize, Vec<String>, Vec<(LocalId, Shape)>),
}

impl Shape {
    /// How deep function values are nested in captures of function values.
    pub fn depth(&self) -> usize {
        match self {
            Shape::Group(items) | Shape::Variant(_, items) => {
                items.iter().map(Shape::depth).max().unwrap_or(0)
            }
            Shape::Lambda(_, _, captures) => 1 + captures.iter().map(|(_, s)| s.depth()).max().unwrap_or(0),
            _ => 0,
        }
    }
}

impl<'m> Value<'m> {
    pub fn constant(value: Const) -> Value<'m> {
        Value::Atom(Atom::Const(value))
    }

    pub fn atom(&self) -> Atom {
        match self {
            Value::Atom(atom) => *atom,
            other => unreachable!("a scalar's value is one atom, not {other:?}"),
        }
    }

    pub fn items(&self) -> &[Value<'m>] {
        match self {
            Value::Group(items) => items,
            other => unreachable!("a product's value is a group, not {other:?}"),
        }
    }

    /// Components of a vector; a scalar counts as one.
    pub fn components(&self) -> Vec<Atom> {
        match self {
            Value::Atom(atom) => vec![*atom],
            Value::Group(items) => items.iter().flat_map(Value::components).collect(),
            other => unreachable!("a vector has atoms, not {other:?}"),
        }
    }

    pub fn vector(atoms: Vec<Atom>) -> Value<'m> {
        Value::Group(atoms.into_iter().map(Value::Atom).collect())
    }
}

/// Type arguments as a hashable key.
pub fn type_key(types: &[Type]) -> Vec<String> {
    types.iter().map(|t| format!("{t:?}")).collect()
}

impl<'m> Lower<'m> {
    /// Splits a value into its static shape and the machine words it carries.
    pub fn dissect(&mut self, value: &Value<'m>, ty: &Type, words: &mut Vec<Atom>) -> Shape {
        if layout::scalars(self.module, ty).is_some() {
            self.flatten(value, ty, words);
            return Shape::Words;
        }
        match (value, ty) {
            (Value::Group(items), _) => {
                let types = layout::items(self.module, ty).expect("a group has a product type");
                Shape::Group(items.iter().zip(&types).map(|(v, t)| self.dissect(v, t, words)).collect())
            }
            (Value::Variant(tag, fields), Type::Enum(id, args)) => {
                let types = layout::variants(self.module, *id, args).swap_remove(*tag as usize);
                let shapes = fields.iter().zip(&types).map(|(v, t)| self.dissect(v, t, words)).collect();
                Shape::Variant(*tag, shapes)
            }
            (Value::Function(closure), _) => self.dissect_closure(closure, words),
            _ => Shape::Words,
        }
    }

    fn dissect_closure(&mut self, closure: &Closure<'m>, words: &mut Vec<Atom>) -> Shape {
        match closure {
            Closure::Function(id, types) => Shape::Function(*id, type_key(types)),
            Closure::Builtin(builtin) => Shape::Builtin(*builtin),
            Closure::Raster(id) => Shape::Raster(id.0),
            Closure::Variant(tag) => Shape::VariantFunction(*tag),
            Closure::Struct => Shape::StructFunction,
            Closure::Lambda { body, captures, types, .. } => {
                let shapes = captures.iter().map(|(id, v)| (*id, self.dissect_any(v, words))).collect();
                Shape::Lambda(std::ptr::from_ref::<Expr>(body) as usize, type_key(types), shapes)
            }
        }
    }

    /// As `dissect`, for captures: their structure is in the value, no type is needed.
    fn dissect_any(&mut self, value: &Value<'m>, words: &mut Vec<Atom>) -> Shape {
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
            Value::Group(items) => Shape::Group(items.iter().map(|v| self.dissect_any(v, words)).collect()),
            Value::Variant(tag, fields) => {
                Shape::Variant(*tag, fields.iter().map(|v| self.dissect_any(v, words)).collect())
            }
            Value::Function(closure) => self.dissect_closure(closure, words),
        }
    }

    /// The value of `dissect`'s shape again, its words taken from `words`.
    pub fn rebuild(&self, like: &Value<'m>, ty: &Type, words: &mut impl Iterator<Item = Atom>) -> Value<'m> {
        if layout::scalars(self.module, ty).is_some() {
            return self.unflatten(ty, words);
        }
        match (like, ty) {
            (Value::Group(items), _) => {
                let types = layout::items(self.module, ty).expect("a group has a product type");
                Value::Group(items.iter().zip(&types).map(|(v, t)| self.rebuild(v, t, words)).collect())
            }
            (Value::Variant(tag, fields), Type::Enum(id, args)) => {
                let types = layout::variants(self.module, *id, args).swap_remove(*tag as usize);
                let fields = fields.iter().zip(&types).map(|(v, t)| self.rebuild(v, t, words)).collect();
                Value::Variant(*tag, fields)
            }
            (like, _) => Self::rebuild_any(like, words),
        }
    }

    fn rebuild_any(like: &Value<'m>, words: &mut impl Iterator<Item = Atom>) -> Value<'m> {
        let mut next = || words.next().expect("as many words as were dissected");
        match like {
            Value::Atom(_) => Value::Atom(next()),
            Value::Enum(_, payload) => {
                let tag = next();
                Value::Enum(tag, payload.iter().map(|_| next()).collect())
            }
            Value::Group(items) => Value::Group(items.iter().map(|v| Self::rebuild_any(v, words)).collect()),
            Value::Variant(tag, fields) => {
                Value::Variant(*tag, fields.iter().map(|v| Self::rebuild_any(v, words)).collect())
            }
            Value::Function(closure) => match &**closure {
                Closure::Lambda { params, body, captures, types } => {
                    let captures =
                        captures.iter().map(|(id, v)| (*id, Self::rebuild_any(v, words))).collect();
                    Value::Function(Rc::new(Closure::Lambda { params, body, captures, types: types.clone() }))
                }
                _ => like.clone(),
            },
        }
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
                let types = layout::items(self.module, ty).expect("a group has a product type");
                for (item, ty) in items.iter().zip(&types) {
                    self.flatten(item, ty, words);
                }
            }
            Value::Variant(tag, fields) => {
                let Type::Enum(id, args) = ty else { unreachable!("a variant has an enum type") };
                let (tag_atom, payload) = self.pack(*id, args, *tag, fields);
                words.push(tag_atom);
                words.extend(payload);
            }
            Value::Function(_) => unreachable!("first-order values hold no functions"),
        }
    }

    /// Tag and payload words of a variant.
    fn pack(&mut self, id: EnumId, args: &[Type], tag: u32, fields: &[Value<'m>]) -> (Atom, Vec<Atom>) {
        let variants = layout::variants(self.module, id, args);
        let target = layout::payload(self.module, &variants).expect("first-order payload");
        let mut own = Vec::new();
        for (field, ty) in fields.iter().zip(&variants[tag as usize]) {
            self.flatten(field, ty, &mut own);
        }
        let mut payload = Vec::with_capacity(target.len());
        for (at, scalar) in target.iter().enumerate() {
            payload.push(match own.get(at) {
                Some(atom) => self.as_word(*atom, *scalar),
                None => Atom::Const(Const::from_word(*scalar, 0)),
            });
        }
        (Atom::Const(Const::I32(tag as i32)), payload)
    }

    /// A first-order value from its words.
    pub fn unflatten(&self, ty: &Type, words: &mut impl Iterator<Item = Atom>) -> Value<'m> {
        let mut next = || words.next().expect("as many words as the type has");
        if let Some(items) = layout::items(self.module, ty) {
            return Value::Group(items.iter().map(|t| self.unflatten(t, words)).collect());
        }
        if let Type::Enum(id, args) = ty {
            let payload = layout::payload(self.module, &layout::variants(self.module, *id, args));
            let tag = next();
            let payload = payload.expect("first-order payload").iter().map(|_| next()).collect();
            return Value::Enum(tag, payload);
        }
        Value::Atom(next())
    }

    /// Fields of variant `tag` of an enum that only the machine knows.
    pub fn unpack(&mut self, id: EnumId, args: &[Type], tag: u32, payload: &[Atom]) -> Vec<Value<'m>> {
        let types = layout::variants(self.module, id, args).swap_remove(tag as usize);
        let scalars: Vec<Scalar> = types
            .iter()
            .flat_map(|t| layout::scalars(self.module, t).expect("first-order payload"))
            .collect();
        let words: Vec<Atom> = payload.iter().zip(&scalars).map(|(a, s)| self.as_word(*a, *s)).collect();
        let mut words = words.into_iter();
        types.iter().map(|t| self.unflatten(t, &mut words)).collect()
    }

    /// The same bits as another scalar.
    pub fn as_word(&mut self, atom: Atom, target: Scalar) -> Atom {
        let from = self.scalar_of(atom);
        match (from, target) {
            (from, to) if from == to => atom,
            (Scalar::Bool, _) => self.prim(Prim::ToU32, Scalar::Bool, vec![atom]),
            (from, Scalar::Bool) => self.prim(Prim::ToBool, from, vec![atom]),
            (from, Scalar::I32) => self.prim(Prim::BitcastI32, from, vec![atom]),
            (from, Scalar::U32) => self.prim(Prim::BitcastU32, from, vec![atom]),
            (from, Scalar::F32) => self.prim(Prim::BitcastF32, from, vec![atom]),
        }
    }
}
