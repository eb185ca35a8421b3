//! What is known of a value without its machine words.

use crate::builtins::Builtin;
use crate::source::Span;
use crate::typed::{Expr, FunctionId, Type};
use std::rc::Rc;

/// What specialisation keys on: the statically known part of an argument.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Shape {
    /// Machine words only.
    Words,
    Group(Vec<Shape>),
    Variant(u32, Vec<Shape>),
    Function(FunctionId, Vec<Type>),
    Builtin(Builtin),
    Raster(u32),
    VariantFunction(u32),
    StructFunction,
    /// Shapes of the captured values.
    Lambda(Identity, Rc<Vec<Type>>, Vec<Shape>),
    Derivative(Box<Shape>),
    Choice(Vec<Shape>),
    Never,
}

/// Tells lambdas apart: where the body stands (a stable order) and its address (two texts may have equal places).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Identity {
    place: (u32, u32, u32),
    address: usize,
}

impl Identity {
    pub fn new(body: &Expr) -> Identity {
        let Span { source, start, end } = body.span;
        Identity { place: (source.0, start, end), address: std::ptr::from_ref(body) as usize }
    }
}

/// Function values nested in captures deeper than this, or of more parts, grow without bound.
const DEPTH_LIMIT: usize = 48;
const SIZE_LIMIT: usize = 10_000;

impl Shape {
    fn children(&self) -> &[Shape] {
        match self {
            Shape::Group(parts)
            | Shape::Variant(_, parts)
            | Shape::Lambda(_, _, parts)
            | Shape::Choice(parts) => parts,
            Shape::Derivative(f) => std::slice::from_ref(f),
            _ => &[],
        }
    }

    /// How deep function values are nested in captures and derivatives of function values.
    fn depth(&self) -> usize {
        let below = self.children().iter().map(Shape::depth).max().unwrap_or(0);
        below + usize::from(matches!(self, Shape::Lambda(..) | Shape::Derivative(_)))
    }

    pub fn size(&self) -> usize {
        1 + self.children().iter().map(Shape::size).sum::<usize>()
    }

    /// No program needs such a shape unless a function value captures itself over and over.
    pub fn is_endless(&self) -> bool {
        self.depth() > DEPTH_LIMIT || self.size() > SIZE_LIMIT
    }

    pub fn has_never(&self) -> bool {
        matches!(self, Shape::Never) || self.children().iter().any(Shape::has_never)
    }

    /// A lambda that captures a value made by itself.
    pub fn captures_itself(&self) -> Option<Identity> {
        fn search(shape: &Shape, path: &mut Vec<Identity>) -> Option<Identity> {
            let Shape::Lambda(identity, ..) = shape else {
                return shape.children().iter().find_map(|c| search(c, path));
            };
            if path.contains(identity) {
                return Some(*identity);
            }
            path.push(*identity);
            let found = shape.children().iter().find_map(|c| search(c, path));
            path.pop();
            found
        }
        search(self, &mut Vec::new())
    }
}

impl Identity {
    pub fn span(&self) -> Span {
        let (source, start, end) = self.place;
        Span { source: crate::source::SourceId(source), start, end }
    }
}
