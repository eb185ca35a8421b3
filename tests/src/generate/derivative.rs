//! Derivatives in random programs: of functions that are exact in single precision, so that they too agree to the bit.
//! They go through arithmetic, branches, calls, recursion, tasks, loops, enums and function values chosen at run time.
//!
//! Numbers are multiples of 1/4 up to 16 and no product has more than three factors: every value, and every product and
//! sum in a derivative, has less than 24 bits.

use super::expression::Scope;
use super::{Generator, Type};

impl Generator<'_> {
    /// `deriv` of a random function at a random number.
    pub(super) fn derivative(&mut self, depth: usize, scope: &mut Scope) -> String {
        let at = self.expression(&Type::F32, depth - 1, scope);
        let second = self.genes.chance(25);
        let body = self.polynomial(&["t"], 3, 3, scope);
        let body = if second { format!("deriv(|t: f32| {body})(t) + t") } else { body };
        format!("grid(deriv(|t: f32| {body})(small({at})))")
    }

    /// `grad` of a random function at a random point.
    pub(super) fn gradient(&mut self, depth: usize, scope: &mut Scope) -> String {
        let at = self.expression(&Type::Vec2, depth - 1, scope);
        let body = self.polynomial(&["t.x", "t.y"], 3, 3, scope);
        format!("{{ let at = {at}; grid2(grad(|t: vec2| {body})(vec2(small(at.x), small(at.y)))) }}")
    }

    /// Of at most that degree in the variables and in what is captured.
    fn polynomial(&mut self, variables: &[&str], degree: usize, depth: usize, scope: &mut Scope) -> String {
        scope.count();
        if depth == 0 {
            return match self.genes.pick(3) {
                0 => (*self.genes.one(variables)).to_string(),
                1 => self.genes.one(&["1.0", "-2.0", "0.5", "3.0"]).to_string(),
                _ => format!("small({})", self.leaf(&Type::F32, scope)),
            };
        }
        let mut part =
            |generator: &mut Self, degree: usize| generator.polynomial(variables, degree, depth - 1, scope);
        match self.genes.pick(18) {
            0 => part(self, degree),
            1 | 2 if degree > 1 => {
                let left = 1 + self.genes.pick(degree - 1);
                format!("({}) * ({})", part(self, left), part(self, degree - left))
            }
            3 => format!("({}) - ({})", part(self, degree), part(self, degree)),
            4 => format!("abs({})", part(self, degree)),
            5 => format!("min({}, {})", part(self, degree), part(self, degree)),
            6 => format!("max({}, {})", part(self, degree), part(self, degree)),
            7 => {
                let (a, b) = (part(self, degree), part(self, degree));
                format!("(if {a} < {b} {{ {} }} else {{ {} }})", part(self, degree), part(self, degree))
            }
            8 => format!("({}) + ({})", part(self, degree), part(self, degree)),
            chosen => {
                let (a, b) = (part(self, degree), part(self, degree));
                let n = format!("({} & 3)", self.leaf(&Type::I32, scope));
                match chosen {
                    9 => format!("climb({n}, {a}, {b})"),
                    10 => format!("relay({n}, {a}, {b})"),
                    11 => format!("apart({a}, {b})"),
                    12 => format!("worth(if {a} < {b} {{ Scaled({n}, {b}) }} else {{ Plain({a}) }})"),
                    13 => format!("worth(match {n} {{ 0 => Nil, 1 => Plain({a}), k => Scaled(-k, {b}) }})"),
                    14 => format!("fold(0..{n}, {a}, |s, i| {b} - s)"),
                    15 => format!(
                        "{{ let s = {a}; (if {n} < 2 {{ |r: f32| r - s }} else {{ |r: f32| s }})({b}) }}"
                    ),
                    16 => format!("[{a}, {b}][{n}]"),
                    _ => format!("pick_step({n})({a})"),
                }
            }
        }
    }
}
