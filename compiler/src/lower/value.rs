//! Values while lowering: what is known now (functions, variants) and what the machine will know (atoms).

use super::shape::Identity;
use crate::builtins::Builtin;
use crate::core::{Atom, Const};
use crate::typed::{Expr, FunctionId, LocalId, RasterId, Type};
use std::rc::Rc;

#[derive(Clone, Debug)]
pub enum Value<'m> {
    Atom(Atom),
    /// Vector, matrix, tuple, struct or array. Shared, because every mention of a name takes one.
    Group(Rc<[Value<'m>]>),
    /// An enum whose variant only the machine knows: tag and payload words.
    Enum(Atom, Vec<Atom>),
    /// An enum whose variant is known now.
    Variant(u32, Vec<Value<'m>>),
    Function(Rc<Closure<'m>>),
    /// One of several functions, or of several variants that hold functions, which only the machine knows: the
    /// candidates (two or more, words typed zeros, see `choice.rs`), tag and payload words.
    Choice(Rc<Vec<Value<'m>>>, Atom, Vec<Atom>),
    /// What a call yields of which no way to an end is known so far.
    Never,
}

/// A function value known at compile time.
#[derive(Clone, Debug)]
pub enum Closure<'m> {
    Function(FunctionId, Vec<Type>),
    Builtin(Builtin),
    Raster(RasterId),
    Variant(u32),
    Struct,
    Lambda(Lambda<'m>),
    /// The derivative of a function value.
    Derivative(Value<'m>),
}

#[derive(Clone, Debug)]
pub struct Lambda<'m> {
    pub params: &'m [LocalId],
    pub body: &'m Expr,
    pub captures: Vec<Capture<'m>>,
    /// Of the captures: [`weight_of`].
    pub weight: usize,
    /// Type arguments of the function that it stands in.
    pub types: Rc<Vec<Type>>,
}

#[derive(Clone, Debug)]
pub struct Capture<'m> {
    pub local: LocalId,
    pub ty: Type,
    pub value: Value<'m>,
}

/// Parts of a function value beyond which none is made: values share parts, so that each may hold the last one twice.
pub const MOST_WEIGHT: usize = 1_000_000;

/// Parts of captured values, shared ones counted each time.
pub fn weight_of(captures: &[Capture]) -> usize {
    captures.iter().fold(1, |n, capture| n.saturating_add(capture.value.weight()))
}

impl<'m> Closure<'m> {
    pub fn lambda(&self) -> Option<&Lambda<'m>> {
        match self {
            Closure::Lambda(lambda) => Some(lambda),
            _ => None,
        }
    }
}

impl<'m> Lambda<'m> {
    pub fn identity(&self) -> Identity {
        Identity::new(self.body)
    }

    /// The same lambda with other captured values.
    pub fn with(&self, values: impl Iterator<Item = Value<'m>>) -> Value<'m> {
        let captures = self.captures.iter().zip(values);
        let capture = |(c, value): (&Capture<'m>, _)| Capture { local: c.local, ty: c.ty.clone(), value };
        let captures: Vec<Capture> = captures.map(capture).collect();
        let weight = weight_of(&captures);
        Value::function(Closure::Lambda(Lambda { captures, weight, types: self.types.clone(), ..*self }))
    }
}

impl<'m> Value<'m> {
    pub fn constant(value: Const) -> Value<'m> {
        Value::Atom(Atom::Const(value))
    }

    pub fn function(closure: Closure<'m>) -> Value<'m> {
        Value::Function(Rc::new(closure))
    }

    fn weight(&self) -> usize {
        let sum = |parts: &[Value]| parts.iter().fold(1usize, |n, part| n.saturating_add(part.weight()));
        match self {
            Value::Group(parts) => sum(parts),
            Value::Variant(_, parts) => sum(parts),
            Value::Function(closure) => match &**closure {
                Closure::Lambda(lambda) => lambda.weight,
                Closure::Derivative(f) => f.weight().saturating_add(1),
                _ => 1,
            },
            Value::Choice(candidates, _, payload) => sum(candidates).saturating_add(payload.len()),
            Value::Enum(_, payload) => 1 + payload.len(),
            Value::Atom(_) | Value::Never => 1,
        }
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
