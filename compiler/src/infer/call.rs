//! Calls: functions, constructors, holes and pipes.

use super::goals::GoalKind;
use super::table::{Form, Origin, Ty};
use super::tree::{Kind, Node, Pattern};
use super::{HereType, Infer, Want};
use crate::analysis::notes::{HERE, Meaning};
use crate::ast::{self, Argument, Expr, ExprKind, LambdaParam, Name};
use crate::builtins::{Builtin, Shape};
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::resolve::scope::Value;
use crate::resolve::types::{PLAIN, count};
use crate::source::Span;
use crate::typed::{FunctionId, StructId, UnaryOp};
use smallvec::SmallVec;
use std::borrow::Cow;

/// An argument where it stands in the tree, which for what is piped is not among the arguments.
#[derive(Clone, Copy)]
pub(super) struct Given<'x> {
    pub name: Option<&'x Name>,
    pub value: &'x Expr,
}

type AllGiven<'x> = SmallVec<[Given<'x>; 4]>;

pub(super) fn given(arguments: &[Argument]) -> AllGiven<'_> {
    arguments.iter().map(|a| Given { name: a.name.as_ref(), value: &a.value }).collect()
}

/// The constructor of the type that an alias stands for.
pub(super) enum Aliased {
    Struct(StructId, Vec<Ty>),
    Builtin(Builtin),
}

/// What is known about each parameter of a callee.
type Params = Vec<(Ty, Option<Span>)>;

const PARAM: &str = "the parameter has this type";

impl Infer<'_, '_> {
    pub(super) fn call(&mut self, callee: &Expr, arguments: &[Given], span: Span, want: Want) -> Node {
        if arguments.iter().any(|a| matches!(a.value.kind, ExprKind::Hole)) {
            return self.partial(callee, arguments, span, want);
        }
        let ExprKind::Name(name) = &callee.kind else {
            return self.call_value(callee, arguments, span, want);
        };
        if self.lookup(name).is_some() {
            return self.call_value(callee, arguments, span, want);
        }
        let scopes = &self.env.names.scopes;
        match scopes.value(self.place.file, name) {
            Some(Value::Function(id)) => {
                self.note(callee.span, Meaning::Function(id), Ty::ERROR);
                self.call_function(id, name, callee.span, arguments, span, want)
            }
            Some(Value::Struct(id)) => {
                self.note(callee.span, Meaning::Struct(id), Ty::ERROR);
                let declared = &self.env.module.structs[id.0 as usize];
                let args = self.instantiate(&declared.generics, &declared.name, span);
                self.construct((id, args), name, arguments, span, want)
            }
            Some(Value::Variant(id, index)) => {
                self.note(callee.span, Meaning::Variant(id, index), Ty::ERROR);
                let module = self.env.module;
                let declared = &module.enums[id.0 as usize];
                let of = &declared.variants[index as usize].name;
                let args = self.instantiate(&declared.generics, of, callee.span);
                let fields = &declared.variants[index as usize].fields;
                let params: Params = fields.iter().map(|t| (self.table.import(t, &args), None)).collect();
                let ty = self.table.add(Form::Enum(id, args));
                // The context may know the type arguments: they help the fields.
                self.hint(ty, want);
                let nodes = self.arguments(name, &params, arguments, span, Some(declared.span));
                self.settle(Kind::Variant(id, index, nodes), ty, span, want)
            }
            Some(_) => self.call_value(callee, arguments, span, want),
            None => match scopes.builtin(self.place.file, name) {
                Some(builtin) => {
                    self.note(callee.span, Meaning::Builtin(builtin), Ty::ERROR);
                    self.call_builtin(builtin, callee.span, arguments, span, want)
                }
                None if super::forms::is_form(name) => {
                    let form = super::forms::names().find(|form| form == name);
                    form.into_iter().for_each(|form| self.note(callee.span, Meaning::Form(form), Ty::ERROR));
                    self.form_call(name, arguments, span, want)
                }
                None => match self.aliased(name, callee.span) {
                    Some(Aliased::Struct(id, args)) => {
                        self.construct((id, args), name, arguments, span, want)
                    }
                    Some(Aliased::Builtin(builtin)) => {
                        self.call_builtin(builtin, callee.span, arguments, span, want)
                    }
                    None => {
                        self.unknown_name(name, callee.span);
                        self.check_anyway(arguments);
                        self.error_node(span)
                    }
                },
            },
        }
    }

