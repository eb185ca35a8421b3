//! Expressions other than calls.

use std::collections::HashMap;

use super::call::{Aliased, given};
use super::goals::GoalKind;
use super::pattern::Bound;
use super::table::{Form, Origin, Ty};
use super::tree::{Arm, Kind, Node, Number, Pattern, PatternKind};
use super::{HereType, Infer, Want};
use crate::analysis::notes::HERE;
use crate::ast::{self, Expr, ExprKind, LambdaParam, Operator};
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::foreign;
use crate::resolve::declare::defining_module;
use crate::resolve::scope::{TypeName, Value};
use crate::resolve::types::count;
use crate::source::Span;
use crate::typed::{BinaryOp, LocalId, StructId, Type, UnaryOp};

impl<'e> Infer<'e, '_> {
    /// Fresh types for the type parameters of an item.
    pub(super) fn instantiate(&mut self, generics: &'e [String], of: &'e str, span: Span) -> Vec<Ty> {
        generics.iter().map(|param| self.table.fresh(Origin::Generic(param, of, span))).collect()
    }
}

impl Infer<'_, '_> {
    /// Checks an expression against the type its place wants.
    pub(super) fn expr(&mut self, e: &Expr, want: Want) -> Node {
        let span = e.span;
        if self.is_given_up() {
            return self.error_node(span);
        }
        match &e.kind {
            ExprKind::Error => self.error_node(span),
            ExprKind::Bool(b) => self.settle(Kind::Number(Number::Bool(*b)), Ty::BOOL, span, want),
            ExprKind::Int(value) => self.integer(*value, false, span, want),
            ExprKind::Uint(value) => self.settle(Kind::Number(Number::Uint(*value)), Ty::U32, span, want),
            ExprKind::Float(value) => self.settle(Kind::Number(Number::Float(*value)), Ty::F32, span, want),
            ExprKind::Name(name) => self.name(name, span, want),
            ExprKind::Hole => {
                let title = "`_` stands only for an argument of a call";
                self.report(
                    Diagnostic::error(codes::MISPLACED_HOLE, span, title).help("write `f(a, _)` or a lambda"),
                );
                self.error_node(span)
            }
            ExprKind::Range(..) => self.misplaced_range(span),
            ExprKind::Unary(op, operand) => self.unary(*op, operand, span, want),
            ExprKind::Binary(op, l, r) => self.binary(*op, l, r, span, want),
            ExprKind::Call(callee, arguments) => self.call(callee, &given(arguments), span, want),
            ExprKind::With(base, fields) => self.with(base, fields, span, want),
            ExprKind::Field(base, name) => {
                let unknown = self.fresh(base.span);
                let base = self.expr(base, Want::just(unknown));
                let ty = self.fresh(span);
                let kind = GoalKind::Field { base: base.ty, name: name.clone(), result: ty, update: false };
                self.goal(kind, span);
                self.settle(Kind::Field(Box::new(base), name.clone()), ty, span, want)
            }
            ExprKind::Index(base, index) => {
                let unknown = self.fresh(base.span);
                let base = self.expr(base, Want::just(unknown));
                let unknown = self.fresh(index.span);
                let index = self.expr(index, Want::just(unknown));
                let ty = self.fresh(span);
                self.goal(GoalKind::Index { base: base.ty, index: (index.ty, index.span), result: ty }, span);
                self.settle(Kind::Index(Box::new(base), Box::new(index)), ty, span, want)
            }
            ExprKind::Tuple(items) => self.tuple(items, span, want),
            ExprKind::Array(items) => self.array(items, span, want),
            ExprKind::Lambda(params, body) => self.lambda(params, body, span, want),
            ExprKind::If(branches, last) => self.conditional(branches, last, span, want),
            ExprKind::Match(e, arms) => self.matching(e, arms, span, want),
            ExprKind::Block(lets, value) => self.block(lets, value, span, want),
        }
    }

    /// Checks an expression whose place says nothing about its type.
    pub(super) fn any(&mut self, e: &Expr) -> Node {
        let unknown = self.fresh(e.span);
        self.expr(e, Want::just(unknown))
    }

