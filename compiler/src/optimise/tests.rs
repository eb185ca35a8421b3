//! Each pass keeps the meaning, and does what it is for.

mod faults;
mod structure;

use super::{optimise, passes, run};
use crate::core::{Program, parse, print, verify};

fn program(text: &str) -> Program {
    let program = parse::program(text).unwrap_or_else(|why| panic!("{why}"));
    verify::program(&program).expect("is core");
    program
}

fn optimised(text: &str) -> String {
    let mut program = program(text);
    optimise(&mut program);
    print::program(&program)
}

fn becomes(before: &str, after: &str) {
    assert_eq!(optimised(before), print::program(&program(after)));
}

#[test]
fn constants_fold_and_known_branches_are_taken() {
    becomes(
        "entry f fn f(x: i32) -> (i32, i32) {
           a: i32 = add.i32(2, 3)
           c: bool = lt.i32(a, 9)
           b: i32 = if c { d: i32 = mul.i32(a, x) yield d } else { e: i32 = sub.i32(x, 1) yield e }
           z: i32 = add.i32(b, 0)
           q: i32 = div.i32(z, 0)
           yield q, a
         }",
        "entry f fn f(x: i32) -> (i32, i32) { d: i32 = mul.i32(5, x) yield d, 5 }",
    );
}

#[test]
fn float_identities_are_only_the_exact_ones() {
    let text = "entry f fn f(x: f32) -> (f32, f32, f32, f32) {
       a: f32 = sub.f32(x, 0.0)
       b: f32 = mul.f32(a, 1.0)
       c: f32 = add.f32(x, 0.0)
       d: f32 = mul.f32(x, 0.0)
       e: f32 = sub.f32(x, x)
       yield b, c, d, e
     }";
    becomes(
        text,
        "entry f fn f(x: f32) -> (f32, f32, f32, f32) {
           c: f32 = add.f32(x, 0.0)
           d: f32 = mul.f32(x, 0.0)
           e: f32 = sub.f32(x, x)
           yield x, c, d, e
         }",
    );
}

#[test]
fn a_condition_is_known_in_its_branches() {
    becomes(
        "entry f fn f(c: bool, x: i32) -> (i32) {
           r: i32 = if c {
             s: i32 = if c { a: i32 = add.i32(x, 1) yield a } else { b: i32 = sub.i32(x, 1) yield b }
             yield s
           } else { n: bool = not.bool(c) t: i32 = to_i32.bool(n) yield t }
           yield r
         }",
        "entry f fn f(c: bool, x: i32) -> (i32) {
           r: i32 = if c { a: i32 = add.i32(x, 1) yield a } else { yield 1 }
           yield r
         }",
    );
}

#[test]
fn equal_operations_are_evaluated_once() {
    becomes(
        "entry f fn f(x: f32, y: f32) -> (f32) {
           a: f32 = mul.f32(x, y)
           b: f32 = mul.f32(y, x)
           c: f32 = @bilinear(a, a)
           d: f32 = @bilinear(b, a)
           e: f32 = sub.f32(c, d)
           yield e
         }",
        "entry f fn f(x: f32, y: f32) -> (f32) {
           a: f32 = mul.f32(x, y)
           c: f32 = @bilinear(a, a)
           e: f32 = sub.f32(c, c)
           yield e
         }",
    );
}

#[test]
fn unused_fields_vanish_between_functions() {
    let text = optimised(
        "entry main
         @task fn ray(x: f32, unused: f32) -> (f32, f32, f32) {
           a: f32 = sin.f32(x)
           b: f32 = cos.f32(unused)
           c: f32 = tan.f32(x)
           yield a, b, c
         }
         fn main(x: f32, y: f32) -> (f32) {
           a: f32, b: f32, c: f32 = call ray(x, y)
           d: f32 = add.f32(a, c)
           yield d
         }",
    );
    assert!(text.contains("@task fn ray(v0: f32) -> (f32, f32)"), "{text}");
    assert!(!text.contains("cos"), "{text}");
}

