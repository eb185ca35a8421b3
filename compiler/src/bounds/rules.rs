//! THE table of enclosures of scalar operations: one row an operation on floats, and below it those on other words.
//!
//! Each row is given intervals of its operands and yields one that holds every result. Rounding is outwards (`ROUNDED`,
//! `DIVIDED`, `LOOSE`); what only chooses, negates or steps is exact.

use super::interval::{DIVIDED, Emit, Interval, LOOSE, ROUNDED, Range, extremes, flag, known, number};
use crate::core::Prim::{self, *};
use crate::core::Scalar::{self, Bool, F32, I32, U32};
use crate::core::{Atom, Const};
use std::f32::consts::{FRAC_PI_2, PI};

pub(super) type Rule = fn(&mut Emit, &[Interval]) -> Interval;
pub(super) type Rules = [(Prim, Rule)];

pub(super) const RULES: &Rules = &[
    (Add, |e, a| add(e, &a[0], &a[1])),
    (Sub, |e, a| {
        let minus = negate(e, &a[1]);
        add(e, &a[0], &minus)
    }),
    (Mul, |e, a| multiply(e, &a[0], &a[1])),
    (Div, |e, a| divide(e, &a[0], &a[1])),
    (Rem, remainder),
    (Neg, |e, a| negate(e, &a[0])),
    (Abs, |e, a| absolute(e, &a[0])),
    (Sign, |e, a| step(e, Sign, &a[0], f64::signum)),
    (Min, |e, a| either(e, false, &a[0], &a[1])),
    (Max, |e, a| either(e, true, &a[0], &a[1])),
    (Floor, |e, a| step(e, Floor, &a[0], f64::floor)),
    (Ceil, |e, a| step(e, Ceil, &a[0], f64::ceil)),
    (Round, |e, a| step(e, Round, &a[0], f64::round_ties_even)),
    (Trunc, |e, a| step(e, Trunc, &a[0], f64::trunc)),
    (Fract, fraction),
    (Sqrt, |e, a| {
        let inside = at_least(e, &a[0], 0.0);
        let root = rising(e, Sqrt, &inside, f64::sqrt);
        e.widen(root, DIVIDED, 0.0)
    }),
    (InverseSqrt, |e, a| {
        if !a[0].range.is_positive() {
            return Interval {
                lo: Some(number(0.0)),
                ..pole(e, "`inverseSqrt` of what may be 0", "max(.., 1e-6)")
            };
        }
        let inside = at_least(e, &a[0], a[0].range.lo * 0.999);
        let root = falling(e, InverseSqrt, &inside, |x| 1.0 / x.sqrt());
        e.widen(root, DIVIDED, 0.0)
    }),
    (Fma, |e, a| {
        let product = multiply(e, &a[0], &a[1]);
        add(e, &product, &a[2])
    }),
    (Sin, |e, a| wave(e, Sin, &a[0])),
    (Cos, |e, a| wave(e, Cos, &a[0])),
    (Tan, |e, a| {
        if a[0].range.lo < -1.5 || a[0].range.hi > 1.5 {
            return pole(e, "`tan` of what may pass a quarter turn", "clamp(.., -1.5, 1.5)");
        }
        loose(e, &a[0], |e, i| rising(e, Tan, i, f64::tan))
    }),
    (Asin, |e, a| {
        let inside = between(e, &a[0], -1.0, 1.0);
        loose(e, &inside, |e, i| rising(e, Asin, i, f64::asin))
    }),
    (Acos, |e, a| {
        let inside = between(e, &a[0], -1.0, 1.0);
        loose(e, &inside, |e, i| falling(e, Acos, i, f64::acos))
    }),
    (Atan, |e, a| {
        let angle = loose(e, &a[0], |e, i| rising(e, Atan, i, f64::atan));
        Interval {
            lo: angle.lo.or(Some(number(-FRAC_PI_2))),
            hi: angle.hi.or(Some(number(FRAC_PI_2))),
            range: Range::new(-1.6, 1.6),
            why: None,
        }
    }),
    (Sinh, |e, a| growing(e, Sinh, &a[0], f64::sinh)),
    (Cosh, |e, a| {
        let size = absolute(e, &a[0]);
        growing(e, Cosh, &size, f64::cosh)
    }),
    (Tanh, |e, a| {
        let found = loose(e, &a[0], |e, i| rising(e, Tanh, i, f64::tanh));
        let inside = Interval {
            lo: found.lo.or(Some(number(-1.0))),
            hi: found.hi.or(Some(number(1.0))),
            range: found.range,
            why: None,
        };
        between(e, &inside, -1.0, 1.0)
    }),
    (Asinh, |e, a| loose(e, &a[0], |e, i| rising(e, Asinh, i, f64::asinh))),
    (Acosh, |e, a| {
        let inside = at_least(e, &a[0], 1.0);
        loose(e, &inside, |e, i| rising(e, Acosh, i, f64::acosh))
    }),
    (Atanh, |e, a| {
        if a[0].range.lo <= -1.0 || a[0].range.hi >= 1.0 {
            return pole(e, "`atanh` of what may reach 1", "clamp(.., -0.999, 0.999)");
        }
        loose(e, &a[0], |e, i| rising(e, Atanh, i, f64::atanh))
    }),
    (Atan2, |_, _| Interval::new(number(-PI - LOOSE), number(PI + LOOSE), Range::new(-3.2, 3.2))),
    (Exp, |e, a| growing(e, Exp, &a[0], f64::exp)),
    (Exp2, |e, a| growing(e, Exp2, &a[0], f64::exp2)),
    (Log, |e, a| logarithm(e, Log, &a[0], f64::ln)),
    (Log2, |e, a| logarithm(e, Log2, &a[0], f64::log2)),
    (Pow, |e, a| power(e, &a[0], &a[1])),
];

