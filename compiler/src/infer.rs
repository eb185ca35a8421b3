//! Types of expressions: Hindley-Milner over bodies, with stated types at the top level.
//!
//! A body is walked once, with the type its place wants pushed down and unified. What depends on a type that
//! is not known yet (operators, fields, overloads) becomes a goal, which is tried at once, again whenever
//! something was learned, and again at the end after literals took their default. Then the tree is finished:
//! see [`finish`].

mod call;
mod expr;
mod finish;
pub(crate) mod forms;
mod goals;
mod locals;
mod numeric;
mod overload;
mod pattern;
pub mod show;
pub mod table;
mod tree;

use std::cell::{Cell, RefCell};
use std::collections::{HashMap, HashSet};

use crate::analysis::notes::{HERE, Meaning};
use crate::ast;
use crate::builtins::Builtin;
use crate::codes;
use crate::diagnostic::{Diagnostic, Severity};
use crate::front::MAX_DIAGNOSTICS;
use crate::resolve::similar;
use crate::resolve::types::{self, Place};
use crate::source::Span;
use crate::typed::{self, ConstId, LocalId, Module, StructId, Type};
use goals::Goals;
use locals::Names;
use table::{Clash, Form, Origin, Table, Ty};
use tree::{Kind, Node};

/// What bodies refer to: declarations, and what was found about constants so far.
pub struct Env<'e, 'a> {
    pub module: &'e Module,
    pub names: &'e types::Names<'a>,
    /// Functions as written, by id, for labels; empty where only the module is known.
    pub functions: &'e [(usize, &'a ast::Function)],
    pub consts: RefCell<Vec<ConstState>>,
    pub fixed: RefCell<HashMap<Builtin, Type>>,
    /// Nodes of all types written out so far.
    pub written: Cell<u64>,
    /// Places of the fields of wide structs.
    fields: RefCell<HashMap<StructId, HashMap<String, usize>>>,
}

/// Fields of a struct that are found sooner by looking at each.
const FEW_FIELDS: usize = 16;

#[derive(Clone)]
pub enum ConstState {
    Waiting,
    Running,
    Done(Body),
    /// Finished elsewhere: only its type matters.
    Known(Type),
}

/// A checked expression with the locals it binds.
#[derive(Clone, Debug)]
pub struct Body {
    pub expr: typed::Expr,
    pub locals: Vec<typed::Local>,
    pub diagnostics: Vec<Diagnostic>,
}

