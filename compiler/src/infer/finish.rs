//! From the tree of inference to the typed tree: types are written out, literals get their values, fields
//! and swizzles are told apart, patterns are checked for what they leave out.

use std::collections::HashSet;

use super::goals::swizzle;
use super::show::show_type;
use super::table::{Origin, Ty, Unfinished};
use super::tree::{self, Kind, Node, Number};
use super::{Body, HereType, Infer};
use crate::analysis::notes::{HERE, Here, Meaning};
use crate::ast::Name;
use crate::builtins::Builtin;
use crate::codes;
use crate::diagnostic::{Diagnostic, Severity};
use crate::exhaustive::{self, Coverage};
use crate::resolve::declare::too_large;
use crate::resolve::scope::Value;
use crate::resolve::size::{Sizes, holds_function, substituted_nodes};
use crate::source::Span;
use crate::typed::{
    Arm, BinaryOp, Expr, ExprKind, Let, Literal, Local, LocalId, Module, Pattern, PatternKind, RangeForm,
    Type,
};

impl Infer<'_, '_> {
    pub(super) fn finish(mut self, node: Node) -> Body {
        // Unknown types are often only the consequence of an error.
        let quiet = self.quiet || self.has_errors();
        let locals: Vec<(String, Ty, Span)> =
            self.locals.iter().map(|l| (l.name.clone(), l.ty, l.span)).collect();
        let comparable = std::mem::take(&mut self.comparable);
        let mut finish = Finish { infer: self, quiet, sizes: Sizes::default() };
        let locals =
            locals.into_iter().map(|(name, ty, span)| Local { name, ty: finish.ty(ty, span) }).collect();
        let expr = finish.expr(node);
        for (ty, span) in comparable {
            finish.comparable(ty, span);
        }
        if finish.infer.table.is_full() || finish.infer.env.written.get() > MOST_WRITTEN {
            finish.report(
                Diagnostic::error(codes::TOO_LARGE, expr.span, "the types in this program are too large")
                    .help("give smaller types to what is used most"),
            );
        }
        // What is wrong elsewhere in the body may be why a name is not read.
        let unused = match finish.infer.has_errors() {
            true => Vec::new(),
            false => std::mem::take(&mut finish.infer.unused),
        };
        finish.notes();
        let is_told = |d: &Diagnostic| {
            finish.infer.out.iter().any(|o| o.code == codes::LOOKALIKE && o.primary.0 == d.primary.0)
        };
        let unused: Vec<Diagnostic> = unused.into_iter().filter(|d| !is_told(d)).collect();
        let mut diagnostics = finish.infer.out;
        diagnostics.extend(unused);
        let mut seen = HashSet::new();
        diagnostics.retain(|d| seen.insert((d.code, d.primary.0, d.title.clone())));
        Body { expr, locals, diagnostics }
    }

    fn has_errors(&self) -> bool {
        self.out.iter().any(|d| d.severity == Severity::Error)
    }

    /// Stops types that grow from `let` to `let`.
    pub(super) fn check_size(&mut self, ty: Ty, span: Span) {
        if self.table.is_too_large(ty) {
            self.report(too_large(span, u64::MAX));
            self.table.replace_by_error(ty);
        }
    }
}

/// Most nodes of the types in a whole program.
pub(super) const MOST_WRITTEN: u64 = 4_000_000;

struct Finish<'e, 'a> {
    infer: Infer<'e, 'a>,
    quiet: bool,
    sizes: Sizes,
}

impl Finish<'_, '_> {
    fn module(&self) -> &Module {
        self.infer.env.module
    }

    fn report(&mut self, diagnostic: Diagnostic) {
        self.infer.out.push(diagnostic);
    }