/// Encloses an operation of which an operand moves; `twice` tells that both operands are the same word.
pub(super) fn enclose(
    rules: &Rules,
    e: &mut Emit,
    (prim, on): (Prim, Scalar),
    a: &[Interval],
    twice: bool,
) -> Interval {
    match (prim, on) {
        (Mul, F32) if twice => square(e, &a[0]),
        (Select, _) => select(e, on, a),
        (Index, _) => index(e, on, a),
        (Lt | Le, _) => below(e, prim, on, &a[0], &a[1]),
        (Eq | Ne, F32 | I32 | U32) => equal(e, prim, on, &a[0], &a[1]),
        (And | Or, Bool) => {
            let side = |e: &mut Emit, x: Option<Atom>, y: Option<Atom>| match (x, y) {
                (Some(x), Some(y)) => e.op(prim, Bool, &[x, y]),
                _ => unreachable!("truth values have both ends"),
            };
            let (lo, hi) = (side(e, a[0].lo, a[1].lo), side(e, a[0].hi, a[1].hi));
            Interval::new(lo, hi, Range::of(Bool))
        }
        (Not, Bool) => {
            let (lo, hi) = a[0].both().unwrap_or((flag(false), flag(true)));
            Interval::new(e.not(hi), e.not(lo), Range::of(Bool))
        }
        (ToF32 | ToI32 | ToU32, _) if on != prim.result(on) => convert(e, prim, on, &a[0]),
        (_, F32) => match rules.iter().find(|(row, _)| *row == prim) {
            Some((_, rule)) => rule(e, a),
            None => points(e, prim, on, a),
        },
        (_, I32 | U32) => integer(e, prim, on, a),
        (_, Bool) => points(e, prim, on, a),
    }
}

fn pole(e: &Emit, what: &'static str, mend: &'static str) -> Interval {
    e.endless(what, mend)
}

fn negate(e: &mut Emit, a: &Interval) -> Interval {
    let mut turn = |x: Atom| e.float(Neg, &[x]);
    let (lo, hi) = (a.hi.map(&mut turn), a.lo.map(&mut turn));
    Interval::sides(lo, hi, a.range.neg(), &[a])
}

fn add(e: &mut Emit, a: &Interval, b: &Interval) -> Interval {
    let lo = a.lo.zip(b.lo).map(|(x, y)| e.float(Add, &[x, y]));
    let hi = a.hi.zip(b.hi).map(|(x, y)| e.float(Add, &[x, y]));
    let sum = Interval::sides(lo, hi, a.range.add(b.range), &[a, b]);
    e.rounded(sum)
}