/// A place's type, and another place that explains it.
#[derive(Clone, Copy)]
pub struct Want {
    pub ty: Ty,
    pub why: Option<(Span, &'static str)>,
}

impl Want {
    fn just(ty: Ty) -> Want {
        Want { ty, why: None }
    }
}

impl<'e, 'a> Env<'e, 'a> {
    pub fn new(
        module: &'e Module,
        names: &'e types::Names<'a>,
        functions: &'e [(usize, &'a ast::Function)],
    ) -> Env<'e, 'a> {
        let consts = names.consts.iter().map(|_| ConstState::Waiting).collect();
        Env {
            module,
            names,
            functions,
            consts: RefCell::new(consts),
            fixed: RefCell::default(),
            written: Cell::new(0),
            fields: RefCell::default(),
        }
    }

    /// For arguments of a finished module.
    pub fn finished(module: &'e Module, names: &'e types::Names<'a>) -> Env<'e, 'a> {
        let known = module.consts.iter().map(|c| ConstState::Known(c.ty.clone())).collect();
        Env { consts: RefCell::new(known), ..Env::new(module, names, &[]) }
    }

    /// The place of a struct's field.
    fn field(&self, id: StructId, name: &str) -> Option<usize> {
        let fields = &self.module.structs[id.0 as usize].fields;
        if fields.len() <= FEW_FIELDS {
            return fields.iter().position(|(field, _)| field == name);
        }
        let mut known = self.fields.borrow_mut();
        let places = known.entry(id).or_insert_with(|| {
            let places = fields.iter().enumerate().map(|(i, (field, _))| (field.clone(), i));
            places.rev().collect()
        });
        places.get(name).copied()
    }

    pub fn function(&self, index: usize) -> Body {
        let (file, written) = self.functions[index];
        let declared = &self.module.functions[index];
        let mut infer = Infer::new(self, Place { file, generics: &declared.generics });
        for ((name, _), local) in written.params.iter().zip(&declared.locals) {
            let ty = infer.table.import(&local.ty, &[]);
            infer.bind(&name.text, ty, name.span);
        }
        infer.quiet = declared.param_types().chain([&declared.result]).any(is_wrong);
        let why = Some((written.result.span, "the result type is stated here"));
        let want = Want { ty: infer.table.import(&declared.result, &[]), why };
        infer.body(&written.body, want)
    }

    /// Checks a constant; its type is stated or found.
    fn constant(&self, id: ConstId) -> Body {
        let (file, written) = self.names.consts[id.0 as usize];
        self.expression(
            file,
            &written.value,
            written.ty.as_ref().map(|t| (&self.module.consts[id.0 as usize].ty, t.span)),
        )
    }

    /// Checks an expression outside a function against a type, if there is one.
    pub fn expression(&self, file: usize, written: &ast::Expr, stated: Option<(&Type, Span)>) -> Body {
        let mut infer = Infer::new(self, Place { file, generics: &[] });
        let want = match stated {
            Some((ty, span)) => {
                let why = (span != written.span).then_some((span, "the type is stated here"));
                Want { ty: infer.table.import(ty, &[]), why }
            }
            None => Want::just(infer.table.fresh(Origin::Value(written.span))),
        };
        infer.body(written, want)
    }

    /// The type of a constant, which is checked when it is needed first.
    pub fn const_type(&self, id: ConstId, used: Span, out: &mut Vec<Diagnostic>) -> Type {
        let index = id.0 as usize;
        let is_running = match &self.consts.borrow()[index] {
            ConstState::Known(ty) => return ty.clone(),
            ConstState::Done(body) => return body.expr.ty.clone(),
            ConstState::Running => true,
            ConstState::Waiting => false,
        };
        match is_running {
            true => {
                let declared = &self.module.consts[index];
                if self.names.consts[index].1.ty.is_some() {
                    return declared.ty.clone();
                }
                let title = format!("the constant `{}` needs its own value", declared.name);
                out.push(
                    Diagnostic::error(codes::CYCLIC_CONSTANT, declared.span, title)
                        .also(used, "needed here")
                        .help("constants can refer to each other only without a cycle"),
                );
                Type::Error
            }
            false => {
                self.consts.borrow_mut()[index] = ConstState::Running;
                let body = self.constant(id);
                let ty = body.expr.ty.clone();
                self.consts.borrow_mut()[index] = ConstState::Done(body);
                ty
            }
        }
    }
}

/// Inference of one body.
struct Infer<'e, 'a> {
    env: &'e Env<'e, 'a>,
    place: Place<'e>,
    table: Table<'e>,
    locals: Vec<Local>,
    scope: Names,
    goals: Goals,
    /// Types that must not hold functions.
    comparable: Vec<(Ty, Span)>,
    out: Vec<Diagnostic>,
    /// How many of them are errors.
    errors: usize,
    /// Number of names made for holes.
    holes: usize,
    /// Warnings about names that nothing reads.
    unused: Vec<Diagnostic>,
    /// A stated type is wrong, so that others may stay unknown.
    quiet: bool,
    /// The names of the `let`s whose values are looked at.
    bound_to: Vec<String>,
    /// Where fields are called as other languages call methods.
    called: Vec<Span>,
    /// For editors: what names mean.
    noted: Vec<(Span, Meaning, Ty)>,
    here: Option<HereType>,
}

/// What could stand somewhere, before types are known.
enum HereType {
    Value(Vec<(String, Ty)>, Option<StructId>),
    Field(Ty),
    Pattern(Ty),
}

struct Local {
    name: String,
    ty: Ty,
    span: Span,
    used: Cell<bool>,
}

