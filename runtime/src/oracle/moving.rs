//! Ranges of numbers with ranges of their slopes: what an expression can be along a piece of a ray. Interval arithmetic in double
//! precision, every result rounded outwards, and the chain rule on intervals for the slopes. What jumps is not enclosed but
//! [`RunError::Undecided`], so that a piece that has a value is continuous and its slope holds between any two of its points.

pub mod samplers;
pub mod span;

use std::rc::Rc;

use ghyll_compiler::builtins::{Builtin, Shape};
use ghyll_compiler::typed::BinaryOp;

use self::span::Span;
use super::datum::Datum;
use crate::error::RunError;

type Result<T> = std::result::Result<T, RunError>;

/// Values and slopes by the ray's parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    pub value: Span,
    pub slope: Span,
}

impl Range {
    pub fn still(x: f64) -> Range {
        Range { value: Span::point(x), slope: Span::point(0.0) }
    }

    fn add(self, b: Range) -> Range {
        Range { value: self.value.add(b.value), slope: self.slope.add(b.slope) }
    }

    pub fn sub(self, b: Range) -> Range {
        self.add(b.scale(-1.0))
    }

    fn mul(self, b: Range) -> Range {
        let slope = self.slope.mul(b.value).add(self.value.mul(b.slope));
        Range { value: self.value.mul(b.value), slope }
    }

    pub fn scale(self, k: f64) -> Range {
        Range { value: self.value.mul(Span::point(k)), slope: self.slope.mul(Span::point(k)) }
    }

    /// A function's values, and its derivative's.
    fn chain(self, value: Span, derivative: Span) -> Range {
        Range { value, slope: derivative.mul(self.slope) }
    }

    fn inverse(self) -> Result<Range> {
        let value = self.value.inverse()?;
        Ok(self.chain(value, value.mul(value).mul(Span::point(-1.0))))
    }

    fn min(self, b: Range) -> Range {
        if self.value.hi <= b.value.lo {
            self
        } else if b.value.hi <= self.value.lo {
            b
        } else {
            let value = Span { lo: self.value.lo.min(b.value.lo), hi: self.value.hi.min(b.value.hi) };
            Range { value, slope: self.slope.hull(b.slope) }
        }
    }

    fn max(self, b: Range) -> Range {
        self.scale(-1.0).min(b.scale(-1.0)).scale(-1.0)
    }

    pub fn clamp(self, low: f64, high: f64) -> Range {
        self.max(Range::still(low)).min(Range::still(high))
    }

    fn abs(self) -> Range {
        self.max(self.scale(-1.0))
    }

    fn sqrt(self) -> Result<Range> {
        let value = self.value.above(f64::MIN_POSITIVE)?.monotone(f64::sqrt);
        Ok(self.chain(value, value.mul(Span::point(2.0)).inverse()?))
    }

    fn exp(self) -> Range {
        let value = self.value.monotone(f64::exp);
        self.chain(value, value)
    }

    fn log(self) -> Result<Range> {
        Ok(self.chain(self.value.above(f64::MIN_POSITIVE)?.monotone(f64::ln), self.value.inverse()?))
    }

    /// What a function that moves in steps gives to all of it.
    fn step(self, f: fn(f64) -> f64) -> Result<f64> {
        let (low, high) = (f(self.value.lo), f(self.value.hi));
        if low == high { Ok(low) } else { Err(RunError::Undecided) }
    }
}

pub fn datum<'m>(ranges: Vec<Range>) -> Datum<'m> {
    Datum::Moving(ranges.into())
}

pub fn is_moving(d: &Datum) -> bool {
    matches!(d, Datum::Moving(_))
}

/// Components of a number or a vector, moving or not.
pub fn ranges(d: &Datum) -> Result<Rc<[Range]>> {
    Ok(match d {
        Datum::Moving(ranges) => ranges.clone(),
        other => other.floats()?.slice().iter().map(|x| Range::still(*x)).collect(),
    })
}

