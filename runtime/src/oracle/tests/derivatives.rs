//! The oracle's derivatives against differences: Richardson's extrapolation of central differences in double
//! precision, which knows nothing of how derivatives are made.

mod bodies;

use super::check;
use crate::oracle::{OracleOptions, grid};
use crate::terrain::raster::Texels;
use crate::terrain::{Layer, Layers, Raster, Scene, SceneOptions, Terrain, View};
use crate::value::Value;
use std::sync::Arc;

/// Halvings of the step.
const LEVELS: usize = 7;
const FIRST_STEP: f64 = 1.0 / 64.0;
const RANDOM_BODIES: usize = 40;
/// Places at which a function is tried, and a random one.
const PLACES: u32 = 200;
const RANDOM_PLACES: u32 = 100;

/// Bodies of `fn f(p: vec2) -> f32`, for p in [0.1, 0.9] squared: every built-in that has a derivative, every form of the
/// language, every sampler.
const BODIES: &[&str] = &[
    "sin(3.0 * p.x) * cos(p.y) + tan(p.x * p.y)",
    "asin(p.x) + acos(p.y) * atan(p.x - 3.0 * p.y)",
    "sinh(p.x) + cosh(p.y) * tanh(p.x + p.y)",
    "asinh(p.x * 4.0) + acosh(1.5 + p.y) * atanh(p.x * p.y)",
    "atan2(p.x - 0.5, p.y - 2.0) + atan2(p.y, p.x)",
    "exp(p.x) + exp2(p.y * p.x) * log(p.x) + log2(p.y)",
    "pow(p.x, p.y) + pow(p.y, 2.5) + pow(1.7, p.x)",
    "sqrt(p.x) * inverseSqrt(p.y + p.x)",
    "abs(p.x - 0.5) + sign(p.y - 0.5) * p.x",
    "floor(p.x * 3.0) + ceil(p.y * 3.0) * p.x + round(p.x * 5.0) + trunc(p.y * 7.0) * p.y",
    "fract(p.x * 3.0) * fract(p.y * 5.0 - 2.0)",
    "degrees(p.x) * radians(p.y) + saturate(p.x * 3.0 - 1.0)",
    "step(0.4, p.x) * p.y + smoothstep(0.2, 0.7, p.y) * p.x + smoothstep(p.x, 2.0, p.y)",
    "fma(p.x, p.y, p.x * p.x) + min(p.x, p.y) * max(p.x * 2.0, p.y)",
    "clamp(p.x, 0.3, p.y) + select(p.x, p.y * p.y, p.x < 0.4)",
    "mix(p.x, p.y * p.y, p.x) + mix(vec2(p.x, 1.0), p, vec2(p.y)).x + mix(p, p.yx, p.x).y",
    "p.x / (p.y + 0.5) + (p.x * 7.0) % (p.y + 1.0) - p.x % 0.3",
    "dot(p, vec2(p.y, 3.0)) + length(p) * distance(p, vec2(2.0, p.x)) + length(p.x - 0.5)",
    "normalize(vec3(p, 0.7)).y + cross(vec3(p, 1.0), vec3(2.0, p.yx)).z",
    "reflect(vec3(p, 1.0), normalize(vec3(p.y, 1.0, p.x))).x",
    "refract(normalize(vec3(p, -1.0)), normalize(vec3(0.1, p.x, 1.0)), 0.5 + 0.1 * p.y).y",
    "refract(normalize(vec3(p, -0.3)), vec3(0.0, 0.0, 1.0), 1.4).x",
    "faceForward(p, vec2(p.y - 0.4, 0.1), vec2(1.0, p.x)).x",
    "determinant(mat2(p, p.yx * 2.0)) + determinant(mat3(vec3(p, 1.0), vec3(1.0, p), vec3(p.y, 2.0, p.x)))",
    "(mat2(p.x, 1.0, p.y, 2.0) * p).y + (p * mat2(p, p)).x + (mat2(p, p.yx) * mat2(p.yx, p))[1].y",
    "(transpose(mat3(vec3(p, 1.0), vec3(p.x), vec3(2.0)))[1] * 2.0).x + (mat2(p, p) * p.x)[0].y",
    "(p * p).x + (p + 2.0 * p.yx - p.x).y + (3.0 / p).x + (p / p.x).y - (-p).x",
    "vec4(p, p.x * p.y, 1.0).zyxw[0] + f32(i32(p.x * 4.0)) * p.y",
    "if p.x < 0.5 { p.x * p.y } else { sin(p.y) }",
    "match (p.x < 0.3, p.y) { (true, y) => y * y, (false, y) if y > 0.5 => p.x * y, _ => p.x }",
    "area(if p.x > 0.4 { Circle(p.y) } else { Box(3, p.x * p.y) })",
    "fold(0..6, vec2(0.1), |z, i| vec2(z.x * z.x - z.y * z.y, 2.0 * z.x * z.y) + p * f32(i) * 0.1).x",
    "sum(1..5, |i| sin(p.x * f32(i)) / f32(i)) + p.y",
    "if any(0..9, |i| f32(i) * 0.1 > p.x) { p.x * p.y } else { p.y }",
    "{ let s = Span(lo: p.x, hi: p.y * p.x); let t = s with (lo: s.hi * 2.0); t.lo * s.lo + width(t) }",
    "{ let k = p.x * 2.0; let f = |x: f32| x * k + p.y; f(f(p.y)) }",
    "twice(|x| x * x + p.y, p.x) + twice(pow(_, 1.5), p.y)",
    "power(5, p.x) + power(3, p.y) * wave(p.x, 2.0)",
    "[p.x, p.y, p.x * p.y][i32(p.x * 3.0)] * 2.0",
    "even(4, p.x) + p |> length",
    "grad(|q| q.x * q.x * q.y)(p).x + deriv(|t| t * t * p.y)(p.x) * p.y",
    "deriv(deriv(|t| sin(t * p.x)))(p.y)",
    "deriv(|x| deriv(|y| x * y * y + p.x * x)(x) * p.y)(p.x)",
    "grad(|q| grad(|r| sin(r.x * r.y))(q).x * p.y)(p).y",
    "bilinear(p * 90.0) + triangulated(p.yx * 90.0) * p.x + nearest(p * 60.0) * p.y",
    "bilinear((p - 0.5) * 200.0) + triangulated((p - 0.5) * 200.0)",
    "bicubic(p * 90.0) + subdivided_by(p * 90.0, 3)",
    "noise(p * 3.0) + fbm(p * 2.0, 4) + ridged(p * 2.0, 3)",
    "grad(bilinear)(p * 90.0).x * p.y + grad(triangulated)(p * 90.0).y",
    "layer(p * 90.0) + dot(colours(p.yx * 80.0), vec3(1.0, p.x, p.y)) + baked(p * 90.0)",
    "grad(layer)(p * 90.0).x * p.y + deriv(|x| colours(vec2(x, p.y) * 90.0).y)(p.x)",
    "(if p.x < 0.5 { sin } else { |x| x * p.y })(p.y) + choose(i32(p.y * 4.0))(p.x * p.y)",
    "fold(0..4, |x: f32| x * p.x, |f, i| if i % 2 == 0 { sin } else { |x| x + p.y })(p.y)",
    "normal(bilinear, p * 90.0).x + normal(|q| bicubic(q) + 3.0 * fbm(q / 40.0, 2), p * 90.0).y",
];

