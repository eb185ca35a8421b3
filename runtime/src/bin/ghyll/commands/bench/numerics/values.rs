//! What functions give out of their domains.

use super::super::program;
use super::{Seat, exact, pixels};
use crate::failure::Failure;
use ghyll_compiler::compile::EntryKind;
use serde_json::{Value, json};

/// Calls, with their argument apart so that nothing can evaluate them before.
const CALLS: &[(&str, f32)] = &[
    ("sqrt(-1.0)", -1.0),
    ("inverseSqrt(0.0)", 0.0),
    ("inverseSqrt(-1.0)", -1.0),
    ("log(0.0)", 0.0),
    ("log(-1.0)", -1.0),
    ("log2(0.0)", 0.0),
    ("pow(-2.0, 2.0)", -2.0),
    ("pow(0.0, 0.0)", 0.0),
    ("pow(0.0, -1.0)", 0.0),
    ("asin(2.0)", 2.0),
    ("acos(2.0)", 2.0),
    ("acosh(0.5)", 0.5),
    ("atanh(1.0)", 1.0),
    ("atanh(2.0)", 2.0),
    ("atan2(0.0, 0.0)", 0.0),
    ("exp(100.0)", 100.0),
    ("exp(-200.0)", -200.0),
    ("exp2(200.0)", 200.0),
    ("sin(1e30)", 1e30),
    ("1.0 / 0.0", 0.0),
    ("0.0 / 0.0", 0.0),
    ("1.0 % 0.0", 0.0),
    ("normalize(vec2(0.0, 0.0)).x", 0.0),
    ("clamp(1.0, 2.0, 0.0)", 0.0),
    ("smoothstep(0.0, 0.0, 1.0)", 0.0),
    ("f32(i32(3e9))", 3e9),
    ("f32(i32(0.0 / 0.0))", 0.0),
    ("f32(u32(-1.5))", -1.5),
];

/// The call with its argument as x.
fn of_x((call, argument): &(&str, f32)) -> String {
    let number = [format!("{argument:?}"), format!("{argument:e}"), "3e9".into()];
    let number = number.iter().find(|n| call.contains(n.as_str())).cloned().unwrap_or_default();
    call.replace(&number, "x")
}

pub fn rows(machines: &[Seat]) -> Result<Vec<Value>, Failure> {
    let shown = |x: f64| match x {
        x if x.is_nan() => "NaN".to_string(),
        f64::INFINITY => "inf".into(),
        f64::NEG_INFINITY => "-inf".into(),
        x if x != 0.0 && !(1e-4..1e6).contains(&x.abs()) => format!("{x:e}"),
        x => x.to_string(),
    };
    let mut rows = Vec::new();
    for row @ (call, argument) in CALLS {
        let bits = argument.to_bits();
        let text = format!(
            "fn pixel(p: vec2) -> vec4 {{ let x = bitcast_f32({bits}u + u32(p.x)); vec4(x, 0.0, 0.0, {}) }}",
            of_x(row)
        );
        let compiled = program(call, &text, EntryKind::Image)?;
        let real = exact(&compiled, (1, 1))?[0][3];
        for (machine, backend, adapter) in machines {
            let value = pixels(&compiled, (1, 1), machine)?[0][3];
            rows.push(json!({
                "name": call,
                "backend": backend,
                "adapter": adapter,
                "value": shown(f64::from(value)),
                "exact": shown(real),
            }));
        }
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_call_is_a_program_of_x() {
        for row in CALLS {
            assert!(of_x(row).contains('x'), "{row:?}: {}", of_x(row));
        }
        assert_eq!(of_x(&("0.0 / 0.0", 0.0)), "x / x");
        let seats = [(ghyll_runtime::machine::Machine::Cpu, "cpu", "twin".to_string())];
        let rows = rows(&seats).unwrap();
        assert_eq!(rows.len(), CALLS.len());
        let value = |name: &str| rows.iter().find(|r| r["name"] == name).unwrap()["value"].clone();
        assert_eq!(
            (value("sqrt(-1.0)"), value("1.0 / 0.0"), value("f32(u32(-1.5))")),
            ("NaN".into(), "inf".into(), "0".into())
        );
    }
}
