//! Derivatives by differences: Richardson's extrapolation of central differences in double precision, with
//! the step that Ridders' error estimate likes best. The machines differentiate the program itself; this knows
//! nothing of how.

use super::datum::{Callable, Datum};
use super::evaluator::Evaluator;
use super::float::Precision;
use super::terrain;
use crate::error::RunError;

/// Steps tried, each half of the one before.
const LEVELS: usize = 8;
/// The first step for arguments between 1 and 2^20; a power of two, so that `x + h` is exact.
const FIRST_STEP: f64 = 1.0 / 64.0;

impl<'m> Evaluator<'m> {
    /// The derivative of `f` at a number, its gradient at a point.
    pub fn derivative(&mut self, f: &Callable<'m>, args: &[Datum<'m>]) -> Result<Datum<'m>, RunError> {
        let at = args.first().ok_or_else(|| RunError::Internal("a derivative has no argument".into()))?;
        if let Some(exact) = terrain::gradient_of(self, f, at)? {
            return Ok(exact);
        }
        let precision = std::mem::replace(&mut self.precision, Precision::F64);
        let slopes = self.slopes(f, at);
        self.precision = precision;
        let slopes: Vec<f64> = slopes?.iter().map(|s| precision.round(*s)).collect();
        Ok(match slopes.as_slice() {
            [slope] => Datum::F32(*slope),
            gradient => Datum::vec(gradient),
        })
    }

    fn slopes(&mut self, f: &Callable<'m>, at: &Datum<'m>) -> Result<Vec<f64>, RunError> {
        let x = at.floats()?;
        let mut slopes = Vec::new();
        for axis in 0..x.len() {
            let mut value = |moved: f64| {
                let mut items = x.slice().to_vec();
                items[axis] = moved;
                let arg = if x.len() == 1 { Datum::F32(moved) } else { Datum::vec(&items) };
                self.apply(f.clone(), vec![arg])?.f32()
            };
            slopes.push(slope(&mut value, x.slice()[axis])?);
        }
        Ok(slopes)
    }
}

/// Derivative of `f` at `x`.
fn slope(f: &mut dyn FnMut(f64) -> Result<f64, RunError>, x: f64) -> Result<f64, RunError> {
    let mut step = FIRST_STEP * scale(x);
    let mut above: Vec<f64> = Vec::new();
    let (mut best, mut least) = (f64::NAN, f64::INFINITY);
    for _ in 0..LEVELS {
        let mut row = vec![(f(x + step)? - f(x - step)?) / (2.0 * step)];
        let mut power = 1.0;
        for coarse in &above {
            power *= 4.0;
            let fine = row[row.len() - 1];
            let better = fine + (fine - coarse) / (power - 1.0);
            let error = (better - fine).abs().max((better - coarse).abs());
            if error < least {
                (best, least) = (better, error);
            }
            row.push(better);
        }
        above = row;
        step *= 0.5;
    }
    Ok(if least.is_finite() { best } else { above[0] })
}

/// Power of two by which steps at `x` are longer or shorter.
fn scale(x: f64) -> f64 {
    let size = match x.abs() {
        0.0 => 1.0,
        size if size < 1.0 => size.max(2f64.powi(-20)),
        size => (size * 2f64.powi(-20)).max(1.0),
    };
    size.log2().floor().exp2()
}

#[cfg(test)]
mod tests {
    use super::slope;

    #[test]
    fn slopes_of_smooth_functions() {
        let check = |f: fn(f64) -> f64, x: f64, expected: f64| {
            let found = slope(&mut |x| Ok(f(x)), x).unwrap();
            assert!((found - expected).abs() <= 1e-8 * expected.abs(), "{found} instead of {expected}");
        };
        check(f64::sin, 1.0, 1f64.cos());
        check(f64::exp, 2.0, 2f64.exp());
        check(f64::ln, 1e-3, 1e3);
        check(|x| x * x * x, 5000.0, 7.5e7);
    }

    #[test]
    fn a_nearby_kink_is_stepped_over() {
        let found = slope(&mut |x| Ok((x - 1.001).abs() * 2.0), 1.0).unwrap();
        assert!((found + 2.0).abs() < 1e-9, "{found}");
    }
}