fn multiply(e: &mut Emit, a: &Interval, b: &Interval) -> Interval {
    if let (Some(x), None) = (a.still(), b.still()) {
        return scale(e, b, x, a.range);
    }
    if let Some(x) = b.still() {
        return scale(e, a, x, b.range);
    }
    let range = a.range.corners(b.range, |x, y| x * y);
    let (Some((a0, a1)), Some((b0, b1))) = (a.both(), b.both()) else {
        if a.range.lo >= 0.0 && b.range.lo >= 0.0 {
            let lo = a.lo.zip(b.lo).map(|(x, y)| e.float(Mul, &[x, y]));
            let hi = a.hi.zip(b.hi).map(|(x, y)| e.float(Mul, &[x, y]));
            let product = Interval::sides(lo, hi, range, &[a, b]);
            return e.rounded(product);
        }
        return Interval::endless(Interval::why(&[a, b]));
    };
    let (lo, hi) = match (a.range.lo >= 0.0, b.range.lo >= 0.0) {
        (true, true) => (e.float(Mul, &[a0, b0]), e.float(Mul, &[a1, b1])),
        (true, false) => reach(e, [(a0, b0), (a1, b0)], [(a0, b1), (a1, b1)]),
        (false, true) => reach(e, [(a0, b0), (a0, b1)], [(a1, b0), (a1, b1)]),
        (false, false) => {
            let all = [(a0, b0), (a0, b1), (a1, b0), (a1, b1)].map(|(x, y)| e.float(Mul, &[x, y]));
            let mut end = |greater| {
                let [left, right] = [[0, 1], [2, 3]].map(|[i, j]| e.outer(greater, F32, all[i], all[j]));
                e.outer(greater, F32, left, right)
            };
            (end(false), end(true))
        }
    };
    let product = Interval::new(lo, hi, range);
    e.rounded(product)
}

/// The least of the first two products and the greatest of the others.
fn reach(e: &mut Emit, low: [(Atom, Atom); 2], high: [(Atom, Atom); 2]) -> (Atom, Atom) {
    let [l0, l1] = low.map(|(x, y)| e.float(Mul, &[x, y]));
    let [h0, h1] = high.map(|(x, y)| e.float(Mul, &[x, y]));
    (e.outer(false, F32, l0, l1), e.outer(true, F32, h0, h1))
}

/// Times a number that stands still.
fn scale(e: &mut Emit, a: &Interval, by: Atom, sign: Range) -> Interval {
    let range = a.range.corners(sign, |x, y| x * y);
    let mut times = |x: Atom| e.float(Mul, &[x, by]);
    let exact = known(by).is_some_and(|x| (x as f32).to_bits() << 9 == 0);
    let product = if sign.lo >= 0.0 || sign.hi <= 0.0 {
        let (lo, hi) = (a.lo.map(&mut times), a.hi.map(&mut times));
        let (lo, hi) = if sign.lo >= 0.0 { (lo, hi) } else { (hi, lo) };
        Interval::sides(lo, hi, range, &[a])
    } else {
        let Some((lo, hi)) = a.both() else { return Interval::endless(a.why.clone()) };
        let (x, y) = (times(lo), times(hi));
        Interval::new(e.outer(false, F32, x, y), e.outer(true, F32, x, y), range)
    };
    if exact { product } else { e.rounded(product) }
}

fn square(e: &mut Emit, a: &Interval) -> Interval {
    let top = a.range.lo.abs().max(a.range.hi.abs());
    let range = Range::new(0.0, top * top);
    let Some((lo, hi)) = a.both() else {
        return Interval { lo: Some(number(0.0)), range, ..Interval::endless(a.why.clone()) };
    };
    // One of the two is 0 where the signs differ, both where 0 lies between.
    let right = e.float(Max, &[lo, number(0.0)]);
    let left = e.float(Min, &[hi, number(0.0)]);
    let [right, left] = [right, left].map(|x| e.float(Mul, &[x, x]));
    let least = e.float(Max, &[right, left]);
    let [low, high] = [lo, hi].map(|x| e.float(Mul, &[x, x]));
    let most = e.float(Max, &[low, high]);
    e.rounded(Interval::new(least, most, range))
}

