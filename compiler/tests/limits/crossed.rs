//! Constructs that are harmless alone, crossed with what makes each of them dear: wide structs with names of their
//! fields, many type parameters with many calls, long bodies deep inside of others.

use super::texts::{Text, chain, count, numbered, text};

/// Fields of the widest structs here; a value has 4096 words at most.
const WIDE: usize = 4000;
/// Branches and loops in each other; the parser takes trees of 500 levels.
const DEEP: usize = 120;

fn each(n: usize, piece: impl Fn(usize) -> String) -> String {
    (0..n).map(piece).collect()
}

/// `n` copies of `open`, `#` being the number, then `inner`, then as many of `close`.
fn around(n: usize, open: &str, inner: &str, close: &str) -> String {
    each(n, |i| open.replace('#', &i.to_string())) + inner + &close.repeat(n)
}

/// Wide structs, their fields named in every way.
pub fn fields(bytes: usize) -> Vec<Text> {
    let wide = format!("struct S({} z: i32);\n", each(WIDE, |i| format!("f{i}: i32, ")));
    let left = bytes.saturating_sub(wide.len()).max(bytes / 4);
    let construct = each(WIDE, |i| format!("f{}: n, ", WIDE - 1 - i));
    vec![
        chain(
            "the last field of a wide struct",
            &format!("{wide} fn main(s: S) -> i32 {{ let a0 = 1; "),
            "let a# = a% + s.z; ",
            "a$ }",
            left,
        ),
        chain(
            "the last field of a wide struct in patterns",
            &format!("{wide} fn main(s: S) -> i32 {{ let a0 = 1; "),
            "let S(z: a#, ..) = s; ",
            "a$ }",
            left,
        ),
        chain(
            "arms over the last field of a wide struct",
            &format!("{wide} fn main(s: S) -> i32 = match s {{ "),
            "S(z: #, ..) => %, ",
            "_ => 0 };",
            left,
        ),
        chain(
            "arms over a wide tuple",
            &format!("fn main(s: ({} i32)) -> i32 = match s {{ ", "i32, ".repeat(WIDE)),
            &format!("({} #) => %, ", "_, ".repeat(WIDE)),
            "_ => 0 };",
            bytes,
        ),
        text(
            "a wide struct built by names again and again",
            format!(
                "{wide} fn main(n: i32) -> i32 {{ {} n }}",
                each(left / construct.len() + 1, |_| format!("let n = S({construct} z: n).z; "))
            ),
        ),
        text(
            "an update of fields that are not there",
            format!(
                "struct S(a: i32); fn main(s: S) -> i32 = (s with ({} a: 1)).a;",
                numbered("b#: 1, ", bytes)
            ),
        ),
        text(
            "a struct built of fields that are not there",
            format!("struct S(a: i32); fn main(n: i32) -> i32 = S({} a: 1).a;", numbered("b#: 1, ", bytes)),
        ),
        text(
            "a pattern of fields that are not there",
            format!(
                "struct S(a: i32); fn main(s: S) -> i32 = match s {{ S({} a: k) => k }};",
                numbered("b#: _, ", bytes)
            ),
        ),
        text("names of many alternatives in each other", {
            let half = WIDE / 2;
            let row = format!(
                "({} {} 1)",
                each(half, |i| format!("a{i}, ")),
                each(half, |i| format!("b{i} | b{i}, "))
            );
            let rows = vec![row.as_str(); bytes / row.len() + 1].join(" | ");
            format!(
                "fn main(n: i32) -> i32 = match ({} n) {{ {rows} => a1, _ => 0 }};",
                "n, ".repeat(2 * half)
            )
        }),
        text("alternatives in each column of wide rows", {
            let row = format!("({} 1)", "1 | 2, ".repeat(WIDE / 2));
            let rows = vec![row.as_str(); bytes / row.len() + 1].join(" | ");
            format!(
                "fn main(n: i32) -> i32 = match ({} n) {{ {rows} => 1, _ => 0 }};",
                "n, ".repeat(WIDE / 2)
            )
        }),
        text("arms of alternatives in each column", {
            let row = |i: usize| format!("({} {i}) => {i}, ", "1 | 2, ".repeat(WIDE / 2));
            let rows = each(bytes / row(1).len() + 1, row);
            format!("fn main(n: i32) -> i32 = match ({} n) {{ {rows} _ => 0 }};", "n, ".repeat(WIDE / 2))
        }),
        text(
            "a struct too wide, built by names",
            format!(
                "struct S({} z: i32); fn main(n: i32) -> i32 = S({} z: n).z;",
                numbered("f#: i32, ", bytes / 2),
                numbered("f#: n, ", bytes / 3)
            ),
        ),
        chain(
            "wide structs in wide structs",
            &format!(
                "struct T({} z: i32); struct S(a: T, b: T, c: T, d: T); fn main(s: S, n: i32) -> i32 {{ let s0 = s; ",
                each(900, |i| format!("f{i}: i32, "))
            ),
            "let s# = s% with (a: s%.b with (f7: n), d: s%.a); ",
            "s$.a.z }",
            bytes,
        ),
    ]
}

