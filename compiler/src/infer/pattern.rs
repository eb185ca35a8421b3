//! Patterns: names bound, constructors looked up, types unified.

use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};

use super::call::Aliased;
use super::finish::MOST_WRITTEN;
use super::table::{Form, Origin, Ty};
use super::tree::{Number, Pattern, PatternKind};
use super::{HereType, Infer, Want};
use crate::analysis::notes::{HERE, Meaning};
use crate::ast::{self, FieldPattern, Name, Rest};
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::resolve::scope::Value;
use crate::resolve::types::count;
use crate::source::Span;
use crate::typed::{LocalId, StructId};

/// Names that an earlier alternative bound, of an or-pattern and of those around it.
#[derive(Default)]
pub(super) struct Bound<'b> {
    own: HashMap<String, LocalId>,
    around: Option<&'b Bound<'b>>,
}

impl Bound<'_> {
    fn get(&self, name: &str) -> Option<LocalId> {
        self.own.get(name).copied().or_else(|| self.around?.get(name))
    }
}

/// Nodes of types that a part of a pattern counts as.
const NODES_OF_A_PART: u64 = 2;

/// Fields of a struct that a message names.
const MOST_FIELDS: usize = 12;

impl Infer<'_, '_> {
    pub(super) fn pattern(&mut self, p: &ast::Pattern, want: Want) -> Pattern {
        let mark = self.scope.len();
        let pattern = self.pattern_part(p, want, &Bound::default());
        self.distinct_since(mark);
        pattern
    }

    /// Reports names that were bound twice since the scope had a certain length.
    pub(super) fn distinct_since(&mut self, mark: usize) {
        let mut twice = Vec::new();
        let mut seen = HashMap::new();
        for (name, id) in self.scope.since(mark) {
            match seen.entry(name.as_str()) {
                Entry::Occupied(earlier) => twice.push((name.clone(), *earlier.get(), *id)),
                Entry::Vacant(new) => drop(new.insert(*id)),
            }
        }
        for (name, earlier, id) in twice {
            let span = |id: LocalId| self.locals[id.0 as usize].span;
            let diagnostic =
                Diagnostic::error(codes::DUPLICATE, span(id), format!("`{name}` is bound twice"))
                    .also(span(earlier), "first here")
                    .help("rename one of them, or use `_`");
            self.report(diagnostic);
        }
    }

    /// As [`Infer::pattern`], inside a larger pattern.
    pub(super) fn pattern_part(&mut self, p: &ast::Pattern, want: Want, bound: &Bound) -> Pattern {
        let span = p.span;
        let number = |number| PatternKind::Number(number);
        let kind = match &p.kind {
            ast::PatternKind::Error | ast::PatternKind::Wild => PatternKind::Wild,
            ast::PatternKind::Name(name) => self.name_pattern(name, span, want, bound),
            ast::PatternKind::Bool(b) => {
                self.require(span, Ty::BOOL, want);
                number(Number::Bool(*b))
            }
            ast::PatternKind::Int(value, negative) => {
                let ty = self.table.literal(span);
                self.require(span, ty, want);
                number(Number::Int(*value, *negative))
            }
            ast::PatternKind::Uint(value) => {
                self.require(span, Ty::U32, want);
                number(Number::Uint(*value))
            }
            ast::PatternKind::Float(value) => {
                self.require(span, Ty::F32, want);
                number(Number::Float(*value))
            }
            ast::PatternKind::Tuple(items) => self.tuple_pattern(items, span, want, bound),
            ast::PatternKind::Constructor(name, fields, rest) => {
                self.constructor_pattern(name, fields, *rest, span, want, bound)
            }
            ast::PatternKind::Or(alternatives) => self.alternatives(alternatives, want, bound),
        };
        Pattern { kind, ty: want.ty, span }
    }

