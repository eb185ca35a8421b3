//! Built-in mathematics, by WGSL's definitions.

use std::rc::Rc;

use ghyll_compiler::builtins::{Builtin, Shape};
use ghyll_compiler::core::Prim;

use super::datum::{Components, Datum, Floats, Ints};
use super::float::Precision;
use super::integer::{builtin_i32, builtin_u32};
use super::{dual, moving};
use crate::error::RunError;

/// The value of a built-in of mathematics; none if it is a built-in of another kind.
pub fn apply<'m>(p: Precision, b: Builtin, args: &[Datum<'m>]) -> Result<Option<Datum<'m>>, RunError> {
    if b.shape() != Shape::Select && dual::highest(args) > 0 {
        return dual::call(p, b, args);
    }
    if !matches!(b.shape(), Shape::Select | Shape::Fixed(_)) && args.iter().any(moving::is_moving) {
        return moving::call(b, args).map(Some);
    }
    Ok(Some(match b.shape() {
        Shape::Float(_) | Shape::Number(_) | Shape::Integer(_) => componentwise(p, b, args)?,
        Shape::Bits(_) => bits(b, args)?,
        Shape::Mix => mix(p, args)?,
        Shape::Select => if args[2].bool()? { &args[1] } else { &args[0] }.clone(),
        Shape::Measure(_) | Shape::Vector(_) | Shape::Refract | Shape::Cross => geometry(p, b, args)?,
        Shape::Matrix => Datum::Mat(transpose(args[0].columns()?).into()),
        Shape::Determinant => Datum::F32(determinant(p, args[0].columns()?)),
        Shape::Convert => convert(p, b, &args[0])?,
        Shape::Bitcast => bitcast(b, &args[0])?,
        Shape::VectorOf(n) => Datum::Vec(match args {
            [Datum::IVec(v)] => v.convert(|i| p.round(f64::from(i))),
            _ => gather(args, n as usize, Datum::floats)?,
        }),
        Shape::IVectorOf(n) => Datum::IVec(match args {
            [Datum::Vec(v)] => v.convert(|x| x as i32),
            _ => gather(args, n as usize, ints)?,
        }),
        Shape::MatrixOf(n) => matrix(args, n as usize)?,
        Shape::Fixed(_) => return Ok(None),
    }))
}

fn wrong(b: Builtin) -> RunError {
    RunError::Internal(format!("`{}` has arguments of the wrong types", b.name()))
}

fn componentwise<'m>(p: Precision, b: Builtin, args: &[Datum<'m>]) -> Result<Datum<'m>, RunError> {
    match &args[0] {
        Datum::I32(_) => {
            let mut operands = [0; 3];
            for (to, from) in operands.iter_mut().zip(args) {
                *to = from.i32()?;
            }
            builtin_i32(b, operands).map(Datum::I32).ok_or_else(|| wrong(b))
        }
        Datum::U32(_) => {
            let mut operands = [0; 3];
            for (to, from) in operands.iter_mut().zip(args) {
                let Datum::U32(u) = from else { return Err(wrong(b)) };
                *to = *u;
            }
            builtin_u32(b, operands).map(Datum::U32).ok_or_else(|| wrong(b))
        }
        Datum::IVec(first) => {
            let mut result = Vec::new();
            for i in 0..first.len() {
                let mut operands = [0; 3];
                for (to, from) in operands.iter_mut().zip(args) {
                    *to = *ints(from)?.slice().get(i).ok_or_else(|| wrong(b))?;
                }
                result.push(builtin_i32(b, operands).ok_or_else(|| wrong(b))?);
            }
            Ok(Datum::IVec(Ints::new(&result)))
        }
        first => {
            let n = first.floats()?.len();
            let mut result = Vec::new();
            for i in 0..n {
                let mut operands = [0.0; 3];
                for (to, from) in operands.iter_mut().zip(args) {
                    *to = *from.floats()?.slice().get(i).ok_or_else(|| wrong(b))?;
                }
                result.push(float(p, b, operands).ok_or_else(|| wrong(b))?);
            }
            Ok(float_result(Floats::new(&result), first))
        }
    }
}

