//! `grad` and `deriv`: the function is lowered as one of its own, and a hole takes the place of its derivative until
//! `derive` fills it. A function that only the machine knows is no different: its tag and captures stand still.

use super::Lower;
use super::call::Application;
use super::value::Value;
use crate::core::{FnId, Op};
use crate::derive::{Along, Request};
use crate::source::Span;
use crate::typed::Type;

impl<'m> Lower<'m> {
    /// The derivative of the function `f` where the argument is.
    pub(super) fn slope(&mut self, f: &Value<'m>, at: Application<'_, 'm>) -> Value<'m> {
        if matches!(f, Value::Never) {
            return self.placeholder(at.result);
        }
        let callee = self.callee(f);
        let scalars = self.layouts.scalars(at.result).expect("slopes are numbers or vectors");
        let (base, _, words) = self.specialise(&callee, &Application { result: &Type::F32, ..at.clone() });
        let hole = self.hole(base, scalars.len(), at.span);
        let words = self.emit(Op::Call(hole, words.into()), &scalars);
        self.unflatten(at.result, &mut words.into_iter())
    }

    fn hole(&mut self, base: FnId, directions: usize, span: Span) -> FnId {
        if let Some(known) = self.derivatives.get(&base) {
            return *known;
        }
        let hole = self.hole_id();
        self.derivatives.insert(base, hole);
        let span = self.called.filter(|_| self.module.is_library(span)).unwrap_or(span);
        self.requests.push(Request { hole, base, directions, along: None, span });
        hole
    }

    /// Value and slope along a direction.
    pub(super) fn along_hole(&mut self, base: FnId, span: Span) -> FnId {
        self.derived_along(base, Along::Slope, span)
    }

    /// Value and slope, and the slopes of both along another direction.
    pub(super) fn bend_hole(&mut self, base: FnId, span: Span) -> FnId {
        let slope = self.along_hole(base, span);
        self.derived_along(slope, Along::Bend, span)
    }

    fn derived_along(&mut self, base: FnId, along: Along, span: Span) -> FnId {
        if let Some(known) = self.alongs.get(&base) {
            return *known;
        }
        let hole = self.hole_id();
        self.alongs.insert(base, hole);
        self.requests.push(Request { hole, base, directions: 1, along: Some(along), span });
        hole
    }
}
