//! The value of each kind of expression.

use std::rc::Rc;

use ghyll_compiler::typed::{Arm, BinaryOp, Expr, ExprKind, Let, RangeForm, RangeOp, Type};

use super::datum::{Callable, Components, Datum, Floats, Frame, Lambda};
use super::evaluator::{Evaluator, Step};
use super::{moving, operator, pattern};
use crate::error::RunError;
use crate::value::field_types;

type Result<T> = std::result::Result<T, RunError>;

impl<'m> Evaluator<'m> {
    /// Evaluates an expression in tail position, but for the last call in it.
    pub fn tail(&mut self, mut expr: &'m Expr, frame: &mut Frame<'m>) -> Result<Step<'m>> {
        loop {
            expr = match &expr.kind {
                ExprKind::Call(callee, args) => {
                    let f = self.eval(callee, frame)?.function()?;
                    return Ok(Step::Call(f, self.eval_all(args, frame)?));
                }
                ExprKind::If(cond, yes, no) => {
                    if self.eval(cond, frame)?.bool()? {
                        yes
                    } else {
                        no
                    }
                }
                ExprKind::And(a, b) if self.eval(a, frame)?.bool()? => b,
                ExprKind::Or(a, b) if !self.eval(a, frame)?.bool()? => b,
                ExprKind::And(..) => return Ok(Step::Done(Datum::Bool(false))),
                ExprKind::Or(..) => return Ok(Step::Done(Datum::Bool(true))),
                ExprKind::Match(value, arms) => &self.choose(value, arms, frame)?.value,
                ExprKind::Block(lets, value) => {
                    self.bind_all(lets, frame)?;
                    value
                }
                _ => return self.eval(expr, frame).map(Step::Done),
            };
        }
    }

    /// Evaluates an expression. What only some kinds need is in functions of its own, so that deep recursion
    /// takes little stack.
    pub fn eval(&mut self, mut expr: &'m Expr, frame: &mut Frame<'m>) -> Result<Datum<'m>> {
        loop {
            expr = match &expr.kind {
                ExprKind::Literal(literal) => return Ok(self.precision.literal(*literal)),
                ExprKind::Local(id) => return frame.get(*id),
                ExprKind::Call(callee, args) => return self.call(callee, args, frame),
                ExprKind::Binary(op, a, b) => return self.binary(*op, a, b, frame),
                ExprKind::If(cond, yes, no) => {
                    if self.eval(cond, frame)?.bool()? {
                        yes
                    } else {
                        no
                    }
                }
                ExprKind::And(a, b) if self.eval(a, frame)?.bool()? => b,
                ExprKind::Or(a, b) if !self.eval(a, frame)?.bool()? => b,
                ExprKind::And(..) => return Ok(Datum::Bool(false)),
                ExprKind::Or(..) => return Ok(Datum::Bool(true)),
                ExprKind::Match(value, arms) => &self.choose(value, arms, frame)?.value,
                ExprKind::Block(lets, value) => {
                    self.bind_all(lets, frame)?;
                    value
                }
                ExprKind::Range(op, range) => return self.range(*op, range, &expr.ty, frame),
                ExprKind::Const(id) => return self.constant(*id),
                ExprKind::Param(id) => return self.param(*id),
                _ => return self.function_or_data(expr, frame),
            };
        }
    }

    #[inline(never)]
    fn call(&mut self, callee: &'m Expr, args: &'m [Expr], frame: &mut Frame<'m>) -> Result<Datum<'m>> {
        let f = self.eval(callee, frame)?.function()?;
        let args = self.eval_all(args, frame)?;
        self.apply(f, args)
    }

    #[inline(never)]
    fn binary(&mut self, op: BinaryOp, a: &'m Expr, b: &'m Expr, frame: &mut Frame<'m>) -> Result<Datum<'m>> {
        let a = self.eval(a, frame)?;
        let b = self.eval(b, frame)?;
        operator::binary(self.precision, op, &a, &b)
    }

    #[inline(never)]
    fn function_or_data(&mut self, expr: &'m Expr, frame: &mut Frame<'m>) -> Result<Datum<'m>> {
        Ok(Datum::Function(match &expr.kind {
            ExprKind::Raster(id) => Callable::Raster(*id),
            ExprKind::Function(id, types) => {
                Callable::Function(*id, types.iter().map(|t| t.substitute(&frame.types)).collect())
            }
            ExprKind::Builtin(b) => Callable::Builtin(*b),
            ExprKind::VariantFunction(_, tag) => Callable::Variant(*tag),
            ExprKind::StructFunction(_) => Callable::Struct,
            ExprKind::Lambda(params, body) => {
                Callable::Lambda(Rc::new(Lambda { params, body, frame: frame.clone() }))
            }
            ExprKind::Derivative(f) => Callable::Derivative(Rc::new(self.eval(f, frame)?.function()?)),
            _ => return self.data(expr, frame),
        }))
    }

    /// Expressions that make or take apart data.
    #[inline(never)]
    fn data(&mut self, expr: &'m Expr, frame: &mut Frame<'m>) -> Result<Datum<'m>> {
        Ok(match &expr.kind {
            ExprKind::Unary(op, a) => operator::unary(*op, &self.eval(a, frame)?)?,
            ExprKind::Tuple(items) | ExprKind::Array(items) | ExprKind::Struct(_, items) => {
                Datum::Fields(self.eval_all(items, frame)?.into())
            }
            ExprKind::Variant(_, tag, items) => Datum::Variant(*tag, self.eval_all(items, frame)?.into()),
            ExprKind::With(base, changes) => {
                let mut fields = self.eval(base, frame)?.fields()?.to_vec();
                for (at, value) in changes {
                    fields[*at as usize] = self.eval(value, frame)?;
                }
                Datum::Fields(fields.into())
            }
            ExprKind::Field(base, at) => self.eval(base, frame)?.fields()?[*at as usize].clone(),
            ExprKind::Swizzle(base, at) => self.eval(base, frame)?.linear(|d| swizzle(d, at))?,
            ExprKind::Index(base, at) => {
                let (base, at) = (self.eval(base, frame)?, self.eval(at, frame)?);
                base.linear(|d| index(d, &at))?
            }
            other => return Err(RunError::Internal(format!("the oracle has no meaning for {other:?}"))),
        })
    }

    #[inline(never)]
    fn eval_all(&mut self, exprs: &'m [Expr], frame: &mut Frame<'m>) -> Result<Vec<Datum<'m>>> {
        exprs.iter().map(|e| self.eval(e, frame)).collect()
    }

    #[inline(never)]
    fn bind_all(&mut self, lets: &'m [Let], frame: &mut Frame<'m>) -> Result<()> {
        for Let { pattern, value } in lets {
            let value = self.eval(value, frame)?;
            if !pattern::fits(pattern, &value, frame, self.precision)? {
                return Err(RunError::Internal("the pattern of a `let` does not fit its value".into()));
            }
        }
        Ok(())
    }

    /// The first arm that fits, with its names bound.
    #[inline(never)]
    fn choose(&mut self, value: &'m Expr, arms: &'m [Arm], frame: &mut Frame<'m>) -> Result<&'m Arm> {
        let value = self.eval(value, frame)?;
        for arm in arms {
            if !pattern::fits(&arm.pattern, &value, frame, self.precision)? {
                continue;
            }
            match &arm.guard {
                Some(guard) if !self.eval(guard, frame)?.bool()? => {}
                _ => return Ok(arm),
            }
        }
        Err(RunError::Internal("no arm of a `match` fits".into()))
    }

    #[inline(never)]
    fn range(
        &mut self,
        op: RangeOp,
        range: &'m RangeForm,
        ty: &Type,
        frame: &mut Frame<'m>,
    ) -> Result<Datum<'m>> {
        let (lo, hi) = (self.eval(&range.lo, frame)?.i32()?, self.eval(&range.hi, frame)?.i32()?);
        let mut value = match (op, &range.init) {
            (RangeOp::Fold, Some(init)) => self.eval(init, frame)?,
            (RangeOp::Sum, _) => self.zero(&ty.substitute(&frame.types))?,
            (op, _) => Datum::Bool(op == RangeOp::All),
        };
        let f = self.eval(&range.f, frame)?.function()?;
        for i in lo..hi {
            self.tick()?;
            let i = Datum::I32(i);
            value = match op {
                RangeOp::Fold => self.apply(f.clone(), vec![value, i])?,
                RangeOp::Sum => operator::add(self.precision, &value, &self.apply(f.clone(), vec![i])?)?,
                RangeOp::Any | RangeOp::All => self.apply(f.clone(), vec![i])?,
            };
            let decided = match op {
                RangeOp::Any => value.bool()?,
                RangeOp::All => !value.bool()?,
                RangeOp::Fold | RangeOp::Sum => false,
            };
            if decided {
                break;
            }
        }
        Ok(value)
    }

    /// What a sum starts with.
    fn zero(&self, ty: &Type) -> Result<Datum<'m>> {
        let all = |types: &[Type]| types.iter().map(|t| self.zero(t)).collect::<Result<Rc<_>>>();
        Ok(match ty {
            Type::I32 => Datum::I32(0),
            Type::U32 => Datum::U32(0),
            Type::F32 => Datum::F32(0.0),
            Type::Vec(n) => Datum::Vec(Components::splat(0.0, *n as usize)),
            Type::IVec(n) => Datum::IVec(Components::splat(0, *n as usize)),
            Type::Mat(n) => Datum::Mat(vec![Floats::splat(0.0, *n as usize); *n as usize].into()),
            Type::Tuple(types) => Datum::Fields(all(types)?),
            Type::Array(item, n) => Datum::Fields(all(&vec![(**item).clone(); *n as usize])?),
            Type::Struct(id, args) => Datum::Fields(all(&field_types(self.module, *id, args))?),
            other => return Err(RunError::Internal(format!("there is no sum of {other:?}"))),
        })
    }
}

