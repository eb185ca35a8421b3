//! Bounds of a surface over a box: the surface is lowered as a function of its own, and a hole takes the place of its
//! enclosure until `bounds` fills it.

use super::Lower;
use super::call::{Application, Callee};
use super::value::{Closure, Value};
use crate::bounds::{Ask, Known, Part, Request};
use crate::core::{Atom, Const, FnId, Intrinsic, Op, walk};
use crate::typed::{FunctionId, Type};
use std::collections::{HashMap, HashSet};

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

    /// `(surface, position or low, ..)`, in the order of [`Ask`]'s words.
    pub(super) fn enclosure(&mut self, ask: Ask, at: Application<'_, 'm>) -> Value<'m> {
        let anywhere = || self.zeros(&Type::Vec(2)).expect("a position is two words");
        let position = at.args.get(1).cloned().unwrap_or_else(anywhere);
        let (base, mut words) = self.surface_of(&at, position);
        words.extend(at.args.iter().skip(2).flat_map(Value::components));
        let hole = self.enclosure_hole(base, ask, &at);
        let words = self.emit(Op::Call(hole, words.into()), ask.results());
        self.unflatten(at.result, &mut words.into_iter())
    }

    fn enclosure_hole(&mut self, surface: FnId, ask: Ask, at: &Application<'_, 'm>) -> FnId {
        if let Some(known) = self.enclosures.get(&(surface, ask)) {
            return *known;
        }
        let base = match ask {
            Ask::Above | Ask::InCells | Ask::Raise => surface,
            Ask::Along | Ask::Rise => self.along_hole(surface, at.span),
            Ask::Reach => self.bend_hole(surface, at.span),
        };
        let hole = self.hole_id();
        self.enclosures.insert((surface, ask), hole);
        let span = self.called.filter(|_| self.module.is_library(at.span)).unwrap_or(at.span);
        self.bounds.push(Request { hole, surface, base, ask, span });
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
            if self.specialised(*known).is_empty() || (self.requests.is_empty() && self.bounds.is_empty()) {
                continue;
            }
            for derived in [known.gradient(), known.along()].into_iter().flatten() {
                let Some(id) = self.library(derived.name()) else { continue };
                self.specialise_plainly(id);
            }
        }
        let all = Known::ALL
            .iter()
            .flat_map(|(known, _)| self.specialised(*known).into_iter().map(|id| (id, *known)));
        all.collect()
    }

    /// Functions of a patch's samples, if they are asked for.
    pub(super) fn patch_functions(&mut self) -> HashMap<Part, FnId> {
        if !self.bounds.iter().any(|request| matches!(request.ask, Ask::Rise | Ask::Reach)) {
            return HashMap::new();
        }
        let mut made = HashMap::new();
        for (part, name) in Part::ALL {
            let Some(id) = self.library(name) else { continue };
            made.insert(*part, self.specialise_plainly(id));
        }
        made
    }

    /// A function whose operands are numbers.
    fn specialise_plainly(&mut self, id: FunctionId) -> FnId {
        let function = &self.module.functions[id.0 as usize];
        let params: Vec<Type> = function.param_types().cloned().collect();
        let (result, span) = (function.result.clone(), function.span);
        let args = params.iter().map(|ty| self.zeros(ty).expect("its operands are numbers")).collect();
        let at = Application { args, params: &params, result: &result, span };
        self.specialise(&Callee::Function(id, Vec::new()), &at).0
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
