//! Built-in functions that exist for several types. [`Shape`] says how the arguments' types make the result's.

use super::goals::Placed;
use super::numeric::Class;
use super::table::Ty;
use super::{Env, Infer, Want, quoted};
use crate::ast::Item;
use crate::builtins::{Builtin, Shape};
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::parse;
use crate::resolve::types::Place;
use crate::source::{SourceId, Span};
use crate::typed::Type;

/// Which types a built-in's one type may be.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// f32 and float vectors.
    Float,
    /// Those, i32, u32 and integer vectors.
    Number,
    Integer,
    Vector,
    Matrix,
}

impl Kind {
    fn accepts(self, class: Class) -> bool {
        match class {
            Class::Scalar(Ty::F32) => matches!(self, Kind::Float | Kind::Number),
            Class::Scalar(_) => matches!(self, Kind::Number | Kind::Integer),
            Class::Vec(_) => matches!(self, Kind::Float | Kind::Number | Kind::Vector),
            Class::IVec(_) => self == Kind::Number,
            Class::Mat(_) => self == Kind::Matrix,
            _ => false,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Kind::Float => "f32, vec2, vec3 and vec4",
            Kind::Number => "numbers and vectors",
            Kind::Integer => "i32 and u32",
            Kind::Vector => "vec2, vec3 and vec4",
            Kind::Matrix => "mat2, mat3 and mat4",
        }
    }
}

impl Env<'_, '_> {
    /// The one type of a built-in that is not overloaded.
    pub(super) fn fixed_type(&self, builtin: Builtin) -> Type {
        if let Some(ty) = self.fixed.borrow().get(&builtin) {
            return ty.clone();
        }
        let Shape::Fixed(text) = builtin.shape() else { return Type::Error };
        let alias = parse::file(SourceId(0), &format!("type T = {text};"));
        let mut out = Vec::new();
        let ty = match alias.tree.first() {
            Some(Item::Alias(alias)) => {
                self.plain().ty(Place { file: 0, generics: &[] }, &alias.ty, &mut out)
            }
            _ => Type::Error,
        };
        self.fixed.borrow_mut().insert(builtin, ty.clone());
        ty
    }

    /// Names without any items, so that nothing shadows the types of built-ins.
    fn plain(&self) -> crate::resolve::types::Names<'static> {
        let scopes = crate::resolve::scope::Scopes::empty();
        crate::resolve::types::Names { scopes, ..Default::default() }
    }
}

impl Infer<'_, '_> {
    pub(super) fn solve_builtin(
        &mut self,
        builtin: Builtin,
        args: &[Placed],
        result: Ty,
        span: Span,
        guess: bool,
    ) -> bool {
        // A wrong number of arguments was reported.
        if super::call::arity(builtin).is_some_and(|n| n != args.len())
            || args.iter().any(|(ty, _)| self.class(*ty) == Class::Error)
        {
            return self.abandon(args, result);
        }
        match builtin.shape() {
            Shape::Float(_) => self.uniform(builtin, args, Kind::Float, Some(result), None, span),
            Shape::Number(_) => self.uniform(builtin, args, Kind::Number, Some(result), None, span),
            Shape::Integer(_) => self.uniform(builtin, args, Kind::Integer, Some(result), None, span),
            Shape::Bits(n) => {
                let (values, places) = args.split_at(n.into());
                places.iter().for_each(|&place| self.argument(place, Ty::U32));
                self.uniform(builtin, values, Kind::Integer, Some(result), None, span)
            }
            Shape::Vector(_) => self.uniform(builtin, args, Kind::Vector, Some(result), None, span),
            Shape::Matrix => self.uniform(builtin, args, Kind::Matrix, Some(result), None, span),
            Shape::Determinant => {
                self.uniform(builtin, args, Kind::Matrix, None, Some((result, Ty::F32)), span)
            }
            Shape::Measure(_) => {
                let kind = if builtin == Builtin::Dot { Kind::Vector } else { Kind::Float };
                self.uniform(builtin, args, kind, None, Some((result, Ty::F32)), span)
            }
            Shape::Refract => {
                self.argument(args[2], Ty::F32);
                self.uniform(builtin, &args[..2], Kind::Vector, Some(result), None, span)
            }
            Shape::Cross => {
                self.argument(args[0], Ty::vec(3));
                self.argument(args[1], Ty::vec(3));
                self.result(result, Ty::vec(3), span)
            }
            Shape::Mix => self.mix(builtin, args, result, span, guess),
            Shape::Select => {
                self.argument(args[2], Ty::BOOL);
                self.same(builtin, &args[..2]);
                self.comparable.push((args[0].0, span));
                self.result(result, args[0].0, span)
            }
            Shape::Convert => self.convert(builtin, args[0], result, span),
            Shape::Bitcast => {
                let to = target(builtin);
                self.result(result, to, span);
                match self.class(args[0].0) {
                    Class::Unknown => false,
                    Class::Literal | Class::Scalar(_) => true,
                    _ => self.refuse(builtin, args, "i32, u32 and f32", span),
                }
            }
            Shape::VectorOf(n) => {
                self.components(builtin, args, (n, Ty::F32, Ty::vec(n)), result, span, guess)
            }
            Shape::IVectorOf(n) => {
                self.components(builtin, args, (n, Ty::I32, Ty::ivec(n)), result, span, guess)
            }
            Shape::MatrixOf(n) => self.matrix(builtin, args, n, result, span),
            Shape::Fixed(_) => true,
        }
    }

