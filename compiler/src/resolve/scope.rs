//! What a name means at the top level of each file: its own items and those of the files it uses, then those of the
//! library modules it uses (the last `use` first), then the prelude's. Types and values live apart.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use super::load::{File, PRELUDE};
use crate::builtins::{Builtin, Scope as Visibility};
use crate::source::Span;
use crate::typed::{ConstId, EnumId, FunctionId, Module, ParamId, RasterId, StructId};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Value {
    Function(FunctionId),
    Const(ConstId),
    Param(ParamId),
    Raster(RasterId),
    Struct(StructId),
    Variant(EnumId, u32),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TypeName {
    Struct(StructId),
    Enum(EnumId),
    /// Index in [`super::types::Names`]' aliases.
    Alias(usize),
}

#[derive(Default)]
pub struct Scope {
    values: HashMap<String, (Value, Span)>,
    types: HashMap<String, (TypeName, Span)>,
    uses: Vec<usize>,
    library: bool,
    /// The terrain built-ins can be named.
    terrain: bool,
    /// The module that they are named by.
    terrain_at: Option<usize>,
}

impl Scope {
    /// Adds a value; the place of an earlier one of that name if there is one.
    pub fn add_value(&mut self, name: &str, value: Value, span: Span) -> Option<Span> {
        insert(&mut self.values, name, value, span)
    }

    pub fn add_type(&mut self, name: &str, ty: TypeName, span: Span) -> Option<Span> {
        insert(&mut self.types, name, ty, span)
    }

    /// Names of values and types, in order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        let all: BTreeSet<&str> = self.values.keys().chain(self.types.keys()).map(String::as_str).collect();
        all.into_iter()
    }

    /// Where a name is defined.
    pub fn place(&self, name: &str) -> Option<Span> {
        let value = self.values.get(name).map(|(_, span)| *span);
        value.or_else(|| self.types.get(name).map(|(_, span)| *span))
    }

    /// Where a name is defined, if it means something else in another scope.
    pub fn clash(&self, other: &Scope, name: &str) -> Option<Span> {
        let value = match (self.values.get(name), other.values.get(name)) {
            (Some((a, at)), Some((b, _))) if a != b => Some(*at),
            _ => None,
        };
        value.or(match (self.types.get(name), other.types.get(name)) {
            (Some((a, at)), Some((b, _))) if a != b => Some(*at),
            _ => None,
        })
    }
}

fn insert<T>(map: &mut HashMap<String, (T, Span)>, name: &str, item: T, span: Span) -> Option<Span> {
    if let Some((_, earlier)) = map.get(name) {
        return Some(*earlier);
    }
    map.insert(name.to_owned(), (item, span));
    None
}

/// Names that stay in their module: those with `_` in front, and the entries of a program of its own.
pub fn is_private(name: &str) -> bool {
    name.starts_with('_') || name == "main" || name == "pixel"
}

/// The scopes of all files, by index.
#[derive(Default)]
pub struct Scopes(pub Vec<Scope>, RefCell<Lookups>);

/// What was looked up so far, for warnings.
#[derive(Default)]
struct Lookups {
    /// A file and the one that it took a name from.
    modules: HashSet<(usize, usize)>,
    values: HashSet<Value>,
}

impl Scopes {
    pub fn new(files: &[File]) -> Scopes {
        let scope = |file: &File| Scope {
            uses: file.uses.iter().copied().chain(file.files.iter().map(|(used, _)| *used)).collect(),
            library: file.library(),
            terrain: file.library() || file.uses.iter().any(|&u| files[u].module == "terrain"),
            terrain_at: file.uses.iter().copied().find(|&u| files[u].module == "terrain"),
            ..Scope::default()
        };
        Scopes(files.iter().map(scope).collect(), RefCell::default())
    }

    /// One scope with every name of a module, the user's before the library's: for arguments of a program.
    pub fn of_module(module: &Module) -> Scopes {
        let mut scope = Scope { terrain: true, ..Scope::default() };
        for users in [true, false] {
            let wanted = |span: Span| module.is_library(span) != users;
            for (i, f) in module.functions.iter().enumerate().filter(|(_, f)| wanted(f.span)) {
                scope.add_value(&f.name, Value::Function(FunctionId(i as u32)), f.span);
            }
            for (i, c) in module.consts.iter().enumerate().filter(|(_, c)| wanted(c.span)) {
                scope.add_value(&c.name, Value::Const(ConstId(i as u32)), c.span);
            }
            for (i, r) in module.rasters.iter().enumerate().filter(|(_, r)| wanted(r.span)) {
                scope.add_value(&r.name, Value::Raster(RasterId(i as u32)), r.span);
            }
            for (i, s) in module.structs.iter().enumerate().filter(|(_, s)| wanted(s.span)) {
                let id = StructId(i as u32);
                scope.add_value(&s.name, Value::Struct(id), s.span);
                scope.add_type(&s.name, TypeName::Struct(id), s.span);
            }
            for (i, e) in module.enums.iter().enumerate().filter(|(_, e)| wanted(e.span)) {
                let id = EnumId(i as u32);
                scope.add_type(&e.name, TypeName::Enum(id), e.span);
                for (v, variant) in e.variants.iter().enumerate() {
                    scope.add_value(&variant.name, Value::Variant(id, v as u32), e.span);
                }
            }
        }
        Scopes(vec![scope], RefCell::default())
    }

