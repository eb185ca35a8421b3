//! What is known of a word whose position runs over a box: a pair of words that enclose it, and what is known of them
//! while the program is compiled.

use crate::core::{Atom, Const, Op, Prim, Scalar, Stmt, Var};
use crate::scalar;
use crate::source::Span;
use smallvec::smallvec;

/// Share of a result by which `+ - *` and conversions are widened: four times the rounding of IEEE, which WGSL asks of
/// them; a fused product is rounded less. What a denormal loses when it is flushed lies below 1e-37.
pub(super) const ROUNDED: f32 = 4.0 / 16_777_216.0;
/// Division and roots: 2.5 units in the last place are allowed; this is eight.
pub(super) const DIVIDED: f32 = 16.0 / 16_777_216.0;
/// Functions that WGSL allows an absolute error of 2^-11, or defines by others: share and absolute part.
pub(super) const LOOSE: f32 = 1e-3;

/// Larger than any number that counts.
const LIMIT: f64 = f32::MAX as f64;

/// Ends as far as they are known to the compiler; a number of which nothing is known is finite all the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range {
    pub lo: f64,
    pub hi: f64,
}

impl Range {
    pub const ANY: Range = Range { lo: -LIMIT, hi: LIMIT };

    pub fn new(lo: f64, hi: f64) -> Range {
        let cut = |x: f64, other: f64| if x.is_nan() { other } else { x.clamp(-LIMIT, LIMIT) };
        Range { lo: cut(lo, -LIMIT), hi: cut(hi, LIMIT) }
    }

    pub fn point(x: f64) -> Range {
        Range::new(x, x)
    }

    pub fn hull(self, other: Range) -> Range {
        Range { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    pub fn is_positive(self) -> bool {
        self.lo > 0.0
    }

    pub fn is_negative(self) -> bool {
        self.hi < 0.0
    }

    pub fn add(self, other: Range) -> Range {
        Range::new(self.lo + other.lo, self.hi + other.hi)
    }

    pub fn neg(self) -> Range {
        Range { lo: -self.hi, hi: -self.lo }
    }

    pub fn corners(self, other: Range, f: impl Fn(f64, f64) -> f64) -> Range {
        let all = [(self.lo, other.lo), (self.lo, other.hi), (self.hi, other.lo), (self.hi, other.hi)];
        let all = all.map(|(a, b)| f(a, b));
        if all.iter().any(|x| x.is_nan()) {
            return Range::ANY;
        }
        Range::new(
            all.into_iter().fold(f64::INFINITY, f64::min),
            all.into_iter().fold(f64::NEG_INFINITY, f64::max),
        )
    }

    pub fn map(self, f: impl Fn(f64) -> f64) -> Range {
        Range::new(f(self.lo), f(self.hi))
    }

    /// Does no integer in it wrap?
    pub fn fits(self, scalar: Scalar) -> bool {
        match scalar {
            Scalar::I32 => self.lo >= f64::from(i32::MIN) && self.hi <= f64::from(i32::MAX),
            Scalar::U32 => self.lo >= 0.0 && self.hi <= f64::from(u32::MAX),
            _ => true,
        }
    }

    /// All values of a scalar.
    pub fn of(scalar: Scalar) -> Range {
        match scalar {
            Scalar::Bool => Range { lo: 0.0, hi: 1.0 },
            Scalar::I32 => Range { lo: f64::from(i32::MIN), hi: f64::from(i32::MAX) },
            Scalar::U32 => Range { lo: 0.0, hi: f64::from(u32::MAX) },
            Scalar::F32 => Range::ANY,
        }
    }
}

/// Why a bound is missing.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Reason {
    /// What has no bound, as in "`1 / x` has no bound where x may be 0".
    pub what: &'static str,
    pub mend: &'static str,
    /// The function that it stands in.
    pub place: Option<Span>,
}

/// A word that moves. A side that is none has no bound.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Interval {
    pub lo: Option<Atom>,
    pub hi: Option<Atom>,
    pub range: Range,
    /// Why a side is missing.
    pub why: Option<Reason>,
}

impl Interval {
    pub fn new(lo: Atom, hi: Atom, range: Range) -> Interval {
        Interval { lo: Some(lo), hi: Some(hi), range, why: None }
    }