fn divide(e: &mut Emit, a: &Interval, b: &Interval) -> Interval {
    if let Some(by) = b.still() {
        let exact = known(by).filter(|x| *x != 0.0).map(|x| 1.0 / x);
        let sign = if b.range.lo >= 0.0 || b.range.hi <= 0.0 { b.range } else { Range::ANY };
        let range = match exact {
            Some(inverse) => a.range.corners(Range::point(inverse), |x, y| x * y),
            None if a.range.lo >= 0.0 && b.range.lo >= 0.0 => Range::new(0.0, f64::MAX),
            None => Range::ANY,
        };
        let mut over = |x: Atom| e.float(Div, &[x, by]);
        let quotient = if sign != Range::ANY {
            let (lo, hi) = (a.lo.map(&mut over), a.hi.map(&mut over));
            let (lo, hi) = if sign.lo >= 0.0 { (lo, hi) } else { (hi, lo) };
            Interval::sides(lo, hi, range, &[a])
        } else {
            let Some((lo, hi)) = a.both() else { return Interval::endless(a.why.clone()) };
            let (x, y) = (over(lo), over(hi));
            Interval::new(e.outer(false, F32, x, y), e.outer(true, F32, x, y), range)
        };
        return e.widen(quotient, DIVIDED, 0.0);
    }
    if !b.range.is_positive() && !b.range.is_negative() {
        return pole(e, "a division by what may be 0", "max(.., 1e-3)");
    }
    // The inverse falls on either side of 0; rounding may not bring the divisor there.
    let kept = if b.range.is_positive() {
        at_least(e, b, b.range.lo * 0.999)
    } else {
        let turned = negate(e, b);
        let kept = at_least(e, &turned, -b.range.hi * 0.999);
        negate(e, &kept)
    };
    let mut invert = |x: Atom| e.float(Div, &[number(1.0), x]);
    let (lo, hi) = (kept.hi.map(&mut invert), kept.lo.map(&mut invert));
    let nought = Some(number(0.0));
    let (lo, hi) = if b.range.is_positive() { (lo.or(nought), hi) } else { (lo, hi.or(nought)) };
    let range = Range::new(1.0 / kept.range.hi, 1.0 / kept.range.lo);
    let inverse = Interval::sides(lo, hi, range, &[&kept]);
    let inverse = e.widen(inverse, DIVIDED, 0.0);
    multiply(e, a, &inverse)
}

/// `a - b * trunc(a / b)`: smaller than `b`, of the sign of `a`.
fn remainder(e: &mut Emit, a: &[Interval]) -> Interval {
    e.jumps.push(flag(true));
    let size = absolute(e, &a[1]);
    let Some(most) = size.hi else { return Interval::endless(a[1].why.clone()) };
    let least = if a[0].range.lo >= 0.0 { number(0.0) } else { e.float(Neg, &[most]) };
    let range = Range::new(if a[0].range.lo >= 0.0 { 0.0 } else { -size.range.hi }, size.range.hi);
    Interval::new(least, most, range)
}

fn absolute(e: &mut Emit, a: &Interval) -> Interval {
    if a.range.lo >= 0.0 {
        return a.clone();
    }
    if a.range.hi <= 0.0 {
        return negate(e, a);
    }
    let range = Range::new(0.0, a.range.lo.abs().max(a.range.hi.abs()));
    let turned = negate(e, a);
    // The larger of x and -x, and never below 0.
    let lo = a.lo.zip(turned.lo).map(|(x, y)| e.float(Max, &[x, y]));
    let lo = lo.map_or(number(0.0), |lo| e.float(Max, &[lo, number(0.0)]));
    let hi = a.hi.zip(turned.hi).map(|(x, y)| e.float(Max, &[x, y]));
    Interval::sides(Some(lo), hi, range, &[a])
}