const HELP: &str = "use terrain;
    raster layer: f32;
    raster colours: vec3;
    @bake fn baked(p: vec2) -> f32 = layer(p) * p.x * 0.01;
    fn choose(n: i32) -> fn(f32) -> f32 = if n > 2 { choose(n - 2) } else { [sin, |x| x * x, power(3, _)][n] };
    enum Shape { Circle(f32), Box(i32, f32), Nothing }
    struct Span(lo: f32, hi: f32);
    fn width(s: Span) -> f32 = s.hi - s.lo;
    fn area(s: Shape) -> f32 = match s { Circle(r) => r * r, Box(i, h) => f32(i) * h, Nothing => 1.0 };
    fn twice(f: fn(f32) -> f32, x: f32) -> f32 = f(f(x));
    fn power(n: i32, x: f32) -> f32 = if n == 0 { 1.0 } else { x * power(n - 1, x) };
    fn even(n: i32, x: f32) -> f32 = if n == 0 { x } else { odd(n - 1, x * x + 0.1) };
    fn odd(n: i32, x: f32) -> f32 = if n == 0 { 0.0 } else { even(n - 1, sin(x)) };
    @task fn wave(x: f32, k: f32) -> f32 = sin(k * x);
";

fn scene() -> Scene {
    let terrain = Terrain::from_heights(10, 12, [10.0, 9.0], (0..120).map(height_of).collect()).unwrap();
    let options = SceneOptions { view: View::overview(), size: (8, 8), ..SceneOptions::default() };
    let scene = Scene::new(Arc::new(terrain), &options).unwrap();
    let mut layers = Layers::default();
    for (slot, components, width, height) in [(0, 1, 7, 5), (1, 3, 4, 9)] {
        let texels = Texels::Floats((0..width * height * components).map(|i| height_of(i + 7)).collect());
        let raster = Raster::computed(width, height, components, texels);
        layers.set(slot, Layer::placed(Arc::new(raster), scene.terrain()).unwrap());
    }
    scene.with_layers(layers)
}