#[test]
fn values_that_only_keep_themselves_alive_vanish() {
    let text = optimised(
        "entry main
         fn go(n: i32, waste: i32, k: i32) -> (i32, i32) {
           z: bool = le.i32(n, 0)
           r: i32, w: i32 = if z { yield k, waste } else {
             m: i32 = sub.i32(n, 1)
             v: i32 = mul.i32(waste, 3)
             s: i32, t: i32 = call go(m, v, k)
             u: i32 = add.i32(s, n)
             yield u, t
           }
           yield r, w
         }
         fn main(n: i32) -> (i32) {
           a: i32, b: i32 = call go(n, 1, 7)
           i: i32, s: i32, t: i32 = loop fold (i0: i32 = 0, s0: i32 = 0, t0: i32 = 1) while {
             c: bool = lt.i32(i0, n) yield c
           } do {
             i1: i32 = add.i32(i0, 1) s1: i32 = add.i32(s0, i0) t1: i32 = mul.i32(t0, s0) yield i1, s1, t1
           }
           r: i32 = add.i32(a, s)
           yield r
         }",
    );
    assert!(text.contains("fn go(v0: i32) -> (i32)"), "{text}");
    assert!(!text.contains("mul"), "{text}");
}

#[test]
fn what_one_branch_needs_is_evaluated_there() {
    becomes(
        "entry f fn f(c: bool, x: f32) -> (f32) {
           a: f32 = sin.f32(x)
           b: f32 = cos.f32(a)
           d: f32 = tan.f32(x)
           r: f32 = if c { yield b } else { yield d }
           yield r
         }",
        "entry f fn f(c: bool, x: f32) -> (f32) {
           r: f32 = if c {
             a: f32 = sin.f32(x)
             b: f32 = cos.f32(a)
             yield b
           } else {
             d: f32 = tan.f32(x)
             yield d
           }
           yield r
         }",
    );
}

#[test]
fn choices_are_operations() {
    becomes(
        "entry f fn f(c: bool, d: bool, x: f32) -> (f32, bool, bool) {
           r: f32, a: bool = if c { yield x, d } else { yield 1.0, false }
           b: bool = if d { yield true } else { yield c }
           yield r, a, b
         }",
        "entry f fn f(c: bool, d: bool, x: f32) -> (f32, bool, bool) {
           a: bool = and.bool(c, d)
           r: f32 = select.f32(1.0, x, c)
           b: bool = or.bool(d, c)
           yield r, a, b
         }",
    );
}

#[test]
fn loops_do_not_repeat_what_never_changes() {
    let text = optimised(
        "entry f fn f(n: i32, x: f32) -> (f32) {
           i: i32, s: f32 = loop fold (i0: i32 = 0, s0: f32 = 0.0) while { c: bool = lt.i32(i0, n) yield c } do {
             a: f32 = sin.f32(x)
             s1: f32 = add.f32(s0, a)
             i1: i32 = add.i32(i0, 1)
             yield i1, s1
           }
           yield s
         }",
    );
    assert!(text.find("sin") < text.find("loop"), "{text}");
}

#[test]
fn small_functions_are_inlined_and_tasks_are_not() {
    let text = optimised(
        "entry main
         @task fn t(x: i32) -> (i32) { y: i32 = call once(x) yield y }
         fn once(x: i32) -> (i32) { y: i32 = call small(x) yield y }
         fn small(x: i32) -> (i32) { y: i32 = mul.i32(x, x) yield y }
         fn main(x: i32) -> (i32) {
           a: i32 = call small(x)
           b: i32 = call t(a)
           yield b
         }",
    );
    let functions: Vec<_> = text.lines().filter(|l| l.contains("fn ")).collect();
    assert_eq!(functions.len(), 2, "{text}");
    assert!(text.contains("@task fn t(v0: i32)"));
}

#[test]
fn tail_calls_stay_tail_calls() {
    let mut program = program(
        "entry main
         fn go(n: i32, a: i32, b: i32) -> (i32, i32, i32) {
           z: bool = le.i32(n, 0)
           x: i32, y: i32, w: i32 = if z { yield a, b, 5 } else {
             m: i32 = sub.i32(n, 1)
             p: i32, q: i32, r: i32 = call go(m, b, a)
             yield p, q, r
           }
           yield x, y, w
         }
         fn main(n: i32) -> (i32) { a: i32, b: i32, c: i32 = call go(n, 1, 2) d: i32 = add.i32(a, c) yield d }",
    );
    optimise(&mut program);
    let (table, _) = crate::split::split(&program).expect("few words");
    assert!(crate::table::print::table(&table).contains("again"));
}

#[test]
fn passes_leave_verified_core() {
    for text in crate::split::tests::PROGRAMS {
        let mut program = program(text);
        for pass in passes() {
            run(&[pass], &mut program);
            verify::program(&program).unwrap_or_else(|why| panic!("after {}: {why}", pass.0));
        }
    }
}