/// The lesser or the greater of both; a side that is missing on one hand may be there on the other.
fn either(e: &mut Emit, greater: bool, a: &Interval, b: &Interval) -> Interval {
    let pick = |e: &mut Emit, x: Option<Atom>, y: Option<Atom>, one_is_enough: bool| match (x, y) {
        (Some(x), Some(y)) => Some(e.outer(greater, F32, x, y)),
        (one, None) | (None, one) if one_is_enough => one,
        _ => None,
    };
    let lo = pick(e, a.lo, b.lo, greater);
    let hi = pick(e, a.hi, b.hi, !greater);
    let range = match greater {
        true => Range { lo: a.range.lo.max(b.range.lo), hi: a.range.hi.max(b.range.hi) },
        false => Range { lo: a.range.lo.min(b.range.lo), hi: a.range.hi.min(b.range.hi) },
    };
    Interval::sides(lo, hi, range, &[a, b])
}

fn at_least(e: &mut Emit, a: &Interval, least: f64) -> Interval {
    let floor = Interval::point(number(least as f32), Range::point(least));
    either(e, true, a, &floor)
}

fn between(e: &mut Emit, a: &Interval, lo: f64, hi: f64) -> Interval {
    let raised = at_least(e, a, lo);
    let top = Interval::point(number(hi as f32), Range::point(hi));
    either(e, false, &raised, &top)
}

fn step(e: &mut Emit, prim: Prim, a: &Interval, f: fn(f64) -> f64) -> Interval {
    let found = rising(e, prim, a, f);
    e.jump_where_apart(F32, &found);
    found
}

fn fraction(e: &mut Emit, a: &[Interval]) -> Interval {
    let whole = Interval::new(number(0.0), number(1.0), Range::new(0.0, 1.0));
    let Some((lo, hi)) = a[0].both() else {
        e.jumps.push(flag(true));
        return whole;
    };
    let [first, last] = [lo, hi].map(|x| e.float(Floor, &[x]));
    let same = e.float(Eq, &[first, last]);
    let apart = e.not(same);
    e.jumps.push(apart);
    let [lo, hi] = [lo, hi].map(|x| e.float(Sub, &[x, first]));
    let part = e.widen(Interval::new(lo, hi, Range::new(0.0, 1.0)), ROUNDED, ROUNDED);
    let (lo, hi) = part.both().unwrap_or((lo, hi));
    let lo = e.float(Select, &[number(0.0), lo, same]);
    let hi = e.float(Select, &[number(1.0), hi, same]);
    Interval::new(lo, hi, whole.range)
}

fn rising(e: &mut Emit, prim: Prim, a: &Interval, f: impl Fn(f64) -> f64) -> Interval {
    let mut at = |x: Atom| e.float(prim, &[x]);
    let (lo, hi) = (a.lo.map(&mut at), a.hi.map(&mut at));
    Interval::sides(lo, hi, a.range.map(f), &[a])
}

fn falling(e: &mut Emit, prim: Prim, a: &Interval, f: impl Fn(f64) -> f64) -> Interval {
    let mut at = |x: Atom| e.float(prim, &[x]);
    let (lo, hi) = (a.hi.map(&mut at), a.lo.map(&mut at));
    Interval::sides(lo, hi, Range::new(f(a.range.hi), f(a.range.lo)), &[a])
}

fn loose(e: &mut Emit, a: &Interval, f: impl Fn(&mut Emit, &Interval) -> Interval) -> Interval {
    let found = f(e, a);
    let found = Interval { range: Range::new(found.range.lo - 1e-2, found.range.hi + 1e-2), ..found };
    let range = found.range;
    let wide = e.widen(Interval { range: Range::ANY, ..found }, LOOSE, LOOSE);
    Interval { range, ..wide }
}

/// Exponentials: of something large they pass every number.
fn growing(e: &mut Emit, prim: Prim, a: &Interval, f: fn(f64) -> f64) -> Interval {
    const MOST: f64 = 80.0;
    let cut = Interval { range: Range::new(a.range.lo.max(-MOST), a.range.hi.min(MOST)), ..a.clone() };
    let found = loose(e, &cut, |e, i| rising(e, prim, i, f));
    let least = if prim == Sinh { None } else { Some(number(0.0)) };
    let (lo, hi) = (found.lo, found.hi.filter(|_| a.range.hi <= MOST));
    let lo = match least {
        Some(least) => Some(lo.map_or(least, |lo| e.float(Max, &[lo, least]))),
        None => lo.filter(|_| a.range.lo >= -MOST),
    };
    let range = Range::new(if least.is_some() { 0.0 } else { found.range.lo }, found.range.hi);
    if lo.is_some() && hi.is_some() {
        return Interval { lo, hi, range, why: None };
    }
    let why = match &a.why {
        Some(why) => Some(why.clone()),
        None => pole(e, "an exponential of what may be large", "min(.., 20.0)").why,
    };
    let hi_range = if hi.is_some() { range.hi } else { f64::MAX };
    Interval { lo, hi, range: Range::new(range.lo, hi_range), why }
}