fn height_of(i: u32) -> f32 {
    (i.wrapping_mul(2654435761) >> 20) as f32 * 0.01
}

/// A number in [0.1, 0.9] for each place and axis.
fn place(i: u32, axis: u32) -> f64 {
    let mixed = (2 * i + axis + 1).wrapping_mul(2654435761);
    let mixed = (mixed ^ (mixed >> 15)).wrapping_mul(2246822519);
    0.1 + 0.8 * f64::from(mixed >> 8) / f64::from(1u32 << 24)
}

/// The best derivative that differences give and how far it can be trusted.
fn extrapolate(pairs: &[(f64, f64)]) -> (f64, f64) {
    let mut step = FIRST_STEP;
    let mut above: Vec<f64> = Vec::new();
    let (mut best, mut least) = (f64::NAN, f64::INFINITY);
    for (low, high) in pairs {
        let mut row = vec![(high - low) / (2.0 * step)];
        let mut power = 1.0;
        for coarse in &above {
            power *= 4.0;
            let fine = row[row.len() - 1];
            let better = fine + (fine - coarse) / (power - 1.0);
            let error = (better - fine).abs().max((better - coarse).abs());
            if error < least {
                (best, least) = (better, error);
            }
            row.push(better);
        }
        above = row;
        step *= 0.5;
    }
    (best, least)
}

/// Places where a derivative is that of differences, and places where it is not; where a kink or a jump is near there is
/// no telling.
#[derive(Default)]
struct Found {
    right: usize,
    wrong: usize,
}