fn swizzle<'m>(base: &Datum<'m>, at: &[u8]) -> Result<Datum<'m>> {
    fn pick<T: Copy + Default>(v: &Components<T>, at: &[u8]) -> Vec<T> {
        at.iter().filter_map(|i| v.slice().get(*i as usize).copied()).collect()
    }
    Ok(match base {
        Datum::Moving(v) => moving::datum(at.iter().filter_map(|i| v.get(*i as usize).copied()).collect()),
        Datum::IVec(v) => match pick(v, at).as_slice() {
            [one] => Datum::I32(*one),
            items => Datum::IVec(Components::new(items)),
        },
        other => match pick(&other.floats()?, at).as_slice() {
            [one] => Datum::F32(*one),
            items => Datum::vec(items),
        },
    })
}

/// The index is clamped to what there is.
fn index<'m>(base: &Datum<'m>, at: &Datum<'m>) -> Result<Datum<'m>> {
    let at = match at {
        Datum::U32(u) => *u as i64,
        other => other.i32()? as i64,
    };
    let clamped = |len: usize| match len {
        0 => Err(RunError::Unsupported("an element of an array without elements".into())),
        len => Ok(at.clamp(0, len as i64 - 1) as usize),
    };
    Ok(match base {
        Datum::Vec(v) => Datum::F32(v.slice()[clamped(v.len())?]),
        Datum::Moving(v) => moving::datum(vec![v[clamped(v.len())?]]),
        Datum::IVec(v) => Datum::I32(v.slice()[clamped(v.len())?]),
        Datum::Mat(columns) => Datum::Vec(columns[clamped(columns.len())?]),
        other => {
            let items = other.fields()?;
            items[clamped(items.len())?].clone()
        }
    })
}
