//! `ghyll bench numerics`: the largest error of every built-in function over its domain, on every machine, against the oracle.
//!
//! Arguments are made of integers by each machine itself, so that all of them and the oracle have the same ones: floats that lie
//! evenly by their bits, random ones by bits and by value, and edges.

mod table;
mod values;

use super::folder::Folder;
use super::program;
use super::reference::PATIENCE;
use crate::arguments::{Bench, On};
use crate::failure::Failure;
use ghyll_compiler::compile::{Compiled, EntryKind};
use ghyll_compiler::front::Checked;
use ghyll_runtime::config::Config;
use ghyll_runtime::gpu::Gpu;
use ghyll_runtime::machine::{Job, Machine};
use ghyll_runtime::oracle::{self, OracleOptions};
use ghyll_runtime::renderer::Renderer;
use serde_json::{Value, json};
use std::fmt::Write;
use table::{Function, TABLE};

/// Pixels that take their arguments from the edges.
const EDGES: u32 = 4096;

/// Spacing of single precision numbers at x.
fn ulp(x: f64) -> f64 {
    let power = x.abs().max(f64::from(f32::MIN_POSITIVE)).log2().floor() as i32;
    // The logarithm may be rounded up.
    let power = if 2f64.powi(power) > x.abs() { power - 1 } else { power };
    2f64.powi(power.max(-126) - 23)
}

/// A number for every float, in the floats' order.
fn key(x: f32) -> u32 {
    let bits = x.to_bits();
    if bits >> 31 == 0 { bits ^ 0x8000_0000 } else { !bits }
}

/// Floats of a domain where functions tend to be wrong, and their neighbours.
fn edges([low, high]: [f32; 2]) -> Vec<u32> {
    use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};
    let special = [
        0.0,
        f32::MIN_POSITIVE,
        1e-30,
        1e-6,
        0.5,
        1.0,
        2.0,
        FRAC_PI_4,
        FRAC_PI_2,
        PI,
        100.0,
        1e30,
        low,
        high,
    ];
    let mut found: Vec<u32> = Vec::new();
    for x in special.into_iter().flat_map(|x| [x, -x]) {
        let beside = [key(x).saturating_sub(1), key(x), key(x).saturating_add(1)];
        found.extend(beside.into_iter().filter(|k| (key(low)..=key(high)).contains(k)));
    }
    found.sort_unstable();
    found.dedup();
    found
}

/// The program whose pixel is the arguments and the value.
fn text(function: &Function, (width, height): (u32, u32)) -> String {
    let mut text = String::from(
        "use terrain;\n\
         fn float(k: u32) -> f32 = if k >= 0x80000000u { bitcast_f32(k ^ 0x80000000u) } else { bitcast_f32(!k) };\n",
    );
    let count = width * height;
    for (at, domain) in function.domain.iter().enumerate() {
        let [low, high] = *domain;
        let (first, span) = (key(low), key(high) - key(low));
        let edges = edges(*domain);
        let list: Vec<String> = edges.iter().map(|k| format!("{k}u")).collect();
        let n = edges.len() as u32;
        // Whole numbers of this unit have at most 24 bits.
        let unit = 2f64.powi(low.abs().max(high.abs()).log2().ceil() as i32 - 23);
        let (from, to) = ((f64::from(low) / unit).ceil() as i32, (f64::from(high) / unit).floor() as i32);
        let divisor = n.pow(at as u32);
        let _ = writeln!(
            text,
            "fn argument{at}(i: u32) -> f32 {{\n\
             let h = hash(i * 3u + {at}u);\n\
             if i < {EDGES}u {{ float([{list}][i32(i / {divisor}u % {n}u)]) }} else {{\n\
             match i32(i % 4u) {{ 0 => {even}, 1 => float({first}u + {random}), \
             _ => f32({from} + i32(h % {range}u)) * {unit:e} }} }}\n}}",
            list = list.join(", "),
            // The first argument goes evenly through its domain, the others at random.
            even = if at == 0 {
                format!("float({first}u + i * {}u)", span / count)
            } else {
                format!("float({first}u + {})", below(span))
            },
            random = below(span),
            range = (to - from) as u32 + 1,
        );
    }
    let x = |at: usize| if at < function.domain.len() { format!("argument{at}(i)") } else { "0.0".into() };
    let _ = writeln!(
        text,
        "fn pixel(p: vec2) -> vec4 {{\n\
         let i = u32(p.x) + {width}u * u32(p.y);\n\
         let x = {}; let y = {}; let z = {};\n\
         vec4(x, y, z, {})\n}}",
        x(0),
        x(1),
        x(2),
        function.text
    );
    text
}