/// Calls of what has many parameters, holes or type parameters.
pub fn calls(bytes: usize) -> Vec<Text> {
    let types = 1000.min(bytes / 40);
    let generic = format!(
        "fn f<{}>(x: ({})) -> i32 = 1;\nparam p: ({}) = ({});\n",
        each(types, |i| format!("A{i}, ")),
        each(types, |i| format!("A{i}, ")),
        "i32, ".repeat(types),
        "1, ".repeat(types)
    );
    let left = bytes.saturating_sub(generic.len()).max(bytes / 4);
    // Each pipe and each hole is a level of the tree, and the call another one.
    let pipes = "n".to_string() + &" |> h".repeat(480);
    let filled = "n".to_string() + &" |> k(_, n)".repeat(240);
    let holes = around(240, "k(_, ", "n", ")(1)");
    let many = |line: &str| {
        let line = format!("let n = {line}; ");
        format!(
            "fn h(n: i32) -> i32 = n * 3; fn k(a: i32, b: i32) -> i32 = a - b; fn main(n: i32) -> i32 {{ {} n }}",
            line.repeat(bytes / line.len() + 1)
        )
    };
    vec![
        text("many long pipes", many(&pipes)),
        text("many long pipes into holes", many(&filled)),
        text("holes in holes", many(&holes)),
        text("lambdas called in place in each other", many(&around(160, "(|a#| a# + ", "n", ")(n)"))),
        chain(
            "functions that call one of many type parameters",
            &generic,
            "fn g#() -> i32 = f(p);\n",
            "fn main() -> i32 = g$();",
            left,
        ),
        chain(
            "calls of a function of many type parameters",
            &format!("{generic} fn main(n: i32) -> i32 {{ "),
            "let n = n + f(p); ",
            "n }",
            left,
        ),
        chain(
            "functions of one large type",
            &format!(
                "type T0 = (i32, f32); {} type T = T10;\n",
                each(10, |i| format!("type T{} = (T{i}, T{i});", i + 1))
            ),
            "fn f#(a: T, n: i32) -> i32 = n;\n",
            "fn main(n: i32) -> i32 = n;",
            bytes,
        ),
        chain(
            "locals of one large type",
            &format!(
                "type T0 = (i32, f32); {}\n fn main(a0: T10) -> i32 {{ ",
                each(10, |i| format!("type T{} = (T{i}, T{i});", i + 1))
            ),
            "let a# = a%; ",
            "1 }",
            bytes,
        ),
        chain(
            "structs of one large type",
            &format!("type T0 = (i32, f32); {}\n", each(10, |i| format!("type T{} = (T{i}, T{i});", i + 1))),
            "struct S#(a: T10);\n",
            "fn main(n: i32) -> i32 = n;",
            bytes,
        ),
        chain(
            "array lengths that are loops",
            "",
            "fn f#(a: [i32; fold(0..1000000, 1, |a, i| a * 3 + i) % 4 + 9]) -> i32 = 1;\n",
            "fn main(n: i32) -> i32 = n;",
            bytes,
        ),
        chain(
            "parameters whose defaults are loops",
            "",
            "param p#: i32 = fold(0..1000000, 1, |a, i| a * 3 + i);\n",
            "fn main(n: i32) -> i32 = p$ + p1;",
            bytes,
        ),
    ]
}