fn logarithm(e: &mut Emit, prim: Prim, a: &Interval, f: fn(f64) -> f64) -> Interval {
    let positive = a.range.is_positive();
    let inside = at_least(e, a, if positive { a.range.lo * 0.999 } else { 0.0 });
    let found = loose(e, &inside, |e, i| rising(e, prim, i, |x| if x > 0.0 { f(x) } else { -1e4 }));
    if positive {
        return found;
    }
    Interval { lo: None, why: pole(e, "a logarithm of what may be 0", "max(.., 1e-6)").why, ..found }
}

fn power(e: &mut Emit, base: &Interval, by: &Interval) -> Interval {
    // `pow` of a negative base is no number, so only what is not negative counts.
    let positive = base.range.is_positive();
    if !positive && by.range.lo < 0.0 {
        return Interval {
            lo: Some(number(0.0)),
            ..pole(e, "a negative power of what may be 0", "max(.., 1e-3)")
        };
    }
    let least = if positive { base.range.lo * 0.999 } else { 0.0 };
    let base = at_least(e, base, least);
    let (Some((x0, x1)), Some((y0, y1))) = (base.both(), by.both()) else {
        return Interval { lo: Some(number(0.0)), ..Interval::endless(Interval::why(&[&base, by])) };
    };
    // Monotone along each operand, so the corners bound it.
    let all = [(x0, y0), (x0, y1), (x1, y0), (x1, y1)].map(|(x, y)| e.float(Pow, &[x, y]));
    let mut end = |greater| {
        let [left, right] = [[0, 1], [2, 3]].map(|[i, j]| e.outer(greater, F32, all[i], all[j]));
        e.outer(greater, F32, left, right)
    };
    let (lo, hi) = (end(false), end(true));
    let range = base.range.corners(by.range, f64::powf);
    let range = Range::new(range.lo.min(range.hi).max(0.0), range.hi);
    let wide = e.widen(Interval::new(lo, hi, Range::ANY), LOOSE, LOOSE);
    let lo = wide.lo.map(|lo| e.float(Max, &[lo, number(0.0)]));
    Interval { lo, range, ..wide }
}

/// Sine and cosine change by at most as much as the angle does.
fn wave(e: &mut Emit, prim: Prim, a: &Interval) -> Interval {
    let range = Range::new(-1.0, 1.0);
    let all = Interval::new(number(-1.0), number(1.0), range);
    let Some((middle, half)) = e.middle(a) else { return all };
    let value = e.float(prim, &[middle]);
    let size = e.float(Abs, &[middle]);
    let slack = e.float(Mul, &[size, number(ROUNDED)]);
    let slack = e.float(Add, &[slack, number(LOOSE)]);
    let half = e.float(Add, &[half, slack]);
    let lo = e.float(Sub, &[value, half]);
    let hi = e.float(Add, &[value, half]);
    Interval::new(e.float(Max, &[lo, number(-1.0)]), e.float(Min, &[hi, number(1.0)]), range)
}

