//! Baked functions: evaluated once for every sample of the field, then read from a layer.
//!
//! A bake may read the bakes of functions that do not lead back to it; those that do are called, as in a recursion.
//! So bakes can always be put in an order in which each reads earlier ones only.

use crate::back::{self, Back};
use crate::codes;
use crate::core::{self, Atom, Const, Op, Program};
use crate::diagnostic::Diagnostic;
use crate::front::walk::walk;
use crate::lower::slot::fitting;
use crate::lower::{self, Asked, Settings};
use crate::split::TooMany;
use crate::typed::{Expr, ExprKind, FunctionId, Module};
use std::collections::{BTreeMap, BTreeSet};

/// A function that is read from a layer, as a program of its own whose entry takes the pixel position of a sample.
#[derive(Clone, Debug)]
pub struct Bake {
    pub function: FunctionId,
    /// Its place among the layers.
    pub slot: u32,
    /// Floats of its value.
    pub components: u32,
    /// Slots that it reads itself.
    pub reads: BTreeSet<u32>,
    pub back: Back,
}

/// The marked functions of a module with their slots among the layers, behind the rasters.
pub struct Plan {
    slots: BTreeMap<FunctionId, u32>,
    /// Every function that each of those that are needed may lead to.
    reached: BTreeMap<FunctionId, BTreeSet<FunctionId>>,
}

impl Plan {
    /// For what `entry` may lead to.
    pub fn new(module: &Module, settings: &Settings, entry: FunctionId) -> Plan {
        let ids = (0..module.functions.len() as u32).map(FunctionId);
        let marked = ids.filter(|id| module.functions[id.0 as usize].attributes.bake);
        let slots: BTreeMap<_, _> = marked.zip(module.rasters.len() as u32..).collect();
        let mut needed = reached(module, settings, entry);
        needed.insert(entry);
        let needed = slots.keys().filter(|id| needed.contains(id)).take(MOST_BAKES + 1);
        let reached = needed.map(|id| (*id, reached(module, settings, *id))).collect();
        Plan { slots, reached }
    }

    /// A bake is a pass of its own over the field, and a layer that is kept.
    fn within_limits(&self, module: &Module) -> Result<(), Vec<Diagnostic>> {
        let Some((id, _)) = self.reached.iter().nth(MOST_BAKES) else { return Ok(()) };
        Err(vec![too_much(
            module,
            *id,
            "too many functions are baked",
            "leave `@bake` away where a call is cheap",
        )])
    }

    /// The function of a slot; none for a raster's.
    pub fn function(&self, slot: u32) -> Option<FunctionId> {
        self.slots.iter().find(|(_, s)| **s == slot).map(|(id, _)| *id)
    }

    /// What `function` reads from layers instead of calling it.
    pub fn read_by(&self, function: FunctionId) -> BTreeMap<FunctionId, u32> {
        let leads_back = |(id, reached): &(&FunctionId, &BTreeSet<FunctionId>)| {
            **id == function || reached.contains(&function)
        };
        self.reached.iter().filter(|bake| !leads_back(bake)).map(|(id, _)| (*id, self.slots[id])).collect()
    }
}

/// Bakes that one entry may need.
const MOST_BAKES: usize = 256;
/// Statements of all programs that an entry's bakes are: they may share most of their functions.
const MOST_STATEMENTS: usize = 400_000;

fn too_much(module: &Module, id: FunctionId, title: &str, help: &str) -> Diagnostic {
    let function = &module.functions[id.0 as usize];
    Diagnostic::error(codes::TOO_MUCH_CODE, function.span, title)
        .label(format!("up to `{}`", function.name))
        .help(help)
}

/// Functions that `from` may call, directly or not, whatever its arguments are.
pub(crate) fn reached(module: &Module, settings: &Settings, from: FunctionId) -> BTreeSet<FunctionId> {
    let mut found = BTreeSet::new();
    let (mut params, mut consts) = (BTreeSet::new(), BTreeSet::new());
    let mut pending: Vec<&Expr> = vec![&module.functions[from.0 as usize].body];
    while let Some(body) = pending.pop() {
        walk(body, &mut |expr| match &expr.kind {
            ExprKind::Function(id, _) if found.insert(*id) => {
                pending.push(&module.functions[id.0 as usize].body);
            }
            ExprKind::Param(id) if params.insert(*id) => {
                let default = &module.params[id.0 as usize].default;
                pending.push(settings.set.get(id).map_or(default, |setting| &setting.value));
                if settings.live.contains(id) {
                    let held = fitting(module, *id).filter(|function| found.insert(*function));
                    pending.extend(held.map(|function| &module.functions[function.0 as usize].body));
                }
            }
            ExprKind::Const(id) if consts.insert(*id) => pending.push(&module.consts[id.0 as usize].value),
            _ => {}
        });
    }
    found
}

