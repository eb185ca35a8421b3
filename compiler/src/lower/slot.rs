//! Live parameters of function type: operator slots. Every function of the user's program that has the slot's type is
//! compiled in; which one is called is a live word, so it is replaced without making code again.

use super::choice::head;
use super::value::{Closure, Value};
use super::words::dissect_any;
use super::{Lower, Settings, unsupported};
use crate::codes;
use crate::core::{Op, Scalar};
use crate::diagnostic::Diagnostic;
use crate::front::walk::walk;
use crate::typed::{Expr, ExprKind, FunctionId, Module, ParamId, Type};
use std::collections::HashSet;
use std::rc::Rc;

/// A live parameter of function type.
#[derive(Clone, Debug)]
pub struct Slot {
    pub param: ParamId,
    /// Names of the functions it can hold, by the value of its word. With one alone there is no word.
    pub names: Vec<String>,
    /// What it holds at first.
    pub initial: u32,
}

impl Slot {
    /// The word for a function given by its name.
    pub fn word(&self, name: &str) -> Option<u32> {
        self.names.iter().position(|n| n == name).map(|at| at as u32)
    }

    /// Words in the stream of live words.
    pub fn words(&self) -> usize {
        usize::from(self.names.len() > 1)
    }
}

/// A slot while lowering: the candidates with their words, by tag.
pub(super) struct Candidates<'m> {
    values: Vec<Value<'m>>,
    names: Vec<String>,
    initial: usize,
}

impl<'m> Lower<'m> {
    /// What the slot can hold: the functions that fit and do not read it themselves, and its first value.
    pub(super) fn slot(&mut self, id: ParamId) -> Result<Candidates<'m>, Vec<Diagnostic>> {
        let param = &self.module.params[id.0 as usize];
        let first = self.fixed(id);
        if !matches!(first, Value::Function(_)) || !super::constant::has_only_constants(&first) {
            return Err(vec![unsupported(
                codes::LIVE_FUNCTION,
                param.span,
                format!("what the live parameter `{}` holds at first is not known yet", param.name),
                "give it a function by its name",
            )]);
        }
        let mut values = vec![first.clone()];
        for function in fitting(self.module, id) {
            let value = Value::function(Closure::Function(function, Vec::new()));
            if head(&value) != head(&first) && !reads(self.module, self.settings, function, id) {
                values.push(value);
            }
        }
        values.sort_by_key(head);
        let initial = values.iter().position(|v| head(v) == head(&first)).expect("it is one of them");
        let names = values.iter().map(|v| self.function_name(v, &param.name)).collect();
        Ok(Candidates { values, names, initial })
    }

    fn function_name(&self, value: &Value<'m>, param: &str) -> String {
        match value {
            Value::Function(closure) => match &**closure {
                Closure::Function(id, _) => self.module.functions[id.0 as usize].name.clone(),
                Closure::Builtin(builtin) => builtin.name().into(),
                _ => param.into(),
            },
            _ => unreachable!("slots hold functions"),
        }
    }

    /// The function in the slot.
    pub(super) fn slot_value(&mut self, id: ParamId, word: u32) -> Value<'m> {
        let slot = &self.slots[&id];
        let first = slot.values[slot.initial].clone();
        if slot.values.len() == 1 {
            return first;
        }
        let outlines = Rc::new(slot.values.iter().map(|v| self.outline_any(v)).collect());
        // Top-level functions capture nothing, so all payload is that of the first value.
        let mut payload = Vec::new();
        dissect_any(&first, &mut payload);
        let tag = self.emit(Op::Live(word), &[Scalar::I32])[0];
        Value::Choice(outlines, tag, payload)
    }
}

impl Candidates<'_> {
    pub fn describe(&self, param: ParamId) -> Slot {
        Slot { param, names: self.names.clone(), initial: self.initial as u32 }
    }

    pub fn len(&self) -> usize {
        self.values.len()
    }
}

/// The user's functions of a parameter's type.
pub(crate) fn fitting(module: &Module, param: ParamId) -> impl Iterator<Item = FunctionId> + '_ {
    let wanted = &module.params[param.0 as usize].ty;
    let ids = (0..module.functions.len() as u32).map(FunctionId);
    ids.filter(move |id| {
        let function = &module.functions[id.0 as usize];
        let params = || function.param_types().cloned().collect();
        !function.library
            && function.generics.is_empty()
            && Type::Fn(params(), Box::new(function.result.clone())) == *wanted
    })
}

/// Does the function, or one that it mentions, read the parameter?
fn reads(module: &Module, settings: &Settings, function: FunctionId, param: ParamId) -> bool {
    let (mut functions, mut params, mut consts) = (HashSet::from([function]), HashSet::new(), HashSet::new());
    let mut pending: Vec<&Expr> = vec![&module.functions[function.0 as usize].body];
    while let Some(expr) = pending.pop() {
        walk(expr, &mut |e| match &e.kind {
            ExprKind::Param(id) if params.insert(*id) => {
                let default = &module.params[id.0 as usize].default;
                pending.push(settings.set.get(id).map_or(default, |setting| &setting.value));
            }
            ExprKind::Const(id) if consts.insert(*id) => pending.push(&module.consts[id.0 as usize].value),
            ExprKind::Function(id, _) if functions.insert(*id) => {
                pending.push(&module.functions[id.0 as usize].body);
            }
            _ => {}
        });
    }
    params.contains(&param)
}