    fn abandon(&mut self, args: &[Placed], result: Ty) -> bool {
        args.iter().for_each(|(ty, _)| self.table.give_up(*ty));
        self.table.give_up(result);
        true
    }

    fn argument(&mut self, (ty, span): Placed, wanted: Ty) {
        self.require(span, ty, Want::just(wanted));
    }

    /// Arguments of one type.
    fn same(&mut self, builtin: Builtin, args: &[Placed]) -> bool {
        let Some(&(first, at)) = args.first() else { return true };
        // A vector among the arguments says more than a literal before it.
        let &(model, model_at) = args
            .iter()
            .find(|(ty, _)| !matches!(self.class(*ty), Class::Unknown | Class::Literal))
            .unwrap_or(&(first, at));
        let mut fine = true;
        for &(ty, span) in args {
            let shown = (self.show(model), self.show(ty));
            if self.table.unify(ty, model).is_err() {
                fine = false;
                let title = format!(
                    "`{}` takes arguments of one type, found {} and {}",
                    builtin.name(),
                    quoted(&shown.0),
                    quoted(&shown.1)
                );
                let diagnostic = Diagnostic::error(codes::BUILTIN, span, title)
                    .label(format!("this is {}", quoted(&shown.1)))
                    .also(model_at, format!("this is {}", quoted(&shown.0)));
                self.report(match self.conversion(ty, model) {
                    Some(help) => diagnostic.help(help),
                    None => diagnostic,
                });
            }
        }
        fine
    }

    /// All arguments, and the result where it is given, have one type of a kind.
    fn uniform(
        &mut self,
        builtin: Builtin,
        args: &[Placed],
        kind: Kind,
        result: Option<Ty>,
        scalar: Option<(Ty, Ty)>,
        span: Span,
    ) -> bool {
        if !self.same(builtin, args) {
            result.into_iter().chain(scalar.map(|(ty, _)| ty)).for_each(|ty| self.table.give_up(ty));
            return true;
        }
        let ty = args[0].0;
        if let (Class::Unknown, Some(result)) = (self.class(ty), result) {
            // A result that is wanted elsewhere decides an unknown argument.
            self.result(result, ty, span);
        }
        let class = self.class(ty);
        let fits = match class {
            Class::Unknown | Class::Error => true,
            Class::Literal => !matches!(kind, Kind::Vector | Kind::Matrix),
            class => kind.accepts(class),
        };
        let (own, other) = (result.map(|r| (r, ty)), scalar);
        if !fits {
            own.into_iter().chain(other).for_each(|(result, _)| self.table.give_up(result));
            return self.refuse(builtin, args, kind.name(), span);
        }
        if class == Class::Literal && kind == Kind::Float {
            self.argument(args[0], Ty::F32);
        }
        for (result, ty) in own.into_iter().chain(other) {
            self.result(result, ty, span);
        }
        class != Class::Unknown
    }