    fn name_pattern(&mut self, name: &str, span: Span, want: Want, bound: &Bound) -> PatternKind {
        match self.constructor(name) {
            Some(Value::Variant(id, index)) => {
                self.note(span, Meaning::Variant(id, index), want.ty);
                let declared = &self.env.module.enums[id.0 as usize];
                let fields = declared.variants[index as usize].fields.len();
                if fields > 0 {
                    self.field_count(name, fields, 0, span);
                }
                let args = self.pattern_args(declared.generics.len(), span);
                let ty = self.table.add(Form::Enum(id, args));
                self.require(span, ty, want);
                PatternKind::Variant(id, index, self.wilds(fields, span))
            }
            Some(Value::Struct(id)) => {
                let fields = self.env.module.structs[id.0 as usize].fields.len();
                self.field_count(name, fields, 0, span);
                PatternKind::Wild
            }
            _ => {
                if name == HERE {
                    self.here = Some(HereType::Pattern(want.ty));
                }
                let id = match bound.get(name) {
                    Some(id) => {
                        let local = &self.locals[id.0 as usize];
                        let why = Some((local.span, "it has another type here"));
                        let ty = local.ty;
                        self.require(span, want.ty, Want { ty, why });
                        id
                    }
                    None => self.local(name, want.ty, span),
                };
                self.note_local(name, id, span);
                self.scope.push(name, id);
                PatternKind::Bind(id)
            }
        }
    }

    fn is_value(&self, name: &str) -> bool {
        self.env.names.scopes.value(self.place.file, name).is_some()
    }

    /// Type arguments of a constructor, which what is matched will tell.
    fn pattern_args(&mut self, n: usize, span: Span) -> Vec<Ty> {
        (0..n).map(|_| self.fresh(span)).collect()
    }

    fn wilds(&mut self, n: usize, span: Span) -> Vec<Pattern> {
        (0..n).map(|_| Pattern { kind: PatternKind::Wild, ty: Ty::ERROR, span }).collect()
    }

    fn tuple_pattern(
        &mut self,
        items: &[ast::Pattern],
        span: Span,
        want: Want,
        bound: &Bound,
    ) -> PatternKind {
        let types = match self.table.form(want.ty) {
            Form::Tuple(types) if types.len() == items.len() => types.clone(),
            _ => {
                let types: Vec<Ty> = items.iter().map(|p| self.component(p)).collect();
                let ty = self.table.add(Form::Tuple(types.clone()));
                self.require(span, ty, want);
                types
            }
        };
        let parts = items.iter().zip(types).map(|(p, ty)| self.pattern_part(p, Want { ty, ..want }, bound));
        PatternKind::Tuple(parts.collect())
    }

    fn component(&mut self, p: &ast::Pattern) -> Ty {
        match &p.kind {
            ast::PatternKind::Name(name) => self.table.fresh(Origin::Local(name.clone(), p.span)),
            _ => self.fresh(p.span),
        }
    }

    fn constructor_pattern(
        &mut self,
        name: &Name,
        fields: &[FieldPattern],
        rest: Rest,
        span: Span,
        want: Want,
        bound: &Bound,
    ) -> PatternKind {
        let module = self.env.module;
        let (constructor, aliased) = match self.constructor(&name.text) {
            None if !self.is_value(&name.text) => match self.aliased(&name.text, span) {
                Some(Aliased::Struct(id, args)) => (Some(Value::Struct(id)), Some(args)),
                _ => (None, None),
            },
            found => (found, None),
        };
        if let Some(value) = constructor {
            self.note(name.span, value.into(), want.ty);
        }
        match constructor {
            Some(Value::Struct(id)) => {
                let declared = &module.structs[id.0 as usize];
                if !self.may_fill_in(declared.fields.len().saturating_sub(fields.len())) {
                    return self.parts_alone(fields, bound);
                }
                let args = aliased.unwrap_or_else(|| self.pattern_args(declared.generics.len(), span));
                let types: Vec<Ty> =
                    declared.fields.iter().map(|(_, t)| self.table.import(t, &args)).collect();
                let ty = self.table.add(Form::Struct(id, args));
                self.require(span, ty, want);
                let parts = self.struct_fields(id, name, fields, rest, span, &types, bound);
                PatternKind::Struct(id, parts)
            }
            Some(Value::Variant(id, index)) => {
                let declared = &module.enums[id.0 as usize];
                let args = self.pattern_args(declared.generics.len(), span);
                let variant = &declared.variants[index as usize];
                if !self.may_fill_in(variant.fields.len().saturating_sub(fields.len())) {
                    return self.parts_alone(fields, bound);
                }
                let types: Vec<Ty> = variant.fields.iter().map(|t| self.table.import(t, &args)).collect();
                let ty = self.table.add(Form::Enum(id, args));
                self.require(span, ty, want);
                if let Some(field) = fields.iter().find_map(|f| f.name.as_ref()) {
                    let title = format!("the fields of `{}` have no names", name.text);
                    self.report(
                        Diagnostic::error(codes::NAMED_ARGUMENT, field.span, title)
                            .help("give them by position"),
                    );
                }
                let parts = self.positions(&name.text, fields, rest, span, &types, bound);
                PatternKind::Variant(id, index, parts)
            }
            _ => {
                self.no_constructor(name);
                self.parts_alone(fields, bound)
            }
        }
    }