    pub(super) fn misplaced_range(&mut self, span: Span) -> Node {
        self.report(crate::diagnostic::misplaced_range(span));
        self.error_node(span)
    }

    fn integer(&mut self, value: u64, negative: bool, span: Span, want: Want) -> Node {
        let ty = self.table.literal(span);
        self.settle(Kind::Number(Number::Int(value, negative)), ty, span, want)
    }

    fn unary(&mut self, op: UnaryOp, operand: &Expr, span: Span, want: Want) -> Node {
        if let (UnaryOp::Neg, ExprKind::Int(value)) = (op, &operand.kind) {
            return self.integer(*value, true, span, want);
        }
        let operand = self.any(operand);
        let ty = self.fresh(span);
        self.goal(GoalKind::Unary { op, operand: operand.ty, result: ty }, span);
        self.settle(Kind::Unary(op, Box::new(operand)), ty, span, want)
    }

    fn binary(&mut self, op: Operator, l: &Expr, r: &Expr, span: Span, want: Want) -> Node {
        match op {
            Operator::Pipe => self.pipe(l, r, span, want),
            Operator::And | Operator::Or => {
                let l = self.expr(l, Want::just(Ty::BOOL));
                let r = self.expr(r, Want::just(Ty::BOOL));
                let (l, r) = (Box::new(l), Box::new(r));
                let kind = if op == Operator::And { Kind::And(l, r) } else { Kind::Or(l, r) };
                self.settle(kind, Ty::BOOL, span, want)
            }
            Operator::Plain(op) => {
                let (l, r) = (self.any(l), self.any(r));
                let result = match op {
                    BinaryOp::Eq
                    | BinaryOp::Ne
                    | BinaryOp::Lt
                    | BinaryOp::Le
                    | BinaryOp::Gt
                    | BinaryOp::Ge => Ty::BOOL,
                    _ => self.fresh(span),
                };
                let (left, right) = ((l.ty, l.span), (r.ty, r.span));
                // The context can decide an operand that is not known.
                let unsettled = self.goal(GoalKind::Binary { op, left, right, result }, span);
                let node = self.settle(Kind::Binary(op, Box::new(l), Box::new(r)), result, span, want);
                if unsettled {
                    self.retry();
                }
                node
            }
        }
    }

    fn name(&mut self, name: &str, span: Span, want: Want) -> Node {
        let (kind, ty) = if let Some(id) = self.lookup(name) {
            self.note_local(name, id, span);
            (Kind::Local(id), self.locals[id.0 as usize].ty)
        } else if let Some(value) = self.env.names.scopes.value(self.place.file, name) {
            let (kind, ty) = self.global(value, span);
            self.note(span, value.into(), ty);
            (kind, ty)
        } else if let Some(builtin) = self.env.names.scopes.builtin(self.place.file, name) {
            return self.builtin_value(builtin, span, want);
        } else {
            match self.aliased(name, span) {
                Some(Aliased::Builtin(builtin)) if matches!(self.table.form(want.ty), Form::Fn(..)) => {
                    return self.builtin_value(builtin, span, want);
                }
                Some(Aliased::Struct(id, args)) => self.struct_function(id, args),
                _ => {
                    self.unknown_name(name, span);
                    return self.error_node(span);
                }
            }
        };
        self.settle(kind, ty, span, want)
    }

    /// A struct's name as the function that builds it.
    fn struct_function(&mut self, id: StructId, args: Vec<Ty>) -> (Kind, Ty) {
        let declared = &self.env.module.structs[id.0 as usize];
        let params = declared.fields.iter().map(|(_, t)| self.table.import(t, &args)).collect();
        let result = self.table.add(Form::Struct(id, args));
        (Kind::StructFunction(id), self.table.add(Form::Fn(params, result)))
    }

