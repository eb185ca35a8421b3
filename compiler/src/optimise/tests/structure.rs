//! What is left of whole programs: a lost fusion, a word too many on the stream or an operation back in a loop
//! fails here though every value is right.

use crate::back::{back, stats};
use crate::compile::check;
use crate::core::walk::{size, statements};
use crate::core::{Op, Stmt};
use crate::lower::{Asked, Settings, lower};
use crate::source::Source;
use crate::table::{Table, Tail, TailBlock};

/// `task arity > literals+tokens of each exit`, then the number of helpers and of operations in loops.
fn structure(text: &str) -> String {
    let checked = check(Source::new("test.ghyll", text)).expect("a program");
    let entry = checked.module.function("main").expect("a main");
    let table = back(lower(&checked.module, entry, Asked::Plainly, &Settings::default()).expect("lowers"))
        .expect("few words")
        .table;
    let stats = stats(&table);
    let task = |r: &crate::back::Rewrite| {
        let exits: Vec<_> = r.emissions.iter().map(|(words, tokens)| format!("{words}+{tokens}")).collect();
        format!("{} {} > {}", r.task, r.arity, exits.join(" "))
    };
    let tasks: Vec<_> = stats.rewrites.iter().map(task).collect();
    format!("{}; {} helpers; {} in loops", tasks.join(", "), stats.helpers, in_loops(&table))
}

fn in_loops(table: &Table) -> usize {
    fn of(stmts: &[Stmt]) -> usize {
        let mut n = 0;
        statements(stmts, &mut |stmt| {
            if let Op::Loop(l) = &stmt.op {
                n += size(&l.cond.stmts) + size(&l.body.stmts);
            }
        });
        n
    }
    fn tail(block: &TailBlock) -> usize {
        let inner = match &block.tail {
            Tail::If(_, yes, no) => tail(yes) + tail(no),
            _ => 0,
        };
        of(&block.stmts) + inner
    }
    table.tasks.iter().map(|t| tail(&t.body)).sum::<usize>()
        + table.helpers.iter().map(|h| of(&h.body.stmts)).sum::<usize>()
}

