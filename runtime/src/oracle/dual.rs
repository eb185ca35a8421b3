//! Dual numbers: data that carry their slope along. A derivative is the slope of a function's value when its
//! argument has slope 1; nothing here knows how the compiler makes derivatives.
//!
//! A dual has a level, the nesting of the derivative that it belongs to, so that derivatives of derivatives do not
//! mix: its value and its slope may be duals of lower levels, and data of a lower level stand still for it. Linear
//! operations act on values and slopes alike, products by Leibniz's rule, and what WGSL defines by a formula is
//! evaluated by that formula.

use std::rc::Rc;

use ghyll_compiler::builtins::{Builtin, Shape};
use ghyll_compiler::typed::BinaryOp;

use super::datum::{Components, Datum, Floats};
use super::float::Precision;
use super::{builtin, operator};
use crate::error::RunError;

/// Value and slope are of one kind: number, vector or matrix.
pub struct Dual<'m> {
    pub level: u32,
    pub value: Datum<'m>,
    pub slope: Datum<'m>,
}

type Result<T> = std::result::Result<T, RunError>;

impl<'m> Datum<'m> {
    pub fn dual(level: u32, value: Datum<'m>, slope: Datum<'m>) -> Datum<'m> {
        Datum::Dual(Rc::new(Dual { level, value, slope }))
    }

    /// 0 for what carries no slope.
    pub fn level(&self) -> u32 {
        match self {
            Datum::Dual(dual) => dual.level,
            _ => 0,
        }
    }

    /// Value and slope at a level that no part exceeds.
    pub fn split(&self, level: u32) -> (Datum<'m>, Option<Datum<'m>>) {
        match self {
            Datum::Dual(dual) if dual.level == level => (dual.value.clone(), Some(dual.slope.clone())),
            other => (other.clone(), None),
        }
    }

    /// Without slopes.
    pub fn plain(&self) -> &Datum<'m> {
        match self {
            Datum::Dual(dual) => dual.value.plain(),
            other => other,
        }
    }

    /// Applies what acts on values and slopes alike.
    pub fn linear(&self, f: impl Fn(&Datum<'m>) -> Result<Datum<'m>> + Copy) -> Result<Datum<'m>> {
        match self {
            Datum::Dual(dual) => Ok(Datum::dual(dual.level, dual.value.linear(f)?, dual.slope.linear(f)?)),
            other => f(other),
        }
    }
}

pub fn highest(data: &[Datum]) -> u32 {
    data.iter().map(Datum::level).max().unwrap_or(0)
}

/// Zero of the kind of `like`.
fn zero<'m>(like: &Datum<'m>) -> Result<Datum<'m>> {
    Ok(match like.plain() {
        Datum::Mat(columns) => Datum::Mat(columns.iter().map(|c| c.map(|_| 0.0)).collect()),
        Datum::Vec(v) => Datum::Vec(v.map(|_| 0.0)),
        _ => Datum::F32(0.0),
    })
}

fn number<'m>(x: f64) -> Datum<'m> {
    Datum::F32(x)
}

/// The language's operations on data of any level, in one precision.
#[derive(Clone, Copy)]
struct Algebra(Precision);

