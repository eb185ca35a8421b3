//! Intervals of doubles, rounded outwards.

use crate::error::RunError;
use std::f64::consts::{FRAC_PI_2, TAU};

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    pub lo: f64,
    pub hi: f64,
}

impl Span {
    pub fn point(x: f64) -> Span {
        Span { lo: x, hi: x }
    }

    /// From one to the other, whichever is less.
    pub fn between(a: f64, b: f64) -> Span {
        Span { lo: a.min(b).next_down(), hi: a.max(b).next_up() }
    }

    fn out(lo: f64, hi: f64) -> Span {
        // What infinities make of each other is anything.
        let or = |x: f64, unknown: f64| if x.is_nan() { unknown } else { x };
        Span { lo: or(lo, f64::NEG_INFINITY).next_down(), hi: or(hi, f64::INFINITY).next_up() }
    }

    pub fn add(self, b: Span) -> Span {
        // Adding nothing is exact.
        if b == Span::point(0.0) {
            return self;
        }
        Span::out(self.lo + b.lo, self.hi + b.hi)
    }

    pub fn mul(self, b: Span) -> Span {
        if b == Span::point(-1.0) {
            return Span { lo: -self.hi, hi: -self.lo };
        }
        if b == Span::point(1.0) {
            return self;
        }
        if b == Span::point(0.0) || self == Span::point(0.0) {
            return Span::point(0.0);
        }
        let products = [self.lo * b.lo, self.lo * b.hi, self.hi * b.lo, self.hi * b.hi];
        if products.iter().any(|x| x.is_nan()) {
            return Span { lo: f64::NEG_INFINITY, hi: f64::INFINITY };
        }
        let least = products.into_iter().fold(f64::INFINITY, f64::min);
        Span::out(least, products.into_iter().fold(f64::NEG_INFINITY, f64::max))
    }

    pub fn hull(self, b: Span) -> Span {
        Span { lo: self.lo.min(b.lo), hi: self.hi.max(b.hi) }
    }

    /// Itself if nothing of it is below.
    pub fn above(self, low: f64) -> Result<Span, RunError> {
        if self.lo >= low { Ok(self) } else { Err(RunError::Undecided) }
    }

    pub fn inverse(self) -> Result<Span, RunError> {
        if self.lo <= 0.0 && self.hi >= 0.0 {
            return Err(RunError::Undecided);
        }
        Ok(Span::out(1.0 / self.hi, 1.0 / self.lo))
    }

    /// Of a function that does not fall and that is known to a few units in the last place.
    pub fn monotone(self, f: fn(f64) -> f64) -> Span {
        Span { lo: f(self.lo), hi: f(self.hi) }.wider()
    }

    fn wider(self) -> Span {
        let by = |x: f64| 4.0 * f64::EPSILON * x.abs() + f64::MIN_POSITIVE;
        Span { lo: self.lo - by(self.lo), hi: self.hi + by(self.hi) }
    }

    pub fn sin(self) -> Span {
        self.wave(0.0)
    }

    pub fn cos(self) -> Span {
        self.wave(FRAC_PI_2)
    }

    /// The sine of what lies so much farther.
    fn wave(self, phase: f64) -> Span {
        let (lo, hi) = (self.lo + phase, self.hi + phase);
        let slack = 1e-15 * (1.0 + lo.abs().max(hi.abs()));
        // Whether a place and all that are whole turns away from it lie within.
        let has = |place: f64| ((lo - slack - place) / TAU).ceil() * TAU + place <= hi + slack;
        if hi - lo >= TAU || (hi - lo).is_nan() {
            return Span { lo: -1.0, hi: 1.0 };
        }
        let ends = Span { lo: lo.sin().min(hi.sin()) - slack, hi: lo.sin().max(hi.sin()) + slack };
        Span {
            lo: if has(-FRAC_PI_2) { -1.0 } else { ends.lo.max(-1.0) },
            hi: if has(FRAC_PI_2) { 1.0 } else { ends.hi.min(1.0) },
        }
    }
}
