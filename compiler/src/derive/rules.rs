//! THE table of derivatives of scalar operations: one row an operation on floats.

use crate::core::Prim::{self, *};
use crate::core::{Args, Atom, Const, Op, Scalar, Stmt, Var};
use crate::scalar;
use smallvec::smallvec;

/// How the slope of a result follows from those of its operands.
#[derive(Clone, Copy)]
pub(super) enum Rule {
    /// The result moves in steps or not at all.
    Flat,
    /// The result has the operand's value.
    Same,
    /// The chain rule: the partial derivative by each operand. Values: operands and result.
    Chain(fn(&mut Emit, &[Atom], Atom, usize) -> Partial),
    /// The result is one of the operands, whose slopes are given.
    Choice(fn(&mut Emit, &[Atom], &[Atom]) -> Atom),
}

/// What an operand's slope is multiplied with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Partial {
    Plus,
    Minus,
    Times(Atom),
    /// Divided by.
    Over(Atom),
}

pub(super) type Rules = [(Prim, Rule)];

use Partial::{Minus, Over, Plus, Times};
use Rule::{Chain, Choice, Flat, Same};

pub(super) const RULES: &Rules = &[
    (Add, Chain(|_, _, _, _| Plus)),
    (Sub, Chain(|_, _, _, k| if k == 0 { Plus } else { Minus })),
    (Mul, Chain(|_, a, _, k| Times(a[1 - k]))),
    (Div, Chain(quotient)),
    (Rem, Chain(remainder)),
    (Neg, Chain(|_, _, _, _| Minus)),
    (Abs, Chain(|e, a, _, _| Times(e.op(Sign, &[a[0]])))),
    (Sign, Flat),
    (Min, Choice(|e, a, t| e.choose(Lt, a[1], a[0], t))),
    (Max, Choice(|e, a, t| e.choose(Lt, a[0], a[1], t))),
    (Floor, Flat),
    (Ceil, Flat),
    (Round, Flat),
    (Fract, Chain(|_, _, _, _| Plus)),
    (Trunc, Flat),
    (Sqrt, Chain(|e, _, r, _| Over(e.op(Add, &[r, r])))),
    (InverseSqrt, Chain(inverse_root)),
    (Fma, Chain(|_, a, _, k| if k == 2 { Plus } else { Times(a[1 - k]) })),
    (Sin, Chain(|e, a, _, _| Times(e.op(Cos, &[a[0]])))),
    (Cos, Chain(|e, a, _, _| Times(e.negated(Sin, a[0])))),
    (Tan, Chain(|e, _, r, _| Times(e.square_and(Add, r)))),
    (Asin, Chain(|e, a, _, _| Over(e.circle(a[0])))),
    (Acos, Chain(|e, a, _, _| Over(e.negated_circle(a[0])))),
    (Atan, Chain(|e, a, _, _| Over(e.square_and(Add, a[0])))),
    (Sinh, Chain(|e, a, _, _| Times(e.op(Cosh, &[a[0]])))),
    (Cosh, Chain(|e, a, _, _| Times(e.op(Sinh, &[a[0]])))),
    (Tanh, Chain(|e, _, r, _| Times(e.square_and(Sub, r)))),
    (Asinh, Chain(|e, a, _, _| Over(e.root_of_square_and(a[0])))),
    (Acosh, Chain(hyperbola)),
    (Atanh, Chain(|e, a, _, _| Over(e.one_minus_square(a[0])))),
    (Atan2, Chain(angle)),
    (Exp, Chain(|_, _, r, _| Times(r))),
    (Exp2, Chain(|e, _, r, _| Times(e.op(Mul, &[r, number(std::f32::consts::LN_2)])))),
    (Log, Chain(|_, a, _, _| Over(a[0]))),
    (Log2, Chain(|e, a, _, _| Over(e.op(Mul, &[a[0], number(std::f32::consts::LN_2)])))),
    (Pow, Chain(power)),
    (Select, Choice(|e, a, t| e.op(Select, &[t[0], t[1], a[2]]))),
    (Index, Choice(|e, a, t| e.op_of(Index, [&[a[0]], &t[1..]].concat().into()))),
    (ToBool, Flat),
    (ToI32, Flat),
    (ToU32, Flat),
    (ToF32, Same),
    (BitcastI32, Flat),
    // A float that waits in an enum's payload keeps its slope; what a program casts itself goes through i32.
    (BitcastU32, Same),
    (BitcastF32, Same),
];

/// Words that can have a slope: floats, and the words of enums' payloads, which may hold floats.
pub(super) fn rule(rules: &Rules, prim: Prim, on: Scalar) -> Rule {
    let row = || rules.iter().find(|(p, _)| *p == prim).map_or(Flat, |(_, rule)| *rule);
    match (on, prim) {
        (Scalar::F32, _) | (Scalar::U32, Select | Index | BitcastU32 | BitcastF32) => row(),
        _ => Flat,
    }
}

fn quotient(e: &mut Emit, a: &[Atom], r: Atom, k: usize) -> Partial {
    if k == 0 {
        return Over(a[1]);
    }
    let share = e.op(Div, &[r, a[1]]);
    Times(e.op(Neg, &[share]))
}

