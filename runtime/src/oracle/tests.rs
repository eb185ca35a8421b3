//! Programs whose values are known, limits, and single precision against the twin to the bit.

mod derivatives;
mod surfaces;

use std::time::Duration;

use ghyll_compiler::compile::{self, Compiled, compile};
use ghyll_compiler::core::{Const, Intrinsic};
use ghyll_compiler::front::{Checked, front};
use ghyll_compiler::source::{NoFiles, Source};
use ghyll_compiler::stream::initial;

use super::{OracleOptions, Precision, evaluate, render};
use crate::config::Config;
use crate::error::RunError;
use crate::twin::Twin;
use crate::value::Value;
use crate::world::World;

fn check(text: &str) -> Checked {
    front(Source::new("test.ghyll", text), &NoFiles).unwrap_or_else(|r| panic!("{:?}\n{text}", r.diagnostics))
}

fn run(text: &str, args: &[Value], options: &OracleOptions) -> Result<Value, RunError> {
    let checked = check(text);
    let entry = checked.module.function("main").expect("main is there");
    evaluate(&checked.module, entry, args, options, Some(&Slope))
}

fn value(text: &str, args: &[Value]) -> String {
    run(text, args, &OracleOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}")).to_string()
}

/// A plane that rises by 0.25 to the east, and a camera that looks down.
struct Slope;

impl World for Slope {
    fn eval_f64(&self, intrinsic: Intrinsic, args: &[f64], out: &mut [f64]) {
        match intrinsic {
            Intrinsic::Bilinear => out[0] = 0.25 * args[0],
            Intrinsic::GradientBilinear => out.copy_from_slice(&[0.25, 0.0]),
            Intrinsic::TraceBilinear => out.copy_from_slice(&[1.0, args[2] - 0.25 * args[0]]),
            _ => out.fill(0.0),
        }
    }

    fn eval_f32(&self, intrinsic: Intrinsic, args: &[u32], out: &mut [u32]) {
        let args: Vec<f64> = args.iter().map(|w| f32::from_bits(*w) as f64).collect();
        let mut wide = vec![0.0; out.len()];
        self.eval_f64(intrinsic, &args, &mut wide);
        for (i, (to, from)) in out.iter_mut().zip(wide).enumerate() {
            *to = match intrinsic.results()[i] {
                ghyll_compiler::core::Scalar::Bool => (from != 0.0) as u32,
                _ => (from as f32).to_bits(),
            };
        }
    }
}

#[test]
fn closures_and_partial_application() {
    let text = "fn twice(f: fn(i32) -> i32) -> fn(i32) -> i32 = |x| f(f(x));
        fn add(a: i32, b: i32) -> i32 = a + b;
        fn main(n: i32) -> i32 {
            let k = n * 10;
            let f = if n > 1 { add(k, _) } else { |x| x - k };
            twice(f)(1) |> twice(|y| y * 2)
        }";
    assert_eq!(value(text, &[Value::I32(3)]), "244");
    assert_eq!(value(text, &[Value::I32(1)]), "-76");
}

#[test]
fn patterns_guards_and_updates() {
    let text = "struct Ray(origin: vec3, near: f32);
        enum Shape { Dot, Disc(f32), Box(i32, i32) }
        fn size(s: Shape) -> i32 = match s {
            Dot => 0,
            Disc(r) if r > 2.0 => 100,
            Disc(r) => i32(r),
            Box(0, n) | Box(n, 0) => n,
            Box(a, b) => a * b,
        };
        fn main() -> ([i32; 5], Ray) = (
            [size(Dot), size(Disc(3.0)), size(Disc(1.5)), size(Box(7, 0)), size(Box(3, 4))],
            Ray(vec3(1.0), 2.0) with (near: 0.5));";
    assert_eq!(value(text, &[]), "([0, 100, 1, 7, 12], Ray(origin: vec3(1.0, 1.0, 1.0), near: 0.5))");
}

#[test]
fn ranges_in_order_and_empty() {
    let text = "fn main() -> (i32, i32, vec2, bool, bool) = (
        fold(0..5, 1, |a, i| a * 10 + i),
        sum(-2..4, |i| i * i),
        sum(3..3, |i| vec2(1.0, 2.0)),
        any(0..10, |i| i == 9),
        all(5..0, |i| false));";
    assert_eq!(value(text, &[]), "(101234, 19, vec2(0.0, 0.0), true, true)");
}

