//! THE table of what is measured: function, domain, and the error that WGSL allows.

use super::ulp;

pub struct Function {
    /// As it is written, of x, y and z.
    pub name: &'static str,
    pub text: &'static str,
    /// A range for each argument.
    pub domain: &'static [[f32; 2]],
    /// In words.
    pub bound: &'static str,
    /// Absolute error that is allowed for arguments and exact value.
    pub allowed: Option<Allowed>,
    /// Whether twin and GPU must give the same bits.
    pub identical: bool,
}

type Allowed = fn([f64; 3], f64) -> f64;

impl Function {
    pub fn range(&self) -> String {
        let sign = |x: f32| if x < 0.0 { "-" } else { "" };
        let number = |x: f32| match x.abs() {
            a if a == std::f32::consts::PI => format!("{}pi", sign(x)),
            a if a == f32::MAX => format!("{}max", sign(x)),
            a if a == f32::MIN_POSITIVE => "2^-126".into(),
            a if a != 0.0 && !(1e-4..1e6).contains(&a) => format!("{x:e}"),
            _ => x.to_string(),
        };
        let mut ranges: Vec<String> =
            self.domain.iter().map(|[low, high]| format!("[{}, {}]", number(*low), number(*high))).collect();
        ranges.dedup();
        ranges.join(", ")
    }
}

const PI: f32 = std::f32::consts::PI;
const MAX: f32 = f32::MAX;
const LEAST: f32 = f32::MIN_POSITIVE;
const ALL: [f32; 2] = [-MAX, MAX];
const UNIT: [f32; 2] = [-1.0, 1.0];
const HUNDRED: [f32; 2] = [-100.0, 100.0];
const GROUND: [f32; 2] = [-1000.0, 1000.0];

/// Half an ulp, and what the oracle itself rounds.
fn rounded(_: [f64; 3], value: f64) -> f64 {
    0.5000001 * ulp(value)
}

fn power([x, ..]: [f64; 3], value: f64) -> f64 {
    (3.0 + 2.0 * x.abs()) * ulp(value)
}

fn logarithm([x, ..]: [f64; 3], value: f64) -> f64 {
    if (0.5..=2.0).contains(&x) { 2f64.powi(-21).max(3.0 * ulp(value)) } else { 3.0 * ulp(value) }
}

/// `exp2(y * log2(x))`.
fn powers([x, y, _]: [f64; 3], value: f64) -> f64 {
    let exponent = y * x.log2();
    let lost = y.abs() * logarithm([x, 0.0, 0.0], x.log2()) + ulp(exponent);
    value * (lost.exp2() - 1.0) + power([exponent.abs() + lost, 0.0, 0.0], value)
}

/// `sin(x) / cos(x)`.
fn tangent([x, ..]: [f64; 3], value: f64) -> f64 {
    let (each, cosine) = (2f64.powi(-11), x.cos().abs());
    if cosine <= each {
        f64::INFINITY
    } else {
        each * (1.0 + value.abs()) / (cosine - each) + 2.5 * ulp(value)
    }
}

/// `(exp(x) -+ exp(-x)) / 2`.
fn hyperbolic([x, ..]: [f64; 3], value: f64) -> f64 {
    (3.0 + 2.0 * x.abs()) * ulp(x.abs().exp()) + ulp(value)
}

fn arc(_: [f64; 3], value: f64) -> f64 {
    6.8e-5f64.max(4096.0 * ulp(value))
}

const EXACT: &str = "correctly rounded";

const fn exact(name: &'static str, domain: &'static [[f32; 2]]) -> Function {
    Function { name, text: name, domain, bound: EXACT, allowed: Some(rounded), identical: true }
}

const fn bounded(
    name: &'static str,
    domain: &'static [[f32; 2]],
    bound: &'static str,
    allowed: Allowed,
) -> Function {
    Function { name, text: name, domain, bound, allowed: Some(allowed), identical: false }
}

const fn free(name: &'static str, domain: &'static [[f32; 2]]) -> Function {
    Function { name, text: name, domain, bound: "-", allowed: None, identical: false }
}

/// Of sums of products of numbers up to 1.
const FORMULA: &str = "1e-6, formula";
fn formula(_: [f64; 3], _: f64) -> f64 {
    1e-6
}

