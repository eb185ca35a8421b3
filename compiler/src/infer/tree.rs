//! The typed tree while types are still unknown. What depends on a type (field or swizzle, the value of a
//! literal) is decided when the tree is finished.

use super::table::Ty;
use crate::ast::Name;
use crate::builtins::Builtin;
use crate::source::Span;
use crate::typed::{
    BinaryOp, ConstId, EnumId, FunctionId, LocalId, ParamId, RangeOp, RasterId, StructId, UnaryOp,
};

#[derive(Debug)]
pub struct Node {
    pub kind: Kind,
    pub ty: Ty,
    pub span: Span,
}

#[derive(Clone, Copy, Debug)]
pub enum Number {
    Bool(bool),
    /// Without suffix: value, negative.
    Int(u64, bool),
    Uint(u64),
    Float(f64),
}

#[derive(Debug)]
pub enum Kind {
    Error,
    Number(Number),
    Local(LocalId),
    Const(ConstId),
    Param(ParamId),
    Raster(RasterId),
    Function(FunctionId, Vec<Ty>),
    Builtin(Builtin),
    Call(Box<Node>, Vec<Node>),
    Lambda(Vec<LocalId>, Box<Node>),
    Unary(UnaryOp, Box<Node>),
    Binary(BinaryOp, Box<Node>, Box<Node>),
    And(Box<Node>, Box<Node>),
    Or(Box<Node>, Box<Node>),
    Tuple(Vec<Node>),
    Array(Vec<Node>),
    Struct(StructId, Vec<Node>),
    With(Box<Node>, Vec<(Name, Node)>),
    Variant(EnumId, u32, Vec<Node>),
    VariantFunction(EnumId, u32),
    StructFunction(StructId),
    /// Field, tuple component or swizzle.
    Field(Box<Node>, Name),
    Index(Box<Node>, Box<Node>),
    /// Conditions with their values in order, then `else`.
    If(Vec<(Node, Node)>, Box<Node>),
    Match(Box<Node>, Vec<Arm>),
    Block(Vec<(Pattern, Node)>, Box<Node>),
    Range(RangeOp, Box<RangeForm>),
    Derivative(Box<Node>),
}

#[derive(Debug)]
pub struct Arm {
    pub pattern: Pattern,
    pub guard: Option<Node>,
    pub value: Node,
}

#[derive(Debug)]
pub struct RangeForm {
    pub lo: Node,
    pub hi: Node,
    pub init: Option<Node>,
    pub f: Node,
}

#[derive(Debug)]
pub struct Pattern {
    pub kind: PatternKind,
    pub ty: Ty,
    pub span: Span,
}

#[derive(Debug)]
pub enum PatternKind {
    Wild,
    Bind(LocalId),
    Number(Number),
    Tuple(Vec<Pattern>),
    Struct(StructId, Vec<Pattern>),
    Variant(EnumId, u32, Vec<Pattern>),
    Or(Vec<Pattern>),
}