#[test]
fn derivatives_and_surfaces() {
    let text = "use terrain;
        fn rough(p: vec2) -> f32 = bilinear(p) + sin(p.y);
        fn same(p: vec2) -> f32 = bilinear(p);
        fn main() -> (vec2, vec2, f32) =
            (grad(rough)(vec2(3.0, 0.0)), grad(same)(vec2(1.0, 1.0)), deriv(|x| x * x * x)(2.0));";
    let found = run(text, &[], &OracleOptions::default()).unwrap();
    let expected =
        Value::Tuple(vec![Value::Vec(vec![0.25, 1.0]), Value::Vec(vec![0.25, 0.0]), Value::F32(12.0)]);
    assert!(found.close(&expected, 1e-9, 1e-9), "{found}");
    let text = "use terrain;
        fn same(p: vec2) -> f32 = bilinear(p);
        fn main() -> Option<f32> = trace(same, Ray(vec3(4.0, 0.0, 9.0), vec3(0.0, 0.0, -1.0), 0.0, 99.0));";
    assert_eq!(value(text, &[]), "Some(8.0)");
}

#[test]
fn tail_calls_keep_no_stack_and_recursion_is_deep() {
    let loops = "fn count(n: i32, a: i32) -> i32 {
            let b = a + 1;
            if n == 0 { a } else { match n % 2 { 0 => count(n - 1, b), _ => { let c = b; count(n - 1, c) } } }
        }
        fn even(n: i32) -> bool = n == 0 || odd(n - 1);
        fn odd(n: i32) -> bool = n != 0 && even(n - 1);
        fn main(n: i32) -> (i32, bool) = (count(n, 0), even(n));";
    let small = OracleOptions { max_memory: 16 << 20, ..OracleOptions::default() };
    let found = run(loops, &[Value::I32(100_001)], &small).unwrap();
    assert_eq!(found.to_string(), "(100001, false)");
    let deep = "fn total(n: i32) -> i32 = if n == 0 { 0 } else { n + total(n - 1) };
        fn main(n: i32) -> i32 = total(n);";
    assert_eq!(value(deep, &[Value::I32(60_000)]), "1800030000");
    let error = run(deep, &[Value::I32(1_000_000)], &small).unwrap_err();
    assert!(
        matches!(&error, RunError::TooDeep { function, depth, .. }
        if function == "total" && *depth > 100),
        "{error}"
    );
}

#[test]
fn what_does_not_end_is_an_error_that_names_the_function() {
    let text = "fn spin(n: i32) -> i32 = spin(n + 1);
        fn long(n: i32) -> i32 = sum(0..2000000000, |i| i * n);
        fn main(n: i32) -> i32 = if n == 0 { spin(n) } else { long(n) };";
    let short = OracleOptions { timeout: Duration::from_millis(100), ..OracleOptions::default() };
    for (n, name) in [(0, "spin"), (1, "long")] {
        let error = run(text, &[Value::I32(n)], &short).unwrap_err();
        assert!(matches!(&error, RunError::Timeout { function, .. } if function == name), "{error}");
    }
    let few = OracleOptions { max_steps: Some(1000), ..OracleOptions::default() };
    let error = run(text, &[Value::I32(0)], &few).unwrap_err();
    assert_eq!(error, RunError::MaxRewrites { function: "spin".into(), limit: 1000 });
}

/// Integers, floats of every kind of built-in, control flow, tasks.
const MIXED: &str = "
    @task fn wave(x: f32, n: i32) -> f32 = if n <= 0 { x } else { 0.5 * wave(sin(x * 1.7) + 0.3, n - 1) + fract(x) };
    fn geometry(v: vec3) -> vec3 {
        let n = normalize(v + vec3(0.1, 0.2, 0.3));
        let r = reflect(v, n) + refract(n, normalize(v.zxy), 0.7) + cross(v, n);
        faceForward(mix(r, v, 0.3), n, v) * smoothstep(0.0, 3.0, length(v)) + step(vec3(0.5), n)
    }
    fn matrices(v: vec3) -> vec3 {
        let m = mat3(v, v.yzx, vec3(1.0, 2.0, 3.0));
        transpose(m) * v + v * m * determinant(m) + (m * m)[1]
    }
    fn scalars(x: f32) -> f32 =
        exp(-abs(x)) + log(abs(x) + 1.0) + pow(abs(x), 1.3) + atan2(x, 2.0) + inverseSqrt(x * x + 1.0)
        + degrees(x) + radians(x) + clamp(x, -1.0, 1.0) + round(x) + x % 0.7 + fma(x, x, 1.0) + distance(x, 3.0);
    fn bits(n: i32) -> i32 = (n << 3) ^ (n >> 1) + n * 7919 / 3 + n % 5 + countOneBits(n) - firstLeadingBit(n);
    fn main(n: i32, x: f32) -> (f32, vec3, vec3, f32, i32, bool) {
        let v = vec3(x, x * 0.5 - 1.0, f32(n));
        let s = sum(0..n, |i| wave(x + f32(i), i));
        (s, geometry(v), matrices(v), scalars(x), fold(0..n, n, |a, i| bits(a + i)), any(0..n, |i| f32(i) > x))
    }";