/// `(no, yes, cond)`.
fn select(e: &mut Emit, on: Scalar, a: &[Interval]) -> Interval {
    let (no, yes, cond) = (&a[0], &a[1], &a[2]);
    let range = no.range.hull(yes.range);
    if let Some(cond) = cond.still() {
        let mut pick = |no: Option<Atom>, yes: Option<Atom>| {
            no.zip(yes).map(|(no, yes)| e.op(Select, on, &[no, yes, cond]))
        };
        let (lo, hi) = (pick(no.lo, yes.lo), pick(no.hi, yes.hi));
        return Interval::sides(lo, hi, range, &[no, yes]);
    }
    let (certain, possible) = cond.both().unwrap_or((flag(false), flag(true)));
    let undecided = e.not(certain);
    let undecided = e.and(possible, undecided);
    e.jumps.push(undecided);
    let both = e.hull(on, no, yes);
    // Where the condition is certain, one side; else what both span.
    let mut pick = |no: Option<Atom>, yes: Option<Atom>, both: Option<Atom>| {
        let both = both?;
        let decided = e.op(Select, on, &[no?, yes?, certain]);
        Some(e.op(Select, on, &[decided, both, undecided]))
    };
    let (lo, hi) = (pick(no.lo, yes.lo, both.lo), pick(no.hi, yes.hi, both.hi));
    Interval { lo, hi, ..both }
}

fn index(e: &mut Emit, on: Scalar, a: &[Interval]) -> Interval {
    let (at, elements) = (&a[0], &a[1..]);
    let mut all = elements[0].clone();
    for element in &elements[1..] {
        all = e.hull(on, &all, element);
    }
    let Some(at) = at.still() else {
        e.jump_where_apart(I32, at);
        return all;
    };
    let mut pick = |side: fn(&Interval) -> Option<Atom>| {
        let ends: Option<Vec<Atom>> = elements.iter().map(side).collect();
        ends.map(|ends| e.op(Index, on, &[&[at], &ends[..]].concat()))
    };
    let (lo, hi) = (pick(|i| i.lo), pick(|i| i.hi));
    Interval { lo, hi, ..all }
}

/// `<` and `<=`: certain, and possible.
fn below(e: &mut Emit, prim: Prim, on: Scalar, a: &Interval, b: &Interval) -> Interval {
    let certain = a.hi.zip(b.lo).map(|(x, y)| e.op(prim, on, &[x, y]));
    let possible = a.lo.zip(b.hi).map(|(x, y)| e.op(prim, on, &[x, y]));
    Interval::new(certain.unwrap_or(flag(false)), possible.unwrap_or(flag(true)), Range::of(Bool))
}

fn equal(e: &mut Emit, prim: Prim, on: Scalar, a: &Interval, b: &Interval) -> Interval {
    let (mut certain, mut possible) = (flag(false), flag(true));
    if let (Some((a0, a1)), Some((b0, b1))) = (a.both(), b.both()) {
        let tests = [(a0, a1), (b0, b1), (a0, b0)].map(|(x, y)| e.op(Eq, on, &[x, y]));
        let points = e.and(tests[0], tests[1]);
        certain = e.and(points, tests[2]);
        let tests = [(a0, b1), (b0, a1)].map(|(x, y)| e.op(Le, on, &[x, y]));
        possible = e.and(tests[0], tests[1]);
    }
    if prim == Ne {
        (certain, possible) = (e.not(possible), e.not(certain));
    }
    Interval::new(certain, possible, Range::of(Bool))
}

fn convert(e: &mut Emit, prim: Prim, from: Scalar, a: &Interval) -> Interval {
    let to = prim.result(from);
    // Integers of the other sign are taken as they are in bits.
    let wraps = matches!((from, to), (I32, U32) | (U32, I32)) && !a.range.fits(to);
    if wraps {
        return points(e, prim, from, std::slice::from_ref(a));
    }
    let ends = extremes(to);
    let mut at = |x: Atom| e.op(prim, from, &[x]);
    let (lo, hi) = (a.lo.map(&mut at), a.hi.map(&mut at));
    let all = Range::of(to);
    let whole = |x: f64| if to == F32 { x } else { x.trunc().clamp(all.lo, all.hi) };
    let range = a.range.map(whole);
    let found = Interval::new(lo.unwrap_or(ends.0), hi.unwrap_or(ends.1), range);
    if to == F32 && from != Bool {
        return e.rounded(found);
    }
    e.jump_where_apart(to, &found);
    found
}