    /// Counts parts that a pattern has without being written. Too many in the whole program are reported with its
    /// types.
    fn may_fill_in(&mut self, parts: usize) -> bool {
        let written = self.env.written.get().saturating_add(NODES_OF_A_PART * parts as u64);
        self.env.written.set(written);
        written <= MOST_WRITTEN
    }

    /// Binds the names of a pattern that is wrong itself.
    fn parts_alone(&mut self, fields: &[FieldPattern], bound: &Bound) -> PatternKind {
        for field in fields {
            self.pattern_part(&field.pattern, Want::just(Ty::ERROR), bound);
        }
        PatternKind::Wild
    }

    fn no_constructor(&mut self, name: &Name) {
        let title = format!("`{}` is neither a struct nor a variant", name.text);
        let diagnostic = Diagnostic::error(codes::NOT_A_CONSTRUCTOR, name.span, title);
        let scopes = &self.env.names.scopes;
        let known = scopes.value_names(self.place.file).filter(|n| self.constructor(n).is_some());
        let diagnostic = match self.similar(&name.text, known) {
            Some(meant) => diagnostic.help(format!("did you mean `{meant}`?")),
            None => diagnostic,
        };
        self.report(diagnostic);
    }

    fn field_count(&mut self, name: &str, expected: usize, found: usize, span: Span) {
        let title = format!("`{name}` has {}, found {found} in this pattern", count(expected, "field"));
        let blanks = vec!["_"; expected.min(8)].join(", ");
        let help = match expected {
            0 => format!("write `{name}` alone"),
            _ => format!("write `{name}({blanks})`, or `{name}(..)` for any"),
        };
        self.report(Diagnostic::error(codes::PATTERN_FIELDS, span, title).help(help));
    }

    fn positions(
        &mut self,
        name: &str,
        fields: &[FieldPattern],
        rest: Rest,
        span: Span,
        types: &[Ty],
        bound: &Bound,
    ) -> Vec<Pattern> {
        let fits = match rest {
            Rest::Present => fields.len() <= types.len(),
            Rest::Absent => fields.len() == types.len(),
        };
        if !fits {
            self.field_count(name, types.len(), fields.len(), span);
        }
        let mut parts = Vec::new();
        for (i, field) in fields.iter().enumerate() {
            let ty = types.get(i).copied().unwrap_or(Ty::ERROR);
            parts.push(self.pattern_part(&field.pattern, Want::just(ty), bound));
        }
        parts.truncate(types.len());
        for &ty in &types[parts.len()..] {
            parts.push(Pattern { kind: PatternKind::Wild, ty, span });
        }
        parts
    }

    #[allow(clippy::too_many_arguments)]
    fn struct_fields(
        &mut self,
        id: StructId,
        name: &Name,
        fields: &[FieldPattern],
        rest: Rest,
        span: Span,
        types: &[Ty],
        bound: &Bound,
    ) -> Vec<Pattern> {
        if fields.iter().all(|f| f.name.is_none()) {
            return self.positions(&name.text, fields, rest, span, types, bound);
        }
        let declared = &self.env.module.structs[id.0 as usize];
        let mut parts: Vec<Option<Pattern>> = types.iter().map(|_| None).collect();
        for field in fields {
            let index = field.name.as_ref().and_then(|n| self.env.field(id, &n.text));
            let ty = index.map_or(Ty::ERROR, |i| types[i]);
            let part = self.pattern_part(&field.pattern, Want::just(ty), bound);
            match (&field.name, index) {
                (Some(n), Some(i)) => {
                    self.note(n.span, Meaning::Field(id, i as u32), ty);
                    if parts[i].replace(part).is_some() {
                        let title = format!("the field `{}` is given twice", n.text);
                        self.report(Diagnostic::error(codes::DUPLICATE_FIELD, n.span, title));
                    }
                }
                (Some(n), None) => {
                    self.unknown_field(n, &name.text, declared.fields.iter().map(|(f, _)| f.as_str()))
                }
                (None, _) => {
                    let span = field.pattern.span;
                    let binding = match &field.pattern.kind {
                        ast::PatternKind::Name(text) => self.env.field(id, text).map(|_| text.as_str()),
                        _ => None,
                    };
                    self.report(super::call::mixed_fields(span, binding));
                }
            }
        }
        let missing = declared.fields.iter().zip(&parts).find(|(_, part)| part.is_none());
        let named = fields.iter().all(|field| field.name.is_some());
        if let (true, Some(((field, _), _)), Rest::Absent) = (named, missing, rest) {
            let title = format!("this pattern leaves out the field `{field}`");
            self.report(
                Diagnostic::error(codes::PATTERN_FIELDS, span, title)
                    .help(format!("add `{field}: _`, or `..` at the end")),
            );
        }
        let wild = |(part, &ty): (Option<Pattern>, &Ty)| {
            part.unwrap_or(Pattern { kind: PatternKind::Wild, ty, span })
        };
        parts.into_iter().zip(types).map(wild).collect()
    }