/// `a - b * trunc(a / b)`.
fn remainder(e: &mut Emit, a: &[Atom], _: Atom, k: usize) -> Partial {
    if k == 0 {
        return Plus;
    }
    let ratio = e.op(Div, &[a[0], a[1]]);
    let whole = e.op(Trunc, &[ratio]);
    Times(e.op(Neg, &[whole]))
}

fn inverse_root(e: &mut Emit, a: &[Atom], r: Atom, _: usize) -> Partial {
    let half = e.op(Mul, &[number(-0.5), r]);
    Times(e.op(Div, &[half, a[0]]))
}

/// `atan2(y, x)`: the square of the distance from the origin divides.
fn angle(e: &mut Emit, a: &[Atom], _: Atom, k: usize) -> Partial {
    let squares = [0, 1].map(|i| e.op(Mul, &[a[i], a[i]]));
    let square = e.op(Add, &squares);
    let other = if k == 0 { a[1] } else { e.op(Neg, &[a[0]]) };
    Times(e.op(Div, &[other, square]))
}

fn hyperbola(e: &mut Emit, a: &[Atom], _: Atom, _: usize) -> Partial {
    let below = e.op(Sub, &[a[0], number(1.0)]);
    let above = e.op(Add, &[a[0], number(1.0)]);
    let product = e.op(Mul, &[below, above]);
    Over(e.op(Sqrt, &[product]))
}

/// `y x^(y-1)`, 0 for `y = 0`; and `x^y log x`, 0 where `x^y` is.
fn power(e: &mut Emit, a: &[Atom], r: Atom, k: usize) -> Partial {
    let (slope, factor) = if k == 0 {
        let less = e.op(Sub, &[a[1], number(1.0)]);
        let lower = e.op(Pow, &[a[0], less]);
        (e.op(Mul, &[a[1], lower]), a[1])
    } else {
        let log = e.op(Log, &[a[0]]);
        (e.op(Mul, &[r, log]), r)
    };
    let none = e.op_on(Eq, Scalar::F32, smallvec![factor, number(0.0)]);
    Times(e.op(Select, &[slope, number(0.0), none]))
}

pub(super) fn number(x: f32) -> Atom {
    Atom::Const(Const::f32(x))
}

/// Writes statements; what is known now becomes a constant.
pub(super) struct Emit<'a> {
    pub vars: &'a mut Vec<Scalar>,
    pub out: &'a mut Vec<Stmt>,
}

impl Emit<'_> {
    pub fn fresh(&mut self, scalar: Scalar) -> Var {
        self.vars.push(scalar);
        Var(self.vars.len() as u32 - 1)
    }

    pub fn op(&mut self, prim: Prim, args: &[Atom]) -> Atom {
        self.op_of(prim, args.into())
    }

    fn op_of(&mut self, prim: Prim, args: Args) -> Atom {
        self.op_on(prim, Scalar::F32, args)
    }

    pub fn op_on(&mut self, prim: Prim, on: Scalar, args: Args) -> Atom {
        let constant = |a: &Atom| match a {
            Atom::Const(c) => Some(*c),
            Atom::Var(_) => None,
        };
        if let Some(constants) = args.iter().map(constant).collect::<Option<Vec<_>>>() {
            return Atom::Const(scalar::eval(prim, on, &constants));
        }
        let dst = self.fresh(prim.result(on));
        self.out.push(Stmt { dst: smallvec![dst], op: Op::Prim(prim, on, args) });
        Atom::Var(dst)
    }

    /// A slope carried through a partial derivative.
    pub fn carry(&mut self, partial: Partial, slope: Atom) -> Atom {
        let one = number(1.0);
        match partial {
            Plus => slope,
            Minus => self.op(Neg, &[slope]),
            Times(factor) if slope == one => factor,
            Times(factor) if factor == one => slope,
            Times(factor) => self.op(Mul, &[factor, slope]),
            Over(divisor) if divisor == one => slope,
            Over(divisor) => self.op(Div, &[slope, divisor]),
        }
    }

    /// `t[1]` where `test(x, y)`, else `t[0]`.
    fn choose(&mut self, test: Prim, x: Atom, y: Atom, t: &[Atom]) -> Atom {
        let second = self.op(test, &[x, y]);
        self.op(Select, &[t[0], t[1], second])
    }

    fn negated(&mut self, prim: Prim, a: Atom) -> Atom {
        let value = self.op(prim, &[a]);
        self.op(Neg, &[value])
    }

    /// `1 + a^2` or `1 - a^2`.
    fn square_and(&mut self, op: Prim, a: Atom) -> Atom {
        let square = self.op(Mul, &[a, a]);
        self.op(op, &[number(1.0), square])
    }

    /// `1 - a^2` without loss near 1.
    fn one_minus_square(&mut self, a: Atom) -> Atom {
        let below = self.op(Sub, &[number(1.0), a]);
        let above = self.op(Add, &[number(1.0), a]);
        self.op(Mul, &[below, above])
    }

    fn circle(&mut self, a: Atom) -> Atom {
        let square = self.one_minus_square(a);
        self.op(Sqrt, &[square])
    }

    fn negated_circle(&mut self, a: Atom) -> Atom {
        let root = self.circle(a);
        self.op(Neg, &[root])
    }

    fn root_of_square_and(&mut self, a: Atom) -> Atom {
        let square = self.square_and(Add, a);
        self.op(Sqrt, &[square])
    }
}
