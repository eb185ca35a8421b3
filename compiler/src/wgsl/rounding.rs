//! Sums whose rounding a driver would lose.
//!
//! SPIR-V lets a driver take float sums for exact ones unless they carry `NoContraction`, which WGSL cannot ask for, so
//! Mesa makes `b` of `(a + b) - a` and `x` of `(x + C) - C`. Where a sum meets one of its own addends again, or two constants
//! would meet, the inner sum goes through the runtime's `rounded`, which a driver cannot see through. So does a divisor that is 0.

use rustc_hash::FxHashMap;

use crate::core::{Atom, Const, Prim, Scalar, Var};

/// Addends of the float sums that are known so far, their signs left out.
#[derive(Default)]
pub(super) struct Sums {
    addends: FxHashMap<Var, [Atom; 2]>,
    negated: FxHashMap<Var, Atom>,
}

impl Sums {
    /// Notes what a variable is.
    pub fn learn(&mut self, v: Var, prim: Prim, on: Scalar, args: &[Atom]) {
        match (prim, on, args) {
            (Prim::Add | Prim::Sub, Scalar::F32, &[a, b]) => {
                self.addends.insert(v, [self.positive(a), self.positive(b)]);
            }
            (Prim::Neg, Scalar::F32, &[a]) => {
                self.negated.insert(v, a);
            }
            _ => {}
        }
    }

    /// Which operands of an operation a driver must not know.
    pub fn rounded(&self, prim: Prim, on: Scalar, args: &[Atom]) -> [bool; 2] {
        let sensitive = matches!(prim, Prim::Add | Prim::Sub | Prim::Lt | Prim::Le | Prim::Eq | Prim::Ne);
        let zero = |b: Atom| matches!(b, Atom::Const(Const::F32(bits)) if bits << 1 == 0);
        match *args {
            // llvmpipe makes of `x / 0` by a constant neither an infinity nor the same number twice.
            [_, b] if prim == Prim::Div && on == Scalar::F32 && zero(b) => [false, true],
            [a, b] if sensitive && on == Scalar::F32 => [self.meets(a, b), self.meets(b, a)],
            _ => [false; 2],
        }
    }

    /// Whether `other` could be cancelled against an addend of `sum`.
    fn meets(&self, sum: Atom, other: Atom) -> bool {
        let (sum, other) = (self.positive(sum), self.positive(other));
        let Atom::Var(sum) = sum else { return false };
        let Some(addends) = self.addends.get(&sum) else { return false };
        let again = |addend: &Atom| match (addend, other) {
            (Atom::Const(_), Atom::Const(_)) => true,
            _ => *addend == other,
        };
        addends.iter().any(again)
    }

    /// The atom without its sign.
    fn positive(&self, atom: Atom) -> Atom {
        match atom {
            Atom::Var(v) => self.negated.get(&v).copied().unwrap_or(atom),
            Atom::Const(_) => atom,
        }
    }
}
