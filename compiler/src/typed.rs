//! The typed tree: every name resolved, every type known, all modules merged. The oracle evaluates it
//! directly; `lower` makes core from it.
//!
//! Partial application with holes and `|>` are gone (`f(a, _)` is a block that binds `a` and a lambda).
//! `Type::Error` does not occur when the front end gave no errors.

use crate::builtins::Builtin;
use crate::source::{SourceId, Span};
pub use crate::types::{EnumId, StructId, Type};

macro_rules! ids {
    ($($(#[$doc:meta])* $name:ident)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub struct $name(pub u32);
    )*};
}

ids! {
    /// Index in [`Module::functions`].
    FunctionId
    /// Index in [`Module::consts`].
    ConstId
    /// Index in [`Module::params`].
    ParamId
    /// Index in [`Module::rasters`].
    RasterId
    /// Index in the `locals` of the enclosing function, constant or parameter.
    LocalId
}

/// A whole program: the user's items and the library items they may reach.
#[derive(Clone, Debug, Default)]
pub struct Module {
    pub structs: Vec<Struct>,
    pub enums: Vec<Enum>,
    pub consts: Vec<Const>,
    pub params: Vec<Param>,
    pub rasters: Vec<Raster>,
    pub functions: Vec<Function>,
    /// The texts that are library modules.
    pub library: Vec<SourceId>,
}

impl Module {
    /// The function that a host means by a name: of the program's own file, else of one that it uses. The names of
    /// entries mean only the program's own; library functions are not entries.
    pub fn function(&self, name: &str) -> Option<FunctionId> {
        let named = |own: bool| {
            let fits = |f: &Function| f.name == name && !f.library && (f.span.source == SourceId(0)) == own;
            self.functions.iter().position(fits)
        };
        let used = || if ["main", "pixel", "map"].contains(&name) { None } else { named(false) };
        named(true).or_else(used).map(|at| FunctionId(at as u32))
    }

    /// Whether a place is in a library module.
    pub fn is_library(&self, span: Span) -> bool {
        self.library.contains(&span.source)
    }
}

#[derive(Clone, Debug)]
pub struct Struct {
    pub name: String,
    pub generics: Vec<String>,
    pub fields: Vec<(String, Type)>,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub struct Enum {
    pub name: String,
    pub generics: Vec<String>,
    pub variants: Vec<Variant>,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub struct Variant {
    pub name: String,
    pub fields: Vec<Type>,
}

#[derive(Clone, Debug)]
pub struct Const {
    pub name: String,
    pub ty: Type,
    pub locals: Vec<Local>,
    pub value: Expr,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub struct Param {
    pub name: String,
    pub ty: Type,
    pub locals: Vec<Local>,
    pub default: Expr,
    /// `in lo..hi`: allowed values, both ends included; expressions of the parameter's type (i32 or f32).
    pub range: Option<(Expr, Expr)>,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub struct Raster {
    pub name: String,
    pub ty: Type,
    pub span: Span,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Attributes {
    pub task: bool,
    pub inline: bool,
    pub bake: bool,
}

impl Attributes {
    pub const NAMES: [&str; 3] = ["task", "inline", "bake"];

    pub fn flag(&mut self, name: &str) -> Option<&mut bool> {
        let flags = [&mut self.task, &mut self.inline, &mut self.bake];
        Self::NAMES.into_iter().zip(flags).find_map(|(own, flag)| (own == name).then_some(flag))
    }
}

#[derive(Clone, Debug)]
pub struct Function {
    pub name: String,
    pub generics: Vec<String>,
    /// Parameters are locals, in this order; their types are `locals[i].ty`.
    pub params: Vec<LocalId>,
    pub result: Type,
    pub locals: Vec<Local>,
    pub body: Expr,
    pub attributes: Attributes,
    /// From a library module, not from the user's files.
    pub library: bool,
    /// The name where it is defined.
    pub span: Span,
}

impl Function {
    /// Types of the parameters in order.
    pub fn param_types(&self) -> impl Iterator<Item = &Type> {
        self.params.iter().map(|p| &self.locals[p.0 as usize].ty)
    }
}

/// A name bound by a parameter, `let`, lambda or pattern.
#[derive(Clone, Debug)]
pub struct Local {
    pub name: String,
    pub ty: Type,
}

#[derive(Clone, Debug)]
pub struct Expr {
    pub kind: ExprKind,
    pub ty: Type,
    pub span: Span,
}

/// A literal with its final type (no abstract integers are left).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Literal {
    Bool(bool),
    I32(i32),
    U32(u32),
    /// As written; `f32` on the machines, kept wide for the oracle.
    F32(f64),
}

#[derive(Clone, Debug)]
pub enum ExprKind {
    Literal(Literal),
    Local(LocalId),
    Const(ConstId),
    Param(ParamId),
    /// A raster used as a function value `fn(vec2) -> T`.
    Raster(RasterId),
    /// A top-level function with its type arguments.
    Function(FunctionId, Vec<Type>),
    /// A built-in; which overload follows from the types of the call's arguments and of this expression.
    Builtin(Builtin),
    /// The callee is any expression of function type; most often `Function` or `Builtin`.
    Call(Box<Expr>, Vec<Expr>),
    Lambda(Vec<LocalId>, Box<Expr>),
    Unary(UnaryOp, Box<Expr>),
    Binary(BinaryOp, Box<Expr>, Box<Expr>),
    /// Short-circuit.
    And(Box<Expr>, Box<Expr>),
    Or(Box<Expr>, Box<Expr>),
    Tuple(Vec<Expr>),
    Array(Vec<Expr>),
    /// Fields in the order of the definition.
    Struct(StructId, Vec<Expr>),
    /// `base with (field: value)`.
    With(Box<Expr>, Vec<(u32, Expr)>),
    /// Variant by index, applied to all its fields.
    Variant(EnumId, u32, Vec<Expr>),
    /// A variant used as a function value `fn(fields) -> Enum`.
    VariantFunction(EnumId, u32),
    /// A struct's name used as a function value.
    StructFunction(StructId),
    /// Field of a struct or tuple.
    Field(Box<Expr>, u32),
    /// Components of a vector; one component gives a scalar.
    Swizzle(Box<Expr>, Vec<u8>),
    /// Element of an array (clamped), component of a vector or column of a matrix.
    Index(Box<Expr>, Box<Expr>),
    If(Box<Expr>, Box<Expr>, Box<Expr>),
    /// Exhaustive; the first arm that fits.
    Match(Box<Expr>, Vec<Arm>),
    Block(Vec<Let>, Box<Expr>),
    Range(RangeOp, Box<RangeForm>),
    /// `grad(f)` and `deriv(f)`.
    Derivative(Box<Expr>),
}

#[derive(Clone, Debug)]
pub struct Let {
    /// Irrefutable.
    pub pattern: Pattern,
    pub value: Expr,
}

#[derive(Clone, Debug)]
pub struct Arm {
    pub pattern: Pattern,
    pub guard: Option<Expr>,
    pub value: Expr,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RangeOp {
    Fold,
    Sum,
    Any,
    All,
}

/// `op(lo..hi, init?, f)`; `f` is any expression of type `fn(i32) -> T` or `fn(acc, i32) -> acc`.
#[derive(Clone, Debug)]
pub struct RangeForm {
    pub lo: Expr,
    pub hi: Expr,
    /// Only for `fold`.
    pub init: Option<Expr>,
    pub f: Expr,
}

#[derive(Clone, Debug)]
pub struct Pattern {
    pub kind: PatternKind,
    pub ty: Type,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum PatternKind {
    Wild,
    Bind(LocalId),
    Literal(Literal),
    Tuple(Vec<Pattern>),
    /// All fields in order; `..` fills in `Wild`.
    Struct(StructId, Vec<Pattern>),
    Variant(EnumId, u32, Vec<Pattern>),
    /// Alternatives bind the same locals.
    Or(Vec<Pattern>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum UnaryOp {
    /// `-` on i32, f32, vectors and matrices.
    Neg,
    /// `!` on bool; bit complement on i32 and u32.
    Not,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BinaryOp {
    Add,
    Sub,
    Mul,
    Div,
    Rem,
    BitAnd,
    BitOr,
    BitXor,
    Shl,
    Shr,
    /// Structural on every type without functions.
    Eq,
    Ne,
    Lt,
    Le,
    Gt,
    Ge,
}

impl BinaryOp {
    /// As it is written.
    pub fn symbol(self) -> &'static str {
        use BinaryOp::*;
        match self {
            Add => "+",
            Sub => "-",
            Mul => "*",
            Div => "/",
            Rem => "%",
            BitAnd => "&",
            BitOr => "|",
            BitXor => "^",
            Shl => "<<",
            Shr => ">>",
            Eq => "==",
            Ne => "!=",
            Lt => "<",
            Le => "<=",
            Gt => ">",
            Ge => ">=",
        }
    }
}
