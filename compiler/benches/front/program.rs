//! Generated programs of any length that read as a user's do: structs, enums, matches, generics, lambdas, folds,
//! recursion and vector mathematics, all of it reached from `main`.

use std::fmt::Write;

/// Units that one function adds up.
const GROUP: usize = 8;

/// A program of at least `lines` lines; a unit more than needed at most.
pub fn program(lines: usize) -> String {
    let mut text = String::from(COMMON);
    let mut count = COMMON.lines().count();
    let mut names = Vec::new();
    while count < lines {
        let i = names.len();
        let unit = unit(i);
        count += unit.lines().count();
        text += &unit;
        names.push(format!("unit{i}"));
        if names.len() % GROUP == 0 {
            count += 3;
        }
    }
    text += &sums(names);
    text
}

/// Functions that add up the others, level by level, down to `main`.
fn sums(mut names: Vec<String>) -> String {
    let mut text = String::new();
    for level in 0.. {
        let root = names.len() <= GROUP;
        let mut next = Vec::new();
        for (i, group) in names.chunks(GROUP).enumerate() {
            let name = if root { "main".to_string() } else { format!("sum{level}_{i}") };
            let terms: Vec<_> = group.iter().map(|f| format!("{f}(x, n)")).collect();
            let _ = writeln!(text, "fn {name}(x: f32, n: i32) -> f32 =\n    {};\n", terms.join(" + "));
            next.push(name);
        }
        if root {
            break;
        }
        names = next;
    }
    text
}

const COMMON: &str = "// What all units share.
enum Maybe<A> { Just(A), Nothing }
struct Pair<A, B>(first: A, second: B);
type Field = fn(vec3) -> f32;

fn otherwise<A>(m: Maybe<A>, fallback: A) -> A = match m { Just(x) => x, Nothing => fallback };
fn apply<A, B>(m: Maybe<A>, f: fn(A) -> B) -> Maybe<B> = match m { Just(x) => Just(f(x)), Nothing => Nothing };
fn swap<A, B>(p: Pair<A, B>) -> Pair<B, A> = Pair(first: p.second, second: p.first);
fn compose<A, B, C>(f: fn(B) -> C, g: fn(A) -> B) -> fn(A) -> C = |x| f(g(x));
fn blend(a: Field, b: Field, k: f32) -> Field = |p| mix(a(p), b(p), k);

";

/// One unit of about 50 lines; its numbers and parts of its shape depend on `i`.
fn unit(i: usize) -> String {
    let (a, b, c) = (i % 7 + 1, i % 5 + 2, i % 11 + 3);
    let search = match i % 4 {
        // A task of its own.
        0 => format!(
            "fn search{i}(x: f32, n: i32) -> i32 =
    if n <= 0 || x * x > {c}.0 {{ n }} else {{ search{i}(x * 0.5 - 0.1, n - 1) + search{i}(x + 0.{b}, n - 2) }};"
        ),
        1 => format!(
            "fn search{i}(x: f32, n: i32) -> i32 =
    if n <= 0 {{ 0 }} else if x > {c}.0 {{ n * {a} }} else {{ search{i}(x * 1.5 + 0.{b}, n - 1) }};"
        ),
        2 => format!(
            "fn search{i}(x: f32, n: i32) -> i32 =
    sum(0..n, |k| if fract(x * f32(k + {a})) < 0.{b} {{ k * {c} }} else {{ 1 }});"
        ),
        _ => format!(
            "fn search{i}(x: f32, n: i32) -> i32 =
    if any(0..n, |k| f32(k * k) > x * {c}.0) {{ n / {b} }} else {{ n % {a} + {c} }};"
        ),
    };
    format!(
        "// ---- unit {i} ----

/// A body of unit {i}.
struct Body{i}(at: vec3, speed: vec3, mass: f32, charge: f32);

enum Shape{i} {{
    Ball{i}(f32),
    Block{i}(vec3),
    Cone{i}(f32, f32),
    Empty{i},
}}

const SCALE{i} = 0.{a}5 * {b}.0;

fn shape{i}(k: i32, x: f32) -> Shape{i} = match k % 4 {{
    0 => Ball{i}(x + {a}.0),
    1 => Block{i}(vec3(x, 0.{b}, {c}.0)),
    2 => Cone{i}(0.5 * x, {b}.5),
    _ => Empty{i},
}};

fn volume{i}(s: Shape{i}) -> Maybe<f32> = match s {{
    Ball{i}(r) if r > 0.0 => Just(4.18879 * r * r * r),
    Ball{i}(r) => Nothing,
    Block{i}(size) => Just(abs(size.x * size.y * size.z)),
    Cone{i}(r, h) => Just(1.0471976 * r * r * h),
    Empty{i} => Nothing,
}};

fn field{i}(body: Body{i}) -> Field = |p| {{
    let away = p - body.at;
    body.charge / max(dot(away, away), 0.0{c})
}};

fn step{i}(body: Body{i}, field: Field, dt: f32) -> Body{i} {{
    let h = 0.0{b};
    let here = field(body.at);
    let slope = vec3(field(body.at + vec3(h, 0.0, 0.0)), field(body.at + vec3(0.0, h, 0.0)), here + h) - here;
    let speed = body.speed * 0.9{a} - slope / (h * body.mass) * dt;
    body with (at: body.at + speed * dt, speed: speed)
}}

{search}

fn unit{i}(x: f32, n: i32) -> f32 {{
    let body = Body{i}(at: vec3(x, {a}.0, 0.{c}), speed: vec3(0.0), mass: {b}.0 + x, charge: SCALE{i});
    let other = body with (at: body.at.zxy, mass: 1.0);
    let field = blend(field{i}(body), field{i}(other), 0.{a});
    let end = fold(0..n, body, |b, k| step{i}(b, field, 0.01 * f32(k + {a})));
    let size = shape{i}(n + {i}, end.at.x) |> volume{i} |> apply(_, |v| v * SCALE{i}) |> otherwise(_, {c}.0);
    let scaled = compose(|y| y + size, |y: f32| y * {b}.0)(length(end.speed));
    let Pair(first: count, second: total) = swap(Pair(first: scaled, second: search{i}(x, n)));
    if total > 1e6 {{ f32(count) }} else {{ total * SCALE{i} + f32(count) }}
}}

"
    )
}
