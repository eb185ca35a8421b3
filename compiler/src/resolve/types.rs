//! Types as written to [`Type`]s: names looked up, aliases expanded, array lengths computed.

use std::cell::{Cell, RefCell};

use super::scope::{Scopes, TypeName, Value};
use super::size::MAX_NODES;
use crate::analysis::notes::{HERE, Here, Meaning, Notes};
use crate::ast::{self, ExprKind, Name, Operator, TypeKind};
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::foreign;
use crate::front::components::shown;
use crate::source::Span;
use crate::typed::{BinaryOp, Type};

/// Types with names of their own.
pub const PLAIN: &[(&str, Type)] = &[
    ("bool", Type::Bool),
    ("i32", Type::I32),
    ("u32", Type::U32),
    ("f32", Type::F32),
    ("vec2", Type::Vec(2)),
    ("vec3", Type::Vec(3)),
    ("vec4", Type::Vec(4)),
    ("ivec2", Type::IVec(2)),
    ("ivec3", Type::IVec(3)),
    ("mat2", Type::Mat(2)),
    ("mat3", Type::Mat(3)),
    ("mat4", Type::Mat(4)),
];

/// Constants that stand for constants, as an array length, at most this far.
const MAX_LENGTH_STEPS: u32 = 64;

/// What names of types mean, for all files.
#[derive(Default)]
pub struct Names<'a> {
    pub scopes: Scopes,
    /// Number of type parameters of each struct and enum.
    pub structs: Vec<usize>,
    pub enums: Vec<usize>,
    pub aliases: RefCell<Vec<Alias<'a>>>,
    /// Aliases that are being expanded, each in the one before.
    pub running: RefCell<Vec<usize>>,
    /// Constants as written, by id, with their files; empty where only finished types matter.
    pub consts: Vec<(usize, &'a ast::Const)>,
    /// Nodes of all types so far.
    pub written: Cell<u64>,
    /// For editors.
    pub notes: Option<RefCell<Notes>>,
}

/// Most nodes of the types of all items.
const MOST_WRITTEN: u64 = 4_000_000;

pub struct Alias<'a> {
    pub file: usize,
    pub written: &'a ast::Alias,
    pub state: AliasState,
}

#[derive(Clone)]
pub enum AliasState {
    Waiting,
    Running,
    Done(Type),
}

/// Puts arguments into a named type.
type Make = Box<dyn FnOnce(Vec<Type>) -> Type>;

/// Where a type stands: the file, and the type parameters in scope.
#[derive(Clone, Copy)]
pub struct Place<'a> {
    pub file: usize,
    pub generics: &'a [String],
}

