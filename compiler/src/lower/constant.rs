//! Constants are computed once, now: their expression is lowered as a program of its own and interpreted.

use super::value::Value;
use super::words::words_of;
use super::{Builder, Env, Lower};
use crate::core::{Atom, Block, Const, Function, Mark, Op, Program, Scalar};
use crate::interpret::{self, NoHost};
use crate::typed::ConstId;
use std::rc::Rc;

/// Steps that a constant may take; a longer one is evaluated where it is used.
const FUEL: u64 = 2_000_000;
/// Steps that all constants may take.
pub(super) const ALL_FUEL: u64 = 20_000_000;

impl<'m> Lower<'m> {
    pub(super) fn constant(&mut self, id: ConstId) -> Value<'m> {
        if let Some(known) = self.constants.get(&id) {
            return known.clone();
        }
        let computed = if self.uncomputed.contains(&id) { None } else { self.computed(id) };
        let value = computed.unwrap_or_else(|| {
            self.uncomputed.insert(id);
            let definition = &self.module.consts[id.0 as usize];
            self.expr(&definition.value, &mut Env::default())
        });
        if has_only_constants(&value) {
            self.constants.insert(id, value.clone());
        }
        value
    }

    /// The constant's value if the interpreter can find it.
    fn computed(&mut self, id: ConstId) -> Option<Value<'m>> {
        let definition = &self.module.consts[id.0 as usize];
        let results = self.layouts.scalars(&definition.ty)?;
        let mut apart = Lower::new(self.module, self.settings, self.yields.clone());
        apart.layouts = Rc::clone(&self.layouts);
        apart.builder = Builder { vars: Vec::new(), open: vec![Vec::new()] };
        apart.functions.push(None);
        (apart.fuel, apart.spent) = (self.fuel, self.spent);
        let words = self.computed_apart(&mut apart, id, results);
        (self.fuel, self.spent) = (apart.fuel, apart.spent);
        self.work(0);
        if apart.grown {
            self.grown = true;
            self.yields = apart.yields;
        }
        Some(self.unflatten(&definition.ty, &mut words?.into_iter().map(Atom::Const)))
    }

    /// The words of a constant, which `apart` lowers.
    fn computed_apart(&self, apart: &mut Self, id: ConstId, results: Vec<Scalar>) -> Option<Vec<Const>> {
        let definition = &self.module.consts[id.0 as usize];
        let value = apart.expr(&definition.value, &mut Env::default());
        if !apart.errors.is_empty() {
            return None;
        }
        let mut words = Vec::new();
        apart.flatten(&value, &definition.ty, &mut words);
        let stmts = apart.builder.open.pop()?;
        if stmts.iter().any(|s| matches!(s.op, Op::Live(_))) {
            return None;
        }
        apart.functions[0] = Some(Function {
            name: definition.name.clone(),
            params: Vec::new(),
            results,
            vars: std::mem::take(&mut apart.builder.vars),
            body: Block { stmts, results: words },
            mark: Mark::Auto,
            span: Some(definition.span),
        });
        apart.drain().ok()?;
        if apart.grown {
            return None;
        }
        let functions = apart.functions_made().ok()?;
        let program = Program { functions, entry: 0, live: Vec::new() };
        let given = apart.fuel.min(FUEL);
        let mut left = given;
        let words = interpret::run_with(&program, &[], &NoHost, &mut left);
        apart.fuel -= given - left;
        words.ok()
    }
}

/// Is every machine word of the value known now?
pub(super) fn has_only_constants(value: &Value) -> bool {
    let mut words = Vec::new();
    words_of(value, &mut words);
    words.iter().all(|word| matches!(word, Atom::Const(_)))
}