impl<'e, 'a> Infer<'e, 'a> {
    fn new(env: &'e Env<'e, 'a>, place: Place<'e>) -> Infer<'e, 'a> {
        Infer {
            env,
            place,
            table: Table::default(),
            locals: Vec::new(),
            scope: Names::default(),
            goals: Goals::default(),
            comparable: Vec::new(),
            out: Vec::new(),
            errors: 0,
            holes: 0,
            unused: Vec::new(),
            quiet: false,
            bound_to: Vec::new(),
            called: Vec::new(),
            noted: Vec::new(),
            here: None,
        }
    }

    fn body(mut self, written: &ast::Expr, want: Want) -> Body {
        let node = self.expr(written, want);
        self.settle_goals();
        self.finish(node)
    }

    /// A new local, not in scope yet.
    fn local(&mut self, name: &str, ty: Ty, span: Span) -> LocalId {
        self.locals.push(Local { name: name.to_owned(), ty, span, used: Cell::new(false) });
        LocalId(self.locals.len() as u32 - 1)
    }

    fn bind(&mut self, name: &str, ty: Ty, span: Span) -> LocalId {
        let id = self.local(name, ty, span);
        if name != "_" {
            self.note_local(name, id, span);
            self.scope.push(name, id);
        }
        id
    }

    fn lookup(&self, name: &str) -> Option<LocalId> {
        let id = self.scope.get(name)?;
        self.locals[id.0 as usize].used.set(true);
        Some(id)
    }

    fn note(&mut self, span: Span, meaning: Meaning, ty: Ty) {
        if self.env.names.notes.is_some() {
            self.noted.push((span, meaning, ty));
        }
    }

    fn note_local(&mut self, name: &str, id: LocalId, span: Span) {
        let Local { ty, span: bound, .. } = self.locals[id.0 as usize];
        // Names made for holes are no names of the text.
        if !name.starts_with('$') {
            self.note(span, Meaning::Local(bound), ty);
        }
    }

    /// The names that an unknown name could have been, if an editor asks.
    fn note_here(&mut self, name: &str) {
        if name != HERE || self.env.names.notes.is_none() {
            return;
        }
        let mut seen = HashSet::new();
        let mut names = Vec::new();
        for name in self.scope.iter().filter(|name| !name.starts_with('$') && seen.insert(*name)) {
            if let Some(id) = self.scope.get(name) {
                names.push((name.to_owned(), self.locals[id.0 as usize].ty));
            }
        }
        let built = match self.here.take() {
            Some(HereType::Value(_, built)) => built,
            _ => None,
        };
        self.here = Some(HereType::Value(names, built));
    }

    fn fresh(&mut self, span: Span) -> Ty {
        self.table.fresh(Origin::Value(span))
    }