pub const TABLE: &[Function] = &[
    exact("x + y", &[HUNDRED, HUNDRED]),
    exact("x - y", &[HUNDRED, HUNDRED]),
    exact("x * y", &[HUNDRED, HUNDRED]),
    bounded("x / y", &[GROUND, [1e-3, 1000.0]], "2.5 ulp", |_, v| 2.5 * ulp(v)),
    exact("abs(x)", &[ALL]),
    exact("sign(x)", &[ALL]),
    exact("min(x, y)", &[ALL, ALL]),
    exact("max(x, y)", &[ALL, ALL]),
    exact("clamp(x, -1.5, y)", &[ALL, [0.0, 10.0]]),
    exact("saturate(x)", &[ALL]),
    exact("floor(x)", &[ALL]),
    exact("ceil(x)", &[ALL]),
    exact("trunc(x)", &[ALL]),
    exact("round(x)", &[ALL]),
    exact("fract(x)", &[[-1e7, 1e7]]),
    exact("step(x, y)", &[UNIT, UNIT]),
    bounded("smoothstep(-1.0, 2.0, x)", &[HUNDRED], FORMULA, formula),
    bounded("mix(x, y, z)", &[HUNDRED, HUNDRED, [0.0, 1.0]], "3 ulp of the larger term", |[x, y, z], _| {
        3.0 * ulp((x * (1.0 - z)).abs().max((y * z).abs()).max(x.abs() * ulp(1.0)))
    }),
    bounded("fma(x, y, z)", &[HUNDRED, HUNDRED, HUNDRED], "1 ulp of each operation", |[x, y, _], v| {
        ulp(x * y) + ulp(v)
    }),
    bounded("degrees(x)", &[HUNDRED], "2 ulp", |_, v| 2.0 * ulp(v)),
    bounded("radians(x)", &[HUNDRED], "2 ulp", |_, v| 2.0 * ulp(v)),
    bounded("sqrt(x)", &[[0.0, MAX]], "4.5 ulp: `1 / inverseSqrt(x)`", |_, v| 4.5 * ulp(v)),
    bounded("inverseSqrt(x)", &[[LEAST, MAX]], "2 ulp", |_, v| 2.0 * ulp(v)),
    bounded("exp(x)", &[[-87.0, 88.0]], "3 + 2 abs(x) ulp", power),
    bounded("exp2(x)", &[[-126.0, 127.0]], "3 + 2 abs(x) ulp", power),
    bounded("log(x)", &[[LEAST, MAX]], "2^-21 in [0.5, 2], else 3 ulp", logarithm),
    bounded("log2(x)", &[[LEAST, MAX]], "2^-21 in [0.5, 2], else 3 ulp", logarithm),
    bounded("pow(x, y)", &[[1e-3, 1000.0], [-8.0, 8.0]], "`exp2(y * log2(x))`", powers),
    bounded("sin(x)", &[[-PI, PI]], "2^-11", |_, _| 2f64.powi(-11)),
    bounded("cos(x)", &[[-PI, PI]], "2^-11", |_, _| 2f64.powi(-11)),
    Function { text: "sin(x)", ..free("sin(x), far", &[[-1e4, 1e4]]) },
    Function { text: "cos(x)", ..free("cos(x), far", &[[-1e4, 1e4]]) },
    bounded("tan(x)", &[[-1.5, 1.5]], "`sin(x) / cos(x)`", tangent),
    bounded("asin(x)", &[UNIT], "6.8e-5 or 4096 ulp", arc),
    bounded("acos(x)", &[UNIT], "6.8e-5 or 4096 ulp", arc),
    bounded("atan(x)", &[[-1e6, 1e6]], "4096 ulp", |_, v| 4096.0 * ulp(v)),
    bounded("atan2(x, y)", &[HUNDRED, HUNDRED], "4096 ulp", |_, v| 4096.0 * ulp(v)),
    bounded("sinh(x)", &[[-10.0, 10.0]], "`(exp(x) - exp(-x)) / 2`", hyperbolic),
    bounded("cosh(x)", &[[-10.0, 10.0]], "`(exp(x) + exp(-x)) / 2`", hyperbolic),
    bounded("tanh(x)", &[[-10.0, 10.0]], "1e-5", |_, _| 1e-5),
    free("asinh(x)", &[[-1e4, 1e4]]),
    free("acosh(x)", &[[1.0, 1e4]]),
    free("atanh(x)", &[[-0.999, 0.999]]),
    bounded("dot(vec3(x, y, z), vec3(z, x, y))", &[UNIT, UNIT, UNIT], FORMULA, formula),
    bounded("length(vec3(x, y, z))", &[UNIT, UNIT, UNIT], FORMULA, formula),
    bounded("distance(vec2(x, y), vec2(z, x))", &[UNIT, UNIT, UNIT], FORMULA, formula),
    bounded("normalize(vec3(x, y, 1.0)).x", &[HUNDRED, HUNDRED], FORMULA, formula),
    bounded("cross(vec3(x, y, z), vec3(y, z, x)).x", &[UNIT, UNIT, UNIT], FORMULA, formula),
    bounded("reflect(vec2(x, y), vec2(z, 0.5)).x", &[UNIT, UNIT, UNIT], FORMULA, formula),
    bounded("refract(vec2(x, y), vec2(0.0, 1.0), 0.5).y", &[UNIT, UNIT], FORMULA, formula),
    bounded("faceForward(vec2(x, y), vec2(z, 1.0), vec2(1.0, 0.0)).y", &[UNIT, UNIT, UNIT], FORMULA, formula),
    bounded("determinant(mat2(x, y, z, 0.75))", &[UNIT, UNIT, UNIT], FORMULA, formula),
    exact("f32(i32(x))", &[[-1e9, 1e9]]),
    exact("f32(u32(x))", &[[0.0, 4e9]]),
    Function {
        text: "noise(vec2(x, y))",
        identical: true,
        ..bounded("noise(vec2(x, y))", &[HUNDRED, HUNDRED], "1e-4", |_, _| 1e-4)
    },
    Function {
        text: "fbm(vec2(x, y), 5)",
        identical: true,
        ..bounded("fbm(vec2(x, y), 5)", &[HUNDRED, HUNDRED], "1e-3", |_, _| 1e-3)
    },
    Function {
        text: "ridged(vec2(x, y), 5)",
        identical: true,
        ..bounded("ridged(vec2(x, y), 5)", &[HUNDRED, HUNDRED], "2e-3", |_, _| 2e-3)
    },
];