    /// What makes values of the type that an alias stands for.
    pub(super) fn aliased(&mut self, name: &str, span: Span) -> Option<Aliased> {
        let (count, ty) = self.env.names.aliased(self.place.file, name)?;
        if let Some((plain, _)) = PLAIN.iter().find(|(_, plain)| *plain == ty) {
            return Builtin::ALL.iter().copied().find(|b| b.name() == *plain).map(Aliased::Builtin);
        }
        let args: Vec<Ty> = (0..count).map(|_| self.fresh(span)).collect();
        let ty = self.table.import(&ty, &args);
        match self.table.form(ty) {
            Form::Struct(id, args) => Some(Aliased::Struct(*id, args.clone())),
            _ => None,
        }
    }

    /// Unifies a result with what is wanted if that can only help; errors come later, with a place.
    fn hint(&mut self, ty: Ty, want: Want) {
        let (Form::Enum(a, xs), Form::Enum(b, ys)) = (self.table.form(ty), self.table.form(want.ty)) else {
            return;
        };
        if a != b {
            return;
        }
        for (x, y) in xs.clone().into_iter().zip(ys.clone()) {
            if self.table.is_unknown(x) && !self.table.is_unknown(y) {
                // A fresh variable takes any type.
                let _ = self.table.unify(x, y);
            }
        }
    }

    /// Looks at arguments whose call is already wrong.
    pub(super) fn check_anyway(&mut self, arguments: &[Given]) {
        for argument in arguments {
            match &argument.value.kind {
                ExprKind::Range(lo, hi) => {
                    self.any(lo);
                    self.any(hi);
                }
                // Its parameters would be unknown only because the call is wrong.
                ExprKind::Lambda(..) => {}
                _ => {
                    self.any(argument.value);
                }
            }
        }
    }

    pub(super) fn named_argument(&mut self, name: &str, span: Span) {
        let title = format!("the arguments of `{name}` are given by position");
        self.report(
            Diagnostic::error(codes::NAMED_ARGUMENT, span, title)
                .help("remove the name; only structs are built by name"),
        );
    }

    pub(super) fn argument_count(
        &mut self,
        name: &str,
        expected: usize,
        arguments: &[Given],
        span: Span,
        declared: Option<Span>,
    ) {
        let title = format!("`{name}` takes {}, found {}", count(expected, "argument"), arguments.len());
        let at = arguments.get(expected).map_or(span, |extra| extra.value.span);
        let label = if arguments.len() > expected { "one too many" } else { "too few" };
        let diagnostic = Diagnostic::error(codes::ARGUMENTS, at, title).label(label);
        self.report(match declared {
            Some(at) => diagnostic.also(at, "defined here"),
            None => diagnostic,
        });
    }

    /// Checks arguments against parameters, lambdas last: the others tell what their parameters are.
    fn arguments(
        &mut self,
        name: &str,
        params: &Params,
        arguments: &[Given],
        span: Span,
        declared: Option<Span>,
    ) -> Vec<Node> {
        if let Some(named) = arguments.iter().find_map(|a| a.name) {
            self.named_argument(name, named.span);
        }
        if arguments.len() != params.len() {
            self.argument_count(name, params.len(), arguments, span, declared);
            self.check_anyway(arguments);
            return Vec::new();
        }
        let mut nodes: Vec<Option<Node>> = arguments.iter().map(|_| None).collect();
        for lambdas in [false, true] {
            for (i, argument) in arguments.iter().enumerate() {
                if matches!(argument.value.kind, ExprKind::Lambda(..)) == lambdas {
                    let (ty, at) = params[i];
                    let want = Want { ty, why: at.map(|at| (at, PARAM)) };
                    nodes[i] = Some(self.expr(argument.value, want));
                }
            }
        }
        nodes.into_iter().flatten().collect()
    }

