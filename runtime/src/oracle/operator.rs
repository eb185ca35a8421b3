//! The operators of expressions on scalars, vectors and matrices.

use std::rc::Rc;

use ghyll_compiler::core::Prim;
use ghyll_compiler::typed::{BinaryOp, UnaryOp};

use super::datum::{Components, Datum, Floats, Ints};
use super::float::Precision;
use super::integer::{binary_i32, binary_u32};
use super::{dual, moving};
use crate::error::RunError;

pub fn unary<'m>(op: UnaryOp, a: &Datum<'m>) -> Result<Datum<'m>, RunError> {
    if a.level() > 0 {
        return a.linear(|d| unary(op, d));
    }
    Ok(match (op, a) {
        (UnaryOp::Neg, Datum::Moving(ranges)) => moving::negate(ranges),
        (UnaryOp::Neg, Datum::I32(i)) => Datum::I32(i.wrapping_neg()),
        (UnaryOp::Neg, Datum::F32(x)) => Datum::F32(-x),
        (UnaryOp::Neg, Datum::Vec(v)) => Datum::Vec(v.map(|x| -x)),
        (UnaryOp::Neg, Datum::IVec(v)) => Datum::IVec(v.map(i32::wrapping_neg)),
        (UnaryOp::Neg, Datum::Mat(columns)) => Datum::Mat(columns.iter().map(|c| c.map(|x| -x)).collect()),
        (UnaryOp::Not, Datum::Bool(b)) => Datum::Bool(!b),
        (UnaryOp::Not, Datum::I32(i)) => Datum::I32(!i),
        (UnaryOp::Not, Datum::U32(u)) => Datum::U32(!u),
        (UnaryOp::Not, Datum::IVec(v)) => Datum::IVec(v.map(|i| !i)),
        _ => return Err(RunError::Internal(format!("the operator {op:?} has an operand of the wrong type"))),
    })
}

pub fn binary<'m>(p: Precision, op: BinaryOp, a: &Datum<'m>, b: &Datum<'m>) -> Result<Datum<'m>, RunError> {
    let moves = moving::is_moving(a) || moving::is_moving(b);
    match op {
        BinaryOp::Eq => return a.equal(b).map(Datum::Bool),
        BinaryOp::Ne => return a.equal(b).map(|same| Datum::Bool(!same)),
        BinaryOp::Lt | BinaryOp::Le | BinaryOp::Gt | BinaryOp::Ge if moves => {
            return moving::compare(op, a, b).map(Datum::Bool);
        }
        BinaryOp::Lt | BinaryOp::Le | BinaryOp::Gt | BinaryOp::Ge => {
            return compare(op, a.plain(), b.plain());
        }
        _ if a.level().max(b.level()) > 0 => return dual::binary(p, op, a, b),
        _ if moves => return moving::binary(op, a, b),
        _ => {}
    }
    let result = match (a, b) {
        (Datum::Bool(a), Datum::Bool(b)) => logic(op, *a, *b).map(Datum::Bool),
        (Datum::I32(a), Datum::I32(b)) => binary_i32(op, *a, *b).map(Datum::I32),
        (Datum::U32(a), Datum::U32(b)) => binary_u32(op, *a, *b).map(Datum::U32),
        (Datum::IVec(a), Datum::IVec(b)) => integers(op, *a, *b),
        (Datum::IVec(a), Datum::I32(b)) => integers(op, *a, Components::splat(*b, a.len())),
        (Datum::I32(a), Datum::IVec(b)) => integers(op, Components::splat(*a, b.len()), *b),
        (Datum::Mat(_), _) | (_, Datum::Mat(_)) => matrices(p, op, a, b),
        (Datum::F32(a), Datum::F32(b)) => float_prim(op).map(|prim| Datum::F32(p.binary(prim, *a, *b))),
        (Datum::Vec(a), Datum::Vec(b)) => floats(p, op, *a, *b),
        (Datum::Vec(a), Datum::F32(b)) => floats(p, op, *a, Components::splat(*b, a.len())),
        (Datum::F32(a), Datum::Vec(b)) => floats(p, op, Components::splat(*a, b.len()), *b),
        _ => None,
    };
    result.ok_or_else(|| RunError::Internal(format!("the operator {op:?} has operands of the wrong types")))
}