/// A long body deep inside of branches, loops, lambdas and blocks, and statements between those.
pub fn depths(bytes: usize) -> Vec<Text> {
    let piece = "let a# = a% * 3 + n; ";
    let (long, last) = (numbered(piece, bytes), count(piece, bytes));
    let long = format!("{{ let a0 = n; {long} a{last} }}");
    let invariant = "let a# = n / # + k; ";
    let (fixed, fixed_last) = (numbered(invariant, bytes), count(invariant, bytes));
    let sum: Vec<String> =
        (1..=300.min(fixed_last)).map(|i| format!("a{}", i * fixed_last / 300.min(fixed_last))).collect();
    let fixed = format!("{{ {fixed} {} }}", sum.join(" + "));
    let head = "@task fn t(n: i32) -> i32 = n; fn main(b: bool, n: i32, k: i32) -> i32 = ";
    let whole = |name: &str, open: &str, inner: &str, close: &str| {
        text(name, format!("{head}{};", around(DEEP, open, inner, close)))
    };
    // Between two levels as many statements as make up the whole text.
    let between = |name: &str, open: &str, piece: &str, close: &str| {
        let some = bytes / DEEP;
        let body = |level: usize| numbered(&piece.replace('^', &format!("{level}_")), some);
        let opened = each(DEEP, |level| body(level) + &open.replace('#', &level.to_string()));
        text(name, format!("{head}{{ let c = k; {opened} n {} }};", close.repeat(DEEP)))
    };
    vec![
        whole("a long body in branches", "if n > # { ", &long, " } else { 1 }"),
        whole("a long body in other branches", "if n > # { 1 } else { ", &long, " }"),
        whole("a long body in loops", "fold(0..n, #, |s#, i#| s# + ", &long, ")"),
        whole("a long body in sums", "sum(0..n, |i#| i# + ", &long, ")"),
        whole("a long body in blocks", "{ let b# = n; b# + ", &long, " }"),
        whole("a long body in lambdas", "(|c#| c# + ", &long, ")(n)"),
        whole("a long body in lambdas of a loop", "fold(0..n, #, |s#, i#| (|c#| c# + s# + ", &long, ")(n))"),
        whole("a long body in matches", "match n { # => 1, _ => ", &long, " }"),
        whole("a long body in branches of tasks", "if t(n) > # { ", &long, " } else { t(1) }"),
        whole("a long body in loops of tasks", "fold(0..n, #, |s#, i#| t(s#) + ", &long, ")"),
        whole("what does not change, in loops", "fold(0..n, #, |s#, i#| s# + i# + ", &fixed, ")"),
        whole("what does not change, in branches", "if n > # { ", &fixed, " } else { 1 }"),
        between("statements between branches", "if n > # { ", "let c = c * 3 + n; ", " } else { c }"),
        between(
            "used statements between branches",
            "c + if n > # { ",
            "let c = c / 3 + n; ",
            " } else { 1 }",
        ),
        between("statements between loops", "fold(0..n, c, |s#, i#| s# + { ", "let c = c / 3 + n; ", " })"),
        between(
            "branches between branches",
            "if n > # { ",
            "let c = if c > # { c + n } else { 7 }; ",
            " } else { c }",
        ),
        between("calls of tasks between branches", "if n > # { ", "let c = t(c) + #; ", " } else { c }"),
        between(
            "loops between loops",
            "fold(0..n, c, |s#, i#| s# + { ",
            "let c = fold(0..c, n, |x, j| x + j); ",
            " })",
        ),
    ]
}
