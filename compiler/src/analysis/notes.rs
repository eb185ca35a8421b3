//! What names mean and what types expressions have, noted while a program is checked if an editor asks for it.

use crate::builtins::Builtin;
use crate::infer::forms;
use crate::resolve::load::USER;
use crate::resolve::scope::{TypeName, Value};
use crate::resolve::size::substituted_nodes;
use crate::resolve::types::Names;
use crate::source::{SourceId, Span};
use crate::typed::{ConstId, EnumId, FunctionId, ParamId, RasterId, StructId, Type};

/// What a name stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Meaning {
    /// What a parameter, `let`, lambda or pattern binds, by the place where it does.
    Local(Span),
    Function(FunctionId),
    Const(ConstId),
    Param(ParamId),
    Raster(RasterId),
    Struct(StructId),
    Enum(EnumId),
    Variant(EnumId, u32),
    Field(StructId, u32),
    /// By the place of its definition.
    Alias(Span),
    Builtin(Builtin),
    /// `fold`, `grad` and their like.
    Form(&'static str),
    Module(SourceId),
}

impl From<Value> for Meaning {
    fn from(value: Value) -> Meaning {
        match value {
            Value::Function(id) => Meaning::Function(id),
            Value::Const(id) => Meaning::Const(id),
            Value::Param(id) => Meaning::Param(id),
            Value::Raster(id) => Meaning::Raster(id),
            Value::Struct(id) => Meaning::Struct(id),
            Value::Variant(id, index) => Meaning::Variant(id, index),
        }
    }
}

impl Meaning {
    /// An alias is known by the place of its definition.
    pub(crate) fn of_type(name: TypeName, alias: impl Fn(usize) -> Span) -> Meaning {
        match name {
            TypeName::Struct(id) => Meaning::Struct(id),
            TypeName::Enum(id) => Meaning::Enum(id),
            TypeName::Alias(index) => Meaning::Alias(alias(index)),
        }
    }
}

/// A name in a text.
#[derive(Clone, Debug, PartialEq)]
pub struct Mention {
    pub span: Span,
    pub meaning: Meaning,
    /// The type it has there; `Type::Error` where it has none or none is known.
    pub ty: Type,
}

/// What could stand where the name [`HERE`] does.
#[derive(Clone, Debug, PartialEq)]
pub enum Here {
    /// A value; the names bound there, innermost first, and the struct that is being built.
    Value(Vec<(String, Type)>, Option<StructId>),
    /// A field of this type.
    Field(Type),
    /// A type; the type parameters in scope.
    Type(Vec<String>),
    /// A pattern for this type.
    Pattern(Type),
}

/// The name that is put where an editor asks what could stand there.
pub const HERE: &str = "__here_of_completion";

#[derive(Default)]
pub struct Notes {
    pub mentions: Vec<Mention>,
    pub types: Vec<(Span, Type)>,
    pub here: Option<Here>,
    /// Whether it is asked what could stand at [`HERE`].
    pub asked: bool,
    /// Names of values and types that the user's file can use, if that is asked.
    pub values: Vec<(String, Meaning)>,
    pub type_names: Vec<(String, Meaning)>,
    pub nodes: u64,
}

/// Most nodes of all noted types; what comes later has none.
const MOST_NODES: u64 = 8_000_000;

impl Notes {
    pub fn mention(&mut self, span: Span, meaning: Meaning, ty: Type) {
        let ty = self.counted(ty);
        self.mentions.push(Mention { span, meaning, ty });
    }

    pub fn expression(&mut self, span: Span, ty: &Type) {
        if self.nodes < MOST_NODES && *ty != Type::Error {
            let ty = self.counted(ty.clone());
            self.types.push((span, ty));
        }
    }

    /// Notes what can be named in the user's file, if somebody asks.
    pub(crate) fn visible(&mut self, names: &Names) {
        if !self.asked {
            return;
        }
        let (values, types) = names.scopes.visible_names(USER);
        let builtins = names.scopes.visible_builtins(USER).filter(|b| !values.contains_key(b.name()));
        self.values.extend(builtins.map(|b| (b.name().to_owned(), Meaning::Builtin(b))));
        let forms = forms::names().filter(|form| !values.contains_key(form));
        self.values.extend(forms.map(|form| (form.to_owned(), Meaning::Form(form))));
        self.values.extend(values.into_iter().map(|(name, value)| (name.to_owned(), value.into())));
        let alias = |index: usize| names.aliases.borrow()[index].written.name.span;
        let types = types.into_iter();
        self.type_names.extend(types.map(|(name, ty)| (name.to_owned(), Meaning::of_type(ty, alias))));
    }

    fn counted(&mut self, ty: Type) -> Type {
        self.nodes = self.nodes.saturating_add(substituted_nodes(&ty, &[]));
        if self.nodes < MOST_NODES { ty } else { Type::Error }
    }
}
