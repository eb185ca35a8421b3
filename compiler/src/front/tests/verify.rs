//! Whether a typed tree keeps the promises of `typed.rs`. Every accepted program of these tests goes through.

use crate::front::walk::walk;
use crate::typed::*;

/// What is wrong with a module; nothing, if the front end is right.
pub fn verify(module: &Module) -> Vec<String> {
    let mut wrong = Vec::new();
    let bodies = (module.functions.iter().map(|f| (&f.name, &f.locals, &f.body, &f.result)))
        .chain(module.consts.iter().map(|c| (&c.name, &c.locals, &c.value, &c.ty)))
        .chain(module.params.iter().map(|p| (&p.name, &p.locals, &p.default, &p.ty)));
    for (name, locals, body, ty) in bodies {
        let mut check = Check { module, locals, name, wrong: &mut wrong };
        check.same("result", &body.ty, ty);
        walk(body, &mut |e| check.expr(e));
    }
    wrong
}

struct Check<'a> {
    module: &'a Module,
    locals: &'a [Local],
    name: &'a str,
    wrong: &'a mut Vec<String>,
}

fn has_error(ty: &Type) -> bool {
    match ty {
        Type::Error => true,
        Type::Tuple(items) | Type::Struct(_, items) | Type::Enum(_, items) => items.iter().any(has_error),
        Type::Array(item, _) => has_error(item),
        Type::Fn(params, result) => params.iter().any(has_error) || has_error(result),
        _ => false,
    }
}