    /// A value that stands still.
    pub fn point(atom: Atom, range: Range) -> Interval {
        Interval::new(atom, atom, range)
    }

    /// The value, if it stands still.
    pub fn still(&self) -> Option<Atom> {
        self.lo.filter(|lo| self.hi == Some(*lo))
    }

    pub fn both(&self) -> Option<(Atom, Atom)> {
        self.lo.zip(self.hi)
    }

    pub fn endless(why: Option<Reason>) -> Interval {
        Interval { lo: None, hi: None, range: Range::ANY, why }
    }

    /// The reason for what is missing in one of these.
    pub fn why(of: &[&Interval]) -> Option<Reason> {
        of.iter().find_map(|i| i.why.clone())
    }

    /// With sides that may be missing.
    pub fn sides(lo: Option<Atom>, hi: Option<Atom>, range: Range, from: &[&Interval]) -> Interval {
        let why = if lo.is_none() || hi.is_none() { Interval::why(from) } else { None };
        Interval { lo, hi, range, why }
    }
}

/// Range of a constant.
pub(super) fn known(atom: Atom) -> Option<f64> {
    match atom {
        Atom::Const(Const::F32(bits)) => Some(f64::from(f32::from_bits(bits))),
        Atom::Const(Const::I32(i)) => Some(f64::from(i)),
        Atom::Const(Const::U32(u)) => Some(f64::from(u)),
        _ => None,
    }
}

pub(super) fn number(x: f32) -> Atom {
    Atom::Const(Const::f32(x))
}

pub(super) fn flag(b: bool) -> Atom {
    Atom::Const(Const::Bool(b))
}

/// Least and greatest value, as constants.
pub(super) fn extremes(scalar: Scalar) -> (Atom, Atom) {
    let (lo, hi) = match scalar {
        Scalar::Bool => (Const::Bool(false), Const::Bool(true)),
        Scalar::I32 => (Const::I32(i32::MIN), Const::I32(i32::MAX)),
        Scalar::U32 => (Const::U32(0), Const::U32(u32::MAX)),
        Scalar::F32 => (Const::f32(f32::MIN), Const::f32(f32::MAX)),
    };
    (Atom::Const(lo), Atom::Const(hi))
}

/// Writes statements; what is known now becomes a constant.
pub(super) struct Emit<'a> {
    pub vars: &'a mut Vec<Scalar>,
    pub out: &'a mut Vec<Stmt>,
    /// Conditions under which the function may jump inside of the box.
    pub jumps: Vec<Atom>,
    /// The function that is being read.
    pub place: Option<Span>,
}

