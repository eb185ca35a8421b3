//! Task sets written by hand in the form that the compiler generates.

use super::super::*;

/// The adapter; none, loudly, where there is none, unless GHYLL_REQUIRE_GPU=1 asks for one.
pub fn gpu() -> Option<Gpu> {
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
