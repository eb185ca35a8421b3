//! `grad` and `deriv`: the function is applied to a dual, once for each direction.

use ghyll_compiler::builtins::Builtin;

use super::builtin;
use super::datum::{Callable, Datum};
use super::evaluator::Evaluator;
use super::float::Precision;
use crate::error::RunError;

impl<'m> Evaluator<'m> {
    /// The derivative of `f` at a number, its gradient at a point.
    pub fn derivative(&mut self, f: &Callable<'m>, args: &[Datum<'m>]) -> Result<Datum<'m>, RunError> {
        let at = args.first().ok_or_else(|| RunError::Internal("a derivative has no argument".into()))?;
        let precision = std::mem::replace(&mut self.precision, Precision::F64);
        self.derivatives += 1;
        let slopes = self.slopes(f, at);
        self.derivatives -= 1;
        self.precision = precision;
        let mut slopes = slopes?;
        let all = match slopes.len() {
            1 => slopes.swap_remove(0),
            _ => builtin::apply(Precision::F64, Builtin::Vec2, &slopes)?
                .ok_or_else(|| RunError::Internal("`vec2` is not mathematics".into()))?,
        };
        match all {
            Datum::F32(x) => Ok(Datum::F32(precision.round(x))),
            Datum::Vec(v) => Ok(Datum::Vec(v.map(|x| precision.round(x)))),
            dual => Ok(dual),
        }
    }

    fn slopes(&mut self, f: &Callable<'m>, at: &Datum<'m>) -> Result<Vec<Datum<'m>>, RunError> {
        let level = self.derivatives;
        let directions = match at.plain() {
            Datum::F32(_) => vec![Datum::F32(1.0)],
            _ => vec![Datum::vec(&[1.0, 0.0]), Datum::vec(&[0.0, 1.0])],
        };
        let along = |direction: Datum<'m>| {
            let value = self.apply(f.clone(), vec![Datum::dual(level, at.clone(), direction)])?;
            Ok(value.split(level).1.unwrap_or(Datum::F32(0.0)))
        };
        directions.into_iter().map(along).collect()
    }
}