    fn ty(&mut self, ty: Ty, span: Span) -> Type {
        if let Some(plain) = self.infer.table.plain(ty) {
            return plain;
        }
        if self.infer.env.written.get() > MOST_WRITTEN {
            return Type::Error;
        }
        loop {
            match self.infer.table.export(ty) {
                Ok(ty) => {
                    let module = self.infer.env.module;
                    let written = self.infer.env.written.get().saturating_add(substituted_nodes(&ty, &[]));
                    self.infer.env.written.set(written);
                    if written > MOST_WRITTEN {
                        return Type::Error;
                    }
                    if self.sizes.fits(module, &ty) {
                        return ty;
                    }
                    let words = self.sizes.words(module, &ty);
                    self.report(too_large(span, words));
                    return Type::Error;
                }
                Err(Unfinished::TooLarge) => {
                    self.report(too_large(span, u64::MAX));
                    return Type::Error;
                }
                Err(Unfinished::Unknown(var)) => {
                    // One such report explains what is only computed from it.
                    let derived = matches!(self.infer.table.origin(var), Some(Origin::Value(_)));
                    if !(self.quiet || derived && self.infer.has_errors()) {
                        let diagnostic = unknown(self.infer.table.origin(var), span);
                        self.report(diagnostic);
                    }
                    self.infer.table.give_up(var);
                }
            }
        }
    }

    fn boxed(&mut self, node: Node) -> Box<Expr> {
        Box::new(self.expr(node))
    }

    fn all(&mut self, nodes: Vec<Node>) -> Vec<Expr> {
        nodes.into_iter().map(|n| self.expr(n)).collect()
    }

    fn expr(&mut self, node: Node) -> Expr {
        let Node { kind, ty, span } = node;
        let ty = self.ty(ty, span);
        // What is refused is not written out.
        if self.infer.env.written.get() > MOST_WRITTEN {
            return error(span);
        }
        if let Some(notes) = &self.infer.env.names.notes {
            notes.borrow_mut().expression(span, &ty);
        }
        let kind = match kind {
            Kind::Error => return error(span),
            Kind::Number(number) => ExprKind::Literal(self.literal(number, &ty, span)),
            Kind::Local(id) => ExprKind::Local(id),
            Kind::Const(id) => ExprKind::Const(id),
            Kind::Param(id) => ExprKind::Param(id),
            Kind::Raster(id) => ExprKind::Raster(id),
            Kind::Function(id, args) => {
                let written = self.infer.env.written.get().saturating_add(args.len() as u64);
                self.infer.env.written.set(written);
                ExprKind::Function(id, args.into_iter().map(|arg| self.ty(arg, span)).collect())
            }
            Kind::Builtin(builtin) => ExprKind::Builtin(builtin),
            Kind::Call(f, args) => ExprKind::Call(self.boxed(*f), self.all(args)),
            Kind::Lambda(params, body) => ExprKind::Lambda(params, self.boxed(*body)),
            Kind::Unary(op, e) => ExprKind::Unary(op, self.boxed(*e)),
            Kind::Binary(op, l, r) => {
                let (l, r) = (self.boxed(*l), self.boxed(*r));
                let r = if matches!(op, BinaryOp::Shl | BinaryOp::Shr) { shift_count(&l.ty, r) } else { r };
                ExprKind::Binary(op, l, r)
            }
            Kind::And(l, r) => ExprKind::And(self.boxed(*l), self.boxed(*r)),
            Kind::Or(l, r) => ExprKind::Or(self.boxed(*l), self.boxed(*r)),
            Kind::Tuple(items) => ExprKind::Tuple(self.all(items)),
            Kind::Array(items) => ExprKind::Array(self.all(items)),
            Kind::Struct(id, fields) => ExprKind::Struct(id, self.all(fields)),
            Kind::With(base, fields) => return self.with(*base, fields, ty, span),
            Kind::Variant(id, index, fields) => ExprKind::Variant(id, index, self.all(fields)),
            Kind::VariantFunction(id, index) => ExprKind::VariantFunction(id, index),
            Kind::StructFunction(id) => ExprKind::StructFunction(id),
            Kind::Field(base, name) => {
                let base = self.boxed(*base);
                self.note_field(&base.ty, &name, &ty);
                match self.field(&base.ty, &name.text) {
                    Some(Part::Field(index)) => ExprKind::Field(base, index),
                    Some(Part::Swizzle(parts)) => ExprKind::Swizzle(base, parts),
                    None => return error(span),
                }
            }
            Kind::Index(base, index) => ExprKind::Index(self.boxed(*base), clamped_index(self.boxed(*index))),
            Kind::If(branches, last) => return self.conditional(branches, *last, ty, span),
            Kind::Match(e, arms) => return self.matching(*e, arms, ty, span),
            Kind::Block(lets, value) => {
                let lets = lets.into_iter().map(|(pattern, value)| self.binding(pattern, value)).collect();
                ExprKind::Block(lets, self.boxed(*value))
            }
            Kind::Range(op, form) => {
                let tree::RangeForm { lo, hi, init, f } = *form;
                let (lo, hi, init) = (self.expr(lo), self.expr(hi), init.map(|e| self.expr(e)));
                ExprKind::Range(op, Box::new(RangeForm { lo, hi, init, f: self.expr(f) }))
            }
            Kind::Derivative(f) => ExprKind::Derivative(self.boxed(*f)),
        };
        Expr { kind, ty, span }
    }