/// How the oracle's derivatives of a function compare with differences, and those of the function with another slope.
fn compare(value: &str, places: u32) -> (Found, Found) {
    let text = format!(
        "{HELP}fn f(p: vec2) -> f32 = {value};
         fn g(p: vec2) -> f32 = f(p) * 1.0001 + 0.0003 * (p.x - p.y);
         fn slopes(p: vec2) -> vec3 = vec3(deriv(|x| f(vec2(x, p.y)))(p.x), grad(f)(p));
         fn planted(p: vec2) -> vec3 = vec3(deriv(|x| g(vec2(x, p.y)))(p.x), grad(g)(p));"
    );
    let checked = check(&text);
    let scene = scene();
    let options = OracleOptions { threads: Some(1), max_memory: 64 << 20, ..OracleOptions::default() };
    let evaluate = |entry: &str, columns: usize, position: &(dyn Fn(u32, u32) -> [f64; 2] + Sync)| {
        let entry = checked.module.function(entry).expect("the entry is there");
        let size = (columns as u32, places);
        let values = grid(&checked.module, entry, size, position, &options, Some(&scene));
        values.unwrap_or_else(|e| panic!("{e}\n{text}"))
    };
    let slopes = |entry| evaluate(entry, 1, &|_, row| [place(row, 0), place(row, 1)]);
    // Pairs of steps along x, then along y.
    let width = 4 * LEVELS;
    let moved = evaluate("f", width, &|column, row| {
        let k = column as usize;
        let (axis, level, side) = (k / (2 * LEVELS), k / 2 % LEVELS, k % 2);
        let mut p = [place(row, 0), place(row, 1)];
        p[axis] += FIRST_STEP * 0.5f64.powi(level as i32) * if side == 0 { -1.0 } else { 1.0 };
        p
    });
    let number = |value: &Value| match value {
        Value::F32(x) => *x,
        other => panic!("{other}"),
    };
    let against = |exact: Vec<Value>| {
        let mut all = Found::default();
        for (exact, row) in exact.iter().zip(moved.chunks(width)) {
            let Value::Vec(exact) = exact else { panic!("{exact}") };
            assert!((exact[0] - exact[1]).abs() <= 1e-12 * exact[1].abs(), "deriv and grad differ: {value}");
            for axis in 0..2 {
                let pairs: Vec<(f64, f64)> = row[axis * width / 2..(axis + 1) * width / 2]
                    .chunks(2)
                    .map(|pair| (number(&pair[0]), number(&pair[1])))
                    .collect();
                let (found, error) = extrapolate(&pairs);
                let size = found.abs().max(1.0);
                if error > 1e-7 * size {
                    continue;
                }
                if (found - exact[1 + axis]).abs() <= 1e-6 * size { all.right += 1 } else { all.wrong += 1 }
            }
        }
        all
    };
    (against(slopes("slopes")), against(slopes("planted")))
}

fn notices(planted: &Found, what: &str) {
    let Found { right, wrong } = planted;
    assert!(wrong > right, "{what}: {wrong} of {} noticed", wrong + right);
}

#[test]
fn derivatives_are_those_of_differences() {
    for body in BODIES {
        let (Found { right, wrong }, planted) = compare(body, PLACES);
        assert!(right > PLACES as usize / 2, "{body}: tried at {right} places only");
        // Differences across a jump that they did not notice.
        assert!(wrong * 100 <= right, "{body}: wrong at {wrong} places, right at {right}");
        notices(&planted, body);
    }
}

/// Every run tries others; `GHYLL_SEED` repeats a run.
#[test]
fn derivatives_of_random_functions_are_those_of_differences() {
    let (seed, mut random) = bodies::random();
    let mut all = Found::default();
    for round in 0..RANDOM_BODIES {
        // Differences planted in deep functions drown where those are steep.
        let depth = if round % 4 == 0 { 3 } else { 4 };
        let body = bodies::body(&mut random, depth);
        let (Found { right, wrong }, planted) = compare(&body, RANDOM_PLACES);
        assert!(wrong * 10 <= right, "GHYLL_SEED={seed} {body}: wrong at {wrong} places, right at {right}");
        (all.right, all.wrong) = (all.right + right, all.wrong + wrong);
        if depth == 3 {
            notices(&planted, &format!("GHYLL_SEED={seed} {body}"));
        }
    }
    let Found { right, wrong } = all;
    assert!(
        right > RANDOM_BODIES * RANDOM_PLACES as usize / 2,
        "GHYLL_SEED={seed}: tried at {right} places only"
    );
    assert!(wrong * 200 <= right, "GHYLL_SEED={seed}: wrong at {wrong} places, right at {right}");
}