fn below(span: u32) -> String {
    if span == u32::MAX { "h".into() } else { format!("h % {}u", span + 1) }
}

/// Arguments and value of each pixel on a machine.
fn pixels(
    (checked, compiled): &(Checked, Compiled),
    size: (u32, u32),
    machine: &Machine,
) -> Result<Vec<[f32; 4]>, Failure> {
    let job = Job { checked, compiled, scene: None };
    let config = Config { timeout: PATIENCE, ..Config::default() };
    let (image, _) = Renderer::default().render(&job, machine, size, &config).map_err(Failure::run)?;
    Ok(image.data.chunks_exact(4).map(|p| [p[0], p[1], p[2], p[3]]).collect())
}

fn exact((checked, compiled): &(Checked, Compiled), size: (u32, u32)) -> Result<Vec<[f64; 4]>, Failure> {
    let options = OracleOptions { timeout: PATIENCE, ..OracleOptions::default() };
    let place = |column: u32, row: u32| [f64::from(column) + 0.5, f64::from(row) + 0.5];
    let all = oracle::components(&checked.module, compiled.entry, size, &place, &options, None)
        .map_err(Failure::run)?;
    Ok(all.chunks_exact(4).map(|p| [p[0], p[1], p[2], p[3]]).collect())
}

/// The largest errors found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Largest {
    ulp: f64,
    absolute: f64,
    /// Of the error that is allowed.
    share: f64,
    at: [f64; 3],
    values: usize,
}

fn largest(function: &Function, found: &[[f32; 4]], real: &[[f64; 4]]) -> Largest {
    let mut largest = Largest::default();
    for (found, real) in found.iter().zip(real) {
        let [x, y, z, real] = *real;
        let arguments = [x, y, z];
        let tiny = |x: &f64| *x != 0.0 && x.abs() < f64::from(f32::MIN_POSITIVE);
        // Numbers below the normal ones may be taken as zero, and what no float can hold is not compared.
        if arguments.iter().any(tiny) || !real.is_finite() || real.abs() > f64::from(f32::MAX) {
            continue;
        }
        let value = f64::from(found[3]);
        let given = (0..3).all(|k| f64::from(found[k]) == arguments[k]);
        let mut error = (value - real).abs();
        if real.abs() < f64::from(f32::MIN_POSITIVE) && value.abs() <= f64::from(f32::MIN_POSITIVE) {
            error = 0.0;
        }
        if !given || error.is_nan() {
            error = f64::INFINITY;
        }
        largest.values += 1;
        let allowed = function.allowed.map_or(ulp(real), |allowed| allowed(arguments, real));
        let share = if error == 0.0 { 0.0 } else { error / allowed };
        if share > largest.share {
            (largest.share, largest.at) = (share, arguments);
        }
        largest.ulp = largest.ulp.max(error / ulp(real));
        largest.absolute = largest.absolute.max(error);
    }
    largest
}

/// Whether two machines have the same arguments and value to the bit. WGSL leaves open whether a number below the normal ones counts
/// as zero, and which of two zeros `min` and `max` give.
fn same(a: &[f32; 4], b: &[f32; 4]) -> bool {
    let arguments = (0..3).all(|k| a[k].to_bits() == b[k].to_bits());
    let open = a[..3].iter().any(|x| x.is_subnormal());
    let value = a[3].to_bits() == b[3].to_bits() || (a[3] == 0.0 && b[3] == 0.0);
    arguments && (open || value)
}