impl Names<'_> {
    pub fn ty(&self, place: Place, written: &ast::Type, out: &mut Vec<Diagnostic>) -> Type {
        // That there is too much of it was reported.
        if self.written.get() > MOST_WRITTEN {
            return Type::Error;
        }
        let mut all = |types: &[ast::Type]| types.iter().map(|t| self.ty(place, t, out)).collect::<Vec<_>>();
        let ty = match &written.kind {
            TypeKind::Error => Type::Error,
            TypeKind::Tuple(items) => Type::Tuple(all(items)),
            TypeKind::Fn(params, result) => Type::Fn(all(params), Box::new(self.ty(place, result, out))),
            TypeKind::Array(item, n) => {
                let item = self.ty(place, item, out);
                match self.length(place.file, n, out) {
                    Some(n) => Type::Array(Box::new(item), n),
                    None => Type::Error,
                }
            }
            TypeKind::Named(name, args) => {
                let args = all(args);
                self.named(place, name, args, written.span, out)
            }
        };
        let size = nodes(&ty);
        self.written.set(self.written.get().saturating_add(size));
        if size > MAX_NODES || self.written.get() > MOST_WRITTEN {
            let title = "this type is too large";
            out.push(
                Diagnostic::error(codes::TOO_LARGE, written.span, title)
                    .help("use an array, or smaller parts"),
            );
            return Type::Error;
        }
        ty
    }

    fn named(
        &self,
        place: Place,
        name: &str,
        args: Vec<Type>,
        span: Span,
        out: &mut Vec<Diagnostic>,
    ) -> Type {
        let (expected, make): (usize, Make) = if let Some(i) = place.generics.iter().position(|g| g == name) {
            (0, Box::new(move |_| Type::Param(i as u32)))
        } else {
            let found = self.scopes.type_name(place.file, name);
            self.note(place, name, found, span);
            match found {
                Some(TypeName::Struct(id)) => {
                    (self.structs[id.0 as usize], Box::new(move |args| Type::Struct(id, args)))
                }
                Some(TypeName::Enum(id)) => {
                    (self.enums[id.0 as usize], Box::new(move |args| Type::Enum(id, args)))
                }
                Some(TypeName::Alias(i)) => {
                    let (count, ty) = self.alias(i, span, out);
                    (count, Box::new(move |args| expand(&ty, &args)))
                }
                None => match PLAIN.iter().find(|(plain, _)| *plain == name) {
                    Some((_, ty)) => (0, Box::new(move |_| ty.clone())),
                    None => {
                        out.push(self.unknown_type(place, name, span));
                        return Type::Error;
                    }
                },
            }
        };
        if args.len() != expected {
            let title = format!("`{name}` has {}, found {}", count(expected, "type parameter"), args.len());
            let help = match expected {
                0 => format!("write `{name}` alone"),
                _ => format!("write `{name}<{}>` with the types meant", vec!["T"; expected].join(", ")),
            };
            out.push(Diagnostic::error(codes::GENERIC_ARGUMENTS, span, title).help(help));
            return Type::Error;
        }
        make(args)
    }

    fn note(&self, place: Place, name: &str, found: Option<TypeName>, span: Span) {
        let Some(notes) = &self.notes else { return };
        let mut notes = notes.borrow_mut();
        if name == HERE {
            notes.here = Some(Here::Type(place.generics.to_vec()));
        }
        let Some(found) = found else { return };
        let meaning = Meaning::of_type(found, |alias| self.aliases.borrow()[alias].written.name.span);
        let start = span.start as usize;
        notes.mention(Span::new(span.source, start, start + name.len()), meaning, Type::Error);
    }

    fn unknown_type(&self, place: Place, name: &str, span: Span) -> Diagnostic {
        let known = self
            .scopes
            .type_names(place.file)
            .chain(PLAIN.iter().map(|(plain, _)| *plain))
            .chain(place.generics.iter().map(String::as_str));
        let diagnostic = Diagnostic::error(codes::UNKNOWN_TYPE, span, format!("there is no type `{name}`"));
        if let Some(place) = self.scopes.elsewhere(name) {
            return diagnostic
                .also(place, "defined here")
                .help("`use` the file that defines it: what it uses itself is not passed on");
        }
        match foreign::type_help(name)
            .or_else(|| super::similar(name, known).map(|meant| format!("did you mean `{meant}`?")))
        {
            Some(help) => diagnostic.help(help),
            None => match super::declare::defining_module(name, true) {
                Some(module) => diagnostic.help(format!("it is in module `{module}`: add `use {module};`")),
                None if name.len() == 1 => {
                    diagnostic.help(format!("a type parameter stands behind the name, as in `fn f<{name}>(x: {name}) -> {name}`"))
                }
                None => diagnostic.help("types are `bool`, numbers, vectors and matrices, and what `struct`, `enum` and `type` define"),
            },
        }
    }

    /// What a name that is an alias stands for, and how many type parameters it has.
    pub fn aliased(&self, file: usize, name: &str) -> Option<(usize, Type)> {
        match self.scopes.type_name(file, name)? {
            // What is wrong with it was reported where it is defined.
            TypeName::Alias(index) => {
                Some(self.alias(index, self.aliases.borrow()[index].written.name.span, &mut Vec::new()))
            }
            _ => None,
        }
    }

    /// Number of type parameters of an alias and what it stands for.
    fn alias(&self, index: usize, used: Span, out: &mut Vec<Diagnostic>) -> (usize, Type) {
        let (file, written, state) = {
            let all = self.aliases.borrow();
            (all[index].file, all[index].written, all[index].state.clone())
        };
        let count = written.generics.len();
        match state {
            AliasState::Done(ty) => (count, ty),
            AliasState::Running => {
                let title = format!("the type `{}` stands for itself", written.name.text);
                let all = self.aliases.borrow();
                let running = self.running.borrow();
                let first = running.iter().position(|&i| i == index).unwrap_or(0);
                out.push(
                    Diagnostic::error(codes::CYCLIC_ALIAS, written.name.span, title)
                        .label(shown(&running[first..], |i| &all[i].written.name.text))
                        .also(used, "used here")
                        .help("an alias is only another name: use a struct or enum for a type of its own"),
                );
                (count, Type::Error)
            }
            AliasState::Waiting => {
                self.aliases.borrow_mut()[index].state = AliasState::Running;
                self.running.borrow_mut().push(index);
                let generics = texts(&written.generics);
                let ty = self.ty(Place { file, generics: &generics }, &written.ty, out);
                self.running.borrow_mut().pop();
                self.aliases.borrow_mut()[index].state = AliasState::Done(ty.clone());
                (count, ty)
            }
        }
    }

    /// Expands every alias, so that errors in unused ones are found too.
    pub fn finish_aliases(&self, out: &mut Vec<Diagnostic>) {
        let n = self.aliases.borrow().len();
        for index in 0..n {
            let used = self.aliases.borrow()[index].written.name.span;
            self.alias(index, used, out);
        }
    }

    fn length(&self, file: usize, n: &ast::Expr, out: &mut Vec<Diagnostic>) -> Option<u32> {
        let mut steps = MAX_LENGTH_STEPS;
        let title = match self.constant(file, n, &mut steps) {
            Some(value @ 1..=0xffff) => return Some(value as u32),
            Some(value) => format!("an array cannot have {value} elements"),
            None => "this array length is not an integer constant".to_owned(),
        };
        if !matches!(n.kind, ExprKind::Error) {
            out.push(
                Diagnostic::error(codes::ARRAY_LENGTH, n.span, title)
                    .help("a length is a positive integer, a constant, or sums and products of these"),
            );
        }
        None
    }

    fn constant(&self, file: usize, e: &ast::Expr, steps: &mut u32) -> Option<i64> {
        *steps = steps.checked_sub(1)?;
        match &e.kind {
            ExprKind::Int(value) | ExprKind::Uint(value) => i64::try_from(*value).ok(),
            ExprKind::Name(name) => match self.scopes.value(file, name)? {
                Value::Const(id) => {
                    let (file, written) = self.consts.get(id.0 as usize)?;
                    self.constant(*file, &written.value, steps)
                }
                _ => None,
            },
            ExprKind::Binary(Operator::Plain(op), a, b) => {
                let (a, b) = (self.constant(file, a, steps)?, self.constant(file, b, steps)?);
                match op {
                    BinaryOp::Add => a.checked_add(b),
                    BinaryOp::Sub => a.checked_sub(b),
                    BinaryOp::Mul => a.checked_mul(b),
                    BinaryOp::Div => a.checked_div(b),
                    _ => None,
                }
            }
            _ => None,
        }
    }
}

/// An alias with its arguments, unless that would be enormous.
fn expand(ty: &Type, args: &[Type]) -> Type {
    if super::size::substituted_nodes(ty, args) > MAX_NODES {
        // One node more than fits, so that the caller reports it.
        return Type::Tuple(vec![Type::Error; MAX_NODES as usize]);
    }
    ty.substitute(args)
}

fn nodes(ty: &Type) -> u64 {
    super::size::substituted_nodes(ty, &[])
}

pub fn texts(names: &[Name]) -> Vec<String> {
    names.iter().map(|n| n.text.clone()).collect()
}

/// `1 field`, `2 fields`.
pub fn count(n: usize, what: &str) -> String {
    match n {
        0 => format!("no {what}s"),
        1 => format!("1 {what}"),
        n => format!("{n} {what}s"),
    }
}