    /// The known name that was probably meant. Each suggestion reads all names: far down the list nobody sees it.
    fn similar<'n>(&self, name: &str, known: impl Iterator<Item = &'n str>) -> Option<&'n str> {
        if self.out.len() < MAX_DIAGNOSTICS { similar(name, known) } else { None }
    }

    fn report(&mut self, diagnostic: Diagnostic) {
        self.errors += usize::from(diagnostic.severity == Severity::Error);
        self.out.push(diagnostic);
    }

    /// Is the body refused whatever else is in it, and more about it would not be shown?
    fn is_given_up(&self) -> bool {
        self.table.is_full() || self.errors > MAX_DIAGNOSTICS && self.env.names.notes.is_none()
    }

    fn show(&self, ty: Ty) -> String {
        show::show(&self.table, self.env.module, self.place.generics, ty)
    }

    fn error_node(&mut self, span: Span) -> Node {
        Node { kind: Kind::Error, ty: Ty::ERROR, span }
    }

    /// A node in its place: its type must be the one wanted.
    fn settle(&mut self, kind: Kind, ty: Ty, span: Span, want: Want) -> Node {
        self.require(span, ty, want);
        Node { kind, ty, span }
    }

    fn require(&mut self, span: Span, found: Ty, want: Want) {
        if self.table.is_same(found, want.ty) {
            return;
        }
        // Shown before unification links parts of the two types.
        let known = !self.table.is_unknown(found) && !self.table.is_unknown(want.ty);
        let shown = known.then(|| (self.show(want.ty), self.show(found)));
        if let Err(clash) = self.table.unify(found, want.ty) {
            let (expected, shown) = shown.unwrap_or_else(|| (self.show(want.ty), self.show(found)));
            let diagnostic = self.clash(clash, span, &expected, &shown);
            let diagnostic = match self.conversion(found, want.ty) {
                Some(help) if clash == Clash::Mismatch => diagnostic.help(help),
                _ => diagnostic,
            };
            self.report(match want.why {
                Some((at, text)) if at != span => diagnostic.also(at, text),
                _ => diagnostic,
            });
        }
    }

    fn clash(&self, clash: Clash, span: Span, expected: &str, found: &str) -> Diagnostic {
        match clash {
            Clash::Mismatch => {
                let title = format!("expected {}, found {}", quoted(expected), quoted(found));
                Diagnostic::error(codes::MISMATCH, span, title).label(format!("this is {}", quoted(found)))
            }
            Clash::Infinite => {
                let title = "the type of this would contain itself";
                Diagnostic::error(codes::INFINITE_TYPE, span, title).help(
                    "a value or function cannot hold itself; state the types to see where it goes wrong",
                )
            }
            Clash::TooLarge => Diagnostic::error(codes::TOO_LARGE, span, "the type of this is too large")
                .help("use an array, or smaller parts"),
        }
    }

    /// How to make one type from the other, where a built-in does it.
    fn conversion(&self, from: Ty, to: Ty) -> Option<String> {
        let option =
            |args: &[Ty]| args.first().is_some_and(|&arg| self.table.root(arg) == self.table.root(from));
        Some(match (self.table.form(from), self.table.form(to)) {
            (Form::I32 | Form::U32 | Form::Bool, Form::F32) => "convert it with `f32(..)`".to_owned(),
            (Form::F32 | Form::U32 | Form::Bool, Form::I32) => "convert it with `i32(..)`".to_owned(),
            (Form::I32 | Form::F32 | Form::Bool, Form::U32) => "convert it with `u32(..)`".to_owned(),
            (Form::I32 | Form::U32 | Form::F32, Form::Bool) => "compare it, as in `x != 0`".to_owned(),
            (Form::F32 | Form::Var { literal: true, .. }, Form::Vec(n)) => {
                format!("make a vector with `vec{n}(..)`")
            }
            (Form::I32 | Form::Var { literal: true, .. }, Form::IVec(n)) => {
                format!("make a vector with `ivec{n}(..)`")
            }
            (_, Form::Enum(id, args))
                if self.env.module.enums[id.0 as usize].name == "Option" && option(args) =>
            {
                "wrap it: `Some(..)`".to_owned()
            }
            (Form::Enum(id, args), _)
                if self.env.module.enums[id.0 as usize].name == "Option"
                    && args.first().is_some_and(|&arg| self.table.root(arg) == self.table.root(to)) =>
            {
                "say what it is when there is none: `match x { Some(v) => v, None => .. }`".to_owned()
            }
            (Form::Array(_, n), Form::Array(_, m)) if n != m => {
                format!("this has {n} elements, and {m} are needed")
            }
            (Form::Fn(params, result), _) if self.table.root(*result) == self.table.root(to) => {
                let holes = vec![".."; params.len().min(1)].concat();
                format!("call it: `f({holes})`")
            }
            _ => return None,
        })
    }
}

/// Whether a part of a stated type was reported.
fn is_wrong(ty: &Type) -> bool {
    match ty {
        Type::Error => true,
        Type::Tuple(items) | Type::Struct(_, items) | Type::Enum(_, items) => items.iter().any(is_wrong),
        Type::Array(item, _) => is_wrong(item),
        Type::Fn(params, result) => params.iter().any(is_wrong) || is_wrong(result),
        _ => false,
    }
}

/// A type's text in a title.
fn quoted(ty: &str) -> String {
    match ty {
        "{integer}" => "an integer".to_owned(),
        ty => format!("`{ty}`"),
    }
}
