//! The tree: what was written, with spans. Names are not resolved, types are not known.

use crate::source::Span;
use crate::typed::{Attributes, UnaryOp};

#[derive(Clone, Debug, PartialEq)]
pub struct Name {
    pub text: String,
    pub span: Span,
}

/// One source text.
pub type File = Vec<Item>;

#[derive(Clone, Debug)]
pub enum Item {
    /// A library module.
    Use(Name),
    /// A module in a file.
    UseFile(Name),
    Const(Const),
    Param(Param),
    Raster(Raster),
    Struct(Struct),
    Enum(Enum),
    Alias(Alias),
    Function(Function),
}

#[derive(Clone, Debug)]
pub struct Const {
    pub name: Name,
    pub ty: Option<Type>,
    pub value: Expr,
}

#[derive(Clone, Debug)]
pub struct Param {
    pub name: Name,
    pub ty: Type,
    pub default: Expr,
    pub range: Option<(Expr, Expr)>,
}

#[derive(Clone, Debug)]
pub struct Raster {
    pub name: Name,
    pub ty: Type,
}

#[derive(Clone, Debug)]
pub struct Struct {
    pub name: Name,
    pub generics: Vec<Name>,
    pub fields: Vec<(Name, Type)>,
}

#[derive(Clone, Debug)]
pub struct Enum {
    pub name: Name,
    pub generics: Vec<Name>,
    pub variants: Vec<(Name, Vec<Type>)>,
}

#[derive(Clone, Debug)]
pub struct Alias {
    pub name: Name,
    pub generics: Vec<Name>,
    pub ty: Type,
}

#[derive(Clone, Debug)]
pub struct Function {
    pub attributes: Attributes,
    pub name: Name,
    pub generics: Vec<Name>,
    pub params: Vec<(Name, Type)>,
    pub result: Type,
    pub body: Expr,
}

#[derive(Clone, Debug)]
pub struct Type {
    pub kind: TypeKind,
    pub span: Span,
    /// Height of this tree, bounded as in [`Expr`].
    pub depth: u32,
}

impl Type {
    /// Stands where a diagnostic was already given.
    pub fn error(span: Span) -> Type {
        Type { kind: TypeKind::Error, span, depth: 1 }
    }
}

#[derive(Clone, Debug)]
pub enum TypeKind {
    Error,
    Named(String, Vec<Type>),
    Tuple(Vec<Type>),
    Array(Box<Type>, Box<Expr>),
    Fn(Vec<Type>, Box<Type>),
}

#[derive(Clone, Debug)]
pub struct Expr {
    pub kind: ExprKind,
    pub span: Span,
    /// Height of this tree; [`crate::parse`] keeps it bounded.
    pub depth: u32,
}

#[derive(Clone, Debug)]
pub enum ExprKind {
    /// Stands where a diagnostic was already given.
    Error,
    Bool(bool),
    Int(u64),
    Uint(u64),
    Float(f64),
    Name(String),
    Hole,
    Unary(UnaryOp, Box<Expr>),
    Binary(Operator, Box<Expr>, Box<Expr>),
    Call(Box<Expr>, Vec<Argument>),
    With(Box<Expr>, Vec<Argument>),
    /// Field, tuple component or swizzle.
    Field(Box<Expr>, Name),
    Index(Box<Expr>, Box<Expr>),
    Tuple(Vec<Expr>),
    Array(Vec<Expr>),
    Lambda(Vec<LambdaParam>, Box<Expr>),
    /// Conditions with their branches in order, then `else`.
    If(Vec<(Expr, Expr)>, Box<Expr>),
    Match(Box<Expr>, Vec<Arm>),
    Block(Vec<Let>, Box<Expr>),
    /// `lo..hi`; the parser makes it only as an argument.
    Range(Box<Expr>, Box<Expr>),
}

impl Expr {
    /// Calls `visit` with each direct part.
    pub fn for_each_part<'a>(&'a self, visit: &mut dyn FnMut(&'a Expr)) {
        use ExprKind::*;
        match &self.kind {
            Error | Bool(_) | Int(_) | Uint(_) | Float(_) | Name(_) | Hole => {}
            Unary(_, e) | Field(e, _) | Lambda(_, e) => visit(e),
            Binary(_, a, b) | Index(a, b) | Range(a, b) => {
                visit(a);
                visit(b);
            }
            Call(e, arguments) | With(e, arguments) => {
                visit(e);
                arguments.iter().for_each(|a| visit(&a.value));
            }
            Tuple(items) | Array(items) => items.iter().for_each(visit),
            If(branches, last) => {
                for (condition, value) in branches {
                    visit(condition);
                    visit(value);
                }
                visit(last);
            }
            Match(e, arms) => {
                visit(e);
                for arm in arms {
                    arm.guard.iter().for_each(&mut *visit);
                    visit(&arm.value);
                }
            }
            Block(lets, value) => {
                lets.iter().for_each(|l| visit(&l.value));
                visit(value);
            }
        }
    }
}

/// Operators between two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    Pipe,
    Or,
    And,
    Plain(crate::typed::BinaryOp),
}

impl Operator {
    /// How tightly it binds; all associate to the left.
    pub fn precedence(self) -> u8 {
        use crate::typed::BinaryOp::*;
        match self {
            Operator::Pipe => 1,
            Operator::Or => 2,
            Operator::And => 3,
            Operator::Plain(Eq | Ne | Lt | Le | Gt | Ge) => 4,
            Operator::Plain(BitOr) => 5,
            Operator::Plain(BitXor) => 6,
            Operator::Plain(BitAnd) => 7,
            Operator::Plain(Shl | Shr) => 8,
            Operator::Plain(Add | Sub) => 9,
            Operator::Plain(Mul | Div | Rem) => 10,
        }
    }

    /// Comparisons are not chained.
    pub fn is_comparison(self) -> bool {
        use crate::typed::BinaryOp::*;
        matches!(self, Operator::Plain(Eq | Ne | Lt | Le | Gt | Ge))
    }

    /// As it is written.
    pub fn symbol(self) -> &'static str {
        match self {
            Operator::Pipe => "|>",
            Operator::Or => "||",
            Operator::And => "&&",
            Operator::Plain(op) => op.symbol(),
        }
    }
}

#[derive(Clone, Debug)]
pub struct Argument {
    pub name: Option<Name>,
    pub value: Expr,
}

#[derive(Clone, Debug)]
pub struct LambdaParam {
    pub pattern: Pattern,
    pub ty: Option<Type>,
}

#[derive(Clone, Debug)]
pub struct Let {
    pub pattern: Pattern,
    pub ty: Option<Type>,
    pub value: Expr,
}

#[derive(Clone, Debug)]
pub struct Arm {
    pub pattern: Pattern,
    pub guard: Option<Expr>,
    pub value: Expr,
}

#[derive(Clone, Debug)]
pub struct Pattern {
    pub kind: PatternKind,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum PatternKind {
    Error,
    Wild,
    /// A new name, or a variant without fields.
    Name(String),
    Bool(bool),
    /// Value, negative.
    Int(u64, bool),
    Uint(u64),
    Float(f64),
    Tuple(Vec<Pattern>),
    Constructor(Name, Vec<FieldPattern>, Rest),
    Or(Vec<Pattern>),
}

#[derive(Clone, Debug)]
pub struct FieldPattern {
    pub name: Option<Name>,
    pub pattern: Pattern,
}

/// Whether `..` stands at the end of a pattern's fields.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rest {
    Absent,
    Present,
}