    /// An item used as a value.
    fn global(&mut self, value: Value, span: Span) -> (Kind, Ty) {
        let module = self.env.module;
        match value {
            Value::Function(id) => {
                let function = &module.functions[id.0 as usize];
                let args = self.instantiate(&function.generics, &function.name, span);
                let params = function.param_types().map(|t| self.table.import(t, &args)).collect();
                let result = self.table.import(&function.result, &args);
                (Kind::Function(id, args), self.table.add(Form::Fn(params, result)))
            }
            Value::Const(id) => {
                let ty = self.env.const_type(id, span, &mut self.out);
                (Kind::Const(id), self.table.import(&ty, &[]))
            }
            Value::Param(id) => (Kind::Param(id), self.table.import(&module.params[id.0 as usize].ty, &[])),
            Value::Raster(id) => {
                let result = self.table.import(&module.rasters[id.0 as usize].ty, &[]);
                (Kind::Raster(id), self.table.add(Form::Fn(vec![Ty::vec(2)], result)))
            }
            Value::Struct(id) => {
                let declared = &module.structs[id.0 as usize];
                let args = self.instantiate(&declared.generics, &declared.name, span);
                self.struct_function(id, args)
            }
            Value::Variant(id, index) => {
                let declared = &module.enums[id.0 as usize];
                let name = &declared.variants[index as usize].name;
                let args = self.instantiate(&declared.generics, name, span);
                let fields = &declared.variants[index as usize].fields;
                let params: Vec<Ty> = fields.iter().map(|t| self.table.import(t, &args)).collect();
                let result = self.table.add(Form::Enum(id, args));
                match params.is_empty() {
                    true => (Kind::Variant(id, index, Vec::new()), result),
                    false => (Kind::VariantFunction(id, index), self.table.add(Form::Fn(params, result))),
                }
            }
        }
    }

    pub(super) fn unknown_name(&mut self, name: &str, span: Span) {
        self.note_here(name);
        let scopes = &self.env.names.scopes;
        if super::forms::is_form(name) {
            let title = format!("`{name}` is not a value");
            self.report(Diagnostic::error(codes::FORM_AS_VALUE, span, title).help(format!(
                "it is a form: write it with its arguments, as in {}",
                super::forms::example(name)
            )));
            return;
        }
        let file = self.place.file;
        let diagnostic = if let Some(ty) = scopes.type_name(file, name) {
            let variants = match ty {
                TypeName::Enum(id) => &self.env.module.enums[id.0 as usize].variants[..],
                _ => &[],
            };
            let title = format!("`{name}` is a type, not a value");
            let variants: Vec<String> = variants.iter().take(4).map(|v| format!("`{}`", v.name)).collect();
            Diagnostic::error(codes::UNKNOWN_NAME, span, title).label("a type").help(match &variants[..] {
                [] => "only structs, vectors, matrices and numbers are built by the name of their type"
                    .to_owned(),
                variants => format!("its values are built by its variants, such as {}", variants.join(", ")),
            })
        } else if self.env.functions.is_empty() && self.env.module.params.iter().any(|p| p.name == name) {
            let title = format!("`{name}` is a parameter, and a value from outside reads none");
            Diagnostic::error(codes::UNKNOWN_NAME, span, title)
                .label("a parameter")
                .help("write its value, or name a function of the program that reads it")
        } else if self.bound_to.iter().any(|bound| bound == name) {
            let title = format!("`{name}` is not known in its own value");
            Diagnostic::error(codes::UNKNOWN_NAME, span, title)
                .label("named by the `let` only from its `;` on")
                .help(format!(
                    "a function that calls itself stands at the top level: `fn {name}(..) -> .. = ..;`"
                ))
        } else if let Some(module) = defining_module(name, false) {
            Diagnostic::error(codes::NEEDS_MODULE, span, format!("`{name}` is in module `{module}`"))
                .label("not in scope")
                .help(format!("add `use {module};`"))
        } else {
            let diagnostic =
                Diagnostic::error(codes::UNKNOWN_NAME, span, format!("nothing is called `{name}` here"))
                    .label("unknown name");
            let locals = self.scope.iter();
            let known = locals
                .chain(scopes.value_names(self.place.file))
                .chain(super::forms::names().map(|form| -> &str { form }));
            let meant = self.similar(name, known);
            match (scopes.elsewhere(name), foreign::value_help(name), meant) {
                (Some(place), ..) => diagnostic
                    .also(place, "defined here")
                    .help("`use` the file that defines it: what it uses itself is not passed on"),
                (None, Some(help), _) => diagnostic.help(help),
                (None, None, Some(meant)) => diagnostic.help(format!("did you mean `{meant}`?")),
                (None, None, None) => diagnostic,
            }
        };
        self.report(diagnostic);
    }

