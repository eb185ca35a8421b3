//! Task sets written by hand in the form that the compiler generates.

use super::super::*;
use ghyll_compiler::table::Widths;
use std::sync::{Mutex, PoisonError};

/// One device for all tests, which so share kernels; none, loudly, where there is none, unless GHYLL_REQUIRE_GPU=1
/// asks for one. A lost one is not handed on.
pub fn gpu() -> Option<Gpu> {
    static SHARED: Mutex<Option<Gpu>> = Mutex::new(None);
    let mut shared = SHARED.lock().unwrap_or_else(PoisonError::into_inner);
    if shared.as_ref().is_none_or(|gpu| gpu.lost().is_some()) {
        *shared = open();
    }
    shared.clone()
}

fn open() -> Option<Gpu> {
    match Gpu::new(&GpuOptions::default()) {
        Ok(gpu) => Some(gpu),
        Err(error) if std::env::var("GHYLL_REQUIRE_GPU").is_ok_and(|v| v == "1") => panic!("{error}"),
        Err(error) => {
            eprintln!("NOT TESTED ON A GPU: {error}");
            None
        }
    }
}

pub fn code(functions: &str, tasks: &[(&str, u32)], longest_emission: u32) -> Code {
    let cases: String = (0..tasks.len()).map(|i| format!("case {i}u: {{ task_{i}(); }}\n")).collect();
    Code {
        functions: format!(
            "{functions}\nfn rewrite(task: u32) {{ switch task {{ {cases} default: {{}} }} }}\n"
        ),
        arities: tasks.iter().map(|task| task.1).collect(),
        names: tasks.iter().map(|task| task.0.to_owned()).collect(),
        longest_emission,
        widths: Widths { first: longest_emission, later: longest_emission, segment: longest_emission },
        ..Code::default()
    }
}

/// fib(n) = if n < 2 { n } else { fib(n - 1) + fib(n - 2) }
pub fn fib() -> Code {
    let functions = "
fn task_0() {
    consume(1u);
    let n = bitcast<i32>(operand(0u));
    if (n < 2) { literal(bitcast<u32>(n)); return; }
    later(1u);
    later(bitcast<u32>(n - 2));
    later(0u | (1u << 16u));
    literal(bitcast<u32>(n - 1));
    invoke = 0u;
}
fn task_1() {
    consume(2u);
    literal(operand(0u) + operand(1u));
}";
    code(functions, &[("fib", 1), ("fib", 2)], 5)
}

/// total(n) = if n == 0 { 0 } else { n + total(n - 1) }
pub fn total() -> Code {
    let functions = "
fn task_0() {
    consume(1u);
    let n = operand(0u);
    if (n == 0u) { literal(0u); return; }
    later(1u);
    literal(n);
    literal(n - 1u);
    invoke = 0u;
}
fn task_1() {
    consume(2u);
    literal(operand(0u) + operand(1u));
}";
    code(functions, &[("total", 1), ("total", 2)], 4)
}

/// count(n, a) = if n == 0 { a } else { count(n - 1, a + n) }, a loop in the task
pub fn count() -> Code {
    let functions = "
fn task_0() {
    consume(2u);
    var n = operand(0u);
    var a = operand(1u);
    loop {
        if (n == 0u) { literal(a); return; }
        a = a + n;
        n = n - 1u;
        fuel = fuel - 1;
        if (fuel <= 0) { break; }
    }
    literal(n);
    literal(a);
    invoke = 0u;
}";
    code(functions, &[("count", 2)], 3)
}

/// Ackermann's function; the outer of the nested calls is a tail call that takes the inner's result.
pub fn ackermann() -> Code {
    let functions = "
fn task_0() {
    consume(2u);
    let m = operand(0u);
    let n = operand(1u);
    if (m == 0u) { literal(n + 1u); return; }
    if (n == 0u) { literal(m - 1u); literal(1u); invoke = 0u; return; }
    later(0u);
    literal(m - 1u);
    literal(m);
    literal(n - 1u);
    invoke = 0u;
}";
    code(functions, &[("ackermann", 2)], 5)
}

/// Takeuchi's function: tak(x, y, z) = if y >= x { z } else { tak(tak(x - 1, y, z), tak(y - 1, z, x), tak(z - 1, x, y)) }
pub fn takeuchi() -> Code {
    let functions = "
fn task_0() {
    consume(3u);
    let x = operand(0u);
    let y = operand(1u);
    let z = operand(2u);
    if (bitcast<i32>(y) >= bitcast<i32>(x)) { literal(z); return; }
    later(0u);
    later(y);
    later(x);
    later(z - 1u);
    later(0u | (3u << 16u));
    later(x);
    later(z);
    later(y - 1u);
    later(0u | (3u << 16u));
    literal(x - 1u);
    literal(y);
    literal(z);
    invoke = 0u;
}";
    code(functions, &[("tak", 3)], 13)
}