/// Integers: exact while each operand is one value; some rows are wider.
fn integer(e: &mut Emit, prim: Prim, on: Scalar, a: &[Interval]) -> Interval {
    let constant = |i: usize| a.get(i).and_then(Interval::still).and_then(known);
    let (x, y) = (a[0].range, a.get(1).map_or(Range::ANY, |y| y.range));
    match prim {
        Min | Max => {
            let greater = prim == Max;
            let mut side =
                |p: Option<Atom>, q: Option<Atom>| p.zip(q).map(|(p, q)| e.outer(greater, on, p, q));
            let (lo, hi) = (side(a[0].lo, a[1].lo), side(a[0].hi, a[1].hi));
            return Interval::sides(lo, hi, x.hull(y), &[&a[0], &a[1]]);
        }
        Add if x.add(y).fits(on) => {
            let mut side = |p: Option<Atom>, q: Option<Atom>| p.zip(q).map(|(p, q)| e.op(Add, on, &[p, q]));
            let (lo, hi) = (side(a[0].lo, a[1].lo), side(a[0].hi, a[1].hi));
            return Interval::sides(lo, hi, x.add(y), &[&a[0], &a[1]]);
        }
        Sub if x.add(y.neg()).fits(on) => {
            let mut side = |p: Option<Atom>, q: Option<Atom>| p.zip(q).map(|(p, q)| e.op(Sub, on, &[p, q]));
            let (lo, hi) = (side(a[0].lo, a[1].hi), side(a[0].hi, a[1].lo));
            return Interval::sides(lo, hi, x.add(y.neg()), &[&a[0], &a[1]]);
        }
        Shr if constant(1).is_some() => {
            let by = a[1].still().expect("a constant stands still");
            let mut shift = |p: Atom| e.op(Shr, on, &[p, by]);
            let (lo, hi) = (a[0].lo.map(&mut shift), a[0].hi.map(&mut shift));
            let down = f64::from(2f32.powi(constant(1).unwrap_or(0.0) as i32 & 31));
            return Interval::sides(lo, hi, x.map(|x| (x / down).floor()), &[&a[0]]);
        }
        _ => {}
    }
    let found = points(e, prim, on, a);
    // A mask or a remainder bounds what is left.
    let most = match prim {
        And => constant(0).or(constant(1)).filter(|m| *m >= 0.0),
        Rem if on == U32 || x.lo >= 0.0 => constant(1).filter(|m| *m > 0.0).map(|m| m - 1.0),
        _ => None,
    };
    let (Some(most), Some((lo, hi))) = (most, found.both()) else { return found };
    let end = |x: f64| Atom::Const(if on == U32 { Const::U32(x as u32) } else { Const::I32(x as i32) });
    let lo = e.outer(true, on, lo, end(0.0));
    let hi = e.outer(false, on, hi, end(most));
    Interval::new(lo, hi, Range::new(0.0, most))
}

/// The value where every operand is one value, else anything.
fn points(e: &mut Emit, prim: Prim, on: Scalar, a: &[Interval]) -> Interval {
    let to = prim.result(on);
    let all = || match to {
        F32 => Interval::endless(None),
        _ => {
            let (lo, hi) = extremes(to);
            Interval::new(lo, hi, Range::of(to))
        }
    };
    let ends: Option<Vec<(Atom, Atom)>> = a.iter().map(Interval::both).collect();
    let Some(ends) = ends else {
        e.jumps.push(flag(true));
        let found = all();
        return Interval {
            why: found.lo.is_none().then(|| Interval::why(&a.iter().collect::<Vec<_>>())).flatten(),
            ..found
        };
    };
    let mut same = flag(true);
    for (i, (lo, hi)) in ends.iter().enumerate() {
        if lo != hi {
            let one = e.op(Eq, prim.operand(on, i), &[*lo, *hi]);
            same = e.and(same, one);
        }
    }
    let apart = e.not(same);
    e.jumps.push(apart);
    if to == F32 {
        // Bits that may be any number.
        return e.endless("a number made from bits", "clamp(.., lo, hi)");
    }
    let firsts: Vec<Atom> = ends.iter().map(|(lo, _)| *lo).collect();
    let value = e.op(prim, on, &firsts);
    let (lo, hi) = extremes(to);
    let [lo, hi] = [lo, hi].map(|end| match to {
        Bool if end == flag(false) => e.and(same, value),
        Bool => {
            let apart = e.not(same);
            e.or(apart, value)
        }
        _ => e.op(Select, to, &[end, value, same]),
    });
    Interval::new(lo, hi, Range::of(to))
}