pub fn rows(arguments: &Bench, gpu: Option<&Gpu>) -> Result<Vec<Value>, Failure> {
    let machines = machines(arguments.on, gpu)?;
    let size = arguments.size.map_or((256, 256), |[width, height]| (width, height));
    let wanted = |name: &str| arguments.only.as_deref().is_none_or(|part| name.contains(part));
    let mut rows = Vec::new();
    for function in TABLE.iter().filter(|function| wanted(function.name)) {
        let compiled = program(function.name, &text(function, size), EntryKind::Image)?;
        let real = exact(&compiled, size)?;
        let mut answers = Vec::new();
        for (machine, backend, adapter) in &machines {
            let found = pixels(&compiled, size, machine)?;
            let Largest { ulp, absolute, share, at, values } = largest(function, &found, &real);
            let at: Vec<String> = at[..function.domain.len()].iter().map(f64::to_string).collect();
            rows.push(json!({
                "name": function.name,
                "domain": function.range(),
                "backend": backend,
                "adapter": adapter,
                "values": values,
                "largest_ulp": ulp,
                "largest_absolute": absolute,
                "at": at.join(", "),
                "bound": function.bound,
                "share_of_bound": function.allowed.map(|_| share),
                "holds": function.allowed.map(|_| share <= 1.0),
            }));
            answers.push(found);
        }
        if let [a, b] = &answers[..] {
            let differ = a.iter().zip(b).filter(|(a, b)| !same(a, b)).count();
            rows.push(json!({
                "name": format!("{}: values that differ between cpu and gpu", function.name),
                "figure": differ,
                "bound": function.identical.then_some(0),
                "unit": "values",
                "holds": function.identical.then_some(differ == 0),
            }));
        }
    }
    if arguments.only.is_none() {
        rows.extend(values::rows(&machines)?);
    }
    if rows.is_empty() {
        return Err(Failure::Usage("--only fits no function of the table".into()));
    }
    if let Some(folder) = &arguments.output {
        Folder::create(folder)?.save("numerics.md", markdown(&rows))?;
    }
    Ok(rows)
}