/// Component by component; a number meets every component.
fn zip(a: &[Range], b: &[Range], f: impl Fn(Range, Range) -> Result<Range>) -> Result<Vec<Range>> {
    let n = a.len().max(b.len());
    (0..n).map(|i| f(a[i.min(a.len() - 1)], b[i.min(b.len() - 1)])).collect()
}

fn unsupported<T>(what: &str) -> Result<T> {
    Err(RunError::Unsupported(format!("ranges of `{what}`")))
}

pub fn negate<'m>(a: &[Range]) -> Datum<'m> {
    datum(a.iter().map(|x| x.scale(-1.0)).collect())
}

/// An operator with a moving operand.
pub fn binary<'m>(op: BinaryOp, a: &Datum<'m>, b: &Datum<'m>) -> Result<Datum<'m>> {
    if let (BinaryOp::Mul, Datum::Mat(columns)) = (op, a) {
        let weights = ranges(b)?;
        let size = columns[0].len();
        let row = |r: usize| {
            let terms = columns.iter().zip(weights.iter()).map(|(c, w)| w.scale(c.slice()[r]));
            terms.reduce(Range::add).unwrap_or(Range::still(0.0))
        };
        return Ok(datum((0..size).map(row).collect()));
    }
    let (a, b) = (ranges(a)?, ranges(b)?);
    Ok(datum(zip(&a, &b, |x, y| match op {
        BinaryOp::Add => Ok(x.add(y)),
        BinaryOp::Sub => Ok(x.sub(y)),
        BinaryOp::Mul => Ok(x.mul(y)),
        BinaryOp::Div => Ok(x.mul(y.inverse()?)),
        BinaryOp::Rem => Ok(x.sub(y.scale(x.mul(y.inverse()?).step(f64::trunc)?))),
        other => unsupported(&format!("{other:?}")),
    })?))
}

/// A comparison that all of both answer alike.
pub fn compare(op: BinaryOp, a: &Datum, b: &Datum) -> Result<bool> {
    let (a, b) = (ranges(a)?[0].value, ranges(b)?[0].value);
    let less = |a: Span, b: Span| match (a.hi < b.lo, a.lo >= b.hi) {
        (true, _) => Ok(true),
        (_, true) => Ok(false),
        _ => Err(RunError::Undecided),
    };
    match op {
        BinaryOp::Lt => less(a, b),
        BinaryOp::Gt => less(b, a),
        BinaryOp::Ge => less(a, b).map(|x| !x),
        _ => less(b, a).map(|x| !x),
    }
}

pub fn equal(a: &Datum, b: &Datum) -> Result<bool> {
    let (a, b) = (ranges(a)?, ranges(b)?);
    let apart = a.iter().zip(b.iter()).any(|(x, y)| x.value.hi < y.value.lo || y.value.hi < x.value.lo);
    if apart { Ok(false) } else { Err(RunError::Undecided) }
}

/// A built-in with a moving argument.
pub fn call<'m>(b: Builtin, args: &[Datum<'m>]) -> Result<Datum<'m>> {
    if let Shape::VectorOf(n) = b.shape() {
        let mut all = Vec::new();
        for arg in args {
            all.extend_from_slice(&ranges(arg)?);
        }
        return Ok(datum(if all.len() == 1 { vec![all[0]; n as usize] } else { all }));
    }
    let a: Vec<Rc<[Range]>> = args.iter().map(ranges).collect::<Result<_>>()?;
    let whole = |f: fn(f64) -> f64| a[0][0].step(f);
    Ok(match b {
        Builtin::ToF32 => args[0].clone(),
        Builtin::ToI32 => Datum::I32(whole(f64::trunc)? as i32),
        Builtin::ToU32 => Datum::U32(whole(f64::trunc)? as u32),
        Builtin::Dot => datum(vec![dot(&a[0], &a[1])]),
        Builtin::Length => datum(vec![length(&a[0])?]),
        Builtin::Distance => datum(vec![length(&zip(&a[0], &a[1], |x, y| Ok(x.sub(y)))?)?]),
        Builtin::Normalize => {
            let by = length(&a[0])?.inverse()?;
            datum(a[0].iter().map(|x| x.mul(by)).collect())
        }
        _ => {
            let n = a.iter().map(|a| a.len()).max().unwrap_or(0);
            let one = |i: usize| {
                let all: Vec<Range> = a.iter().map(|a| a[i.min(a.len() - 1)]).collect();
                component(b, &all)
            };
            datum((0..n).map(one).collect::<Result<_>>()?)
        }
    })
}