impl<'m> Algebra {
    fn op(self, op: BinaryOp, a: &Datum<'m>, b: &Datum<'m>) -> Result<Datum<'m>> {
        operator::binary(self.0, op, a, b)
    }

    fn add(self, a: &Datum<'m>, b: &Datum<'m>) -> Result<Datum<'m>> {
        self.op(BinaryOp::Add, a, b)
    }

    fn sub(self, a: &Datum<'m>, b: &Datum<'m>) -> Result<Datum<'m>> {
        self.op(BinaryOp::Sub, a, b)
    }

    fn mul(self, a: &Datum<'m>, b: &Datum<'m>) -> Result<Datum<'m>> {
        self.op(BinaryOp::Mul, a, b)
    }

    fn div(self, a: &Datum<'m>, b: &Datum<'m>) -> Result<Datum<'m>> {
        self.op(BinaryOp::Div, a, b)
    }

    fn call(self, b: Builtin, args: &[&Datum<'m>]) -> Result<Datum<'m>> {
        let args: Vec<Datum<'m>> = args.iter().map(|a| (*a).clone()).collect();
        builtin::apply(self.0, b, &args)?
            .ok_or_else(|| RunError::Internal(format!("`{}` is not mathematics", b.name())))
    }

    fn neg(self, a: &Datum<'m>) -> Result<Datum<'m>> {
        operator::unary(ghyll_compiler::typed::UnaryOp::Neg, a)
    }

    fn square(self, a: &Datum<'m>) -> Result<Datum<'m>> {
        self.mul(a, a)
    }

    /// The sum of what is there; none if nothing is.
    fn sum(self, terms: impl IntoIterator<Item = Option<Datum<'m>>>) -> Result<Option<Datum<'m>>> {
        let mut sum: Option<Datum<'m>> = None;
        for term in terms.into_iter().flatten() {
            sum = Some(match sum {
                None => term,
                Some(sum) => self.add(&sum, &term)?,
            });
        }
        Ok(sum)
    }
}

/// `a op b` where one of them is a dual.
pub fn binary<'m>(p: Precision, op: BinaryOp, a: &Datum<'m>, b: &Datum<'m>) -> Result<Datum<'m>> {
    let m = Algebra(p);
    let level = a.level().max(b.level());
    let ((a, da), (b, db)) = (a.split(level), b.split(level));
    let value = m.op(op, &a, &b)?;
    let with =
        |d: Option<Datum<'m>>, f: &dyn Fn(&Datum<'m>) -> Result<Datum<'m>>| d.as_ref().map(f).transpose();
    let slope = match op {
        // The other operand's zero gives the slope the kind of the result.
        BinaryOp::Add | BinaryOp::Sub => {
            let (da, db) = (da.map_or_else(|| zero(&a), Ok)?, db.map_or_else(|| zero(&b), Ok)?);
            Some(m.op(op, &da, &db)?)
        }
        BinaryOp::Mul => m.sum([with(da, &|da| m.mul(da, &b))?, with(db, &|db| m.mul(&a, db))?])?,
        BinaryOp::Div => {
            let along = with(da, &|da| m.div(da, &b))?;
            let across = with(db, &|db| m.neg(&m.div(&m.mul(&value, db)?, &b)?))?;
            m.sum([along, across])?
        }
        BinaryOp::Rem => {
            let whole = m.call(Builtin::Trunc, &[&m.div(&a, &b)?])?;
            let across = with(db, &|db| m.neg(&m.mul(&whole, db)?))?;
            let along = with(da, &|da| m.add(da, &zero(&value)?))?;
            m.sum([along, across])?
        }
        _ => None,
    };
    Ok(match slope {
        Some(slope) => Datum::dual(level, value, slope),
        None => value,
    })
}

/// A built-in of mathematics with a dual among its arguments.
pub fn call<'m>(p: Precision, b: Builtin, args: &[Datum<'m>]) -> Result<Option<Datum<'m>>> {
    if matches!(b.shape(), Shape::Fixed(_)) {
        return Ok(None);
    }
    let m = Algebra(p);
    if let Some(value) = by_formula(m, b, args)? {
        return Ok(Some(value));
    }
    let level = highest(args);
    let parts: Vec<_> = args.iter().map(|a| a.split(level)).collect();
    let values: Vec<&Datum<'m>> = parts.iter().map(|(v, _)| v).collect();
    let value = m.call(b, &values)?;
    let slope = match b.shape() {
        Shape::Matrix | Shape::VectorOf(_) | Shape::MatrixOf(_) => {
            let slopes: Vec<Datum<'m>> = parts
                .iter()
                .map(|(v, slope)| slope.clone().map_or_else(|| zero(v), Ok))
                .collect::<Result<_>>()?;
            Some(m.call(b, &slopes.iter().collect::<Vec<_>>())?)
        }
        Shape::Determinant => determinant(m, values[0], parts[0].1.as_ref())?,
        _ if matches!(b, Builtin::Dot | Builtin::Cross) => {
            let left = parts[0].1.as_ref().map(|s| m.call(b, &[s, values[1]])).transpose()?;
            let right = parts[1].1.as_ref().map(|s| m.call(b, &[values[0], s])).transpose()?;
            m.sum([left, right])?
        }
        _ => {
            let mut terms = Vec::new();
            for (k, (_, slope)) in parts.iter().enumerate() {
                if let (Some(slope), Some(partial)) = (slope, partial(m, b, &values, &value, k)?) {
                    terms.push(Some(m.mul(&partial, slope)?));
                }
            }
            m.sum(terms)?
        }
    };
    Ok(Some(match slope {
        Some(slope) => Datum::dual(level, value, slope),
        None => value,
    }))
}

