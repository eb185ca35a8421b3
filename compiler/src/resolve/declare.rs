//! Gives every item of every file its id and its stated types. Bodies are left to inference.

use std::cell::RefCell;
use std::collections::{HashMap, HashSet};
use std::sync::OnceLock;

use super::load::{File, PRELUDE};
use super::scope::{Scopes, TypeName, Value};
use super::size::{MAX_WORDS, Sizes};
use super::types::{Alias, AliasState, Names, Place, texts};
use crate::analysis::notes::Notes;
use crate::ast::{self, Item, Name, TypeKind};
use crate::builtins::{Builtin, Scope as Visibility};
use crate::diagnostic::Diagnostic;
use crate::source::{SourceId, Span};
use crate::typed::{self, ConstId, EnumId, FunctionId, Module, ParamId, RasterId, StructId, Type};
use crate::{codes, library, parse};

/// Declarations with the bodies that are still to be checked, by id.
pub struct Declared<'a> {
    /// Bodies are placeholders.
    pub module: Module,
    pub names: Names<'a>,
    pub functions: Vec<(usize, &'a ast::Function)>,
    pub params: Vec<(usize, &'a ast::Param)>,
    pub diagnostics: Vec<Diagnostic>,
}

/// Declares all items; `notes` takes what an editor may ask for.
pub fn declare(files: &[File], notes: Option<Notes>) -> Declared<'_> {
    let notes = notes.map(RefCell::new);
    let names = Names { scopes: Scopes::new(files), notes, ..Names::default() };
    let mut declared = Declared {
        module: Module::default(),
        names,
        functions: Vec::new(),
        params: Vec::new(),
        diagnostics: Vec::new(),
    };
    let mut work = Work::default();
    // The prelude goes first: the user's `Option` may turn out to be the prelude's.
    for file in std::iter::once(PRELUDE).chain((0..files.len()).filter(|&f| f != PRELUDE)) {
        for item in &files[file].items {
            declared.item(file, files[file].library(), item, &mut work);
        }
    }
    let sources = files.iter().enumerate();
    declared.module.library = sources.filter(|(_, f)| f.library()).map(|(i, _)| SourceId(i as u32)).collect();
    super::clash::check(files, &declared.names.scopes, &declared.module, &mut declared.diagnostics);
    declared.data_types(&work);
    declared.signatures();
    declared.rasters(&work);
    let mut aliases = Vec::new();
    declared.names.finish_aliases(&mut aliases);
    declared.diagnostics.extend(aliases);
    declared
}