    fn tuple(&mut self, items: &[Expr], span: Span, want: Want) -> Node {
        let wanted = match self.table.form(want.ty) {
            Form::Tuple(types) if types.len() == items.len() => types.clone(),
            _ => Vec::new(),
        };
        let mut nodes = Vec::new();
        for (i, item) in items.iter().enumerate() {
            nodes.push(match wanted.get(i) {
                Some(&ty) => self.expr(item, Want { ty, ..want }),
                None => self.any(item),
            });
        }
        if !wanted.is_empty() {
            return Node { kind: Kind::Tuple(nodes), ty: want.ty, span };
        }
        let ty = self.table.add(Form::Tuple(nodes.iter().map(|n| n.ty).collect()));
        self.settle(Kind::Tuple(nodes), ty, span, want)
    }

    fn array(&mut self, items: &[Expr], span: Span, want: Want) -> Node {
        let (element, mut why) = match self.table.form(want.ty) {
            Form::Array(element, n) if *n as usize == items.len() => (*element, want.why),
            _ => (self.fresh(span), None),
        };
        let mut nodes = Vec::new();
        for item in items {
            nodes.push(self.expr(item, Want { ty: element, why }));
            why = why.or(Some((item.span, "because the first element has this type")));
        }
        let ty = self.table.add(Form::Array(element, items.len() as u32));
        self.settle(Kind::Array(nodes), ty, span, want)
    }

    fn lambda(&mut self, params: &[LambdaParam], body: &Expr, span: Span, want: Want) -> Node {
        self.lambda_of(params, span, want, (body.span, |infer, want| infer.expr(body, want)))
    }

    /// A lambda whose body is at a place and is checked by a function.
    pub(super) fn lambda_of(
        &mut self,
        params: &[LambdaParam],
        span: Span,
        want: Want,
        (place, body): (Span, impl FnOnce(&mut Self, Want) -> Node),
    ) -> Node {
        let mut wanted = match self.table.form(want.ty) {
            Form::Fn(types, result) => Some((types.clone(), *result)),
            _ => None,
        };
        if let Some((types, _)) = &wanted
            && types.len() != params.len()
        {
            let (has, needs) = (count(params.len(), "parameter"), count(types.len(), "argument"));
            let title = format!("this lambda has {has}, but it gets {needs}");
            let diagnostic = Diagnostic::error(codes::ARGUMENTS, span, title).label("this lambda");
            self.report(match want.why {
                Some((at, text)) => diagnostic.also(at, text),
                None => diagnostic,
            });
            wanted = None;
        }
        let mismatch = wanted.is_none() && matches!(self.table.form(want.ty), Form::Fn(..));
        let mark = self.scope.len();
        let (mut locals, mut types, mut lets) = (Vec::new(), Vec::new(), Vec::new());
        for (i, param) in params.iter().enumerate() {
            let ty = match wanted.as_ref().map(|(types, _)| types[i]) {
                Some(ty) => ty,
                None => self.param_type(&param.pattern),
            };
            let before = self.errors;
            self.stated(param.ty.as_ref(), ty);
            types.push(ty);
            // What is done with a parameter of the wrong type is right for another.
            let ty = if self.errors > before { Ty::ERROR } else { ty };
            locals.push(self.lambda_param(&param.pattern, ty, &mut lets));
        }
        self.distinct_since(mark);
        let of_body = match &wanted {
            Some((_, result)) => Want { ty: *result, why: want.why },
            None => Want::just(self.fresh(place)),
        };
        let body = body(self, of_body);
        self.scope.split_off(mark);
        let (body_ty, body_span) = (body.ty, body.span);
        let body = match lets.is_empty() {
            true => body,
            false => Node { kind: Kind::Block(lets, Box::new(body)), ty: body_ty, span: body_span },
        };
        let kind = Kind::Lambda(locals, Box::new(body));
        if wanted.is_some() {
            return Node { kind, ty: want.ty, span };
        }
        let ty = self.table.add(Form::Fn(types, body_ty));
        match mismatch {
            true => Node { kind, ty, span },
            false => self.settle(kind, ty, span, want),
        }
    }