/// Hofstadter's female and male sequences: F(n) = n - M(F(n - 1)), M(n) = n - F(M(n - 1)).
pub fn hofstadter() -> Code {
    let task = |number: u32, first: u32, other: u32| {
        format!(
            "
fn task_{number}() {{
    consume(1u);
    let n = operand(0u);
    if (n == 0u) {{ literal({first}u); return; }}
    later(2u);
    later({other}u);
    literal(n);
    literal(n - 1u);
    invoke = {number}u;
}}"
        )
    };
    let functions = task(0, 1, 1)
        + &task(1, 0, 0)
        + "
fn task_2() {
    consume(2u);
    literal(operand(0u) - operand(1u));
}";
    code(&functions, &[("female", 1), ("male", 1), ("minus", 2)], 5)
}

/// spin(n) = spin(n + 1)
pub fn spin() -> Code {
    let functions = "
fn task_0() {
    consume(1u);
    var n = operand(0u);
    loop {
        n = n + 1u;
        fuel = fuel - 1;
        if (fuel <= 0) { break; }
    }
    literal(n);
    invoke = 0u;
}";
    code(functions, &[("spin", 1)], 2)
}

/// grow(n) = grow(n + 1) + grow(n + 2)
pub fn grow() -> Code {
    let functions = "
fn task_0() {
    consume(1u);
    let n = operand(0u);
    later(1u);
    later(n + 2u);
    later(0u | (1u << 16u));
    literal(n + 1u);
    invoke = 0u;
}
fn task_1() {
    consume(2u);
    literal(operand(0u) + operand(1u));
}";
    code(functions, &[("grow", 1), ("grow", 2)], 5)
}

/// A fused loop of n steps, which cannot be cut.
pub fn fused() -> Code {
    let functions = "
fn task_0() {
    consume(1u);
    let n = operand(0u);
    var a = 7u;
    for (var i = 0u; i < n; i = i + 1u) {
        if (fuel <= 0) { exhausted = true; break; }
        fuel = fuel - 1;
        a = a * 3u + i;
    }
    literal(a);
}";
    code(functions, &[("fused", 1)], 2)
}

/// What `fused` computes.
pub fn fused_value(n: u32) -> u32 {
    (0..n).fold(7u32, |a, i| a.wrapping_mul(3).wrapping_add(i))
}

/// A picture by three tasks a pixel: pixel(x, y) = shade(x, length(x, y)), where some pixels recur deeply.
pub fn picture(deep: u32) -> Code {
    let functions = format!(
        "
fn task_0() {{
    consume(2u);
    let x = bitcast<f32>(operand(0u));
    let y = bitcast<f32>(operand(1u));
    later(2u);
    literal(bitcast<u32>(x));
    literal(bitcast<u32>(y));
    let steps = select(1u, {deep}u, (u32(x) % 32u) == 5u && (u32(y) % 16u) == 3u);
    literal(steps);
    invoke = 1u;
}}
fn task_1() {{
    consume(1u);
    let n = operand(0u);
    if (n == 0u) {{ literal(bitcast<u32>(0.5)); return; }}
    later(3u);
    literal(n - 1u);
    invoke = 1u;
}}
fn task_2() {{
    consume(3u);
    let x = bitcast<f32>(operand(0u));
    let y = bitcast<f32>(operand(1u));
    let n = bitcast<f32>(operand(2u));
    literal(bitcast<u32>(x * 2.0));
    literal(bitcast<u32>(y + n));
    literal(bitcast<u32>(n));
}}
fn task_3() {{
    consume(1u);
    literal(bitcast<u32>(bitcast<f32>(operand(0u)) + 1.0));
}}"
    );
    code(&functions, &[("pixel", 2), ("length", 1), ("shade", 3), ("length", 1)], 5)
}

/// What `picture` computes.
pub fn picture_value(x: u32, y: u32, deep: u32) -> [f32; 3] {
    let n = 0.5 + if x % 32 == 5 && y % 16 == 3 { deep as f32 } else { 1.0 };
    [(x as f32 + 0.5) * 2.0, y as f32 + 0.5 + n, n]
}

/// branches(n, d) = if n == 0 { depth(d) } else { branches(n - 1, d) + branches(n - 1, d) } with
/// depth(d) = if d == 0 { 1 } else { 1 + depth(d - 1) }: as many lanes could go deep as there are branches.
pub fn branches() -> Code {
    let functions = "
fn task_0() {
    consume(2u);
    let n = operand(0u);
    let d = operand(1u);
    if (n == 0u) { literal(d); invoke = 1u; return; }
    later(2u);
    later(d);
    later(n - 1u);
    later(0u | (2u << 16u));
    literal(n - 1u);
    literal(d);
    invoke = 0u;
}
fn task_1() {
    consume(1u);
    let d = operand(0u);
    if (d == 0u) { literal(1u); return; }
    later(2u);
    literal(1u);
    literal(d - 1u);
    invoke = 1u;
}
fn task_2() {
    consume(2u);
    literal(operand(0u) + operand(1u));
}";
    code(functions, &[("branches", 2), ("depth", 1), ("plus", 2)], 7)
}