impl Check<'_> {
    fn same(&mut self, what: &str, a: &Type, b: &Type) {
        if a != b || has_error(a) {
            self.wrong.push(format!("{}: {what}: {a:?} is not {b:?}", self.name));
        }
    }

    fn local(&self, id: LocalId) -> &Type {
        self.locals.get(id.0 as usize).map_or(&Type::Error, |l| &l.ty)
    }

    fn all(&mut self, what: &str, items: &[Expr], types: &[Type]) {
        if items.len() != types.len() {
            self.wrong.push(format!("{}: {what}: {} of {}", self.name, items.len(), types.len()));
        }
        for (item, ty) in items.iter().zip(types) {
            self.same(what, &item.ty, ty);
        }
    }

    fn struct_fields(&self, id: StructId, args: &[Type]) -> Vec<Type> {
        self.module.structs[id.0 as usize].fields.iter().map(|(_, t)| t.substitute(args)).collect()
    }

    fn variant_fields(&self, id: EnumId, index: u32, args: &[Type]) -> Vec<Type> {
        let variant = &self.module.enums[id.0 as usize].variants[index as usize];
        variant.fields.iter().map(|t| t.substitute(args)).collect()
    }

    fn function(&self, e: &Expr) -> (Vec<Type>, Type) {
        match &e.ty {
            Type::Fn(params, result) => (params.clone(), (**result).clone()),
            other => (Vec::new(), other.clone()),
        }
    }

    fn expr(&mut self, e: &Expr) {
        let ty = &e.ty;
        match &e.kind {
            ExprKind::Literal(literal) => self.same("literal", ty, &literal_type(*literal)),
            ExprKind::Local(id) => self.same("local", ty, &self.local(*id).clone()),
            ExprKind::Const(id) => self.same("constant", ty, &self.module.consts[id.0 as usize].ty),
            ExprKind::Param(id) => self.same("parameter", ty, &self.module.params[id.0 as usize].ty),
            ExprKind::Raster(id) => {
                let result = self.module.rasters[id.0 as usize].ty.clone();
                self.same("raster", ty, &Type::Fn(vec![Type::Vec(2)], Box::new(result)));
            }
            ExprKind::Function(id, args) => {
                let f = &self.module.functions[id.0 as usize];
                let params = f.param_types().map(|t| t.substitute(args)).collect();
                self.same("function", ty, &Type::Fn(params, Box::new(f.result.substitute(args))));
            }
            ExprKind::Builtin(_) => self.same("built-in", ty, ty),
            ExprKind::Call(f, args) => {
                let (params, result) = self.function(f);
                self.all("argument", args, &params);
                self.same("call", ty, &result);
            }
            ExprKind::Lambda(params, body) => {
                let params = params.iter().map(|p| self.local(*p).clone()).collect();
                self.same("lambda", ty, &Type::Fn(params, Box::new(body.ty.clone())));
            }
            ExprKind::Unary(_, operand) => self.same("unary", ty, &operand.ty),
            ExprKind::Binary(op, l, r) => self.binary(*op, &l.ty, &r.ty, ty),
            ExprKind::And(l, r) | ExprKind::Or(l, r) => {
                [ty, &l.ty, &r.ty].into_iter().for_each(|t| self.same("logic", t, &Type::Bool));
            }
            ExprKind::Tuple(items) => {
                self.same("tuple", ty, &Type::Tuple(items.iter().map(|i| i.ty.clone()).collect()));
            }
            ExprKind::Array(items) => {
                let Type::Array(item, n) = ty else { return self.same("array", ty, &Type::Error) };
                self.all("element", items, &vec![(**item).clone(); *n as usize]);
            }
            ExprKind::Struct(id, fields) => {
                let Type::Struct(of, args) = ty else { return self.same("struct", ty, &Type::Error) };
                assert_eq!(of, id);
                self.all("field", fields, &self.struct_fields(*id, args));
            }
            ExprKind::With(base, updates) => {
                self.same("update", ty, &base.ty);
                for (index, value) in updates {
                    self.same("updated field", &value.ty, &self.field(&base.ty, *index));
                }
            }
            ExprKind::Variant(id, index, fields) => {
                let Type::Enum(of, args) = ty else { return self.same("variant", ty, &Type::Error) };
                assert_eq!(of, id);
                self.all("field", fields, &self.variant_fields(*id, *index, args));
            }
            ExprKind::VariantFunction(id, index) => {
                let (params, result) = self.function(e);
                let Type::Enum(_, args) = &result else { return self.same("variant", &result, &Type::Error) };
                assert_eq!(params, self.variant_fields(*id, *index, args));
            }
            ExprKind::StructFunction(id) => {
                let (params, result) = self.function(e);
                let Type::Struct(_, args) = &result else {
                    return self.same("struct", &result, &Type::Error);
                };
                assert_eq!(params, self.struct_fields(*id, args));
            }
            ExprKind::Field(base, index) => self.same("field", ty, &self.field(&base.ty, *index)),
            ExprKind::Swizzle(base, parts) => {
                let (scalar, vector): (Type, fn(u8) -> Type) = match base.ty {
                    Type::IVec(_) => (Type::I32, Type::IVec),
                    _ => (Type::F32, Type::Vec),
                };
                let expected = if parts.len() == 1 { scalar } else { vector(parts.len() as u8) };
                self.same("swizzle", ty, &expected);
            }
            ExprKind::Index(base, index) => {
                self.same("index", &index.ty, &Type::I32);
                let element = match &base.ty {
                    Type::Array(item, _) => (**item).clone(),
                    Type::Vec(_) => Type::F32,
                    Type::IVec(_) => Type::I32,
                    Type::Mat(n) => Type::Vec(*n),
                    _ => Type::Error,
                };
                self.same("element", ty, &element);
            }
            ExprKind::If(c, a, b) => {
                self.same("condition", &c.ty, &Type::Bool);
                self.same("branch", &a.ty, ty);
                self.same("branch", &b.ty, ty);
            }
            ExprKind::Match(scrutinee, arms) => {
                for arm in arms {
                    self.same("pattern", &arm.pattern.ty, &scrutinee.ty);
                    self.pattern(&arm.pattern);
                    arm.guard.iter().for_each(|g| self.same("guard", &g.ty, &Type::Bool));
                    self.same("arm", &arm.value.ty, ty);
                }
            }
            ExprKind::Block(lets, value) => {
                for l in lets {
                    self.same("let", &l.pattern.ty, &l.value.ty);
                    self.pattern(&l.pattern);
                }
                self.same("block", ty, &value.ty);
            }
            ExprKind::Range(op, form) => {
                self.same("range", &form.lo.ty, &Type::I32);
                self.same("range", &form.hi.ty, &Type::I32);
                let params = match &form.init {
                    Some(init) => {
                        self.same("start", &init.ty, ty);
                        vec![ty.clone(), Type::I32]
                    }
                    None => vec![Type::I32],
                };
                assert_eq!(form.init.is_some(), *op == RangeOp::Fold);
                self.same("step", &form.f.ty, &Type::Fn(params, Box::new(ty.clone())));
            }
            ExprKind::Derivative(f) => {
                let (params, result) = self.function(f);
                self.same("derivative", &result, &Type::F32);
                self.same("derivative", ty, &Type::Fn(params.clone(), Box::new(params[0].clone())));
            }
        }
    }

    fn binary(&mut self, op: BinaryOp, l: &Type, r: &Type, ty: &Type) {
        use BinaryOp::*;
        match op {
            Eq | Ne | Lt | Le | Gt | Ge => {
                self.same("comparison", ty, &Type::Bool);
                self.same("operands", l, r);
            }
            BitAnd | BitOr | BitXor | Shl | Shr => {
                self.same("bits", ty, l);
                self.same("bits", l, r);
            }
            Add | Sub | Mul | Div | Rem if l == r => self.same("arithmetic", ty, l),
            Mul if matches!((l, r), (Type::Mat(_), Type::Vec(_))) => self.same("product", ty, r),
            Mul if matches!((l, r), (Type::Vec(_), Type::Mat(_))) => self.same("product", ty, l),
            _ => {
                let (scalar, whole) = if matches!(l, Type::F32 | Type::I32) { (l, r) } else { (r, l) };
                let element = if matches!(whole, Type::IVec(_)) { Type::I32 } else { Type::F32 };
                self.same("scalar operand", scalar, &element);
                self.same("arithmetic", ty, whole);
            }
        }
    }

    fn field(&self, base: &Type, index: u32) -> Type {
        match base {
            Type::Struct(id, args) => self.struct_fields(*id, args).get(index as usize).cloned(),
            Type::Tuple(items) => items.get(index as usize).cloned(),
            _ => None,
        }
        .unwrap_or(Type::Error)
    }

    fn pattern(&mut self, p: &Pattern) {
        let (parts, types) = match (&p.kind, &p.ty) {
            (PatternKind::Wild, _) => return,
            (PatternKind::Bind(id), ty) => return self.same("name", &self.local(*id).clone(), ty),
            (PatternKind::Literal(literal), ty) => return self.same("literal", &literal_type(*literal), ty),
            (PatternKind::Tuple(parts), Type::Tuple(items)) => (parts, items.clone()),
            (PatternKind::Struct(id, parts), Type::Struct(of, args)) if id == of => {
                (parts, self.struct_fields(*id, args))
            }
            (PatternKind::Variant(id, index, parts), Type::Enum(of, args)) if id == of => {
                (parts, self.variant_fields(*id, *index, args))
            }
            (PatternKind::Or(parts), ty) => (parts, vec![ty.clone(); parts.len()]),
            (_, ty) => return self.same("pattern", ty, &Type::Error),
        };
        assert_eq!(parts.len(), types.len());
        for (part, ty) in parts.iter().zip(&types) {
            self.same("part", &part.ty, ty);
            self.pattern(part);
        }
    }
}

fn literal_type(literal: Literal) -> Type {
    match literal {
        Literal::Bool(_) => Type::Bool,
        Literal::I32(_) => Type::I32,
        Literal::U32(_) => Type::U32,
        Literal::F32(_) => Type::F32,
    }
}

#[test]
fn a_planted_error_is_found() {
    let text = "fn f(n: i32) -> i32 = if n < 2 { 1 } else { n };";
    let mut module = super::accepts(text).module;
    let Some(id) = module.function("f") else { panic!("the test defines it") };
    let body = &mut module.functions[id.0 as usize].body;
    let ExprKind::If(_, branch, _) = &mut body.kind else { panic!("it is an if") };
    branch.ty = Type::F32;
    assert_eq!(verify(&module).len(), 2);
}
