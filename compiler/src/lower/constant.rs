//! Constants are computed once, now: their expression is lowered as a program of its own and interpreted.

use super::value::Value;
use super::words::dissect_any;
use super::{Builder, Env, Lower};
use crate::core::{Atom, Block, Function, Mark, Op, Program};
use crate::interpret::{self, NoHost};
use crate::layout;
use crate::typed::ConstId;

/// Steps that a constant may take; a longer one is evaluated where it is used.
const FUEL: u64 = 2_000_000;

impl<'m> Lower<'m> {
    pub(super) fn constant(&mut self, id: ConstId) -> Value<'m> {
        if let Some(known) = self.constants.get(&id) {
            return known.clone();
        }
        let value = self.computed(id).unwrap_or_else(|| {
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
        let results = layout::scalars(self.module, &definition.ty)?;
        let mut apart = Lower::new(self.module, self.settings, self.yields.clone());
        apart.builder = Builder { vars: Vec::new(), open: vec![Vec::new()] };
        apart.functions.push(None);
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
            self.grown = true;
            self.yields = apart.yields;
            return None;
        }
        let functions = apart.finish().ok()?;
        let program = Program { functions, entry: 0, live: Vec::new() };
        let words = interpret::run(&program, &[], &NoHost, FUEL).ok()?;
        Some(self.unflatten(&definition.ty, &mut words.into_iter().map(Atom::Const)))
    }
}

/// Is every machine word of the value known now?
pub(super) fn has_only_constants(value: &Value) -> bool {
    let mut words = Vec::new();
    dissect_any(value, &mut words);
    words.iter().all(|word| matches!(word, Atom::Const(_)))
}