    /// The scope of nothing: only built-in names have a meaning.
    pub fn empty() -> Scopes {
        Scopes(vec![Scope::default()], RefCell::default())
    }

    pub fn value(&self, file: usize, name: &str) -> Option<Value> {
        let found = |(at, s): (usize, &Scope)| s.values.get(name).map(|(value, _)| (at, *value));
        let (at, value) = self.visible(file, name).find_map(found)?;
        let mut lookups = self.1.borrow_mut();
        lookups.modules.insert((file, at));
        lookups.values.insert(value);
        Some(value)
    }

    pub fn type_name(&self, file: usize, name: &str) -> Option<TypeName> {
        let found = |(at, s): (usize, &Scope)| s.types.get(name).map(|(ty, _)| (at, *ty));
        let (at, ty) = self.visible(file, name).find_map(found)?;
        self.1.borrow_mut().modules.insert((file, at));
        Some(ty)
    }

    /// Whether a file took a name from another.
    pub fn is_used(&self, file: usize, module: usize) -> bool {
        self.1.borrow().modules.contains(&(file, module))
    }

    /// Whether any file named this.
    pub fn is_read(&self, value: Value) -> bool {
        self.1.borrow().values.contains(&value)
    }

    /// Scopes in the order in which they are asked.
    fn visible<'a>(&'a self, file: usize, name: &str) -> impl Iterator<Item = (usize, &'a Scope)> {
        let private = is_private(name);
        self.reachable(file).filter(move |(at, _)| *at == file || !private)
    }

    fn reachable(&self, file: usize) -> impl Iterator<Item = (usize, &Scope)> {
        let used = self.0[file].uses.iter().rev().chain(std::iter::once(&PRELUDE)).copied();
        std::iter::once(file).chain(used).filter_map(|at| Some((at, self.0.get(at)?)))
    }

    /// Where a file that is not in scope defines a name.
    pub fn elsewhere(&self, name: &str) -> Option<Span> {
        let others = self.0.iter().filter(|scope| !scope.library && !is_private(name));
        others.filter_map(|scope| scope.place(name)).next()
    }

    /// A built-in that the file can name.
    pub fn builtin(&self, file: usize, name: &str) -> Option<Builtin> {
        let scope = &self.0[file];
        let builtin = Builtin::ALL.iter().copied().find(|b| b.name() == name)?;
        let visible = match builtin.scope() {
            Visibility::Everywhere => true,
            Visibility::Terrain => {
                let module = scope.terrain_at;
                self.1.borrow_mut().modules.extend(module.map(|at| (file, at)));
                scope.terrain
            }
            Visibility::Library => scope.library,
        };
        visible.then_some(builtin)
    }

    /// Names of values that a file can use, for suggestions.
    pub fn value_names(&self, file: usize) -> impl Iterator<Item = &str> {
        let terrain = self.0[file].terrain;
        let builtins = Builtin::ALL.iter().filter(move |b| terrain || b.scope() == Visibility::Everywhere);
        self.reachable(file)
            .flat_map(|(_, s)| s.values.keys().map(String::as_str))
            .chain(builtins.map(|b| b.name()))
    }

    /// What a file can name without a module before it: values and types, the nearest meaning of each name.
    pub fn visible_names(&self, file: usize) -> (BTreeMap<&str, Value>, BTreeMap<&str, TypeName>) {
        let (mut values, mut types) = (BTreeMap::new(), BTreeMap::new());
        for (at, scope) in self.reachable(file) {
            let open = |name: &str| at == file || !is_private(name);
            for (name, (value, _)) in scope.values.iter().filter(|(name, _)| open(name)) {
                values.entry(name.as_str()).or_insert(*value);
            }
            for (name, (ty, _)) in scope.types.iter().filter(|(name, _)| open(name)) {
                types.entry(name.as_str()).or_insert(*ty);
            }
        }
        (values, types)
    }

    /// Built-ins that a file can name.
    pub fn visible_builtins(&self, file: usize) -> impl Iterator<Item = Builtin> {
        let scope = &self.0[file];
        let visible = |builtin: &Builtin| match builtin.scope() {
            Visibility::Everywhere => true,
            Visibility::Terrain => scope.terrain,
            Visibility::Library => scope.library,
        };
        Builtin::ALL.iter().copied().filter(visible)
    }

    pub fn type_names(&self, file: usize) -> impl Iterator<Item = &str> {
        self.reachable(file).flat_map(|(_, s)| s.types.keys().map(String::as_str))
    }
}