    fn call_function(
        &mut self,
        id: FunctionId,
        name: &str,
        at: Span,
        arguments: &[Given],
        span: Span,
        want: Want,
    ) -> Node {
        let module = self.env.module;
        let function = &module.functions[id.0 as usize];
        let args = self.instantiate(&function.generics, &function.name, at);
        let written = self.env.functions.get(id.0 as usize).map(|(_, f)| *f);
        let spans = |i: usize| written.map(|f: &ast::Function| f.params[i].1.span);
        let types = function.param_types().enumerate();
        let params: Params = types.map(|(i, t)| (self.table.import(t, &args), spans(i))).collect();
        let result = self.table.import(&function.result, &args);
        let before = self.out.len();
        let nodes = self.arguments(name, &params, arguments, span, Some(function.span));
        let ty = self.table.add(Form::Fn(params.iter().map(|(ty, _)| *ty).collect(), result));
        // Wrong arguments may have made the wrong instance.
        let result = if self.out.len() > before && !args.is_empty() { Ty::ERROR } else { result };
        let callee = Node { kind: Kind::Function(id, args), ty, span: at };
        self.settle(Kind::Call(Box::new(callee), nodes), result, span, want)
    }

    fn construct(
        &mut self,
        (id, args): (StructId, Vec<Ty>),
        name: &str,
        arguments: &[Given],
        span: Span,
        want: Want,
    ) -> Node {
        let module = self.env.module;
        let declared = &module.structs[id.0 as usize];
        let params: Params =
            declared.fields.iter().map(|(_, t)| (self.table.import(t, &args), None)).collect();
        let ty = self.table.add(Form::Struct(id, args));
        if arguments.iter().any(|a| matches!(&a.value.kind, ExprKind::Name(name) if name == HERE)) {
            self.here = Some(HereType::Value(Vec::new(), Some(id)));
        }
        let nodes = match arguments.iter().any(|a| a.name.is_some()) {
            false => self.arguments(name, &params, arguments, span, Some(declared.span)),
            true => self.named_fields(id, name, &params, arguments, span),
        };
        self.settle(Kind::Struct(id, nodes), ty, span, want)
    }

    fn named_fields(
        &mut self,
        id: StructId,
        name: &str,
        params: &Params,
        arguments: &[Given],
        span: Span,
    ) -> Vec<Node> {
        let declared = &self.env.module.structs[id.0 as usize];
        let mut nodes: Vec<Option<Node>> = params.iter().map(|_| None).collect();
        for argument in arguments {
            let Some(field) = argument.name else {
                let binding = match &argument.value.kind {
                    ExprKind::Name(text) => self.env.field(id, text).map(|_| text.as_str()),
                    _ => None,
                };
                self.report(mixed_fields(argument.value.span, binding));
                self.any(argument.value);
                continue;
            };
            let Some(i) = self.env.field(id, &field.text) else {
                self.unknown_field(field, name, declared.fields.iter().map(|(n, _)| n.as_str()));
                self.any(argument.value);
                continue;
            };
            self.note(field.span, Meaning::Field(id, i as u32), params[i].0);
            let node = self
                .expr(argument.value, Want { ty: params[i].0, why: Some((declared.span, "of this struct")) });
            if nodes[i].replace(node).is_some() {
                let title = format!("the field `{}` is given twice", field.text);
                self.report(
                    Diagnostic::error(codes::DUPLICATE_FIELD, field.span, title).help("remove one of them"),
                );
            }
        }
        let missing: Vec<String> = (declared.fields.iter().zip(&nodes))
            .filter(|(_, node)| node.is_none())
            .map(|((n, _), _)| format!("`{n}`"))
            .collect();
        // A field with a wrong name explains one that is missing.
        let all_known = |a: &Given| a.name.is_some_and(|n| self.env.field(id, &n.text).is_some());
        if !missing.is_empty() && arguments.iter().all(all_known) {
            let title = format!("`{name}` is built without {}", missing.join(", "));
            self.report(
                Diagnostic::error(codes::MISSING_FIELD, span, title)
                    .also(declared.span, "defined here")
                    .help(
                        "a value has all its fields; to change some of another value write `other with (..)`",
                    ),
            );
        }
        nodes.into_iter().flatten().collect()
    }