    fn conditional(&mut self, branches: Vec<(Node, Node)>, last: Node, ty: Type, span: Span) -> Expr {
        let branches: Vec<(Expr, Expr)> =
            branches.into_iter().map(|(c, value)| (self.expr(c), self.expr(value))).collect();
        let last = self.expr(last);
        branches.into_iter().rev().fold(last, |otherwise, (condition, value)| Expr {
            span: condition.span.to(span),
            ty: ty.clone(),
            kind: ExprKind::If(Box::new(condition), Box::new(value), Box::new(otherwise)),
        })
    }

    fn with(&mut self, base: Node, fields: Vec<(crate::ast::Name, Node)>, ty: Type, span: Span) -> Expr {
        let base = self.boxed(base);
        let mut updates = Vec::new();
        for (name, value) in fields {
            let value = self.expr(value);
            self.note_field(&base.ty, &name, &value.ty);
            if let Some(Part::Field(index)) = self.field(&base.ty, &name.text) {
                updates.push((index, value));
            }
        }
        Expr { kind: ExprKind::With(base, updates), ty, span }
    }

    /// What the names of this body mean, now that types are known.
    fn notes(&mut self) {
        let Some(notes) = &self.infer.env.names.notes else { return };
        let mut notes = notes.borrow_mut();
        let known = |ty: Ty| self.infer.table.export(ty).unwrap_or(Type::Error);
        for &(span, meaning, ty) in &self.infer.noted {
            notes.mention(span, meaning, known(ty));
        }
        if let Some(here) = &self.infer.here {
            notes.here = Some(match here {
                HereType::Value(names, built) => {
                    let names = names.iter().map(|(name, ty)| (name.clone(), known(*ty)));
                    Here::Value(names.collect(), *built)
                }
                HereType::Field(ty) => Here::Field(known(*ty)),
                HereType::Pattern(ty) => Here::Pattern(known(*ty)),
            });
        }
    }

    fn note_field(&self, base: &Type, name: &Name, ty: &Type) {
        let Some(notes) = &self.infer.env.names.notes else { return };
        let mut notes = notes.borrow_mut();
        if name.text == HERE {
            notes.here = Some(Here::Field(base.clone()));
        }
        if let (Type::Struct(id, _), Some(Part::Field(index))) = (base, self.field(base, &name.text)) {
            notes.mention(name.span, Meaning::Field(*id, index), ty.clone());
        }
    }

    fn field(&self, base: &Type, name: &str) -> Option<Part> {
        match base {
            Type::Struct(id, _) => self.infer.env.field(*id, name).map(|i| Part::Field(i as u32)),
            Type::Tuple(_) => name.parse().ok().map(Part::Field),
            Type::Vec(n) | Type::IVec(n) => swizzle(name, *n).map(Part::Swizzle),
            _ => None,
        }
    }