    fn refuse(&mut self, builtin: Builtin, args: &[Placed], takes: &str, _span: Span) -> bool {
        let Some(&(ty, at)) = args.first() else { return true };
        let name = builtin.name();
        let found = quoted(&self.show(ty));
        let title = format!("`{name}` takes {takes}, found {found}");
        let diagnostic = Diagnostic::error(codes::BUILTIN, at, title).label(format!("this is {found}"));
        self.report(match self.class(ty) {
            Class::Scalar(Ty::I32 | Ty::U32) if takes.contains("f32") => {
                diagnostic.help("convert it with `f32(..)`")
            }
            Class::Scalar(Ty::F32) if takes.contains("i32") => diagnostic.help("convert it with `i32(..)`"),
            _ => diagnostic,
        });
        true
    }

    fn mix(&mut self, builtin: Builtin, args: &[Placed], result: Ty, span: Span, guess: bool) -> bool {
        let done = self.uniform(builtin, &args[..2], Kind::Float, Some(result), None, span);
        match self.class(args[2].0) {
            Class::Unknown if !guess => return false,
            Class::Vec(_) => self.argument(args[2], args[0].0),
            _ => self.argument(args[2], Ty::F32),
        }
        done
    }

    fn convert(&mut self, builtin: Builtin, arg: Placed, result: Ty, span: Span) -> bool {
        let to = target(builtin);
        self.result(result, to, span);
        match self.class(arg.0) {
            Class::Unknown => false,
            Class::Literal | Class::Bool | Class::Scalar(_) => true,
            _ => self.refuse(builtin, &[arg], "bool, i32, u32 and f32", span),
        }
    }

    /// `vec3(v, 1.0)`: scalars and vectors that have n components together, or one scalar for all.
    fn components(
        &mut self,
        builtin: Builtin,
        args: &[Placed],
        (n, element, whole): (u8, Ty, Ty),
        result: Ty,
        span: Span,
        guess: bool,
    ) -> bool {
        self.result(result, whole, span);
        // A vector of as many components of the other kind is converted.
        let other = if element == Ty::F32 { Class::IVec(n) } else { Class::Vec(n) };
        if let [(ty, _)] = args
            && self.class(*ty) == other
        {
            return true;
        }
        let mut total = 0usize;
        let (mut unknown, mut wrong) = (false, false);
        for &(ty, at) in args {
            total += match self.class(ty) {
                // As many arguments as components are all scalars.
                Class::Unknown if args.len() == n as usize || guess => {
                    self.argument((ty, at), element);
                    1
                }
                Class::Unknown => {
                    unknown = true;
                    0
                }
                Class::Error => return self.abandon(args, result),
                Class::Vec(k) if element == Ty::F32 => k as usize,
                Class::IVec(k) if element == Ty::I32 => k as usize,
                class => {
                    // How many there are says nothing where some are of the wrong kind.
                    wrong |= !matches!(class, Class::Literal | Class::Scalar(_));
                    self.argument((ty, at), element);
                    1
                }
            };
        }
        if unknown {
            return false;
        }
        let one_for_all = args.len() == 1 && total == 1;
        if total != n as usize && !one_for_all && !wrong {
            let title = format!("`{}` needs {n} components, found {total}", builtin.name());
            let help =
                format!("give {n} scalars, vectors that have {n} components together, or one scalar for all");
            self.report(Diagnostic::error(codes::ARGUMENTS, span, title).help(help));
        }
        true
    }

    /// `mat3(a, b, c)` from columns, or from all their components.
    fn matrix(&mut self, builtin: Builtin, args: &[Placed], n: u8, result: Ty, span: Span) -> bool {
        self.result(result, Ty::mat(n), span);
        let element = match args.len() {
            count if count == n as usize => Ty::vec(n),
            count if count == n as usize * n as usize => Ty::F32,
            count => {
                let title = format!(
                    "`{}` takes {n} columns or {} scalars, found {count} arguments",
                    builtin.name(),
                    u32::from(n) * u32::from(n)
                );
                self.report(Diagnostic::error(codes::ARGUMENTS, span, title));
                return self.abandon(args, result);
            }
        };
        args.iter().for_each(|&arg| self.argument(arg, element));
        true
    }
}

/// What a conversion or bit cast yields.
pub(super) fn target(builtin: Builtin) -> Ty {
    match builtin {
        Builtin::ToF32 | Builtin::BitcastF32 => Ty::F32,
        Builtin::ToI32 | Builtin::BitcastI32 => Ty::I32,
        Builtin::ToU32 | Builtin::BitcastU32 => Ty::U32,
        _ => Ty::BOOL,
    }
}