/// The partial derivative by argument `k` of a built-in that acts on each component; none where it is 0 or moves
/// in steps.
fn partial<'m>(
    m: Algebra,
    b: Builtin,
    v: &[&Datum<'m>],
    value: &Datum<'m>,
    k: usize,
) -> Result<Option<Datum<'m>>> {
    let one = number(1.0);
    let x = v[0];
    let inverse = |d: Datum<'m>| m.div(&number(1.0), &d);
    let root = |d: Datum<'m>| m.call(Builtin::Sqrt, &[&d]);
    let f = |b: Builtin| m.call(b, &[x]);
    let ln2 = number(std::f64::consts::LN_2);
    Ok(Some(match b {
        Builtin::Sin => f(Builtin::Cos)?,
        Builtin::Cos => m.neg(&f(Builtin::Sin)?)?,
        Builtin::Tan => inverse(m.square(&f(Builtin::Cos)?)?)?,
        Builtin::Asin => inverse(root(m.sub(&one, &m.square(x)?)?)?)?,
        Builtin::Acos => m.neg(&inverse(root(m.sub(&one, &m.square(x)?)?)?)?)?,
        Builtin::Atan => inverse(m.add(&one, &m.square(x)?)?)?,
        Builtin::Sinh => f(Builtin::Cosh)?,
        Builtin::Cosh => f(Builtin::Sinh)?,
        Builtin::Tanh => inverse(m.square(&f(Builtin::Cosh)?)?)?,
        Builtin::Asinh => inverse(root(m.add(&m.square(x)?, &one)?)?)?,
        Builtin::Acosh => inverse(root(m.sub(&m.square(x)?, &one)?)?)?,
        Builtin::Atanh => inverse(m.sub(&one, &m.square(x)?)?)?,
        Builtin::Exp => value.clone(),
        Builtin::Exp2 => m.mul(value, &ln2)?,
        Builtin::Log => inverse(x.clone())?,
        Builtin::Log2 => inverse(m.mul(x, &ln2)?)?,
        Builtin::Sqrt => inverse(m.mul(&number(2.0), value)?)?,
        Builtin::InverseSqrt => m.div(&m.mul(&number(-0.5), value)?, x)?,
        Builtin::Atan2 => {
            let square = m.add(&m.square(x)?, &m.square(v[1])?)?;
            if k == 0 { m.div(v[1], &square)? } else { m.neg(&m.div(x, &square)?)? }
        }
        Builtin::Pow if k == 0 => {
            let lower = m.call(Builtin::Pow, &[x, &m.sub(v[1], &one)?])?;
            zero_where_zero(v[1], &m.mul(v[1], &lower)?)?
        }
        Builtin::Pow => zero_where_zero(value, &m.mul(value, &f(Builtin::Log)?)?)?,
        _ => return Ok(None),
    }))
}

/// Built-ins that WGSL defines by others. The kinks are those that the language's manual states.
fn by_formula<'m>(m: Algebra, b: Builtin, a: &[Datum<'m>]) -> Result<Option<Datum<'m>>> {
    let call = |b: Builtin, args: &[&Datum<'m>]| m.call(b, args);
    let test = |x: &Datum<'m>| -> Result<bool> { Ok(x.plain().f32()? < 0.0) };
    Ok(Some(match b {
        // A float that stays a float.
        Builtin::ToF32 | Builtin::BitcastF32 => a[0].clone(),
        Builtin::Abs => m.mul(&call(Builtin::Sign, &[a[0].plain()])?, &a[0])?,
        Builtin::Fract => m.sub(&a[0], &call(Builtin::Floor, &[a[0].plain()])?)?,
        Builtin::Min => pick(&a[0], &a[1], |x, y| y < x)?,
        Builtin::Max => pick(&a[0], &a[1], |x, y| x < y)?,
        Builtin::Clamp => call(Builtin::Min, &[&call(Builtin::Max, &[&a[0], &a[1]])?, &a[2]])?,
        Builtin::Saturate => {
            let (low, high) = (zero(&a[0])?, call(Builtin::Exp, &[&zero(&a[0])?])?);
            call(Builtin::Clamp, &[&a[0], &low, &high])?
        }
        Builtin::Degrees => m.mul(&a[0], &number(180.0 / std::f64::consts::PI))?,
        Builtin::Radians => m.mul(&a[0], &number(std::f64::consts::PI / 180.0))?,
        Builtin::Fma => m.add(&m.mul(&a[0], &a[1])?, &a[2])?,
        Builtin::Mix => {
            let from = m.mul(&a[0], &m.sub(&number(1.0), &a[2])?)?;
            m.add(&from, &m.mul(&a[1], &a[2])?)?
        }
        Builtin::Smoothstep => {
            let ratio = m.div(&m.sub(&a[2], &a[0])?, &m.sub(&a[1], &a[0])?)?;
            let t = call(Builtin::Saturate, &[&ratio])?;
            m.mul(&m.square(&t)?, &m.sub(&number(3.0), &m.mul(&number(2.0), &t)?)?)?
        }
        Builtin::Length if matches!(a[0].plain(), Datum::F32(_)) => call(Builtin::Abs, &[&a[0]])?,
        Builtin::Length => call(Builtin::Sqrt, &[&call(Builtin::Dot, &[&a[0], &a[0]])?])?,
        Builtin::Distance => call(Builtin::Length, &[&m.sub(&a[0], &a[1])?])?,
        Builtin::Normalize => m.div(&a[0], &call(Builtin::Length, &[&a[0]])?)?,
        Builtin::Reflect => {
            let twice = m.mul(&number(2.0), &call(Builtin::Dot, &[&a[1], &a[0]])?)?;
            m.sub(&a[0], &m.mul(&twice, &a[1])?)?
        }
        Builtin::FaceForward if test(&call(Builtin::Dot, &[&a[1], &a[2]])?)? => a[0].clone(),
        Builtin::FaceForward => m.neg(&a[0])?,
        Builtin::Refract => {
            let (i, n, eta) = (&a[0], &a[1], &a[2]);
            let along = call(Builtin::Dot, &[n, i])?;
            let sine = m.sub(&number(1.0), &m.square(&along)?)?;
            let k = m.sub(&number(1.0), &m.mul(&m.square(eta)?, &sine)?)?;
            if test(&k)? {
                zero(i)?
            } else {
                let factor = m.add(&m.mul(eta, &along)?, &call(Builtin::Sqrt, &[&k])?)?;
                m.sub(&m.mul(eta, i)?, &m.mul(&factor, n)?)?
            }
        }
        _ if matches!(b.shape(), Shape::Convert | Shape::Bitcast | Shape::IVectorOf(_)) => {
            call(b, &[a[0].plain()])?
        }
        _ => return Ok(None),
    }))
}