    fn param_type(&mut self, pattern: &ast::Pattern) -> Ty {
        match &pattern.kind {
            ast::PatternKind::Name(name) => self.table.fresh(Origin::Local(name.clone(), pattern.span)),
            _ => self.table.fresh(Origin::Local("_".to_owned(), pattern.span)),
        }
    }

    /// The local of a lambda's parameter; a pattern is taken apart in a `let` of the body.
    fn lambda_param(&mut self, pattern: &ast::Pattern, ty: Ty, lets: &mut Vec<(Pattern, Node)>) -> LocalId {
        let span = pattern.span;
        let plain = match &pattern.kind {
            ast::PatternKind::Name(name) => self.constructor(name).is_none(),
            ast::PatternKind::Wild => true,
            _ => false,
        };
        if let (ast::PatternKind::Name(name), true) = (&pattern.kind, plain) {
            return self.bind(name, ty, span);
        }
        let local = self.local("_", ty, span);
        if !plain {
            let pattern = self.pattern_part(pattern, Want::just(ty), &Bound::default());
            lets.push((pattern, Node { kind: Kind::Local(local), ty, span }));
        }
        local
    }

    /// Unifies a stated type with the one known so far.
    pub(super) fn stated(&mut self, written: Option<&ast::Type>, ty: Ty) -> Option<Span> {
        let written = written?;
        let stated: Type = self.env.names.ty(self.place, written, &mut self.out);
        let stated = self.table.import(&stated, &[]);
        self.require(written.span, stated, Want::just(ty));
        Some(written.span)
    }

    fn conditional(&mut self, branches: &[(Expr, Expr)], last: &Expr, span: Span, want: Want) -> Node {
        let mut want = want;
        let mut nodes = Vec::new();
        for (condition, value) in branches {
            let condition = self.expr(condition, Want::just(Ty::BOOL));
            nodes.push((condition, self.branch(value, &mut want)));
        }
        let last = self.branch(last, &mut want);
        Node { kind: Kind::If(nodes, Box::new(last)), ty: want.ty, span }
    }

    /// A branch; the first one explains the type of the others.
    fn branch(&mut self, value: &Expr, want: &mut Want) -> Node {
        let node = self.expr(value, *want);
        want.why = want.why.or(Some((value.span, "because the first branch has this type")));
        node
    }

    fn matching(&mut self, e: &Expr, arms: &[ast::Arm], span: Span, want: Want) -> Node {
        let scrutinee = self.any(e);
        self.retry();
        let of = Want { ty: scrutinee.ty, why: Some((scrutinee.span, "the type of this is matched")) };
        let mut want = want;
        let mut nodes = Vec::new();
        for arm in arms {
            let mark = self.scope.len();
            let pattern = self.pattern(&arm.pattern, of);
            let guard = arm.guard.as_ref().map(|g| self.expr(g, Want::just(Ty::BOOL)));
            let value = self.branch(&arm.value, &mut want);
            self.scope.split_off(mark);
            self.note_unused_parts(&pattern);
            nodes.push(Arm { pattern, guard, value });
        }
        Node { kind: Kind::Match(Box::new(scrutinee), nodes), ty: want.ty, span }
    }

    fn block(&mut self, lets: &[ast::Let], value: &Expr, span: Span, want: Want) -> Node {
        let mark = self.scope.len();
        let mut nodes = Vec::new();
        for l in lets {
            nodes.push(self.binding(&l.pattern, l.ty.as_ref(), &l.value));
        }
        let value = self.expr(value, want);
        self.scope.split_off(mark);
        for (pattern, _) in &nodes {
            self.note_unused(pattern);
        }
        let ty = value.ty;
        Node { kind: Kind::Block(nodes, Box::new(value)), ty, span }
    }