/// A scalar where `like` is one.
fn float_result<'m>(v: Floats, like: &Datum<'m>) -> Datum<'m> {
    match like {
        Datum::F32(_) => Datum::F32(v.slice()[0]),
        _ => Datum::Vec(v),
    }
}

/// Built-ins that are one operation of core.
const PRIMITIVE: &[(Builtin, Prim)] = &[
    (Builtin::Sin, Prim::Sin),
    (Builtin::Cos, Prim::Cos),
    (Builtin::Tan, Prim::Tan),
    (Builtin::Asin, Prim::Asin),
    (Builtin::Acos, Prim::Acos),
    (Builtin::Atan, Prim::Atan),
    (Builtin::Sinh, Prim::Sinh),
    (Builtin::Cosh, Prim::Cosh),
    (Builtin::Tanh, Prim::Tanh),
    (Builtin::Asinh, Prim::Asinh),
    (Builtin::Acosh, Prim::Acosh),
    (Builtin::Atanh, Prim::Atanh),
    (Builtin::Exp, Prim::Exp),
    (Builtin::Exp2, Prim::Exp2),
    (Builtin::Log, Prim::Log),
    (Builtin::Log2, Prim::Log2),
    (Builtin::Sqrt, Prim::Sqrt),
    (Builtin::InverseSqrt, Prim::InverseSqrt),
    (Builtin::Floor, Prim::Floor),
    (Builtin::Ceil, Prim::Ceil),
    (Builtin::Round, Prim::Round),
    (Builtin::Fract, Prim::Fract),
    (Builtin::Trunc, Prim::Trunc),
    (Builtin::Abs, Prim::Abs),
    (Builtin::Sign, Prim::Sign),
    (Builtin::Atan2, Prim::Atan2),
    (Builtin::Pow, Prim::Pow),
    (Builtin::Min, Prim::Min),
    (Builtin::Max, Prim::Max),
];

fn float(p: Precision, b: Builtin, [x, y, z]: [f64; 3]) -> Option<f64> {
    let clamp = |x, lo, hi| p.binary(Prim::Min, p.binary(Prim::Max, x, lo), hi);
    if let Some((_, prim)) = PRIMITIVE.iter().find(|(row, _)| *row == b) {
        return Some(match b.shape() {
            Shape::Float(1) | Shape::Number(1) => p.unary(*prim, x),
            _ => p.binary(*prim, x, y),
        });
    }
    Some(match b {
        Builtin::Degrees => p.mul(x, p.round(180.0 / std::f64::consts::PI)),
        Builtin::Radians => p.mul(x, p.round(std::f64::consts::PI / 180.0)),
        Builtin::Saturate => clamp(x, 0.0, 1.0),
        Builtin::Clamp => clamp(x, y, z),
        Builtin::Step => (x <= y) as u32 as f64,
        Builtin::Smoothstep => {
            let t = clamp(p.div(p.sub(z, x), p.sub(y, x)), 0.0, 1.0);
            p.mul(p.mul(t, t), p.sub(3.0, p.mul(2.0, t)))
        }
        Builtin::Fma => p.fma(x, y, z),
        _ => return None,
    })
}

fn mix<'m>(p: Precision, args: &[Datum<'m>]) -> Result<Datum<'m>, RunError> {
    let (a, b) = (args[0].floats()?, args[1].floats()?);
    let t = match &args[2] {
        Datum::F32(t) => Components::splat(*t, a.len()),
        other => other.floats()?,
    };
    let from = a.zip(t, |x, t| p.mul(x, p.sub(1.0, t)));
    let to = b.zip(t, |y, t| p.mul(y, t));
    Ok(float_result(from.zip(to, |x, y| p.add(x, y)), &args[0]))
}