    fn literal(&mut self, number: Number, ty: &Type, span: Span) -> Literal {
        let fits = match (number, ty) {
            (Number::Bool(b), _) => Some(Literal::Bool(b)),
            (Number::Float(x), _) => Some(Literal::F32(x)),
            (Number::Uint(n), _) => u32::try_from(n).ok().map(Literal::U32),
            (Number::Int(n, negative), Type::F32) => {
                Some(Literal::F32(if negative { -(n as f64) } else { n as f64 }))
            }
            (Number::Int(n, negative), Type::U32) if !negative || n == 0 => {
                u32::try_from(n).ok().map(Literal::U32)
            }
            (Number::Int(_, true), Type::U32) => None,
            (Number::Int(n, negative), _) => {
                let value = if negative { -i128::from(n) } else { i128::from(n) };
                i32::try_from(value).ok().map(Literal::I32)
            }
        };
        fits.unwrap_or_else(|| {
            let (text, ty_name, range) = match (number, ty) {
                (Number::Int(n, negative), Type::U32) => (signed(n, negative), "u32", "0 to 4294967295"),
                (Number::Uint(n), _) => (format!("{n}u"), "u32", "0 to 4294967295"),
                (Number::Int(n, negative), _) => (signed(n, negative), "i32", "-2147483648 to 2147483647"),
                _ => (String::new(), "f32", "finite numbers"),
            };
            let title = format!("the literal `{text}` does not fit {ty_name}");
            let help = match (number, ty) {
                (Number::Int(n, false), Type::I32) if u32::try_from(n).is_ok() => {
                    format!("{ty_name} holds {range}; `{n}u` is a u32")
                }
                _ => format!("{ty_name} holds {range}"),
            };
            self.report(Diagnostic::error(codes::LITERAL_RANGE, span, title).help(help));
            Literal::I32(0)
        })
    }

    fn pattern(&mut self, p: tree::Pattern) -> Pattern {
        let tree::Pattern { kind, ty, span } = p;
        let ty = self.ty(ty, span);
        let mut all = |parts: Vec<tree::Pattern>| parts.into_iter().map(|p| self.pattern(p)).collect();
        let kind = match kind {
            tree::PatternKind::Wild => PatternKind::Wild,
            tree::PatternKind::Bind(id) => PatternKind::Bind(id),
            tree::PatternKind::Number(number) => PatternKind::Literal(self.literal(number, &ty, span)),
            tree::PatternKind::Tuple(parts) => PatternKind::Tuple(all(parts)),
            tree::PatternKind::Struct(id, parts) => PatternKind::Struct(id, all(parts)),
            tree::PatternKind::Variant(id, index, parts) => PatternKind::Variant(id, index, all(parts)),
            tree::PatternKind::Or(parts) => PatternKind::Or(all(parts)),
        };
        Pattern { kind, ty, span }
    }

    fn binding(&mut self, pattern: tree::Pattern, value: Node) -> Let {
        let value = self.expr(value);
        let pattern = self.pattern(pattern);
        if !self.infer.has_errors()
            && let Some(missing) = exhaustive::refuted(self.module(), &pattern)
        {
            let title = match missing.as_str() {
                "_" => "this pattern does not fit every value".to_owned(),
                missing => format!("this pattern does not fit `{missing}`"),
            };
            self.report(
                Diagnostic::error(codes::REFUTABLE, pattern.span, title).label("may fail").help(
                    "a `let` and a parameter take patterns that always fit; use `match` for the others",
                ),
            );
        }
        Let { pattern, value }
    }

