//! Does a value fit a pattern, and what does the pattern bind?

use ghyll_compiler::typed::{Pattern, PatternKind};

use super::datum::{Datum, Frame};
use super::float::Precision;
use crate::error::RunError;

/// Binds the pattern's names and tells whether `value` fits; bindings of a pattern that does not fit are
/// never read.
pub fn fits<'m>(
    pattern: &Pattern,
    value: &Datum<'m>,
    frame: &mut Frame<'m>,
    precision: Precision,
) -> Result<bool, RunError> {
    let all = |patterns: &[Pattern], values: &[Datum<'m>], frame: &mut Frame<'m>| {
        for (p, v) in patterns.iter().zip(values) {
            if !fits(p, v, frame, precision)? {
                return Ok(false);
            }
        }
        Ok(true)
    };
    match (&pattern.kind, value) {
        (PatternKind::Wild, _) => Ok(true),
        (PatternKind::Bind(id), _) => {
            frame.bind(*id, value.clone());
            Ok(true)
        }
        (PatternKind::Literal(literal), _) => value.equal(&precision.literal(*literal)),
        (PatternKind::Tuple(items) | PatternKind::Struct(_, items), _) => all(items, value.fields()?, frame),
        (PatternKind::Variant(_, tag, items), Datum::Variant(found, fields)) => {
            Ok(tag == found && all(items, fields, frame)?)
        }
        (PatternKind::Variant(..), other) => {
            other.fields()?;
            Err(RunError::Internal("a variant's pattern meets a value that is no enum's".into()))
        }
        (PatternKind::Or(alternatives), _) => {
            for alternative in alternatives {
                if fits(alternative, value, frame, precision)? {
                    return Ok(true);
                }
            }
            Ok(false)
        }
    }
}
