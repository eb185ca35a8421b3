//! Splitting keeps the meaning: direct interpretation and rewriting agree; and the emissions have the expected shape.

use super::split;
use crate::core::{Const, Program, parse, verify};
use crate::interpret::{NoHost, Stopped, run};
use crate::stream::{initial, print, rounds, values};
use crate::table::{self, Table, TaskId};

pub const FIB: &str = "entry fib
fn fib(n: i32) -> (i32) {
  small: bool = lt.i32(n, 2)
  r: i32 = if small { yield n } else {
    n1: i32 = sub.i32(n, 1)
    a: i32 = call fib(n1)
    n2: i32 = sub.i32(n, 2)
    b: i32 = call fib(n2)
    s: i32 = add.i32(a, b)
    yield s
  }
  yield r
}";

pub const ACKERMANN: &str = "entry A
fn A(m: i32, n: i32) -> (i32) {
  m0: bool = eq.i32(m, 0)
  r: i32 = if m0 { s: i32 = add.i32(n, 1) yield s } else {
    m1: i32 = sub.i32(m, 1)
    n0: bool = eq.i32(n, 0)
    t: i32 = if n0 { a: i32 = call A(m1, 1) yield a } else {
      n1: i32 = sub.i32(n, 1)
      b: i32 = call A(m, n1)
      c: i32 = call A(m1, b)
      yield c
    }
    yield t
  }
  yield r
}";

const TAK: &str = "entry tak
fn tak(x: i32, y: i32, z: i32) -> (i32) {
  more: bool = lt.i32(y, x)
  r: i32 = if more {
    x1: i32 = sub.i32(x, 1)
    y1: i32 = sub.i32(y, 1)
    z1: i32 = sub.i32(z, 1)
    a: i32 = call tak(x1, y, z)
    b: i32 = call tak(y1, z, x)
    c: i32 = call tak(z1, x, y)
    d: i32 = call tak(a, b, c)
    yield d
  } else { yield z }
  yield r
}";

const HOFSTADTER: &str = "entry Q
fn Q(n: i32) -> (i32) {
  small: bool = le.i32(n, 2)
  r: i32 = if small { yield 1 } else {
    n1: i32 = sub.i32(n, 1)
    n2: i32 = sub.i32(n, 2)
    q1: i32 = call Q(n1)
    q2: i32 = call Q(n2)
    a: i32 = sub.i32(n, q1)
    b: i32 = sub.i32(n, q2)
    qa: i32 = call Q(a)
    qb: i32 = call Q(b)
    s: i32 = add.i32(qa, qb)
    yield s
  }
  yield r
}";

const MUTUAL: &str = "entry even
fn even(n: i32) -> (bool) {
  z: bool = eq.i32(n, 0)
  r: bool = if z { yield true } else { m: i32 = sub.i32(n, 1) o: bool = call odd(m) yield o }
  yield r
}
fn odd(n: i32) -> (bool) {
  z: bool = eq.i32(n, 0)
  r: bool = if z { yield false } else { m: i32 = sub.i32(n, 1) e: bool = call even(m) yield e }
  yield r
}";

const TAIL_LOOP: &str = "entry f
fn f(n: i32, acc: i32) -> (i32) {
  z: bool = le.i32(n, 0)
  r: i32 = if z { yield acc } else {
    m: i32 = sub.i32(n, 1)
    s: i32 = add.i32(acc, n)
    t: i32 = call f(m, s)
    yield t
  }
  yield r
}";

/// Task calls in a condition, in both and in one branch, with work after each.
const BRANCHES: &str = "entry main
@task fn g(x: i32) -> (i32) { y: i32 = mul.i32(x, 3) yield y }
@task fn two(x: i32) -> (i32, bool) { y: i32 = sub.i32(x, 5) b: bool = lt.i32(y, 0) yield y, b }
fn main(x: i32, y: i32) -> (i32, i32) {
  p: i32, c: bool = call two(x)
  u: i32 = if c { a: i32 = call g(x) b: i32 = add.i32(a, y) yield b } else { yield p }
  v: i32 = add.i32(u, 7)
  d: bool = lt.i32(y, 3)
  e: i32 = if d { q: i32 = call g(v) w: i32 = call g(q) yield w } else {
    k: bool = lt.i32(y, 6)
    m: i32 = if k { yield 100 } else { o: i32 = call g(y) yield o }
    j: i32 = mul.i32(m, u)
    yield j
  }
  f: i32 = sub.i32(e, x)
  yield f, u
}";