fn geometry<'m>(p: Precision, b: Builtin, args: &[Datum<'m>]) -> Result<Datum<'m>, RunError> {
    let a = args[0].floats()?;
    let length = |v: Floats| match v.len() {
        1 => v.slice()[0].abs(),
        _ => p.unary(Prim::Sqrt, p.dot(v, v)),
    };
    let subtract = |a: Floats, b: Floats| a.zip(b, |x, y| p.sub(x, y));
    Ok(match b {
        Builtin::Dot => Datum::F32(p.dot(a, args[1].floats()?)),
        Builtin::Length => Datum::F32(length(a)),
        Builtin::Distance => Datum::F32(length(subtract(a, args[1].floats()?))),
        Builtin::Normalize => {
            let length = length(a);
            Datum::Vec(a.map(|x| p.div(x, length)))
        }
        Builtin::Reflect => {
            let n = args[1].floats()?;
            let k = p.mul(2.0, p.dot(n, a));
            Datum::Vec(subtract(a, p.scale(n, k)))
        }
        Builtin::FaceForward => {
            let towards = p.dot(args[1].floats()?, args[2].floats()?) < 0.0;
            Datum::Vec(if towards { a } else { a.map(|x| -x) })
        }
        Builtin::Refract => Datum::Vec(refract(p, a, args[1].floats()?, args[2].f32()?)),
        Builtin::Cross => Datum::Vec(cross(p, a, args[1].floats()?)?),
        _ => return Err(wrong(b)),
    })
}

fn refract(p: Precision, i: Floats, n: Floats, eta: f64) -> Floats {
    let d = p.dot(n, i);
    let k = p.sub(1.0, p.mul(p.mul(eta, eta), p.sub(1.0, p.mul(d, d))));
    if k < 0.0 {
        return i.map(|_| 0.0);
    }
    let along = p.add(p.mul(eta, d), p.unary(Prim::Sqrt, k));
    i.zip(n, |i, n| p.sub(p.mul(eta, i), p.mul(along, n)))
}

fn cross(p: Precision, a: Floats, b: Floats) -> Result<Floats, RunError> {
    let (&[ax, ay, az], &[bx, by, bz]) = (a.slice(), b.slice()) else { return Err(wrong(Builtin::Cross)) };
    let minor = |a, b, c, d| p.sub(p.mul(a, b), p.mul(c, d));
    Ok(Floats::new(&[minor(ay, bz, az, by), minor(az, bx, ax, bz), minor(ax, by, ay, bx)]))
}

fn transpose(columns: &[Floats]) -> Vec<Floats> {
    let row = |i: usize| columns.iter().map(|c| c.slice()[i]).collect::<Vec<_>>();
    (0..columns.len()).map(|i| Floats::new(&row(i))).collect()
}

/// Expansion along the first column.
fn determinant(p: Precision, columns: &[Floats]) -> f64 {
    let [first, rest @ ..] = columns else { return 1.0 };
    let term = |i: usize, x: f64| {
        if rest.is_empty() {
            return x;
        }
        let minor: Vec<Floats> = rest.iter().map(|c| without(c, i)).collect();
        p.mul(x, determinant(p, &minor))
    };
    let terms = first.slice().iter().enumerate().map(|(i, x)| (i, term(i, *x)));
    let add = |(_, sum), (i, x)| (i, if i % 2 == 0 { p.add(sum, x) } else { p.sub(sum, x) });
    terms.reduce(add).map_or(1.0, |(_, sum)| sum)
}

fn without(column: &Floats, i: usize) -> Floats {
    let mut items = column.slice().to_vec();
    items.remove(i);
    Floats::new(&items)
}