impl Emit<'_> {
    pub fn fresh(&mut self, scalar: Scalar) -> Var {
        self.vars.push(scalar);
        Var(self.vars.len() as u32 - 1)
    }

    pub fn op(&mut self, prim: Prim, on: Scalar, args: &[Atom]) -> Atom {
        let constant = |a: &Atom| match a {
            Atom::Const(c) => Some(*c),
            Atom::Var(_) => None,
        };
        if let Some(constants) = args.iter().map(constant).collect::<Option<Vec<_>>>() {
            return Atom::Const(scalar::eval(prim, on, &constants));
        }
        if let Some(known) = shortcut(prim, on, args) {
            return known;
        }
        let dst = self.fresh(prim.result(on));
        self.out.push(Stmt { dst: smallvec![dst], op: Op::Prim(prim, on, args.into()) });
        Atom::Var(dst)
    }

    pub fn float(&mut self, prim: Prim, args: &[Atom]) -> Atom {
        self.op(prim, Scalar::F32, args)
    }

    pub fn not(&mut self, a: Atom) -> Atom {
        self.op(Prim::Not, Scalar::Bool, &[a])
    }

    pub fn and(&mut self, a: Atom, b: Atom) -> Atom {
        self.op(Prim::And, Scalar::Bool, &[a, b])
    }

    pub fn or(&mut self, a: Atom, b: Atom) -> Atom {
        self.op(Prim::Or, Scalar::Bool, &[a, b])
    }

    /// The lesser, or the greater; of truth values `and`, `or`.
    pub fn outer(&mut self, greater: bool, on: Scalar, a: Atom, b: Atom) -> Atom {
        match (on, greater) {
            _ if a == b => a,
            (Scalar::Bool, false) => self.and(a, b),
            (Scalar::Bool, true) => self.or(a, b),
            (_, false) => self.op(Prim::Min, on, &[a, b]),
            (_, true) => self.op(Prim::Max, on, &[a, b]),
        }
    }

    pub fn hull(&mut self, on: Scalar, a: &Interval, b: &Interval) -> Interval {
        let lo = a.lo.zip(b.lo).map(|(x, y)| self.outer(false, on, x, y));
        let hi = a.hi.zip(b.hi).map(|(x, y)| self.outer(true, on, x, y));
        Interval::sides(lo, hi, a.range.hull(b.range), &[a, b])
    }

    /// Outwards by a share of the size and an absolute part.
    pub fn widen(&mut self, i: Interval, share: f32, part: f32) -> Interval {
        let lo = i.lo.map(|lo| self.moved(lo, -share, -part, i.range));
        let hi = i.hi.map(|hi| self.moved(hi, share, part, i.range));
        Interval { lo, hi, ..i }
    }

    fn moved(&mut self, end: Atom, share: f32, part: f32, range: Range) -> Atom {
        let mut end = match (range.lo >= 0.0, range.hi <= 0.0) {
            _ if share == 0.0 => end,
            (true, _) => self.float(Prim::Mul, &[end, number(1.0 + share)]),
            (_, true) => self.float(Prim::Mul, &[end, number(1.0 - share)]),
            _ => {
                let size = self.float(Prim::Abs, &[end]);
                let by = self.float(Prim::Mul, &[size, number(share)]);
                self.float(Prim::Add, &[end, by])
            }
        };
        if part != 0.0 {
            end = self.float(Prim::Add, &[end, number(part)]);
        }
        end
    }

    pub fn rounded(&mut self, i: Interval) -> Interval {
        self.widen(i, ROUNDED, 0.0)
    }

    pub fn endless(&self, what: &'static str, mend: &'static str) -> Interval {
        Interval::endless(Some(Reason { what, mend, place: self.place }))
    }

    /// The result steps where this holds.
    pub fn jump_where_apart(&mut self, on: Scalar, i: &Interval) {
        let apart = match i.both() {
            Some((lo, hi)) if lo == hi => return,
            Some((lo, hi)) => self.op(Prim::Ne, on, &[lo, hi]),
            None => flag(true),
        };
        self.jumps.push(apart);
    }

    /// Middle and half width.
    pub fn middle(&mut self, i: &Interval) -> Option<(Atom, Atom)> {
        let (lo, hi) = i.both()?;
        let sum = self.float(Prim::Add, &[lo, hi]);
        let middle = self.float(Prim::Mul, &[sum, number(0.5)]);
        let right = self.float(Prim::Sub, &[hi, middle]);
        let left = self.float(Prim::Sub, &[middle, lo]);
        let half = self.float(Prim::Max, &[left, right]);
        Some((middle, self.float(Prim::Mul, &[half, number(1.0 + ROUNDED)])))
    }
}

/// Operations with a constant that leaves the other operand, or decides.
fn shortcut(prim: Prim, on: Scalar, args: &[Atom]) -> Option<Atom> {
    match (prim, on, args) {
        (Prim::And, Scalar::Bool, [Atom::Const(Const::Bool(b)), x] | [x, Atom::Const(Const::Bool(b))]) => {
            Some(if *b { *x } else { flag(false) })
        }
        (Prim::Or, Scalar::Bool, [Atom::Const(Const::Bool(b)), x] | [x, Atom::Const(Const::Bool(b))]) => {
            Some(if *b { flag(true) } else { *x })
        }
        (Prim::Select, _, [no, yes, Atom::Const(Const::Bool(b))]) => Some(if *b { *yes } else { *no }),
        (Prim::Select, _, [no, yes, _]) if no == yes => Some(*no),
        (Prim::Mul, Scalar::F32, [a, b]) if *b == number(1.0) => Some(*a),
        (Prim::Mul, Scalar::F32, [a, b]) if *a == number(1.0) => Some(*b),
        _ => None,
    }
}