    /// A call of whatever an expression yields.
    fn call_value(&mut self, callee: &Expr, arguments: &[Given], span: Span, want: Want) -> Node {
        let f = match &callee.kind {
            ExprKind::Lambda(params, _) if params.len() == arguments.len() => {
                return self.call_lambda(callee, arguments, span, want);
            }
            ExprKind::Field(_, name) => {
                self.called.push(name.span);
                self.any(callee)
            }
            _ => self.any(callee),
        };
        if self.table.is_unknown(f.ty) {
            self.retry();
        }
        let (params, result) = match self.table.form(f.ty) {
            Form::Fn(params, result) => (params.clone(), *result),
            Form::Error => {
                self.check_anyway(arguments);
                return self.error_node(span);
            }
            Form::Var { literal: false, .. } => {
                let params: Vec<Ty> = arguments.iter().map(|a| self.fresh(a.value.span)).collect();
                let result = self.fresh(span);
                let ty = self.table.add(Form::Fn(params.clone(), result));
                self.require(callee.span, ty, Want::just(f.ty));
                (params, result)
            }
            _ => {
                let title = format!("{} is not a function", super::quoted(&self.show(f.ty)));
                self.report(
                    Diagnostic::error(codes::NOT_A_FUNCTION, callee.span, title)
                        .label("called here")
                        .help("only functions can be called; an index is written `a[i]`, a product `a * b`"),
                );
                self.check_anyway(arguments);
                return self.error_node(span);
            }
        };
        let params: Params = params.into_iter().map(|ty| (ty, None)).collect();
        let name = match &callee.kind {
            ExprKind::Name(name) => name.as_str(),
            _ => "this function",
        };
        let nodes = self.arguments(name, &params, arguments, span, None);
        self.settle(Kind::Call(Box::new(f), nodes), result, span, want)
    }

    /// `(|x| ..)(a)`: the arguments tell the types of the parameters.
    fn call_lambda(&mut self, lambda: &Expr, arguments: &[Given], span: Span, want: Want) -> Node {
        let params: Params = arguments.iter().map(|a| (self.fresh(a.value.span), None)).collect();
        let nodes = self.arguments("this function", &params, arguments, span, None);
        let ty = self.table.add(Form::Fn(params.iter().map(|(ty, _)| *ty).collect(), want.ty));
        let f = self.expr(lambda, Want { ty, why: want.why });
        Node { kind: Kind::Call(Box::new(f), nodes), ty: want.ty, span }
    }

    fn call_builtin(
        &mut self,
        builtin: Builtin,
        at: Span,
        arguments: &[Given],
        span: Span,
        want: Want,
    ) -> Node {
        let name = builtin.name();
        if let Some(n) = arity(builtin)
            && n != arguments.len()
            && !matches!(builtin.shape(), Shape::Fixed(_))
        {
            self.argument_count(name, n, arguments, span, None);
            self.check_anyway(arguments);
            return self.error_node(span);
        }
        if let Shape::Fixed(_) = builtin.shape() {
            let (params, result) = self.fixed(builtin);
            let wanted: Params = params.iter().map(|&ty| (ty, None)).collect();
            let nodes = self.arguments(name, &wanted, arguments, span, None);
            let ty = self.table.add(Form::Fn(params, result));
            let callee = Node { kind: Kind::Builtin(builtin), ty, span: at };
            return self.settle(Kind::Call(Box::new(callee), nodes), result, span, want);
        }
        let params: Params = match arguments {
            [a] if builtin.shape() == Shape::Convert && is_integer(a.value) => {
                vec![(converted(builtin), None)]
            }
            _ => arguments.iter().map(|a| (self.fresh(a.value.span), None)).collect(),
        };
        let nodes = self.arguments(name, &params, arguments, span, None);
        let result = self.fresh(span);
        let args: Vec<(Ty, Span)> = nodes.iter().map(|n| (n.ty, n.span)).collect();
        let unsettled = self.goal(GoalKind::Builtin { builtin, args, result }, span);
        let types = nodes.iter().map(|n| n.ty).collect();
        let ty = self.table.add(Form::Fn(types, result));
        let callee = Node { kind: Kind::Builtin(builtin), ty, span: at };
        let node = self.settle(Kind::Call(Box::new(callee), nodes), result, span, want);
        if unsettled {
            self.retry();
        }
        node
    }