fn convert<'m>(p: Precision, b: Builtin, a: &Datum<'m>) -> Result<Datum<'m>, RunError> {
    // Saturation, and 0 for NaN, is what `as` does.
    Ok(match (b, a) {
        (Builtin::ToBool, Datum::Bool(_))
        | (Builtin::ToI32, Datum::I32(_))
        | (Builtin::ToU32, Datum::U32(_)) => a.clone(),
        (Builtin::ToBool, Datum::I32(i)) => Datum::Bool(*i != 0),
        (Builtin::ToBool, Datum::U32(u)) => Datum::Bool(*u != 0),
        (Builtin::ToBool, Datum::F32(x)) => Datum::Bool(*x != 0.0),
        (Builtin::ToI32, Datum::Bool(v)) => Datum::I32(*v as i32),
        (Builtin::ToI32, Datum::U32(u)) => Datum::I32(*u as i32),
        (Builtin::ToI32, Datum::F32(x)) => Datum::I32(*x as i32),
        (Builtin::ToU32, Datum::Bool(v)) => Datum::U32(*v as u32),
        (Builtin::ToU32, Datum::I32(i)) => Datum::U32(*i as u32),
        (Builtin::ToU32, Datum::F32(x)) => Datum::U32(*x as u32),
        (Builtin::ToF32, Datum::Bool(v)) => Datum::F32(*v as u32 as f64),
        (Builtin::ToF32, Datum::I32(i)) => Datum::F32(p.round(*i as f64)),
        (Builtin::ToF32, Datum::U32(u)) => Datum::F32(p.round(*u as f64)),
        (Builtin::ToF32, Datum::F32(_)) => a.clone(),
        _ => return Err(wrong(b)),
    })
}

/// By whole numbers wide enough for every shift.
fn bits<'m>(b: Builtin, args: &[Datum<'m>]) -> Result<Datum<'m>, RunError> {
    let word = |a: &Datum| match a {
        Datum::I32(i) => Ok(u64::from(*i as u32)),
        Datum::U32(u) => Ok(u64::from(*u)),
        _ => Err(wrong(b)),
    };
    let (values, [first, count]) = args.split_at(args.len() - 2) else { return Err(wrong(b)) };
    let first = word(first)?.min(32);
    let count = word(count)?.min(32 - first);
    let mask = (1u64 << count) - 1;
    let found = match values {
        [x] => {
            let part = word(x)? >> first & mask;
            let negative = matches!(x, Datum::I32(_)) && count > 0 && part >> (count - 1) & 1 == 1;
            if negative { part | !mask } else { part }
        }
        [x, new] => word(x)? & !(mask << first) | (word(new)? & mask) << first,
        _ => return Err(wrong(b)),
    } as u32;
    Ok(if let Datum::I32(_) = args[0] { Datum::I32(found as i32) } else { Datum::U32(found) })
}

fn bitcast<'m>(b: Builtin, a: &Datum<'m>) -> Result<Datum<'m>, RunError> {
    let bits = match a {
        Datum::I32(i) => *i as u32,
        Datum::U32(u) => *u,
        Datum::F32(x) => (*x as f32).to_bits(),
        _ => return Err(wrong(b)),
    };
    Ok(match b {
        Builtin::BitcastI32 => Datum::I32(bits as i32),
        Builtin::BitcastU32 => Datum::U32(bits),
        _ => Datum::F32(f32::from_bits(bits) as f64),
    })
}

fn ints(a: &Datum) -> Result<Ints, RunError> {
    match a {
        Datum::I32(i) => Ok(Ints::new(&[*i])),
        Datum::IVec(v) => Ok(*v),
        _ => Err(RunError::Internal("an integer vector is made of something else".into())),
    }
}

/// `n` components from scalars and vectors; one scalar fills all.
fn gather<'m, T: Copy + Default>(
    args: &[Datum<'m>],
    n: usize,
    parts: impl Fn(&Datum<'m>) -> Result<Components<T>, RunError>,
) -> Result<Components<T>, RunError> {
    let mut items = Vec::new();
    for arg in args {
        items.extend_from_slice(parts(arg)?.slice());
    }
    match items.as_slice() {
        [one] => Ok(Components::splat(*one, n)),
        all => Ok(Components::new(all)),
    }
}

fn matrix<'m>(args: &[Datum<'m>], n: usize) -> Result<Datum<'m>, RunError> {
    let mut items = Vec::new();
    for arg in args {
        items.extend_from_slice(arg.floats()?.slice());
    }
    let columns: Rc<[Floats]> = items.chunks(n).map(Floats::new).collect();
    Ok(Datum::Mat(columns))
}
