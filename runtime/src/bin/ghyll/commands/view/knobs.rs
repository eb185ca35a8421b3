//! Live parameters that keys change.

use ghyll_compiler::compile::Compiled;
use ghyll_compiler::front::Checked;
use ghyll_compiler::typed::{ParamId, Type};
use ghyll_runtime::machine::evaluate_argument;
use ghyll_runtime::value::Value;

/// A parameter with its value.
#[derive(Clone, Debug, PartialEq)]
pub struct Knob {
    pub name: String,
    kind: Kind,
}

#[derive(Clone, Debug, PartialEq)]
enum Kind {
    Bool(bool),
    Whole {
        value: i64,
        low: i64,
        high: i64,
    },
    Real {
        value: f64,
        low: f64,
        high: f64,
        step: f64,
    },
    /// One of some functions.
    Choice {
        names: Vec<String>,
        at: usize,
    },
}

/// Steps from one end of a stated range to the other.
const STEPS: f64 = 50.0;

/// The live parameters that can be changed step by step.
pub fn knobs(checked: &Checked, compiled: &Compiled) -> Vec<Knob> {
    compiled.settings.live.iter().filter_map(|id| knob(checked, compiled, *id)).collect()
}

fn knob(checked: &Checked, compiled: &Compiled, id: ParamId) -> Option<Knob> {
    let param = &checked.module.params[id.0 as usize];
    let name = param.name.clone();
    if let Some(slot) = compiled.slots.iter().find(|slot| slot.param == id) {
        let at = compiled.slot_word(&checked.module, slot) as usize;
        let choice = Kind::Choice { names: slot.names.clone(), at };
        return (slot.names.len() > 1).then_some(Knob { name, kind: choice });
    }
    let number = |expr, locals| evaluate_argument(checked, expr, locals, &param.ty).ok();
    let value = match compiled.settings.set.get(&id) {
        Some(setting) => number(setting.value.clone(), setting.locals.clone())?,
        None => number(param.default.clone(), param.locals.clone())?,
    };
    let ends = param.range.as_ref().and_then(|(lo, hi)| {
        let end = |e: &ghyll_compiler::typed::Expr| match number(e.clone(), param.locals.clone())? {
            Value::I32(i) => Some(f64::from(i)),
            Value::F32(x) => Some(x),
            _ => None,
        };
        Some((end(lo)?, end(hi)?))
    });
    let kind = match (value, &param.ty) {
        (Value::Bool(value), _) => Kind::Bool(value),
        (Value::I32(value), _) => {
            let (low, high) = ends.unwrap_or((f64::from(i32::MIN), f64::from(i32::MAX)));
            Kind::Whole { value: value.into(), low: low as i64, high: high as i64 }
        }
        (Value::U32(value), _) => Kind::Whole { value: value.into(), low: 0, high: u32::MAX.into() },
        (Value::F32(value), Type::F32) => {
            let (low, high) = ends.unwrap_or((f64::MIN, f64::MAX));
            let step = match ends {
                Some((low, high)) => (high - low) / STEPS,
                None => {
                    if value == 0.0 {
                        0.05
                    } else {
                        value.abs() / 20.0
                    }
                }
            };
            Kind::Real { value, low, high, step }
        }
        _ => return None,
    };
    Some(Knob { name, kind })
}

impl Knob {
    /// The value as it is set.
    pub fn text(&self) -> String {
        match &self.kind {
            Kind::Bool(value) => value.to_string(),
            Kind::Whole { value, .. } => value.to_string(),
            // Single precision is what the machine has; more digits only hide the value.
            Kind::Real { value, .. } => format!("{:?}", *value as f32),
            Kind::Choice { names, at } => names.get(*at).cloned().unwrap_or_default(),
        }
    }

    /// A step up or down; the text to set, if anything changes.
    pub fn step(&mut self, up: bool) -> Option<String> {
        let before = self.text();
        let sign = if up { 1.0 } else { -1.0 };
        match &mut self.kind {
            Kind::Bool(value) => *value = !*value,
            Kind::Whole { value, low, high } => *value = (*value + sign as i64).clamp(*low, *high),
            Kind::Real { value, low, high, step } => *value = (*value + sign * *step).clamp(*low, *high),
            Kind::Choice { names, at } => *at = (*at + if up { 1 } else { names.len() - 1 }) % names.len(),
        }
        let after = self.text();
        (after != before).then_some(after)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ghyll_compiler::compile::{self, Options};
    use ghyll_compiler::source::Source;

    const PROGRAM: &str = "
        param on: bool = false; param n: i32 = 3 in 1..4; param u: u32 = 0; param x: f32 = 0.5 in 0.0..1.0;
        param free: f32 = -2.0; param v: vec2 = vec2(1.0); param f: fn(f32) -> f32 = once;
        fn once(x: f32) -> f32 = x; fn twice(x: f32) -> f32 = 2.0 * x;
        fn pixel(p: vec2) -> f32 = f(p.x) + x + free + v.x + f32(n) + f32(u) + f32(on);";

    #[test]
    fn parameters_are_changed_in_steps_within_their_range() {
        let checked = compile::check(Source::new("test", PROGRAM)).unwrap();
        let live = ["on", "n", "u", "x", "free", "v", "f"].map(String::from).to_vec();
        let options = Options { live, set: vec![("n".into(), "4".into())], ..Options::default() };
        let compiled = compile::compile(&checked, &options).unwrap();
        let mut knobs = knobs(&checked, &compiled);
        let shown = |knobs: &[Knob]| {
            knobs.iter().map(|k| format!("{}={}", k.name, k.text())).collect::<Vec<_>>().join(" ")
        };
        // A vector has no steps.
        assert_eq!(shown(&knobs), "on=false n=4 u=0 x=0.5 free=-2.0 f=once");
        let up: Vec<_> = knobs.iter_mut().map(|k| k.step(true)).collect();
        assert_eq!(shown(&knobs), "on=true n=4 u=1 x=0.52 free=-1.9 f=twice");
        assert_eq!(up[1], None);
        for _ in 0..100 {
            knobs.iter_mut().for_each(|k| drop(k.step(false)));
        }
        assert_eq!(shown(&knobs), "on=true n=1 u=0 x=0.0 free=-11.9 f=twice");
    }
}