/// The component of `b` where `second` holds of the values, else that of `a`.
fn pick<'m>(a: &Datum<'m>, b: &Datum<'m>, second: fn(f64, f64) -> bool) -> Result<Datum<'m>> {
    let tests: Vec<bool> = {
        let (x, y) = (a.plain().floats()?, b.plain().floats()?);
        x.slice().iter().zip(y.slice()).map(|(x, y)| second(*x, *y)).collect()
    };
    components(&[a, b], &|i, v| if tests[i] { v[1] } else { v[0] })
}

/// `of`, but 0 where `factor` is 0.
fn zero_where_zero<'m>(factor: &Datum<'m>, of: &Datum<'m>) -> Result<Datum<'m>> {
    let factors = factor.plain().floats()?;
    components(&[of], &|i, v| if factors.slice()[i] == 0.0 { 0.0 } else { v[0] })
}

/// A choice for each component, made for values and slopes alike.
fn components<'m>(data: &[&Datum<'m>], choose: &dyn Fn(usize, &[f64]) -> f64) -> Result<Datum<'m>> {
    let level = data.iter().map(|d| d.level()).max().unwrap_or(0);
    if level > 0 {
        let parts: Vec<_> = data.iter().map(|d| d.split(level)).collect();
        let values: Vec<&Datum<'m>> = parts.iter().map(|(v, _)| v).collect();
        let slopes: Vec<Datum<'m>> =
            parts.iter().map(|(v, s)| s.clone().map_or_else(|| zero(v), Ok)).collect::<Result<_>>()?;
        let slopes = components(&slopes.iter().collect::<Vec<_>>(), choose)?;
        return Ok(Datum::dual(level, components(&values, choose)?, slopes));
    }
    let floats: Vec<Floats> = data.iter().map(|d| d.floats()).collect::<Result<_>>()?;
    let chosen: Vec<f64> = (0..floats[0].len())
        .map(|i| choose(i, &floats.iter().map(|f| f.slice()[i]).collect::<Vec<_>>()))
        .collect();
    Ok(match data[0] {
        Datum::F32(_) => Datum::F32(chosen[0]),
        _ => Datum::Vec(Components::new(&chosen)),
    })
}

/// The determinant is linear in each column.
fn determinant<'m>(m: Algebra, matrix: &Datum<'m>, slope: Option<&Datum<'m>>) -> Result<Option<Datum<'m>>> {
    let Some(slope) = slope else { return Ok(None) };
    let size = matrix.plain().columns()?.len();
    let mut terms = Vec::new();
    for at in 0..size {
        let column = |of: &Datum<'m>, i: usize| of.linear(|d| Ok(Datum::Vec(d.columns()?[i])));
        let columns: Vec<Datum<'m>> =
            (0..size).map(|i| column(if i == at { slope } else { matrix }, i)).collect::<Result<_>>()?;
        let build = [Builtin::Mat2, Builtin::Mat3, Builtin::Mat4][size - 2];
        let replaced = m.call(build, &columns.iter().collect::<Vec<_>>())?;
        terms.push(Some(m.call(Builtin::Determinant, &[&replaced])?));
    }
    m.sum(terms)
}