    pub(super) fn unknown_field<'n>(
        &mut self,
        name: &Name,
        of: &str,
        known: impl Iterator<Item = &'n str> + Clone,
    ) {
        let title = format!("`{of}` has no field `{}`", name.text);
        let all: Vec<&str> = known.clone().take(MOST_FIELDS).collect();
        let help = match self.similar(&name.text, known) {
            Some(meant) => format!("did you mean `{meant}`?"),
            None => format!("its fields are {}", all.join(", ")),
        };
        let diagnostic =
            Diagnostic::error(codes::UNKNOWN_FIELD, name.span, title).label("unknown field").help(help);
        self.no_field(name, diagnostic);
    }

    /// Reports a field that does not exist; one that is called was meant as a method.
    pub(super) fn no_field(&mut self, name: &Name, diagnostic: Diagnostic) {
        let (scopes, file, text) = (&self.env.names.scopes, self.place.file, &name.text);
        let known = matches!(scopes.value(file, text), Some(Value::Function(_)))
            || scopes.builtin(file, text).is_some();
        if !self.called.contains(&name.span) {
            return self.report(match known {
                true => diagnostic.help(format!("`{text}` is a function: write `{text}(value)`")),
                false => diagnostic,
            });
        }
        let help = match crate::foreign::value_help(text) {
            _ if known => format!("write `{text}(value, ..)`, or `value |> {text}`"),
            Some(help) => format!("functions stand before their arguments: {help}"),
            None => "functions stand before their arguments: `f(value, ..)`".to_owned(),
        };
        self.report(
            Diagnostic::error(codes::METHOD, name.span, "there are no methods")
                .label("called like one")
                .help(help),
        );
    }

    fn alternatives(&mut self, alternatives: &[ast::Pattern], want: Want, bound: &Bound) -> PatternKind {
        let mark = self.scope.len();
        let mut parts: Vec<Pattern> = Vec::new();
        let mut first: Vec<(String, LocalId)> = Vec::new();
        let mut names = Bound { own: HashMap::new(), around: Some(bound) };
        for p in alternatives {
            let part = self.pattern_part(p, want, &names);
            let own = self.scope.split_off(mark);
            match parts.is_empty() {
                true => {
                    names.own.extend(own.iter().cloned());
                    first = own;
                }
                false => self.same_names(&first, &own, &parts[0], &part),
            }
            parts.push(part);
        }
        first.iter().for_each(|(name, id)| self.scope.push(name, *id));
        PatternKind::Or(parts)
    }

    fn same_names(
        &mut self,
        first: &[(String, LocalId)],
        other: &[(String, LocalId)],
        a: &Pattern,
        b: &Pattern,
    ) {
        let missing = |from: &[(String, LocalId)], of: &[(String, LocalId)]| {
            let from: HashSet<&str> = from.iter().map(|(name, _)| name.as_str()).collect();
            of.iter().find(|(name, _)| !from.contains(name.as_str())).cloned()
        };
        let (name, lacks, has) = match (missing(other, first), missing(first, other)) {
            (Some((name, _)), _) => (name, b.span, a.span),
            (None, Some((name, _))) => (name, a.span, b.span),
            (None, None) => return,
        };
        self.report(
            Diagnostic::error(codes::OR_PATTERN, lacks, format!("this alternative does not bind `{name}`"))
                .also(has, format!("`{name}` is bound here"))
                .help("all alternatives of a pattern bind the same names"),
        );
    }
}