    fn matching(&mut self, e: Node, arms: Vec<tree::Arm>, ty: Type, span: Span) -> Expr {
        let e = self.boxed(e);
        let mut finished = Vec::new();
        let mut misread = None;
        for (i, arm) in arms.into_iter().enumerate() {
            let pattern = self.pattern(arm.pattern);
            if self.lookalikes(&pattern) {
                misread = misread.or(Some(i));
            }
            let guard = arm.guard.map(|g| self.expr(g));
            finished.push(Arm { pattern, guard, value: self.expr(arm.value) });
        }
        // With errors, patterns may not have the types they should.
        if !self.infer.has_errors() {
            self.coverage(&e, &finished, misread, span);
        }
        Expr { kind: ExprKind::Match(e, finished), ty, span }
    }

    /// Warns of names that a pattern binds although a variant or a constant was meant; true if there are any.
    fn lookalikes(&mut self, pattern: &Pattern) -> bool {
        match &pattern.kind {
            PatternKind::Wild | PatternKind::Literal(_) => false,
            PatternKind::Bind(id) => self.lookalike(*id, pattern),
            // All alternatives bind the same names.
            PatternKind::Or(parts) => parts.first().is_some_and(|first| self.lookalikes(first)),
            PatternKind::Tuple(parts) | PatternKind::Struct(_, parts) | PatternKind::Variant(_, _, parts) => {
                parts.iter().filter(|part| self.lookalikes(part)).count() > 0
            }
        }
    }

    fn lookalike(&mut self, id: LocalId, pattern: &Pattern) -> bool {
        let name = self.infer.locals[id.0 as usize].name.clone();
        if name.starts_with(['_', '$']) {
            return false;
        }
        let scopes = &self.infer.env.names.scopes;
        let capital = name.starts_with(|c: char| c.is_ascii_uppercase());
        let of_type = match &pattern.ty {
            Type::Enum(id, _) => &self.module().enums[id.0 as usize].variants[..],
            _ => &[],
        };
        let variant = self.infer.similar(&name, of_type.iter().map(|v| v.name.as_str()));
        let help = match (scopes.value(self.infer.place.file, &name), variant) {
            (Some(Value::Const(_)), _) => {
                format!("compare with the constant in a guard: `x if x == {name} => ..`")
            }
            (_, Some(meant)) => format!("did you mean `{meant}`?"),
            _ if capital => "no variant is called so here; a new name begins with a small letter".to_owned(),
            _ => return false,
        };
        let title = format!("`{name}` binds a new name and fits anything");
        self.report(
            Diagnostic::warning(codes::LOOKALIKE, pattern.span, title).label("a new name").help(help),
        );
        true
    }

    fn coverage(&mut self, e: &Expr, arms: &[Arm], misread: Option<usize>, span: Span) {
        let patterns: Vec<(&Pattern, bool)> = arms.iter().map(|a| (&a.pattern, a.guard.is_some())).collect();
        let Coverage { missing, unreachable, too_complex } =
            exhaustive::coverage(self.module(), &e.ty, &patterns);
        // Behind a name that was meant as a variant, the advice would be wrong.
        for index in unreachable.into_iter().filter(|arm| misread.is_none_or(|misread| *arm <= misread)) {
            self.report(
                Diagnostic::warning(
                    codes::UNREACHABLE_ARM,
                    arms[index].pattern.span,
                    "this arm is never reached",
                )
                .label("the arms before it take everything that fits")
                .help("remove it, or move it up"),
            );
        }
        let at = Span::new(span.source, span.start as usize, e.span.end as usize);
        if too_complex {
            self.report(
                Diagnostic::error(codes::TOO_COMPLEX, at, "this match has too many combinations to check")
                    .help("split it into smaller ones, or end it with `_`"),
            );
        } else if let Some(missing) = missing {
            let unguarded: Vec<(&Pattern, bool)> = arms.iter().map(|a| (&a.pattern, false)).collect();
            let by_guard = exhaustive::coverage(self.module(), &e.ty, &unguarded).missing.is_none();
            let add = match missing.as_str() {
                "_" => "`_ => ..`".to_owned(),
                missing => format!("`{missing} => ..`, or `_ => ..` for all that is left"),
            };
            let help = match by_guard {
                true => format!(
                    "a guard does not count, since it may be false: leave out the last one, or add {add}"
                ),
                false => format!("add {add}"),
            };
            self.report(
                Diagnostic::error(codes::MISSING_CASE, at, format!("the case `{missing}` is missing"))
                    .label(match by_guard {
                        true => format!("`{missing}` has no arm without a guard"),
                        false => format!("`{missing}` has no arm"),
                    })
                    .help(help),
            );
        }
    }