/// Items whose types are resolved once all names are known.
#[derive(Default)]
struct Work<'a> {
    structs: Vec<(usize, &'a ast::Struct)>,
    enums: Vec<(usize, &'a ast::Enum)>,
    rasters: Vec<(usize, &'a ast::Raster)>,
}

/// Body of an item that inference has not reached.
fn placeholder(span: Span) -> typed::Expr {
    let kind = typed::ExprKind::Literal(typed::Literal::Bool(false));
    typed::Expr { kind, ty: Type::Error, span }
}

impl<'a> Declared<'a> {
    fn item(&mut self, file: usize, library: bool, item: &'a Item, work: &mut Work<'a>) {
        match item {
            Item::Use(_) | Item::UseFile(_) => {}
            Item::Const(c) => {
                let id = ConstId(self.module.consts.len() as u32);
                self.value(file, &c.name, Value::Const(id));
                let (name, span) = (c.name.text.clone(), c.name.span);
                let value = placeholder(span);
                self.module.consts.push(typed::Const {
                    name,
                    ty: Type::Error,
                    locals: Vec::new(),
                    value,
                    span,
                });
                self.names.consts.push((file, c));
            }
            Item::Param(p) => {
                let id = ParamId(self.module.params.len() as u32);
                self.value(file, &p.name, Value::Param(id));
                self.module.params.push(typed::Param {
                    name: p.name.text.clone(),
                    ty: Type::Error,
                    locals: Vec::new(),
                    default: placeholder(p.name.span),
                    range: None,
                    span: p.name.span,
                });
                self.params.push((file, p));
            }
            Item::Raster(r) => {
                let id = RasterId(self.module.rasters.len() as u32);
                self.value(file, &r.name, Value::Raster(id));
                let (name, span) = (r.name.text.clone(), r.name.span);
                self.module.rasters.push(typed::Raster { name, ty: Type::Error, span });
                work.rasters.push((file, r));
            }
            Item::Struct(s) => {
                let id = StructId(self.module.structs.len() as u32);
                self.value(file, &s.name, Value::Struct(id));
                self.type_name(file, &s.name, TypeName::Struct(id));
                self.generics(&s.generics);
                self.names.structs.push(s.generics.len());
                self.module.structs.push(typed::Struct {
                    name: s.name.text.clone(),
                    generics: texts(&s.generics),
                    fields: Vec::new(),
                    span: s.name.span,
                });
                work.structs.push((file, s));
            }
            Item::Enum(e) => self.enumeration(file, library, e, work),
            Item::Alias(a) => {
                let index = self.names.aliases.borrow().len();
                self.type_name(file, &a.name, TypeName::Alias(index));
                self.generics(&a.generics);
                self.names.aliases.get_mut().push(Alias { file, written: a, state: AliasState::Waiting });
            }
            Item::Function(f) => {
                let id = FunctionId(self.module.functions.len() as u32);
                self.value(file, &f.name, Value::Function(id));
                self.generics(&f.generics);
                self.distinct(f.params.iter().map(|(name, _)| name), "parameter");
                self.module.functions.push(typed::Function {
                    name: f.name.text.clone(),
                    generics: texts(&f.generics),
                    params: Vec::new(),
                    result: Type::Error,
                    locals: Vec::new(),
                    body: placeholder(f.body.span),
                    attributes: f.attributes,
                    library,
                    span: f.name.span,
                });
                self.functions.push((file, f));
            }
        }
    }

    fn enumeration(&mut self, file: usize, library: bool, e: &'a ast::Enum, work: &mut Work<'a>) {
        if !library
            && let Some(&(_, prelude)) = work.enums.iter().find(|(f, p)| *f == PRELUDE && same_enum(p, e))
        {
            // Written out again, it is the same type, so that library functions fit.
            let Some(TypeName::Enum(id)) = self.names.scopes.type_name(PRELUDE, &prelude.name.text) else {
                return;
            };
            self.type_name(file, &e.name, TypeName::Enum(id));
            for (i, (name, _)) in e.variants.iter().enumerate() {
                self.value(file, name, Value::Variant(id, i as u32));
            }
            return;
        }
        let id = EnumId(self.module.enums.len() as u32);
        self.type_name(file, &e.name, TypeName::Enum(id));
        self.generics(&e.generics);
        for (i, (name, _)) in e.variants.iter().enumerate() {
            self.value(file, name, Value::Variant(id, i as u32));
        }
        if e.variants.is_empty() {
            self.empty(&e.name, "enum", "variant");
        }
        self.names.enums.push(e.generics.len());
        self.module.enums.push(typed::Enum {
            name: e.name.text.clone(),
            generics: texts(&e.generics),
            variants: Vec::new(),
            span: e.name.span,
        });
        work.enums.push((file, e));
    }

    fn empty(&mut self, name: &Name, item: &str, part: &str) {
        let title = format!("the {item} `{}` has no {part}s", name.text);
        self.diagnostics.push(
            Diagnostic::error(codes::EMPTY_ITEM, name.span, title)
                .help(format!("give it at least one {part}")),
        );
    }

    fn value(&mut self, file: usize, name: &Name, value: Value) {
        let earlier = self.names.scopes.0[file].add_value(&name.text, value, name.span);
        self.duplicate(name, earlier);
    }

    fn type_name(&mut self, file: usize, name: &Name, ty: TypeName) {
        let earlier = self.names.scopes.0[file].add_type(&name.text, ty, name.span);
        self.duplicate(name, earlier);
    }

    /// A name that stands for a value and a type is reported once: the reports lie close together.
    fn duplicate(&mut self, name: &Name, earlier: Option<Span>) {
        const RECENT: usize = 16;
        let Some(earlier) = earlier else { return };
        if self
            .diagnostics
            .iter()
            .rev()
            .take(RECENT)
            .any(|d| d.code == codes::DUPLICATE && d.primary.0 == name.span)
        {
            return;
        }
        self.diagnostics.push(
            Diagnostic::error(codes::DUPLICATE, name.span, format!("`{}` is defined twice", name.text))
                .label("second definition")
                .also(earlier, "first definition")
                .help("rename one of them"),
        );
    }

    fn distinct<'n>(&mut self, names: impl Iterator<Item = &'n Name>, what: &str) {
        let mut seen: HashMap<&str, Span> = HashMap::new();
        for name in names.filter(|n| n.text != "_") {
            if let Some(earlier) = seen.insert(&name.text, name.span) {
                let title = format!("two {what}s are called `{}`", name.text);
                self.diagnostics.push(
                    Diagnostic::error(codes::DUPLICATE, name.span, title)
                        .also(earlier, "first one")
                        .help("rename one of them"),
                );
            }
        }
    }

    fn generics(&mut self, names: &[Name]) {
        self.distinct(names.iter(), "type parameter");
    }

    fn ty(&mut self, file: usize, generics: &[String], written: &ast::Type) -> Type {
        self.names.ty(Place { file, generics }, written, &mut self.diagnostics)
    }

    fn data_types(&mut self, work: &Work) {
        for (i, (file, s)) in work.structs.iter().enumerate() {
            let generics = texts(&s.generics);
            let fields = s.fields.iter().map(|(name, ty)| (name.text.clone(), self.ty(*file, &generics, ty)));
            self.module.structs[i].fields = fields.collect();
            self.distinct(s.fields.iter().map(|(name, _)| name), "field");
            if s.fields.is_empty() {
                self.empty(&s.name, "struct", "field");
            }
        }
        for (i, (file, e)) in work.enums.iter().enumerate() {
            let generics = texts(&e.generics);
            let variants = e.variants.iter().map(|(name, fields)| typed::Variant {
                name: name.text.clone(),
                fields: fields.iter().map(|ty| self.ty(*file, &generics, ty)).collect(),
            });
            self.module.enums[i].variants = variants.collect();
        }
        super::cycles::check(&mut self.module, &mut self.diagnostics);
        self.data_sizes();
    }

    /// Structs and enums that are too large even with small type arguments.
    fn data_sizes(&mut self) {
        let mut sizes = Sizes::default();
        let params = |generics: &[String]| (0..generics.len() as u32).map(Type::Param).collect();
        let structs = self.module.structs.iter().enumerate();
        let structs = structs.map(|(i, s)| (Type::Struct(StructId(i as u32), params(&s.generics)), s.span));
        let enums = self.module.enums.iter().enumerate();
        let enums = enums.map(|(i, e)| (Type::Enum(EnumId(i as u32), params(&e.generics)), e.span));
        for (ty, span) in structs.chain(enums) {
            if !sizes.fits(&self.module, &ty) {
                self.diagnostics.push(too_large(span, sizes.words(&self.module, &ty)));
            }
        }
    }

    fn signatures(&mut self) {
        let mut sizes = Sizes::default();
        for i in 0..self.functions.len() {
            let (file, f) = self.functions[i];
            let generics = texts(&f.generics);
            for (p, (name, written)) in f.params.iter().enumerate() {
                let ty = self.checked(file, &generics, written, &mut sizes);
                let function = &mut self.module.functions[i];
                function.locals.push(typed::Local { name: name.text.clone(), ty });
                function.params.push(typed::LocalId(p as u32));
            }
            self.module.functions[i].result = self.checked(file, &generics, &f.result, &mut sizes);
            self.baked(i, f);
        }
        for i in 0..self.params.len() {
            let (file, p) = self.params[i];
            let ty = self.checked(file, &[], &p.ty, &mut sizes);
            if let Some((lo, hi)) = &p.range
                && !matches!(ty, Type::I32 | Type::F32 | Type::Error)
            {
                let title = "only parameters of type i32 and f32 have a range";
                self.diagnostics.push(
                    Diagnostic::error(codes::PARAM_RANGE, lo.span.to(hi.span), title).help("remove `in ..`"),
                );
            }
            self.module.params[i].ty = ty;
        }
        for i in 0..self.names.consts.len() {
            let (file, c) = self.names.consts[i];
            if let Some(written) = &c.ty {
                self.module.consts[i].ty = self.checked(file, &[], written, &mut sizes);
            }
        }
    }

    fn checked(&mut self, file: usize, generics: &[String], written: &ast::Type, sizes: &mut Sizes) -> Type {
        let ty = self.ty(file, generics, written);
        if sizes.fits(&self.module, &ty) {
            return ty;
        }
        self.diagnostics.push(too_large(written.span, sizes.words(&self.module, &ty)));
        Type::Error
    }

    fn baked(&mut self, index: usize, f: &ast::Function) {
        let function = &self.module.functions[index];
        if !function.attributes.bake {
            return;
        }
        let params: Vec<&Type> = function.param_types().collect();
        let known = params.iter().all(|t| **t != Type::Error) && function.result != Type::Error;
        let floats = floats(&self.module, &function.result, 8);
        if known
            && (params != [&Type::Vec(2)]
                || !f.generics.is_empty()
                || !(1..=4).contains(&floats.unwrap_or(0)))
        {
            let title = format!("`{}` cannot be baked", f.name.text);
            self.diagnostics.push(
                Diagnostic::error(codes::BAKED_SHAPE, f.name.span, title)
                    .label("marked `@bake`")
                    .help("a baked function is `fn(p: vec2) -> T` with T of up to 4 floats"),
            );
        }
    }

    fn rasters(&mut self, work: &Work) {
        for (i, (file, r)) in work.rasters.iter().enumerate() {
            let ty = self.ty(*file, &[], &r.ty);
            if !matches!(ty, Type::F32 | Type::Vec(_) | Type::Error) {
                self.diagnostics.push(
                    Diagnostic::error(codes::RASTER_TYPE, r.ty.span, "a raster cannot hold this type")
                        .help("a raster holds f32, vec2, vec3 or vec4"),
                );
            }
            self.module.rasters[i].ty = ty;
        }
    }
}

pub fn too_large(span: Span, words: u64) -> Diagnostic {
    let title = match words {
        u64::MAX => "a value of this type has too many stream words".to_owned(),
        n => format!("a value of this type has {n} stream words"),
    };
    Diagnostic::error(codes::TOO_LARGE, span, title)
        .help(format!("at most {MAX_WORDS} words are allowed; large data belongs into a raster"))
}

/// Number of floats in a type that consists of nothing else.
fn floats(module: &Module, ty: &Type, depth: u32) -> Option<u64> {
    let depth = depth.checked_sub(1)?;
    let sum = |types: &[Type]| {
        types.iter().try_fold(0u64, |n, t| Some(n.saturating_add(floats(module, t, depth)?)))
    };
    match ty {
        Type::F32 => Some(1),
        Type::Vec(n) => Some(u64::from(*n)),
        Type::Tuple(items) => sum(items),
        Type::Array(item, n) => Some(floats(module, item, depth)?.saturating_mul(u64::from(*n))),
        Type::Struct(id, args) => {
            let fields = &module.structs[id.0 as usize].fields;
            sum(&fields.iter().map(|(_, ty)| ty.substitute(args)).collect::<Vec<_>>())
        }
        _ => None,
    }
}

/// Whether two enums say the same, names of type parameters aside.
fn same_enum(a: &ast::Enum, b: &ast::Enum) -> bool {
    let same_type = |x: &ast::Type, y: &ast::Type| match (&x.kind, &y.kind) {
        (TypeKind::Named(x, xs), TypeKind::Named(y, ys)) if xs.is_empty() && ys.is_empty() => {
            let index = |e: &ast::Enum, name: &str| e.generics.iter().position(|g| g.text == name);
            index(a, x).is_some() && index(a, x) == index(b, y)
        }
        _ => false,
    };
    a.name.text == b.name.text
        && a.generics.len() == b.generics.len()
        && a.variants.len() == b.variants.len()
        && a.variants.iter().zip(&b.variants).all(|((an, at), (bn, bt))| {
            an.text == bn.text && at.len() == bt.len() && at.iter().zip(bt).all(|(x, y)| same_type(x, y))
        })
}

/// Names that a library module defines.
struct Exports {
    module: &'static str,
    values: HashSet<String>,
    types: HashSet<String>,
}

impl Exports {
    fn read(module: &'static str, text: &str) -> Exports {
        let mut exports = Exports { module, values: HashSet::new(), types: HashSet::new() };
        for item in parse::file(SourceId(0), text).tree {
            let (value, ty) = match &item {
                Item::Struct(s) => (Some(&s.name), Some(&s.name)),
                Item::Enum(e) => {
                    exports.values.extend(e.variants.iter().map(|(variant, _)| variant.text.clone()));
                    (Some(&e.name), Some(&e.name))
                }
                Item::Alias(a) => (None, Some(&a.name)),
                Item::Function(f) => (Some(&f.name), None),
                Item::Const(c) => (Some(&c.name), None),
                _ => (None, None),
            };
            exports.values.extend(value.map(|name| name.text.clone()));
            exports.types.extend(ty.map(|name| name.text.clone()));
        }
        exports
    }
}

/// The library module that defines a name, for suggestions.
pub fn defining_module(name: &str, types: bool) -> Option<&'static str> {
    static LIBRARY: OnceLock<Vec<Exports>> = OnceLock::new();
    let built_in = Builtin::ALL.iter().any(|b| b.name() == name && b.scope() == Visibility::Terrain);
    if built_in && !types {
        return Some("terrain");
    }
    if name.starts_with('_') {
        return None;
    }
    let library = LIBRARY.get_or_init(|| {
        let modules = library::MODULES.iter().filter(|(module, _)| *module != library::PRELUDE);
        modules.map(|(module, text)| Exports::read(module, text)).collect()
    });
    let defines = |e: &&Exports| if types { e.types.contains(name) } else { e.values.contains(name) };
    library.iter().find(defines).map(|e| e.module)
}