/// The words `a..+b` of an exit are those that a rewrite must write; `Again`, a loop within the task, writes none.
macro_rules! structures {
    ($($name:ident $text:literal => $expected:literal;)*) => {
        $(#[test] fn $name() { assert_eq!(structure($text), $expected); })*
    };
}

structures! {
    constants_leave_one_literal "
        const A = [3, 5, 7];
        fn main() -> i32 = sum(0..0, |i| i) + A[1] * (if true { 4 } else { 2 });"
        => "main 0 > 1+0; 0 helpers; 0 in loops";
    recursion_has_a_task_and_a_continuation "
        fn fib(n: i32) -> i32 = if n < 2 { n } else { fib(n - 1) + fib(n - 2) };
        fn main(n: i32) -> i32 = fib(n);"
        => "main 1 > 1+1, fib 1 > 1+0 2+3, fib.1 2 > 1+0; 0 helpers; 0 in loops";
    tail_calls_need_no_continuation "
        fn ackermann(m: i32, n: i32) -> i32 =
            if m == 0 { n + 1 } else if n == 0 { ackermann(m - 1, 1) } else { ackermann(m - 1, ackermann(m, n - 1)) };
        fn main(m: i32, n: i32) -> i32 = ackermann(m, n);"
        => "main 2 > 2+1, ackermann 2 > 1+0 3+2; 0 helpers; 0 in loops";
    fields_that_recursion_only_passes_on_are_no_words "
        struct State(n: i32, wanted: i32, unused: vec3, scale: i32);
        fn go(s: State) -> State =
            if s.n == 0 { s } else { go(s with (n: s.n - 1, wanted: s.wanted * s.scale, unused: s.unused * 2.0)) };
        fn main(n: i32) -> i32 = go(State(n: n, wanted: 1, unused: vec3(1.0), scale: 3)).wanted;"
        => "main 1 > 2+1, go 2 > 1+0; 0 helpers; 0 in loops";
    unused_results_of_tasks_are_no_words "
        @task fn split(x: f32) -> (f32, vec3, f32) = (x * 2.0, sin(vec3(x, x + 1.0, x + 2.0)), cos(x));
        fn main(x: f32) -> f32 { let (a, b, c) = split(x); let (d, e, f) = split(a); d + a }"
        => "main 1 > 1+2, split 1 > 1+0, main.1 1 > 2+2, main.2 2 > 1+0; 0 helpers; 0 in loops";
    equal_calls_of_tasks_go_out_once "
        @task fn f(x: i32) -> i32 = x * x;
        fn main(x: i32) -> i32 = f(x + 1) + f(1 + x) * f(x + 1);"
        => "main 1 > 1+2, f 1 > 1+0, main.1 1 > 1+0; 0 helpers; 0 in loops";
    higher_order_functions_leave_nothing "
        fn compose<A, B, C>(f: fn(B) -> C, g: fn(A) -> B) -> fn(A) -> C = |x| f(g(x));
        fn twice<A>(f: fn(A) -> A) -> fn(A) -> A = compose(f, f);
        fn main(x: i32) -> i32 = twice(twice(compose(|a| a + 1, |a: i32| a * 2)))(x);"
        => "main 1 > 1+0; 0 helpers; 0 in loops";
    options_between_functions_leave_nothing "
        enum Option<A> { Some(A), None }
        fn then<A, B>(o: Option<A>, f: fn(A) -> Option<B>) -> Option<B> = match o { Some(x) => f(x), None => None };
        fn half(x: i32) -> Option<i32> = if x % 2 == 0 { Some(x / 2) } else { None };
        fn main(x: i32) -> i32 = match then(then(half(x), half), half) { Some(y) => y, None => -1 };"
        => "main 1 > 1+0; 0 helpers; 0 in loops";
    loops_keep_only_what_changes "
        fn main(n: i32, x: f32) -> f32 =
            fold(0..n, 0.0, |a, i| a + f32(i) * (sin(x) * 2.0 + sqrt(abs(x))));"
        => "main 2 > 1+0; 0 helpers; 5 in loops";
    dear_operations_leave_loops_behind_a_test "
        fn main(n: i32, x: f32) -> f32 =
            fold(0..n, 0.0, |a, i| a + if x > 0.0 { pow(x, 1.5) * sin(x) } else { exp(x) * cos(x) });"
        => "main 2 > 1+0; 0 helpers; 3 in loops";
    calls_of_tasks_leave_loops "
        @task fn f(x: f32) -> f32 = sin(x);
        fn main(n: i32, x: f32) -> f32 = fold(0..n, 0.0, |a, i| a * 0.5 + f(x));"
        => "main 2 > 2+2 1+0, f 1 > 1+0, main.1 2 > 1+0; 0 helpers; 8 in loops";
    sums_of_tasks_are_trees "
        @task fn f(x: i32) -> i32 = x * x;
        fn main(n: i32, k: i32) -> i32 = sum(0..n, |i| f(i) * k);"
        => "main 2 > 3+1 1+0, main.sum 3 > 2+2 6+3, f 1 > 1+0, main.sum.1 2 > 1+0, main.sum.2 2 > 1+0; 0 helpers; 0 in loops";
    functions_that_only_call_tasks_are_fused "
        fn fib(n: i32) -> i32 = if n < 2 { n } else { fib(n - 1) + fib(n - 2) };
        fn pair(n: i32, k: i32) -> i32 = fib(n) * k + fib(n + 1);
        fn main(n: i32) -> i32 = pair(n, 2) - pair(n + 2, 3) * pair(n + 3, 5);"
        => "main 1 > 5+6, fib 1 > 1+0 2+3, main.1 5 > 1+0, fib.1 2 > 1+0; 0 helpers; 0 in loops";
    words_that_several_continuations_need_are_carried_once "
        @task fn f(x: i32) -> i32 = x + 1;
        fn main(x: i32, y: i32) -> i32 {
            let a = f(x);
            let b = if a > 3 { f(a) * y } else { f(a + y) - y };
            b * y + y
        }"
        => "main 2 > 2+2, f 1 > 1+0, main.1 2 > 2+2 2+2, main.2 2 > 1+0, main.3 2 > 1+0; 0 helpers; 0 in loops";
    parameters_with_one_value_are_no_words "
        fn power(b: i32, e: i32, m: i32, unit: i32) -> i32 =
            if e == 0 { unit } else { power(b, e - 1, m, unit) * b % m };
        fn main(e: i32) -> i32 = power(3, e, 1000, 1);"
        => "main 1 > 1+1, power 1 > 1+0 1+2, power.1 1 > 1+0; 0 helpers; 0 in loops";
}