/// The entry's program, and those of the bakes that it needs.
pub(crate) fn backs(
    module: &Module,
    (entry, asked): (FunctionId, Asked),
    settings: &Settings,
    bake: bool,
) -> Result<(Back, Vec<Bake>), Vec<Diagnostic>> {
    if !bake {
        let back = back::back(lower::lower(module, entry, asked, settings)?);
        return within_limits(module, entry, back).map(|back| (back, Vec::new()));
    }
    let plan = Plan::new(module, settings, entry);
    plan.within_limits(module)?;
    let settings_of = |id| Settings { baked: plan.read_by(id), ..settings.clone() };
    let back = back::back(lower::lower(module, entry, asked, &settings_of(entry))?);
    let back = within_limits(module, entry, back)?;
    let mut bakes: BTreeMap<u32, Bake> = BTreeMap::new();
    let mut pending: Vec<u32> = slots(&back.core).into_iter().collect();
    let mut statements = 0;
    while let Some(slot) = pending.pop() {
        let Some(function) = plan.function(slot).filter(|_| !bakes.contains_key(&slot)) else { continue };
        let program = lower::lower(module, function, Asked::ForSamples, &settings_of(function))?;
        statements += program.statements();
        if statements > MOST_STATEMENTS {
            let help = "bake the part that they share";
            return Err(vec![too_much(module, function, "the baked functions are too large together", help)]);
        }
        let components = program.functions[0].results.len() as u32;
        let back = within_limits(module, function, back::back(program))?;
        let reads = slots(&back.core);
        pending.extend(&reads);
        bakes.insert(slot, Bake { function, slot, components, reads, back });
    }
    Ok((back, in_order(bakes)))
}

fn within_limits(
    module: &Module,
    id: FunctionId,
    back: Result<Back, TooMany>,
) -> Result<Back, Vec<Diagnostic>> {
    back.map_err(|why| {
        let (title, help) = match why {
            TooMany::Words => (
                "too many values are needed behind calls of tasks",
                "each such call passes on all that is needed after it: compute less before it, or leave `@task` away",
            ),
            TooMany::Tasks => (
                "the program has too many tasks, or tasks of too many words",
                "pass fewer words, and leave `@task` away where it is not needed",
            ),
        };
        vec![too_much(module, id, title, help)]
    })
}

/// Bakes behind all that they read.
fn in_order(mut bakes: BTreeMap<u32, Bake>) -> Vec<Bake> {
    let mut order = Vec::new();
    while !bakes.is_empty() {
        let ready = bakes.values().find(|bake| !bake.reads.iter().any(|slot| bakes.contains_key(slot)));
        let slot = ready.expect("no bake reads one that leads back to it").slot;
        order.extend(bakes.remove(&slot));
    }
    order
}

/// Slots of the data layers that a program reads.
pub(crate) fn slots(program: &Program) -> BTreeSet<u32> {
    let mut found = BTreeSet::new();
    for function in &program.functions {
        core::walk::statements(&function.body.stmts, &mut |stmt| {
            if let Op::Intrinsic(intrinsic, args) = &stmt.op
                && intrinsic.reading().is_some()
                && let Some(Atom::Const(Const::U32(slot))) = args.first()
            {
                found.insert(*slot);
            }
        });
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compile::check;
    use crate::source::Source;

    fn names(module: &Module, plan: &Plan, of: &str) -> Vec<String> {
        let id = module.function(of).expect("is there");
        let name = |id: &FunctionId| module.functions[id.0 as usize].name.clone();
        plan.read_by(id).keys().map(name).collect()
    }

    #[test]
    fn what_leads_back_is_called() {
        let text = "
            raster layer: f32;
            param op: fn(vec2) -> f32 = c;
            @bake fn a(p: vec2) -> f32 = b(p) + layer(p);
            @bake fn b(p: vec2) -> f32 = if p.x > 1.0 { op(p - 1.0) } else { 0.0 };
            @bake fn c(p: vec2) -> f32 = if p.y > 1.0 { b(p) } else { p.x };
            fn pixel(p: vec2) -> f32 = a(p) + c(p);
        ";
        let module = check(Source::new("test", text)).unwrap_or_else(|e| panic!("{e:?}")).module;
        let plan = Plan::new(&module, &Settings::default(), module.function("pixel").unwrap());
        assert_eq!(names(&module, &plan, "pixel"), ["a", "b", "c"]);
        assert_eq!(names(&module, &plan, "a"), ["b", "c"]);
        assert!(names(&module, &plan, "b").is_empty() && names(&module, &plan, "c").is_empty());
        let a = module.function("a").unwrap();
        assert_eq!((plan.function(1), plan.function(0)), (Some(a), None));
    }
}