/// Two independent `if`s with calls inside, and a call.
const PARALLEL_IFS: &str = "entry walk
fn walk(n: i32, k: i32) -> (i32) {
  end: bool = le.i32(n, 0)
  r: i32 = if end { yield 1 } else {
    m: i32 = sub.i32(n, 1)
    b0: i32 = and.i32(k, 1)
    c0: bool = eq.i32(b0, 0)
    k2: i32 = shr.i32(k, 1)
    x: i32 = if c0 { a: i32 = call walk(m, k2) yield a } else { yield 0 }
    b1: i32 = and.i32(k2, 1)
    c1: bool = eq.i32(b1, 0)
    y: i32 = if c1 { b: i32 = call walk(m, k) yield b } else { yield 5 }
    m2: i32 = sub.i32(n, 3)
    z: i32 = call walk(m2, n)
    s: i32 = add.i32(x, y)
    t: i32 = add.i32(s, z)
    yield t
  }
  yield r
}";

const LOOPS: &str = "entry main
@task fn g(x: i32) -> (i32) { y: i32 = mul.i32(x, x) yield y }
fn main(lo: i32, n: i32) -> (i32, i32, i32, bool) {
  i: i32, s: i32 = loop sum (i0: i32 = lo, s0: i32 = 10) while { c: bool = lt.i32(i0, n) yield c } do {
    w0: i32 = add.i32(i0, lo)
    w: i32 = call g(w0)
    i1: i32 = add.i32(i0, 1)
    s1: i32 = add.i32(s0, w)
    yield i1, s1
  }
  j: i32, t: i32 = loop fold (j0: i32 = lo, t0: i32 = 1) while { c2: bool = lt.i32(j0, n) yield c2 } do {
    w2: i32 = call g(t0)
    t1: i32 = add.i32(w2, j0)
    j1: i32 = add.i32(j0, 1)
    yield j1, t1
  }
  a: i32, found: bool = loop any (k0: i32 = lo, f0: bool = false) while {
    c3: bool = lt.i32(k0, n)
    nf: bool = not.bool(f0)
    go: bool = and.bool(c3, nf)
    yield go
  } do {
    w3: i32 = call g(k0)
    f1: bool = eq.i32(w3, 16)
    k1: i32 = add.i32(k0, 1)
    yield k1, f1
  }
  yield i, s, t, found
}";

/// A `sum` in a `sum` in a task, and a loop without task calls that stays a loop.
const NESTED_SUMS: &str = "entry main
@task fn g(x: i32, y: i32) -> (i32, f32) {
  i: i32, p: i32 = loop fold (i0: i32 = 0, p0: i32 = 1) while { c: bool = lt.i32(i0, x) yield c } do {
    i1: i32 = add.i32(i0, 1) p1: i32 = mul.i32(p0, y) yield i1, p1
  }
  q: f32 = to_f32.i32(p)
  yield p, q
}
fn main(n: i32) -> (i32, f32) {
  i: i32, s: i32, f: f32 = loop sum (i0: i32 = 0, s0: i32 = 0, f0: f32 = 0.0) while {
    c: bool = lt.i32(i0, n) yield c
  } do {
    j: i32, t: i32 = loop sum (j0: i32 = 0, t0: i32 = 0) while { d: bool = lt.i32(j0, i0) yield d } do {
      w: i32, v: f32 = call g(i0, j0)
      t1: i32 = add.i32(t0, w)
      j1: i32 = add.i32(j0, 1)
      yield j1, t1
    }
    u: i32, h: f32 = call g(2, i0)
    s1: i32 = add.i32(s0, t)
    f1: f32 = add.f32(f0, h)
    i1: i32 = add.i32(i0, 1)
    yield i1, s1, f1
  }
  yield s, f
}";

/// All of them, for the tests of later phases.
pub const PROGRAMS: &[&str] =
    &[FIB, ACKERMANN, TAK, HOFSTADTER, MUTUAL, TAIL_LOOP, BRANCHES, PARALLEL_IFS, LOOPS, NESTED_SUMS];

pub fn program(text: &str) -> Program {
    let program = parse::program(text).expect("parses");
    verify::program(&program).expect("is core");
    program
}

fn split_text(text: &str) -> (Program, Table, TaskId) {
    let program = program(text);
    let (table, entry) = split(&program).expect("few words");
    table::verify::table(&table, &[]).unwrap_or_else(|why| panic!("{why}\n{}", table::print::table(&table)));
    (program, table, entry)
}

/// The normal form of the entry's stream.
pub fn rewrite(table: &Table, entry: TaskId, args: &[Const], fuel: u64) -> Result<Vec<Const>, Stopped> {
    let stream = initial(table, entry, args);
    let mut last = Vec::new();
    for stream in rounds(table, stream, &NoHost, fuel) {
        last = stream?;
    }
    Ok(values(&last))
}