    /// Parameter and result types of a built-in with one type.
    pub(super) fn fixed(&mut self, builtin: Builtin) -> (Vec<Ty>, Ty) {
        let ty = self.env.fixed_type(builtin);
        let ty = self.table.import(&ty, &[]);
        match self.table.form(ty) {
            Form::Fn(params, result) => (params.clone(), *result),
            _ => (Vec::new(), Ty::ERROR),
        }
    }

    /// A built-in used as a function value, as in `fold(0..3, 0.0, max)`.
    pub(super) fn builtin_value(&mut self, builtin: Builtin, span: Span, want: Want) -> Node {
        self.note(span, Meaning::Builtin(builtin), want.ty);
        if let Shape::Fixed(_) = builtin.shape() {
            let (params, result) = self.fixed(builtin);
            let ty = self.table.add(Form::Fn(params, result));
            return self.settle(Kind::Builtin(builtin), ty, span, want);
        }
        let wanted = match self.table.form(want.ty) {
            Form::Fn(params, _) => Some(params.len()),
            _ => None,
        };
        let Some(n) = arity(builtin).or(wanted) else {
            let title = format!("`{}` takes different numbers of arguments", builtin.name());
            self.report(
                Diagnostic::error(codes::UNKNOWN_TYPE_HERE, span, title)
                    .help(format!("write a lambda, as in `|x| {}(x, x)`", builtin.name())),
            );
            return self.error_node(span);
        };
        let origin =
            |table: &mut super::table::Table| table.fresh(Origin::Generic("T", builtin.name(), span));
        let params: Vec<Ty> = (0..n).map(|_| origin(&mut self.table)).collect();
        let result = origin(&mut self.table);
        let ty = self.table.add(Form::Fn(params.clone(), result));
        let node = self.settle(Kind::Builtin(builtin), ty, span, want);
        let args = params.into_iter().map(|ty| (ty, span)).collect();
        self.goal(GoalKind::Builtin { builtin, args, result }, span);
        node
    }

    /// `f(a, _)`: a block that binds what is given, then a lambda over the holes.
    fn partial(&mut self, callee: &Expr, arguments: &[Given], span: Span, want: Want) -> Node {
        let mark = self.scope.len();
        let mut lets = Vec::new();
        let mut params = Vec::new();
        let callee = self.kept(callee, &mut lets);
        let mut filled = Vec::new();
        for argument in arguments {
            let value = match argument.value.kind {
                ExprKind::Hole => {
                    let name = self.hidden_name(argument.value.span);
                    let ExprKind::Name(text) = &name.kind else { unreachable!("a name was made") };
                    let pattern = ast::PatternKind::Name(text.clone());
                    let pattern = ast::Pattern { kind: pattern, span: name.span };
                    params.push(LambdaParam { pattern, ty: None });
                    Cow::Owned(name)
                }
                _ => self.kept(argument.value, &mut lets),
            };
            filled.push((argument.name, value));
        }
        let filled: AllGiven = filled.iter().map(|(name, value)| Given { name: *name, value }).collect();
        let lambda = self.lambda_of(
            &params,
            span,
            want,
            (span, |infer, want| infer.call(&callee, &filled, span, want)),
        );
        self.scope.split_off(mark);
        lets.iter().for_each(|(pattern, _)| self.note_unused(pattern));
        let ty = lambda.ty;
        match lets.is_empty() {
            true => lambda,
            false => Node { kind: Kind::Block(lets, Box::new(lambda)), ty, span },
        }
    }

