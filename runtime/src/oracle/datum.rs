//! Values while the oracle evaluates: untyped but for their kind, with functions and what they captured.

use std::rc::Rc;

use ghyll_compiler::builtins::Builtin;
use ghyll_compiler::typed::{Expr, FunctionId, LocalId, RasterId, Type};

use super::dual::Dual;
use super::moving::{self, Range};
use crate::error::RunError;

#[derive(Clone)]
pub enum Datum<'m> {
    Bool(bool),
    I32(i32),
    U32(u32),
    F32(f64),
    Vec(Floats),
    IVec(Ints),
    /// Columns.
    Mat(Rc<[Floats]>),
    /// Tuple, array or struct.
    Fields(Rc<[Datum<'m>]>),
    /// Enum value: variant and its fields.
    Variant(u32, Rc<[Datum<'m>]>),
    Function(Callable<'m>),
    /// A number, vector or matrix with its slope, while a derivative is taken.
    Dual(Rc<Dual<'m>>),
    /// Components of a number or a vector as ranges, while a piece of a ray is looked at.
    Moving(Rc<[Range]>),
}

/// Anything that can be applied.
#[derive(Clone)]
pub enum Callable<'m> {
    Function(FunctionId, Rc<[Type]>),
    Builtin(Builtin),
    Lambda(Rc<Lambda<'m>>),
    Variant(u32),
    Struct,
    Raster(RasterId),
    Derivative(Rc<Callable<'m>>),
}

pub struct Lambda<'m> {
    pub params: &'m [LocalId],
    pub body: &'m Expr,
    /// What was bound where the lambda stands.
    pub frame: Frame<'m>,
}

/// Up to four components.
pub type Floats = Components<f64>;
pub type Ints = Components<i32>;

#[derive(Clone, Copy)]
pub struct Components<T> {
    len: u8,
    items: [T; 4],
}

impl<T: Copy + Default> Components<T> {
    /// Of at most four items; more are left out.
    pub fn new(from: &[T]) -> Components<T> {
        let mut items = [T::default(); 4];
        let len = from.len().min(4);
        items[..len].copy_from_slice(&from[..len]);
        Components { len: len as u8, items }
    }

    pub fn splat(item: T, len: usize) -> Components<T> {
        Components::new(&[item; 4][..len.min(4)])
    }

    pub fn slice(&self) -> &[T] {
        &self.items[..self.len as usize]
    }

    pub fn len(&self) -> usize {
        self.len as usize
    }

    pub fn map(self, f: impl Fn(T) -> T) -> Components<T> {
        self.zip(self, |a, _| f(a))
    }

    pub fn convert<U: Copy + Default>(self, f: impl Fn(T) -> U) -> Components<U> {
        let mut result = Components { len: self.len, items: [U::default(); 4] };
        for (to, from) in result.items[..self.len()].iter_mut().zip(self.slice()) {
            *to = f(*from);
        }
        result
    }

    pub fn zip(self, other: Components<T>, f: impl Fn(T, T) -> T) -> Components<T> {
        let mut result = self;
        for (to, (a, b)) in result.items[..self.len()].iter_mut().zip(self.slice().iter().zip(other.slice()))
        {
            *to = f(*a, *b);
        }
        result
    }
}

/// The names that are bound in one activation of a function. Lambdas share it, copied when it changes.
#[derive(Clone)]
pub struct Frame<'m> {
    locals: Rc<Vec<Option<Datum<'m>>>>,
    /// What the enclosing function's type parameters stand for.
    pub types: Rc<[Type]>,
    /// The function whose text this is, for messages.
    pub function: &'m str,
}

impl<'m> Frame<'m> {
    pub fn new(locals: usize, types: Rc<[Type]>, function: &'m str) -> Frame<'m> {
        Frame { locals: Rc::new(vec![None; locals]), types, function }
    }

    pub fn bind(&mut self, id: LocalId, value: Datum<'m>) {
        let locals = Rc::make_mut(&mut self.locals);
        let at = id.0 as usize;
        if locals.len() <= at {
            locals.resize(at + 1, None);
        }
        locals[at] = Some(value);
    }

    pub fn get(&self, id: LocalId) -> Result<Datum<'m>, RunError> {
        let bound = self.locals.get(id.0 as usize).cloned().flatten();
        bound.ok_or_else(|| RunError::Internal(format!("local {} of `{}` is not bound", id.0, self.function)))
    }
}

impl<'m> Datum<'m> {
    fn kind(&self) -> &'static str {
        match self {
            Datum::Bool(_) => "bool",
            Datum::I32(_) => "i32",
            Datum::U32(_) => "u32",
            Datum::F32(_) => "f32",
            Datum::Vec(_) => "vector",
            Datum::IVec(_) => "integer vector",
            Datum::Mat(_) => "matrix",
            Datum::Fields(_) => "tuple, array or struct",
            Datum::Variant(..) => "enum value",
            Datum::Function(_) => "function",
            Datum::Dual(_) => "number with a slope",
            Datum::Moving(_) => "range of numbers",
        }
    }

    fn misfit<T>(&self, wanted: &str) -> Result<T, RunError> {
        Err(RunError::Internal(format!("a {} stands where a {wanted} is needed", self.kind())))
    }

    pub fn bool(&self) -> Result<bool, RunError> {
        match self {
            Datum::Bool(b) => Ok(*b),
            other => other.misfit("bool"),
        }
    }

    pub fn i32(&self) -> Result<i32, RunError> {
        match self {
            Datum::I32(i) => Ok(*i),
            other => other.misfit("i32"),
        }
    }

    pub fn f32(&self) -> Result<f64, RunError> {
        match self {
            Datum::F32(x) => Ok(*x),
            other => other.misfit("f32"),
        }
    }

    pub fn floats(&self) -> Result<Floats, RunError> {
        match self {
            Datum::F32(x) => Ok(Floats::new(&[*x])),
            Datum::Vec(v) => Ok(*v),
            other => other.misfit("vector"),
        }
    }

    pub fn columns(&self) -> Result<&[Floats], RunError> {
        match self {
            Datum::Mat(columns) => Ok(columns),
            other => other.misfit("matrix"),
        }
    }

    pub fn fields(&self) -> Result<&[Datum<'m>], RunError> {
        match self {
            Datum::Fields(items) | Datum::Variant(_, items) => Ok(items),
            other => other.misfit("tuple, array or struct"),
        }
    }

    pub fn function(&self) -> Result<Callable<'m>, RunError> {
        match self {
            Datum::Function(f) => Ok(f.clone()),
            other => other.misfit("function"),
        }
    }

    pub fn vec(items: &[f64]) -> Datum<'m> {
        Datum::Vec(Floats::new(items))
    }

    /// `==` of the language.
    pub fn equal(&self, other: &Datum<'m>) -> Result<bool, RunError> {
        let all = |a: &[Datum<'m>], b: &[Datum<'m>]| {
            for (a, b) in a.iter().zip(b) {
                if !a.equal(b)? {
                    return Ok::<bool, RunError>(false);
                }
            }
            Ok(a.len() == b.len())
        };
        if moving::is_moving(self) || moving::is_moving(other) {
            return moving::equal(self, other);
        }
        Ok(match (self.plain(), other.plain()) {
            (Datum::Bool(a), Datum::Bool(b)) => a == b,
            (Datum::I32(a), Datum::I32(b)) => a == b,
            (Datum::U32(a), Datum::U32(b)) => a == b,
            (Datum::F32(a), Datum::F32(b)) => a == b,
            (Datum::Vec(a), Datum::Vec(b)) => a.slice() == b.slice(),
            (Datum::IVec(a), Datum::IVec(b)) => a.slice() == b.slice(),
            (Datum::Mat(a), Datum::Mat(b)) => a.iter().zip(b.iter()).all(|(a, b)| a.slice() == b.slice()),
            (Datum::Fields(a), Datum::Fields(b)) => all(a, b)?,
            (Datum::Variant(a, x), Datum::Variant(b, y)) => a == b && all(x, y)?,
            (a, b) => return a.misfit(b.kind()),
        })
    }
}