fn agree(text: &str, inputs: &[&[i32]]) {
    let (program, table, entry) = split_text(text);
    for input in inputs {
        let args: Vec<_> = input.iter().map(|i| Const::I32(*i)).collect();
        let direct = run(&program, &args, &NoHost, 10_000_000);
        assert!(direct.is_ok(), "{input:?}: {direct:?}");
        assert_eq!(
            rewrite(&table, entry, &args, 10_000_000),
            direct,
            "{input:?}\n{}",
            table::print::table(&table)
        );
    }
}

fn on_large_stack(check: fn()) {
    let thread = std::thread::Builder::new().stack_size(256 << 20).spawn(check);
    thread.expect("the thread starts").join().expect("the check holds");
}

fn shape(text: &str, task: &str) -> Vec<String> {
    let (_, table, _) = split_text(text);
    let task = table.tasks.iter().find(|t| t.name == task).expect("the task exists");
    task.emissions().into_iter().map(|e| table::print::emission(&table, e)).collect()
}

#[test]
fn rewriting_agrees_with_interpretation() {
    on_large_stack(|| {
        agree(FIB, &[&[-1], &[0], &[1], &[2], &[10], &[15]]);
        agree(ACKERMANN, &[&[0, 0], &[1, 3], &[2, 2], &[2, 3]]);
        agree(TAK, &[&[1, 2, 3], &[5, 3, 1], &[8, 4, 2]]);
        agree(HOFSTADTER, &[&[1], &[5], &[12]]);
        agree(MUTUAL, &[&[0], &[1], &[50], &[51]]);
        agree(TAIL_LOOP, &[&[0, 4], &[100, 0]]);
        agree(PARALLEL_IFS, &[&[0, 0], &[4, 0], &[5, 7], &[7, 2]]);
        agree(LOOPS, &[&[0, 0], &[0, 1], &[0, 5], &[-3, 7], &[5, 2], &[2, 13]]);
        agree(NESTED_SUMS, &[&[0], &[1], &[2], &[5]]);
        for x in [0, 4, 5, 9] {
            agree(BRANCHES, &[&[x, 0], &[x, 4], &[x, 8]]);
        }
    });
}

#[test]
fn a_planted_difference_is_found() {
    let (program, _, _) = split_text(FIB);
    let (_, other, entry) = split_text(&FIB.replace("sub.i32(n, 2)", "sub.i32(n, 3)"));
    let args = [Const::I32(7)];
    assert_ne!(rewrite(&other, entry, &args, 100_000), run(&program, &args, &NoHost, 100_000));
}

#[test]
fn binary_recursion_goes_out_together() {
    assert_eq!(shape(FIB, "fib"), ["v0", "v2 fib v3 fib fib.1"]);
    assert_eq!(shape(FIB, "fib.1"), ["v2"]);
}

#[test]
fn results_that_are_operands_need_no_continuation() {
    assert_eq!(shape(ACKERMANN, "A"), ["v3", "v4 v0 v6 A A"]);
    assert_eq!(shape(TAK, "tak"), ["v4 v1 v2 tak v5 v2 v0 tak v6 v0 v1 tak tak", "v2"]);
    assert_eq!(split_text(TAK).1.tasks.len(), 1);
}

#[test]
fn self_tail_calls_are_loops_and_others_are_tokens() {
    let (_, table, entry) = split_text(TAIL_LOOP);
    assert_eq!(table.tasks.len(), 1);
    assert!(table::print::table(&table).contains("again v3, v4"));
    assert_eq!(table.task(entry).arity(), 2);
    assert_eq!(shape(MUTUAL, "even"), ["true", "v2 odd"]);
}

#[test]
fn branches_with_calls_emit_the_join() {
    let emissions = |rest: &str| {
        let (_, table, _) = split_text(&format!(
            "entry main
             @task fn g(x: i32) -> (i32) {{ yield x }}
             fn main(x: i32, y: i32) -> (i32) {{
               c: bool = lt.i32(x, 0)
               u: i32 = if c {{ a: i32 = call g(x) yield a }} else {{ yield 9 }}
               s0: i32 = mul.i32(u, y)
               {rest}
             }}"
        ));
        table.tasks[0].emissions().iter().map(|e| table::print::emission(&table, e)).collect::<Vec<_>>()
    };
    // A branch without calls evaluates a small rest itself.
    assert_eq!(emissions("yield s0"), ["v1 v0 g main.1", "v3"]);
    let rest: String = (0..20).map(|i| format!("s{}: i32 = mul.i32(s{i}, s{i})\n", i + 1)).collect();
    assert_eq!(emissions(&format!("{rest} yield s20")), ["v1 v0 g main.1", "v1 9 main.1"]);
}