/// `+` of a `sum`: aggregates are added part by part.
pub fn add<'m>(p: Precision, a: &Datum<'m>, b: &Datum<'m>) -> Result<Datum<'m>, RunError> {
    match (a, b) {
        (Datum::Fields(x), Datum::Fields(y)) => {
            let sums = x.iter().zip(y.iter()).map(|(a, b)| add(p, a, b)).collect::<Result<Rc<_>, _>>();
            sums.map(Datum::Fields)
        }
        _ => binary(p, BinaryOp::Add, a, b),
    }
}

fn logic(op: BinaryOp, a: bool, b: bool) -> Option<bool> {
    match op {
        BinaryOp::BitAnd => Some(a & b),
        BinaryOp::BitOr => Some(a | b),
        BinaryOp::BitXor => Some(a ^ b),
        _ => None,
    }
}

fn compare<'m>(op: BinaryOp, a: &Datum<'m>, b: &Datum<'m>) -> Result<Datum<'m>, RunError> {
    fn holds<T: PartialOrd>(op: BinaryOp, a: T, b: T) -> bool {
        match op {
            BinaryOp::Lt => a < b,
            BinaryOp::Le => a <= b,
            BinaryOp::Gt => a > b,
            _ => a >= b,
        }
    }
    match (a, b) {
        (Datum::I32(a), Datum::I32(b)) => Ok(Datum::Bool(holds(op, a, b))),
        (Datum::U32(a), Datum::U32(b)) => Ok(Datum::Bool(holds(op, a, b))),
        _ => Ok(Datum::Bool(holds(op, a.f32()?, b.f32()?))),
    }
}

fn float_prim(op: BinaryOp) -> Option<Prim> {
    match op {
        BinaryOp::Add => Some(Prim::Add),
        BinaryOp::Sub => Some(Prim::Sub),
        BinaryOp::Mul => Some(Prim::Mul),
        BinaryOp::Div => Some(Prim::Div),
        BinaryOp::Rem => Some(Prim::Rem),
        _ => None,
    }
}

fn floats<'m>(p: Precision, op: BinaryOp, a: Floats, b: Floats) -> Option<Datum<'m>> {
    float_prim(op).map(|prim| Datum::Vec(a.zip(b, |x, y| p.binary(prim, x, y))))
}

fn integers<'m>(op: BinaryOp, a: Ints, b: Ints) -> Option<Datum<'m>> {
    binary_i32(op, 1, 1)?;
    Some(Datum::IVec(a.zip(b, |x, y| binary_i32(op, x, y).unwrap_or(0))))
}

/// At least one operand is a matrix.
fn matrices<'m>(p: Precision, op: BinaryOp, a: &Datum<'m>, b: &Datum<'m>) -> Option<Datum<'m>> {
    let columns = |columns: Vec<Floats>| Some(Datum::Mat(columns.into()));
    match (op, a, b) {
        (BinaryOp::Mul, Datum::Mat(m), Datum::Vec(v)) => Some(Datum::Vec(times_vector(p, m, *v))),
        (BinaryOp::Mul, Datum::Vec(v), Datum::Mat(m)) => {
            let dots: Vec<f64> = m.iter().map(|c| p.dot(*v, *c)).collect();
            Some(Datum::vec(&dots))
        }
        (BinaryOp::Mul, Datum::Mat(m), Datum::Mat(n)) => {
            columns(n.iter().map(|c| times_vector(p, m, *c)).collect())
        }
        (BinaryOp::Mul, Datum::Mat(m), Datum::F32(k)) | (BinaryOp::Mul, Datum::F32(k), Datum::Mat(m)) => {
            columns(m.iter().map(|c| p.scale(*c, *k)).collect())
        }
        (BinaryOp::Add | BinaryOp::Sub, Datum::Mat(m), Datum::Mat(n)) => {
            let prim = float_prim(op)?;
            columns(m.iter().zip(n.iter()).map(|(a, b)| a.zip(*b, |x, y| p.binary(prim, x, y))).collect())
        }
        _ => None,
    }
}

/// Columns weighted by the vector's components, added from the first on.
fn times_vector(p: Precision, columns: &[Floats], v: Floats) -> Floats {
    let weighted = columns.iter().zip(v.slice()).map(|(c, k)| p.scale(*c, *k));
    weighted.reduce(|sum, c| sum.zip(c, |x, y| p.add(x, y))).unwrap_or(v)
}