    /// What a partial application keeps: names and literals as they are, the value of anything else.
    fn kept<'x>(&mut self, e: &'x Expr, lets: &mut Vec<(Pattern, Node)>) -> Cow<'x, Expr> {
        match e.kind {
            ExprKind::Name(_)
            | ExprKind::Bool(_)
            | ExprKind::Uint(_)
            | ExprKind::Float(_)
            | ExprKind::Int(_)
            | ExprKind::Range(..)
            | ExprKind::Error => Cow::Borrowed(e),
            _ => {
                let name = self.hidden_name(e.span);
                let ExprKind::Name(text) = &name.kind else { unreachable!("a name was made") };
                let pattern = ast::Pattern { kind: ast::PatternKind::Name(text.clone()), span: e.span };
                lets.push(self.binding(&pattern, None, e));
                Cow::Owned(name)
            }
        }
    }

    /// A name that nobody can write.
    fn hidden_name(&mut self, span: Span) -> Expr {
        self.holes += 1;
        Expr { kind: ExprKind::Name(format!("${}", self.holes)), span, depth: 1 }
    }

    /// `x |> f` is `f(x)`; `x |> f(a, _)` fills the hole.
    pub(super) fn pipe(&mut self, x: &Expr, f: &Expr, span: Span, want: Want) -> Node {
        let piped = Given { name: None, value: x };
        if let ExprKind::Call(callee, arguments) = &f.kind {
            let is_hole = |a: &Given| matches!(a.value.kind, ExprKind::Hole);
            let mut filled = given(arguments);
            let mut holes = filled.iter_mut().filter(|a| is_hole(a));
            if let (Some(hole), None) = (holes.next(), holes.next()) {
                hole.value = x;
                return self.call(callee, &filled, span, want);
            }
        }
        self.call(f, &[piped], span, want)
    }
}

/// A literal alone, perhaps negative.
fn is_integer(e: &Expr) -> bool {
    match &e.kind {
        ExprKind::Int(_) => true,
        ExprKind::Unary(UnaryOp::Neg, e) => matches!(e.kind, ExprKind::Int(_)),
        _ => false,
    }
}

/// The type that a literal has as the whole argument of a conversion. Anything longer has a type of its own:
/// `f32(7)` is the literal 7.0, `f32(7 / 2)` is 3.0.
fn converted(builtin: Builtin) -> Ty {
    match super::overload::target(builtin) {
        Ty::BOOL => Ty::I32,
        number => number,
    }
}

/// Number of arguments, where it is one number.
pub(super) fn arity(builtin: Builtin) -> Option<usize> {
    Some(match builtin.shape() {
        Shape::Float(n) | Shape::Number(n) | Shape::Integer(n) | Shape::Measure(n) | Shape::Vector(n) => {
            n.into()
        }
        Shape::Bits(n) => usize::from(n) + 2,
        Shape::Mix | Shape::Select | Shape::Refract => 3,
        Shape::Cross => 2,
        Shape::Matrix | Shape::Determinant | Shape::Convert | Shape::Bitcast => 1,
        Shape::VectorOf(_) | Shape::IVectorOf(_) | Shape::MatrixOf(_) | Shape::Fixed(_) => return None,
    })
}

/// A field without a name among named ones; `field` if it is called as one of them.
pub(super) fn mixed_fields(span: Span, field: Option<&str>) -> Diagnostic {
    let field_help = match field {
        Some(field) => format!("write `{field}: {field}`"),
        None => "name this field too, as in `field: ..`".to_owned(),
    };
    let title = "fields are given all by name or all by position";
    Diagnostic::error(codes::NAMED_ARGUMENT, span, title).label("this one has no name").help(field_help)
}