fn dot(a: &[Range], b: &[Range]) -> Range {
    a.iter().zip(b).map(|(x, y)| x.mul(*y)).reduce(Range::add).unwrap_or(Range::still(0.0))
}

fn length(a: &[Range]) -> Result<Range> {
    match a {
        [one] => Ok(one.abs()),
        _ => dot(a, a).sqrt(),
    }
}

/// What works on each component.
fn component(b: Builtin, v: &[Range]) -> Result<Range> {
    let x = v[0];
    let still = Range::still;
    Ok(match (b, v) {
        (Builtin::Abs, _) => x.abs(),
        (Builtin::Min, [a, b]) => a.min(*b),
        (Builtin::Max, [a, b]) => a.max(*b),
        (Builtin::Clamp, [x, low, high]) => x.max(*low).min(*high),
        (Builtin::Saturate, _) => x.clamp(0.0, 1.0),
        (Builtin::Mix, [a, b, t]) => a.mul(still(1.0).sub(*t)).add(b.mul(*t)),
        (Builtin::Fma, [a, b, c]) => a.mul(*b).add(*c),
        (Builtin::Smoothstep, [low, high, x]) => {
            let t = x.sub(*low).mul(high.sub(*low).inverse()?).clamp(0.0, 1.0);
            t.mul(t).mul(still(3.0).sub(t.scale(2.0)))
        }
        (Builtin::Step, [edge, x]) => {
            let below = compare(BinaryOp::Lt, &datum(vec![*x]), &datum(vec![*edge]))?;
            still(if below { 0.0 } else { 1.0 })
        }
        (Builtin::Floor, _) => still(x.step(f64::floor)?),
        (Builtin::Ceil, _) => still(x.step(f64::ceil)?),
        (Builtin::Trunc, _) => still(x.step(f64::trunc)?),
        (Builtin::Round, _) => still(x.step(f64::round_ties_even)?),
        (Builtin::Sign, _) => still(x.step(|x| if x == 0.0 { 0.0 } else { x.signum() })?),
        (Builtin::Fract, _) => x.sub(still(x.step(f64::floor)?)),
        (Builtin::Degrees, _) => x.scale(180.0 / std::f64::consts::PI),
        (Builtin::Radians, _) => x.scale(std::f64::consts::PI / 180.0),
        (Builtin::Sqrt, _) => x.sqrt()?,
        (Builtin::InverseSqrt, _) => x.sqrt()?.inverse()?,
        (Builtin::Exp, _) => x.exp(),
        (Builtin::Exp2, _) => x.scale(std::f64::consts::LN_2).exp(),
        (Builtin::Log, _) => x.log()?,
        (Builtin::Log2, _) => x.log()?.scale(std::f64::consts::LOG2_E),
        (Builtin::Pow, [x, y]) => y.mul(x.log()?).exp(),
        (Builtin::Sin, _) => x.chain(x.value.sin(), x.value.cos()),
        (Builtin::Cos, _) => x.chain(x.value.cos(), x.value.sin().mul(Span::point(-1.0))),
        (Builtin::Atan, _) => {
            let square = x.value.mul(x.value).hull(Span::point(0.0)).above(-1.0)?;
            let square = Span { lo: square.lo.max(0.0), ..square };
            x.chain(x.value.monotone(f64::atan), square.add(Span::point(1.0)).inverse()?)
        }
        (Builtin::Tanh, _) => {
            let value = x.value.monotone(f64::tanh);
            x.chain(value, Span { lo: 0.0, hi: 1.0 })
        }
        _ => return unsupported(b.name()),
    })
}