    /// A `let`; its names are in scope from here on.
    pub(super) fn binding(
        &mut self,
        pattern: &ast::Pattern,
        stated: Option<&ast::Type>,
        value: &Expr,
    ) -> (Pattern, Node) {
        let ty = match &pattern.kind {
            ast::PatternKind::Name(name) => self.table.fresh(Origin::Local(name.clone(), pattern.span)),
            _ => self.fresh(value.span),
        };
        let why = self.stated(stated, ty).map(|at| (at, "the type is stated here"));
        let name = match &pattern.kind {
            ast::PatternKind::Name(name) => name.as_str(),
            _ => "",
        };
        self.bound_to.push(name.to_owned());
        let node = self.expr(value, Want { ty, why });
        self.bound_to.pop();
        self.retry();
        self.check_size(ty, value.span);
        let pattern = self.pattern(pattern, Want { ty, why: Some((value.span, "the value has this type")) });
        (pattern, node)
    }

    /// Warns where a `let` names one value and nothing reads it. The parts of a pattern are named to tell them apart.
    pub(super) fn note_unused(&mut self, pattern: &Pattern) {
        if let PatternKind::Bind(id) = pattern.kind {
            self.note_unused_name(id, "remove the `let`");
        }
    }

    fn note_unused_name(&mut self, id: LocalId, mend: &str) {
        let local = &self.locals[id.0 as usize];
        if local.used.get() || local.name.starts_with('_') {
            return;
        }
        let (name, span) = (local.name.clone(), local.span);
        self.unused.push(
            Diagnostic::warning(codes::UNUSED_NAME, span, format!("nothing uses `{name}`"))
                .label("named, but never read")
                .help(format!("{mend}, or call it `_{name}`")),
        );
    }

    /// The same for the names within the pattern of an arm.
    fn note_unused_parts(&mut self, pattern: &Pattern) {
        match &pattern.kind {
            PatternKind::Wild | PatternKind::Number(_) => {}
            PatternKind::Bind(id) => self.note_unused_name(*id, "write `_` instead"),
            // All alternatives bind the same names.
            PatternKind::Or(parts) => parts.iter().take(1).for_each(|part| self.note_unused_parts(part)),
            PatternKind::Tuple(parts) | PatternKind::Struct(_, parts) | PatternKind::Variant(_, _, parts) => {
                parts.iter().for_each(|part| self.note_unused_parts(part));
            }
        }
    }

    fn with(&mut self, base: &Expr, fields: &[ast::Argument], span: Span, want: Want) -> Node {
        let base = self.expr(base, want);
        let mut nodes: Vec<(ast::Name, Node)> = Vec::new();
        let mut places: HashMap<&str, Span> = HashMap::new();
        for field in fields {
            let Some(name) = &field.name else {
                self.any(&field.value);
                if matches!(&field.value.kind, ExprKind::Name(name) if name == HERE) {
                    self.here = Some(HereType::Field(base.ty));
                }
                let title = "an update names its fields";
                self.report(
                    Diagnostic::error(codes::NAMED_ARGUMENT, field.value.span, title)
                        .help("write `value with (field: new)`"),
                );
                continue;
            };
            if let Some(earlier) = places.insert(&name.text, name.span) {
                places.insert(&name.text, earlier);
                let title = format!("the field `{}` is given twice", name.text);
                let diagnostic =
                    Diagnostic::error(codes::DUPLICATE_FIELD, name.span, title).also(earlier, "first here");
                self.report(diagnostic);
                continue;
            }
            let ty = self.fresh(field.value.span);
            self.goal(
                GoalKind::Field { base: base.ty, name: name.clone(), result: ty, update: true },
                name.span,
            );
            let value =
                self.expr(&field.value, Want { ty, why: Some((name.span, "the field has this type")) });
            nodes.push((name.clone(), value));
        }
        let ty = base.ty;
        Node { kind: Kind::With(Box::new(base), nodes), ty, span }
    }

    /// A struct, variant with fields or without, that a name stands for.
    pub(super) fn constructor(&self, name: &str) -> Option<Value> {
        let value = self.env.names.scopes.value(self.place.file, name)?;
        matches!(value, Value::Struct(_) | Value::Variant(..)).then_some(value)
    }
}