fn compiled(checked: &Checked) -> Compiled {
    let options = compile::Options { entry: Some("main".into()), ..compile::Options::default() };
    match compile(checked, &options) {
        Ok(compiled) => compiled,
        Err(error) => panic!("{error:?}"),
    }
}

fn both(oracle: &str, twin: &str, args: &[(Value, Const)]) -> (Value, Value) {
    let (values, constants): (Vec<_>, Vec<_>) = args.iter().cloned().unzip();
    let single = OracleOptions { precision: Precision::F32, ..OracleOptions::default() };
    let expected = run(oracle, &values, &single).unwrap();
    let checked = check(twin);
    let compiled = compiled(&checked);
    let table = &compiled.back.table;
    let start = initial(table, compiled.back.entry, &constants);
    let (words, _) = Twin::new(table).unwrap().run(&start, &Config::default(), Some(&Slope)).unwrap();
    (expected, Value::unflatten(&words, &compiled.result, &checked.module).unwrap())
}

/// `sum` may be grouped freely where its body is a task, so its floats may differ in the last places.
#[test]
fn single_precision_is_the_twins_to_the_bit() {
    for (n, x) in [(0, 0.3f32), (1, -1.25), (5, 2.6), (9, 0.0), (12, 7.75)] {
        let args = [(Value::I32(n), Const::I32(n)), (Value::F32(x as f64), Const::f32(x))];
        let (Value::Tuple(expected), Value::Tuple(found)) = both(MIXED, MIXED, &args) else {
            panic!("main gives a tuple");
        };
        assert!(expected[0].close(&found[0], 1e-5, 1e-5), "{} {}", expected[0], found[0]);
        for (expected, found) in expected[1..].iter().zip(&found[1..]) {
            assert!(expected.close(found, 0.0, 0.0), "n = {n}, x = {x}: {expected} and {found}");
        }
    }
}

#[test]
fn a_planted_difference_is_found() {
    let other = MIXED.replace("7919", "7907").replace("0.7) + cross", "0.71) + cross");
    let args = [(Value::I32(5), Const::I32(5)), (Value::F32(2.5), Const::f32(2.5))];
    let (Value::Tuple(expected), Value::Tuple(found)) = both(MIXED, &other, &args) else {
        panic!("main gives a tuple");
    };
    assert!(!expected[1].close(&found[1], 0.0, 0.0));
    assert!(!expected[4].close(&found[4], 0.0, 0.0));
    assert!(expected[2].close(&found[2], 0.0, 0.0));
}

#[test]
fn parameters_can_be_set() {
    let text = "param k: i32 = 2; const TWICE = 2 * 21; fn main() -> i32 = k * TWICE;";
    let checked = check(text);
    let entry = checked.module.function("main").expect("main is there");
    let other = check("param k: i32 = { let a = 2; let b = 3; a + b }; fn main() -> i32 = k;");
    let param = other.module.params[0].clone();
    let setting = ghyll_compiler::lower::Setting { value: param.default, locals: param.locals };
    let set = vec![(ghyll_compiler::typed::ParamId(0), setting)];
    let mut options = OracleOptions::default();
    assert_eq!(evaluate(&checked.module, entry, &[], &options, None), Ok(Value::I32(84)));
    options.set = set;
    assert_eq!(evaluate(&checked.module, entry, &[], &options, None), Ok(Value::I32(210)));
}

#[test]
fn pictures_have_their_origin_top_left() {
    let checked = check("fn pixel(p: vec2) -> vec2 = p;");
    let entry = checked.module.function("pixel").expect("pixel is there");
    let image = render(&checked.module, entry, (2, 2), [0.5, 0.5], &OracleOptions::default(), None).unwrap();
    assert_eq!(image, [0.5, 0.5, 1.5, 0.5, 0.5, 1.5, 1.5, 1.5]);
}