    fn comparable(&mut self, ty: Ty, span: Span) {
        let ty = self.ty(ty, span);
        if !self.infer.has_errors() && holds_function(self.module(), &ty) {
            let shown = show_type(self.module(), self.infer.place.generics, &ty);
            self.report(
                Diagnostic::error(
                    codes::EQUALITY,
                    span,
                    format!("`{shown}` holds a function, so it cannot be compared"),
                )
                .help("compare the parts that are data"),
            );
        }
    }
}

enum Part {
    Field(u32),
    Swizzle(Vec<u8>),
}

fn error(span: Span) -> Expr {
    Expr { kind: ExprKind::Literal(Literal::Bool(false)), ty: Type::Error, span }
}

fn signed(n: u64, negative: bool) -> String {
    format!("{}{n}", if negative { "-" } else { "" })
}

fn unknown(origin: Option<&Origin>, span: Span) -> Diagnostic {
    let error = |span, title: String| Diagnostic::error(codes::UNKNOWN_TYPE_HERE, span, title);
    match origin {
        Some(Origin::Local(name, at)) if name == "_" || name.starts_with('$') => {
            error(*at, "the type of this is not known: type annotations needed".to_owned())
                .help("state it with a colon, as in `|x: f32| ..`")
        }
        Some(Origin::Local(name, at)) => {
            error(*at, format!("the type of `{name}` is not known: type annotations needed"))
                .help(format!("state it, as in `{name}: f32`"))
        }
        Some(Origin::Generic(param, of, at)) => {
            error(*at, format!("the type `{param}` of `{of}` is not known: type annotations needed"))
                .help("give the result a type, as in `let x: T = ..;`")
        }
        Some(Origin::Value(at)) => {
            error(*at, "the type of this is not known: type annotations needed".to_owned())
                .help("give it a type, as in `let x: T = ..;`")
        }
        None => error(span, "the type of this is not known: type annotations needed".to_owned()),
    }
}

fn call(builtin: Builtin, args: Vec<Expr>, result: Type, span: Span) -> Box<Expr> {
    let params = args.iter().map(|a| a.ty.clone()).collect();
    let ty = Type::Fn(params, Box::new(result.clone()));
    let callee = Expr { kind: ExprKind::Builtin(builtin), ty, span };
    Box::new(Expr { kind: ExprKind::Call(Box::new(callee), args), ty: result, span })
}

/// A shift's count in the type of what is shifted: the five bits that count are the same.
fn shift_count(shifted: &Type, count: Box<Expr>) -> Box<Expr> {
    let span = count.span;
    match (shifted, &count.ty) {
        (Type::I32, Type::U32) => call(Builtin::ToI32, vec![*count], Type::I32, span),
        (Type::U32, Type::I32) => call(Builtin::ToU32, vec![*count], Type::U32, span),
        _ => count,
    }
}

/// An index is i32. A u32 is clamped first, so that a large one means the last element.
fn clamped_index(index: Box<Expr>) -> Box<Expr> {
    if index.ty != Type::U32 {
        return index;
    }
    let span = index.span;
    let kind = ExprKind::Literal(Literal::U32(i32::MAX as u32));
    let limit = Expr { kind, ty: Type::U32, span };
    let clamped = call(Builtin::Min, vec![*index, limit], Type::U32, span);
    call(Builtin::ToI32, vec![*clamped], Type::I32, span)
}