type Seat = (Machine, &'static str, String);

fn machines(on: On, gpu: Option<&Gpu>) -> Result<Vec<Seat>, Failure> {
    let device = |gpu: &Gpu| (Machine::Gpu(Box::new(gpu.clone())), "gpu", gpu.info().name.clone());
    let cpu = (Machine::Cpu, "cpu", "twin".to_string());
    match (on, gpu) {
        (On::Oracle, _) => Err(Failure::Usage("the oracle is the judge; use --on cpu, gpu or auto".into())),
        (On::Gpu, None) => Err(Failure::Usage("there is no GPU adapter; use --on cpu".into())),
        (On::Gpu, Some(gpu)) => Ok(vec![device(gpu)]),
        (On::Auto, Some(gpu)) => Ok(vec![cpu, device(gpu)]),
        _ => Ok(vec![cpu]),
    }
}

/// The tables of the manual: a line for each function with a column for each machine, then the values out of the domains.
fn markdown(rows: &[Value]) -> String {
    let text = |row: &Value, key: &str| row[key].as_str().unwrap_or_default().to_string();
    let with = |key: &str| rows.iter().filter(|row| !row[key].is_null()).collect::<Vec<_>>();
    let (errors, values, equal) = (with("largest_ulp"), with("value"), with("figure"));
    let mut backends: Vec<String> = Vec::new();
    for row in errors.iter().chain(&values) {
        let name = text(row, "backend");
        if !backends.contains(&name) {
            backends.push(name);
        }
    }
    let heads: String = backends.iter().map(|b| format!(" {b} |")).collect();
    let lines = "---|".repeat(backends.len());
    let mut out = format!("| function | domain | bound |{heads} same bits |\n|---|---|---|{lines}---|\n");
    let mut done = Vec::new();
    for row in &errors {
        let (name, domain) = (text(row, "name"), text(row, "domain"));
        if done.contains(&(name.clone(), domain.clone())) {
            continue;
        }
        let figure = |backend: &String| {
            let own = errors.iter().find(|r| text(r, "name") == name && text(r, "backend") == *backend);
            let number = |key: &str| own.and_then(|r| r[key].as_f64());
            match (number("largest_ulp"), number("largest_absolute")) {
                (Some(ulp), _) if ulp < 100.0 => format!(" {ulp:.2} ulp |"),
                (_, Some(absolute)) => format!(" {absolute:.1e} |"),
                _ => " not finite |".into(),
            }
        };
        let figures: String = backends.iter().map(figure).collect();
        let differ = equal.iter().find(|r| text(r, "name").starts_with(&format!("{name}:")));
        let same = differ.map_or("-".into(), |r| match r["figure"].as_u64() {
            Some(0) => "all".into(),
            n => format!("all but {}", n.unwrap_or_default()),
        });
        let _ = writeln!(out, "| `{name}` | {domain} | {} |{figures} {same} |", text(row, "bound"));
        done.push((name, domain));
    }
    let _ = writeln!(out, "\n| out of the domain | exact |{heads}\n|---|---|{lines}");
    let mut done = Vec::new();
    for row in &values {
        let name = text(row, "name");
        if !done.contains(&name) {
            let of = |b: &String| values.iter().find(|r| text(r, "name") == name && text(r, "backend") == *b);
            let found: String = backends
                .iter()
                .map(|b| format!(" {} |", of(b).map_or("-".into(), |r| text(r, "value"))))
                .collect();
            let _ = writeln!(out, "| `{name}` | {} |{found}", text(row, "exact"));
            done.push(name);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: (u32, u32) = (96, 64);

    #[test]
    fn an_ulp_is_the_distance_of_neighbours() {
        assert_eq!(ulp(1.0), f64::from(f32::EPSILON));
        assert_eq!(ulp(1.999), f64::from(f32::EPSILON));
        assert_eq!(ulp(2.0), 2.0 * f64::from(f32::EPSILON));
        assert_eq!(ulp(0.0), 2f64.powi(-149));
        assert_eq!(key(1.0) + 1, key(1.0f32.next_up()));
        assert!(key(-1.0) < key(-0.0) && key(-0.0) < key(0.0));
    }

    #[test]
    fn every_function_holds_on_the_twin() {
        for function in TABLE {
            let compiled = program(function.name, &text(function, SIZE), EntryKind::Image)
                .unwrap_or_else(|e| panic!("{}: {e:?}\n{}", function.name, text(function, SIZE)));
            let found = pixels(&compiled, SIZE, &Machine::Cpu).unwrap();
            let found = largest(function, &found, &exact(&compiled, SIZE).unwrap());
            assert!(function.allowed.is_none() || found.share <= 1.0, "{}: {found:?}", function.name);
            assert!(found.values > 1000, "{}: {found:?}", function.name);
        }
    }

    #[test]
    fn a_planted_difference_of_machines_is_found() {
        let a = [1.0, -2.0, 0.0, 0.5];
        let other = |at: usize, value: f32| {
            let mut b = a;
            b[at] = value;
            b
        };
        assert!(same(&a, &a));
        assert!(!same(&a, &other(3, 0.5f32.next_up())) && !same(&a, &other(0, 1.0f32.next_up())));
        assert!(!same(&a, &other(2, -0.0)) && !same(&other(3, 0.0), &other(3, 1e-40)));
        assert!(same(&other(3, 0.0), &other(3, -0.0)));
        let tiny = |value: f32| [1e-40, 1.0, 0.0, value];
        assert!(same(&tiny(1e-40), &tiny(0.0)));
    }

    #[test]
    fn a_planted_error_and_other_arguments_are_found() {
        let function = TABLE.iter().find(|f| f.name == "sqrt(x)").unwrap();
        let compiled = program(function.name, &text(function, SIZE), EntryKind::Image).unwrap();
        let real = exact(&compiled, SIZE).unwrap();
        let mut found = pixels(&compiled, SIZE, &Machine::Cpu).unwrap();
        assert!(largest(function, &found, &real).ulp <= 0.5);
        found[5000][3] *= 1.0 + 8.0 * f32::EPSILON;
        let planted = largest(function, &found, &real);
        assert!(planted.share > 1.0 && planted.at[0] == real[5000][0], "{planted:?}");
        found[5001][0] *= 2.0;
        assert_eq!(largest(function, &found, &real).ulp, f64::INFINITY);
    }
}