#[test]
fn the_papers_example_has_three_streams() {
    let (_, table, entry) = split_text(
        "entry main
         @task fn mul(x: i32, y: i32) -> (i32) { r: i32 = mul.i32(x, y) yield r }
         @task fn add(x: i32, y: i32) -> (i32) { r: i32 = add.i32(x, y) yield r }
         fn main() -> (i32) {
           a: i32 = call mul(1, 2)
           b: i32 = call mul(3, 4)
           c: i32 = call add(a, b)
           yield c
         }",
    );
    let trace: Vec<_> = rounds(&table, initial(&table, entry, &[]), &NoHost, 100)
        .map(|stream| print(&table, &stream.expect("ends")))
        .collect();
    assert_eq!(trace, ["1 2 mul 3 4 mul add", "2 12 add", "14"]);
}

#[test]
fn continuations_recompute_what_saves_words() {
    // n is live anyway, so n - 1 and n - 2 are not passed; a constant never is.
    let (_, table, _) = split_text(HOFSTADTER);
    let wide = table.tasks.iter().map(|t| t.arity()).max();
    assert_eq!(wide, Some(3), "{}", table::print::table(&table));
}

/// `main` calls `far`, which holds a loop of `n` turns, and `near`, which holds one of `turns`.
fn loops_in_helpers(turns: u32) -> String {
    let digest = |name: &str, limit: &str| {
        format!(
            "fn {name}(n: i32) -> (i32) {{
               i: i32, a: i32 = loop fold (i0: i32 = 0, a0: i32 = n) while {{ c: bool = lt.i32(i0, {limit}) yield c }} do {{
                 j: i32 = add.i32(i0, 1)
                 b: i32 = mul.i32(a0, 5)
                 d: i32 = add.i32(b, i0)
                 yield j, d
               }}
               yield a
             }}\n"
        )
    };
    format!(
        "entry main {} {} fn main(n: i32) -> (i32) {{
           x: i32 = call far(n)
           y: i32 = call near(x)
           z: i32 = sub.i32(x, y)
           yield z
         }}",
        digest("far", "n"),
        digest("near", &turns.to_string())
    )
}

#[test]
fn long_loops_become_tasks_and_so_does_what_holds_them() {
    let names = |turns| {
        let mut program = program(&loops_in_helpers(turns));
        assert!(super::lift::has_long_loops(&program, 100));
        super::lift::long_loops(&mut program, 100);
        let (table, entry) = split(&program).expect("few words");
        let args = [Const::I32(300)];
        let direct = run(&program, &args, &NoHost, 1_000_000);
        assert_eq!(rewrite(&table, entry, &args, 1_000_000), direct);
        // Without continuations.
        let own = |name: &&str| !name.ends_with(|c: char| c.is_ascii_digit());
        let mut names: Vec<_> = table.tasks.iter().map(|t| t.name.as_str()).filter(own).collect();
        names.sort();
        (names.join(" "), table.helpers.len())
    };
    assert_eq!(names(100), ("far far.loop main".into(), 1));
    assert_eq!(names(101), ("far far.loop main near near.loop".into(), 0));
    let short = program(&loops_in_helpers(100).replace("i0, n)", "i0, 20)"));
    assert!(!super::lift::has_long_loops(&short, 100));
}

#[test]
fn emissions_stay_short() {
    let (mut chain, mut wide) = (String::new(), String::new());
    for i in 0..200 {
        chain += &format!("a{}: i32 = call g(a{i}, 0)\n", i + 1);
        wide += &format!("b{i}: i32 = call g(n, {i}) c{}: i32 = add.i32(c{i}, b{i})\n", i + 1);
    }
    let text = format!(
        "entry f @task fn g(x: i32, y: i32) -> (i32) {{ z: i32 = add.i32(x, y) yield z }}
         fn f(n: i32) -> (i32, i32) {{ a0: i32 = add.i32(n, 1) c0: i32 = add.i32(n, 2) {chain} {wide} yield a200, c200 }}"
    );
    let (_, table, _) = split_text(&text);
    assert!(table.longest_emission() < 80, "{}", table.longest_emission());
    agree(&text, &[&[3]]);
}

#[test]
fn long_chains_split_in_reasonable_time() {
    let mut body = String::new();
    for i in 0..500 {
        body += &format!(
            "a{}: i32 = call g(a{i}) b{i}: i32 = mul.i32(a{i}, n) c{}: i32 = add.i32(b{i}, c{i})\n",
            i + 1,
            i + 1
        );
    }
    let text = format!(
        "entry f @task fn g(x: i32) -> (i32) {{ yield x }}
         fn f(n: i32) -> (i32) {{ a0: i32 = add.i32(n, 1) c0: i32 = add.i32(n, 2) {body} yield c500 }}"
    );
    let start = std::time::Instant::now();
    let back = crate::back::back(program(&text)).expect("few words");
    assert_eq!(back.table.tasks.len(), 501);
    let seconds = start.elapsed().as_secs();
    assert!(seconds < 20, "{seconds} s");
}
