//! Bounds of a surface over a box: the surface is lowered as a function of its own, and a hole takes the place of its
//! enclosure until `bounds` fills it.

use super::Lower;
use super::call::{Application, Callee};
use super::value::{Closure, Value};
use crate::bounds::{Ask, Known, Request};
use crate::core::{Atom, Const, FnId, Intrinsic, Op, Scalar, walk};
use crate::typed::{FunctionId, Type};
use std::collections::HashSet;

impl<'m> Lower<'m> {
    /// The surface as a function of its own, and the words that it takes for a position.
    fn surface_of(&mut self, at: &Application<'_, 'm>, position: Value<'m>) -> (FnId, Vec<Atom>) {
        let callee = self.callee(&at.args[0]);
        let args = vec![position];
        let position = Application { args, params: &[Type::Vec(2)], result: &Type::F32, span: at.span };
        let (base, _, words) = self.specialise(&callee, &position);
        (base, words)
    }

    /// Whether a surface is made of bicubic patches.
    pub(super) fn cellwise(&mut self, at: &Application<'_, 'm>) -> Value<'m> {
        let anywhere = self.zeros(&Type::Vec(2)).expect("a position is two words");
        let (base, _) = self.surface_of(at, anywhere);
        let (mut open, mut seen, mut found) = (vec![base], HashSet::new(), false);
        while let Some(id) = open.pop() {
            let Some(function) = &self.functions[id.0 as usize] else { continue };
            if seen.insert(id) {
                let stmts = &function.body.stmts;
                open.extend(walk::calls(stmts));
                walk::statements(stmts, &mut |stmt| {
                    use Intrinsic::{Bicubic, GradientBicubic, GradientSubdivided, Subdivided};
                    let curved = [Bicubic, Subdivided, GradientBicubic, GradientSubdivided];
                    found |= matches!(stmt.op, Op::Intrinsic(intrinsic, _) if curved.contains(&intrinsic));
                });
            }
        }
        Value::constant(Const::Bool(found))
    }

    /// `(surface, low, high)`, and the direction for [`Ask::Along`].
    pub(super) fn enclosure(&mut self, ask: Ask, at: Application<'_, 'm>) -> Value<'m> {
        let (base, mut words) = self.surface_of(&at, at.args[1].clone());
        words.extend(at.args[2..].iter().flat_map(Value::components));
        let hole = self.enclosure_hole(base, ask, &at);
        let scalars: &[Scalar] = match ask {
            Ask::Above => &[Scalar::F32],
            Ask::Along => &[Scalar::Bool, Scalar::F32, Scalar::F32],
        };
        let words = self.emit(Op::Call(hole, words.into()), scalars);
        self.unflatten(at.result, &mut words.into_iter())
    }

    fn enclosure_hole(&mut self, base: FnId, ask: Ask, at: &Application<'_, 'm>) -> FnId {
        if let Some(known) = self.enclosures.get(&(base, ask)) {
            return *known;
        }
        let read = match ask {
            Ask::Above => base,
            Ask::Along => self.along_hole(base, at.span),
        };
        let hole = self.hole_id();
        self.enclosures.insert((base, ask), hole);
        let span = self.called.filter(|_| self.module.is_library(at.span)).unwrap_or(at.span);
        self.bounds.push(Request { hole, base: read, ask, span });
        hole
    }

    pub(super) fn hole_id(&mut self) -> FnId {
        self.functions.push(None);
        FnId(self.functions.len() as u32 - 1)
    }

    /// A function of the library by its name.
    pub(super) fn library(&self, name: &str) -> Option<FunctionId> {
        let at = self.module.functions.iter().position(|f| f.library && f.name == name)?;
        Some(FunctionId(at as u32))
    }

    /// Specialisations of library functions of which more is known than their code tells; those of their gradients are made.
    pub(super) fn known_functions(&mut self) -> Vec<(FnId, Known)> {
        for (known, _) in Known::ALL {
            let Some(gradient) = known.gradient() else { continue };
            if self.specialised(*known).is_empty() || (self.requests.is_empty() && self.bounds.is_empty()) {
                continue;
            }
            let Some(id) = self.library(gradient.name()) else { continue };
            let span = self.module.functions[id.0 as usize].span;
            let args = vec![self.zeros(&Type::Vec(2)).expect("a position is two words")];
            let at = Application { args, params: &[Type::Vec(2)], result: &Type::Vec(2), span };
            self.specialise(&Callee::Function(id, Vec::new()), &at);
        }
        let all = Known::ALL
            .iter()
            .flat_map(|(known, _)| self.specialised(*known).into_iter().map(|id| (id, *known)));
        all.collect()
    }

    fn specialised(&self, known: Known) -> Vec<FnId> {
        let Some(id) = self.library(known.name()) else { return Vec::new() };
        let mut found: Vec<FnId> =
            self.known.iter().filter(|(key, _)| key.is_of(id)).map(|(_, made)| *made).collect();
        found.sort();
        found
    }

    /// What is called where a function's code is read.
    pub(super) fn callee(&self, f: &Value<'m>) -> Callee<'m> {
        match f {
            Value::Function(closure) => match &**closure {
                // A function that is read from a layer has the slopes of what is read.
                Closure::Function(id, types) if !self.settings.baked.contains_key(id) => {
                    Callee::Function(*id, types.clone())
                }
                _ => Callee::Value(f.clone()),
            },
            _ => Callee::Value(f.clone()),
        }
    }
}
