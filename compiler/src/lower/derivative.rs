//! `grad` and `deriv`: the function is lowered as one of its own, and a hole takes the place of its derivative until
//! `derive` fills it. A function that only the machine knows is no different: its tag and captures stand still.

use super::Lower;
use super::call::{Application, Callee};
use super::value::{Closure, Value};
use crate::core::{FnId, Op};
use crate::derive::Request;
use crate::layout;
use crate::source::Span;
use crate::typed::Type;

impl<'m> Lower<'m> {
    /// The derivative of the function `f` where the argument is.
    pub(super) fn slope(&mut self, f: &Value<'m>, at: Application<'_, 'm>) -> Value<'m> {
        let callee = match f {
            Value::Never => return self.placeholder(at.result),
            Value::Function(closure) => match &**closure {
                // A function that is read from a layer has the slopes of what is read.
                Closure::Function(id, types) if !self.settings.baked.contains_key(id) => {
                    Callee::Function(*id, types.clone())
                }
                _ => Callee::Value(f.clone()),
            },
            _ => Callee::Value(f.clone()),
        };
        let scalars = layout::scalars(self.module, at.result).expect("slopes are numbers or vectors");
        let (base, _, words) = self.specialise(&callee, &Application { result: &Type::F32, ..at.clone() });
        let hole = self.hole(base, scalars.len(), at.span);
        let words = self.emit(Op::Call(hole, words), &scalars);
        self.unflatten(at.result, &mut words.into_iter())
    }

    fn hole(&mut self, base: FnId, directions: usize, span: Span) -> FnId {
        if let Some(known) = self.derivatives.get(&base) {
            return *known;
        }
        let hole = FnId(self.functions.len() as u32);
        self.functions.push(None);
        self.derivatives.insert(base, hole);
        let span = self.called.filter(|_| self.module.is_library(span)).unwrap_or(span);
        self.requests.push(Request { hole, base, directions, span });
        hole
    }
}
