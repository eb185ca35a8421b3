//! Hostile programs: far too much of one thing, written to a given length.

use std::fmt::Write;

/// A program, and what there is too much of.
pub struct Text {
    pub name: String,
    pub text: String,
}

pub fn text(name: impl Into<String>, text: impl Into<String>) -> Text {
    Text { name: name.into(), text: text.into() }
}

/// `main` with this body.
fn main_of(body: &str) -> String {
    format!("fn main(b: bool, n: i32, x: f32) -> i32 = {body};\n")
}

/// `piece` with `#` for the number of the repetition and `%` for the one before it, up to `bytes`.
pub fn numbered(piece: &str, bytes: usize) -> String {
    let mut out = String::with_capacity(bytes + piece.len());
    let mut i = 1;
    while out.len() < bytes {
        out += &piece.replace('#', &i.to_string()).replace('%', &(i - 1).to_string());
        i += 1;
    }
    out
}

/// How many repetitions [`numbered`] makes.
pub fn count(piece: &str, bytes: usize) -> usize {
    let mut left = bytes as isize;
    let mut i = 1;
    while left > 0 {
        left -= piece.replace('#', &i.to_string()).replace('%', &(i - 1).to_string()).len() as isize;
        i += 1;
    }
    i - 1
}

/// Pieces numbered from 1, with what comes before them and, with `$` for the last number, after them.
pub fn chain(name: &str, first: &str, piece: &str, last: &str, bytes: usize) -> Text {
    let n = count(piece, bytes);
    text(name, format!("{first}{}{}", numbered(piece, bytes), last.replace('$', &n.to_string())))
}

/// The same with `n` pieces, for what grows by itself.
pub fn grown(name: &str, first: &str, piece: &str, last: &str, n: usize) -> Text {
    let mut out = first.to_string();
    for i in 1..=n {
        out += &piece.replace('#', &i.to_string()).replace('%', &(i - 1).to_string());
    }
    text(name, out + &last.replace('$', &n.to_string()))
}
/// Expressions, types and patterns in each other.
pub fn nested(bytes: usize) -> Vec<Text> {
    let expressions = [
        ("(", ")"),
        ("(", ""),
        ("[", "]"),
        ("[", "][0]"),
        ("(1, ", ").1"),
        ("{ ", " }"),
        ("{ let a = ", "; a }"),
        ("{ let a = 1; ", " }"),
        ("-", ""),
        ("- ", ""),
        ("!", ""),
        ("i32(", ")"),
        ("abs(", ")"),
        ("f(", ")"),
        ("Some(", ")"),
        ("|a| ", ""),
        ("(|a| ", ")(1)"),
        ("|a: i32| ", ""),
        ("if b { n } else ", ""),
        ("if b { ", " } else { 1 }"),
        ("if ", " { true } else { false }"),
        ("if b { n } else if b { 1 } else { ", " }"),
        ("match n { _ => ", " }"),
        ("match n { 1 => 2, _ => ", " }"),
        ("match ", " { a => a }"),
        ("n + ", ""),
        ("n + (", ")"),
        ("(", " + 1)"),
        ("n |> ", ""),
        ("(n |> ", ")"),
        ("b && ", ""),
        ("b && (", ")"),
        ("n < ", ""),
        ("n == ", ""),
        ("x: ", ""),
        ("", ".x"),
        ("", ".0"),
        ("", "[0]"),
        ("", "(1)"),
        ("", "()"),
        ("", " with (a: 1)"),
        ("", " |> abs"),
        ("", " |> (|a| a)"),
        ("", " + 1"),
        ("", " as i32"),
        ("fold(0..", ", 1, |a, i| a)"),
        ("fold(0..2, 1, |a, i| ", ")"),
        ("fold(0..2, ", ", |a, i| a)"),
        ("sum(0..2, |i| ", ")"),
        ("sum(0..n, |i| ", ")"),
        ("any(0..2, |i| ", ")"),
        ("grad(", ")"),
        ("deriv(", ")"),
        ("vec2(", ", 1.0).x"),
        ("trace(", ", _)"),
        ("f(_, ", ")"),
    ];
    let expressions = expressions.into_iter().map(|(open, close)| {
        let n = bytes / (open.len() + close.len());
        let body = format!("{}n{}", open.repeat(n), close.repeat(n));
        text(format!("nested `{open}..{close}`"), main_of(&body))
    });
    let types = [
        ("fn(", ") -> i32"),
        ("fn(", ""),
        ("fn() -> ", ""),
        ("(", ", i32)"),
        ("(", ""),
        ("[", "; 2]"),
        ("[", ""),
        ("Option<", ">"),
        ("Option<", ""),
    ];
    let types = types.into_iter().map(|(open, close)| {
        let n = bytes / (open.len() + close.len());
        let ty = format!("{}i32{}", open.repeat(n), close.repeat(n));
        text(format!("nested type `{open}..{close}`"), format!("fn main(a: {ty}) -> i32 = 1;"))
    });
    let patterns =
        [("(", ", a)"), ("(", ""), ("Some(", ")"), ("Some(", ""), ("1 | ", ""), ("P(a: ", ")"), ("| ", "")];
    let patterns = patterns.into_iter().map(|(open, close)| {
        let n = bytes / (open.len() + close.len());
        let pattern = format!("{}_{}", open.repeat(n), close.repeat(n));
        text(
            format!("nested pattern `{open}..{close}`"),
            main_of(&format!("match n {{ {pattern} => 1, _ => 2 }}")),
        )
    });
    expressions.chain(types).chain(patterns).collect()
}

/// One piece of text over and over, which is hardly ever a program.
pub fn repeated(bytes: usize) -> Vec<Text> {
    let pieces = [
        "(",
        ")",
        "[",
        "]",
        "{",
        "}",
        "<",
        ">",
        "-",
        "!",
        "|",
        "||",
        "|x|",
        "|x",
        "=",
        "=>",
        "->",
        "..",
        ".",
        ",",
        ";",
        ":",
        "_",
        "@",
        "@task ",
        "@task @inline ",
        "if",
        "if ",
        "else ",
        "fn",
        "fn ",
        "fn(",
        "fn f",
        "fn f(",
        "fn f() ",
        "fn f() -> i32 = ",
        "let ",
        "let a = ",
        "match ",
        "match a {",
        "use ",
        "use x;",
        "use terrain;",
        "use \"a\";",
        "const ",
        "const a = ",
        "param ",
        "raster ",
        "struct ",
        "struct S(",
        "enum ",
        "enum E {",
        "type ",
        "type T = ",
        "with ",
        "with (",
        "in ",
        "true ",
        "x",
        "x ",
        "0",
        "0 ",
        "9",
        "0x",
        "1e",
        "1.",
        ".1",
        "1..",
        "1_",
        "\"",
        "'",
        "\\",
        "#",
        "$",
        "`",
        "?",
        "~",
        "/",
        "//",
        "/*",
        "*/",
        "/* ",
        "///",
        "/// a\n",
        "\n",
        "\r",
        "\r\n",
        "\t",
        "\0",
        "\u{1}",
        "\u{7f}",
        "\u{a0}",
        "\u{e9}",
        "\u{fffd}",
        "\u{feff}",
        "\u{202e}",
        "\u{10ffff}",
        "\u{1f600}",
        "a\u{301}",
        "\u{e9} ",
        "f(|x| ",
        "Option<",
        "1 < ",
        "if a { z } el ",
        "let 1;\n",
        "let a = 1 ",
        "fn f() -> i32 = 1 \n",
        "fn f() -> i32 = ;\n",
        "fn f() -> i32 = (;\n",
        "fn f( -> i32 = 1;\n",
        "struct S(a: i32)\n",
        "{ let a = 1; ",
        "for (;;) {",
        "while ",
        "return ",
        "int x = 1;\n",
        "x := 1;\n",
        "x = 1;\n",
        "a::b::",
        "&x ",
        "*x ",
        "(x as i32) ",
        "lambda x: ",
        "\\x -> ",
        "function f() {",
    ];
    let whole = pieces
        .into_iter()
        .map(|piece| text(format!("only `{}`", piece.escape_debug()), piece.repeat(bytes / piece.len())));
    let inside = pieces.into_iter().map(|piece| {
        text(
            format!("in a body, only `{}`", piece.escape_debug()),
            main_of(&piece.repeat(bytes / piece.len())),
        )
    });
    whole.chain(inside).collect()
}

/// Long words.
pub fn lexical(bytes: usize) -> Vec<Text> {
    let (digits, name) = ("9".repeat(bytes), "a".repeat(bytes));
    let mut all: Vec<Text> = [
        digits.clone(),
        format!("0x{digits}"),
        format!("{digits}u"),
        format!("{digits}.0"),
        format!("1e{digits}"),
        format!("1e-{digits}"),
        format!("0.{digits}"),
        format!("0.{}1", "0".repeat(bytes)),
        format!("{}1", "0".repeat(bytes)),
        "1_".repeat(bytes / 2),
        format!("[1; {digits}]"),
        format!("\"{name}\""),
        format!("\"{name}"),
        name.clone(),
        format!("n.{name}"),
        format!("n.{}", "x".repeat(bytes)),
        format!("n.{digits}"),
    ]
    .into_iter()
    .map(|word| text(format!("the word {}..", &word[..8]), main_of(&word)))
    .collect();
    let half = "a".repeat(bytes / 2);
    all.push(text(
        "a long name",
        format!("fn {half}(x: i32) -> i32 = x; fn main(n: i32) -> i32 = {half}(n);"),
    ));
    all.push(text(
        "a long name, misspelt",
        format!("fn {half}(x: i32) -> i32 = x; fn main(n: i32) -> i32 = {half}b(n);"),
    ));
    all.push(text("a long local", format!("fn main(n: i32) -> i32 {{ let {half} = n; {half} }}")));
    all.push(text("a long task", format!("@task fn {name}(x: i32) -> i32 = if x < 1 {{ 1 }} else {{ x }}; fn main(n: i32) -> i32 = {half}(n);")));
    all.push(text("a long parameter", format!("param {half}: i32 = 1; fn main(n: i32) -> i32 = {half};")));
    all.push(text("a long type", format!("struct {half}(a: i32); fn main(n: i32) -> i32 = {half}(n).a;")));
    all.push(text(
        "a long type in many messages",
        format!(
            "struct {half}(a: i32); fn main(n: i32) -> i32 = {};",
            format!("({half}(n) + 1) + ").repeat(1) + "1"
        ),
    ));
    all.push(text("a long comment", format!("// {name}\nfn main(n: i32) -> i32 = n;")));
    all.push(text("a long block comment", format!("/* {name} */ fn main(n: i32) -> i32 = n;")));
    all.push(text("a long doc comment", format!("/// {name}\nfn main(n: i32) -> i32 = n;")));
    all.push(text("a long module path", format!("use \"{name}\"; fn main(n: i32) -> i32 = n;")));
    all.push(text("a long attribute", format!("@{name} fn main(n: i32) -> i32 = n;")));
    all.push(text(
        "a long line with an error",
        format!("fn main(n: i32) -> i32 = {}y;", "n * ".repeat(100) + &" ".repeat(bytes)),
    ));
    let names = 300;
    let long = "b".repeat(bytes / names / 3);
    let functions: String =
        (0..names).map(|i| format!("fn {long}{i}(x: i32) -> i32 = {long}x{i}(x);\n")).collect();
    all.push(text("many long names, misspelt", functions));
    all
}

/// Many items.
pub fn items(bytes: usize) -> Vec<Text> {
    let each = [
        ("constants", "const A0 = 1;", "const A# = A% + 1;\n", "fn main() -> i32 = A$;"),
        ("constants of the next", "", "const A% = A# + 1;\n", "fn main() -> i32 = A0;"),
        ("constants in a circle", "const A0 = A9;", "const A# = A%;\n", ""),
        ("doubling constants", "const A0 = (1, 1);", "const A# = (A%, A%);\n", "fn main() -> i32 = 1;"),
        (
            "constants of calls",
            "fn f(x: i32) -> i32 = x + 1; const A0 = 1;",
            "const A# = f(A%);\n",
            "fn main() -> i32 = A$;",
        ),
        (
            "vector constants",
            "const A0 = vec3(1.0);",
            "const A# = A% + vec3(1.0, 2.0, 3.0);\n",
            "fn main() -> vec3 = A$;",
        ),
        ("aliases", "type T0 = i32;", "type T# = T%;\n", "fn main(x: T$) -> i32 = 1;"),
        ("aliases of the next", "", "type T% = T#;\n", "fn main() -> i32 = 1;"),
        ("aliases in a circle", "type T0 = T9;", "type T# = T%;\n", ""),
        ("alias of itself", "", "type T# = T#;\n", ""),
        ("aliases of pairs", "type T0 = i32;", "type T# = (T%, T%);\n", "fn main(x: T9) -> i32 = 1;"),
        ("aliases of arrays", "type T0 = i32;", "type T# = [T%; 1000];\n", "fn main(x: T$) -> i32 = 1;"),
        (
            "aliases of functions",
            "type T0 = i32;",
            "type T# = fn(T%) -> T%;\n",
            "fn main(x: i32) -> i32 = 1;",
        ),
        (
            "aliases with parameters",
            "type T0<A> = A;",
            "type T#<A> = T%<(A, A)>;\n",
            "fn main(x: T9<i32>) -> i32 = 1;",
        ),
        ("structs", "struct S0(a: i32);", "struct S#(a: S%);\n", "fn main(x: i32) -> i32 = 1;"),
        ("structs of the next", "", "struct S%(a: S#);\n", ""),
        ("structs in a circle", "struct S0(a: S9);", "struct S#(a: S%);\n", ""),
        ("structs of themselves", "", "struct S#(a: S#);\n", ""),
        ("structs of two", "struct S0(a: i32);", "struct S#(a: S%, b: S%);\n", "fn main(x: i32) -> i32 = 1;"),
        (
            "generic structs",
            "struct S0<A>(a: A);",
            "struct S#<A>(a: S%<(A, A)>);\n",
            "fn main(x: S9<i32>) -> i32 = 1;",
        ),
        ("enums", "enum E0 { V0 }", "enum E# { V#(E%) }\n", "fn main(x: i32) -> i32 = 1;"),
        ("enums of the next", "", "enum E% { V%(E#) }\n", ""),
        ("enums of themselves", "", "enum E# { V#(E#), W# }\n", ""),
        ("enums of two", "enum E0 { V0 }", "enum E# { V#(E%, E%) }\n", "fn main(x: i32) -> i32 = 1;"),
        ("parameters", "param p0: i32 = 1;", "param p#: i32 = p%;\n", "fn main() -> i32 = p$;"),
        ("plain parameters", "", "param p#: i32 = # in 0..999999;\n", "fn main() -> i32 = p$;"),
        (
            "function parameters",
            "fn f0(x: i32) -> i32 = x;",
            "param p#: fn(i32) -> i32 = f0;\n",
            "fn main() -> i32 = p$(1);",
        ),
        ("rasters", "use terrain;", "raster r#: vec3;\n", "fn pixel(p: vec2) -> vec3 = r$(p);"),
        (
            "functions",
            "fn f0(n: i32) -> i32 = n;",
            "fn f#(n: i32) -> i32 = f%(n) + 1;\n",
            "fn main(n: i32) -> i32 = f$(n);",
        ),
        (
            "functions of branches",
            "fn f0(n: i32) -> i32 = n;",
            "fn f#(n: i32) -> i32 = if n < # { f%(n + 1) } else { f%(n) };\n",
            "fn main(n: i32) -> i32 = f$(n);",
        ),
        (
            "functions of loops",
            "fn f0(n: i32) -> i32 = n;",
            "fn f#(n: i32) -> i32 = fold(0..n, #, |a, i| a + f%(i));\n",
            "fn main(n: i32) -> i32 = f$(n);",
        ),
        (
            "recursive functions",
            "fn f0(n: i32) -> i32 = f9(n);",
            "fn f#(n: i32) -> i32 = if n < # { n } else { f%(n - 1) };\n",
            "fn main(n: i32) -> i32 = f$(n);",
        ),
        (
            "one circle of functions",
            "",
            "fn f%(n: i32) -> i32 = if n < # { n } else { f#(n - 1) + 1 };\n",
            "fn f$(n: i32) -> i32 = f0(n) + 2; fn main(n: i32) -> i32 = f0(n);",
        ),
        (
            "recursive functions with parameters",
            "",
            "fn f%(n: i32, a: i32, b: f32) -> i32 = if n < # { n } else { f#(n - 1, a, b + 1.0) + 1 };\n",
            "fn f$(n: i32, a: i32, b: f32) -> i32 = f0(n, a, b) + 2; fn main(n: i32) -> i32 = f0(n, 3, 4.0);",
        ),
        (
            "tasks",
            "@task fn f0(n: i32) -> i32 = n;",
            "@task fn f#(n: i32) -> i32 = f%(n) + #;\n",
            "fn main(n: i32) -> i32 = f$(n);",
        ),
        (
            "tasks in tail position",
            "@task fn f0(n: i32) -> i32 = n;",
            "@task fn f#(n: i32) -> i32 = f%(n + #);\n",
            "fn main(n: i32) -> i32 = f$(n);",
        ),
        (
            "inline functions",
            "fn f0(n: i32) -> i32 = n;",
            "@inline fn f#(n: i32) -> i32 = f%(n) + #;\n",
            "fn main(n: i32) -> i32 = f$(n);",
        ),
        (
            "inline functions twice",
            "fn f0(n: i32) -> i32 = n;",
            "@inline fn f#(n: i32) -> i32 = f%(n) + f%(#);\n",
            "fn main(n: i32) -> i32 = f$(n);",
        ),
        (
            "functions twice",
            "fn f0(n: i32) -> i32 = n;",
            "fn f#(n: i32) -> i32 = f%(n) + f%(n + 1);\n",
            "fn main(n: i32) -> i32 = f$(n);",
        ),
        (
            "constant arguments",
            "fn f0(n: i32, k: i32) -> i32 = n + k;",
            "fn f#(n: i32, k: i32) -> i32 = f%(n, k) + f%(n, 7);\n",
            "fn main(n: i32) -> i32 = f$(n, 7);",
        ),
        (
            "generic functions",
            "fn f0<A>(x: A) -> A = x;",
            "fn f#<A>(x: A) -> A = f%(x);\n",
            "fn main() -> i32 = f$(1);",
        ),
        (
            "generic functions of pairs",
            "fn f0<A>(x: A) -> A = x;",
            "fn f#<A>(x: A) -> A = f%((x, x)).0;\n",
            "fn main() -> i32 = f9(1);",
        ),
        (
            "polymorphic recursion",
            "fn f0<A>(x: A) -> i32 = f9((x, 1));",
            "fn f#<A>(x: A) -> i32 = f%(x);\n",
            "fn main() -> i32 = f9(1);",
        ),
        ("entries", "", "fn main#(n: i32) -> i32 = n + #;\n", "fn main(n: i32) -> i32 = n;"),
        (
            "entries of one function",
            "fn f(n: i32) -> i32 = if n < 1 { 1 } else { f(n - 1) + f(n - 2) };",
            "fn main#(n: i32) -> i32 = f(n + #);\n",
            "fn main(n: i32) -> i32 = main$(n);",
        ),
        (
            "bakes",
            "use terrain;",
            "@bake fn b#(p: vec2) -> f32 = p.x + #.0;\n",
            "fn pixel(p: vec2) -> f32 = b$(p);",
        ),
        (
            "bakes of each other",
            "use terrain; @bake fn b0(p: vec2) -> f32 = p.x;",
            "@bake fn b#(p: vec2) -> f32 = b%(p) + #.0;\n",
            "fn pixel(p: vec2) -> f32 = b$(p);",
        ),
        (
            "function values",
            "fn f0(n: i32) -> i32 = n;",
            "fn f#(n: i32) -> i32 = n + #;\nfn g#(n: i32) -> fn(i32) -> i32 = if n > # { f# } else { f% };\n",
            "fn main(n: i32) -> i32 = g$(n)(n);",
        ),
        (
            "choices",
            "fn f0(n: i32) -> i32 = n; fn g0(n: i32) -> fn(i32) -> i32 = f0;",
            "fn f#(n: i32) -> i32 = n + #;\nfn g#(n: i32) -> fn(i32) -> i32 = if n > # { f# } else { g%(n) };\n",
            "fn main(n: i32) -> i32 = g$(n)(n);",
        ),
        ("definitions of one name", "", "fn f(n: i32) -> i32 = #;\n", "fn main(n: i32) -> i32 = f(n);"),
        (
            "parameters of function type used",
            "param q: fn(i32) -> i32 = f0; fn f0(n: i32) -> i32 = n;",
            "fn f#(n: i32) -> i32 = q(n) + f%(n);\n",
            "fn main(n: i32) -> i32 = f$(n);",
        ),
        (
            "derivatives",
            "fn f0(x: f32) -> f32 = x * x;",
            "fn f#(x: f32) -> f32 = deriv(f%)(x) * x;\n",
            "fn main(x: f32) -> f32 = f$(x);",
        ),
        (
            "derivatives of sums",
            "fn f0(x: f32) -> f32 = x * x;",
            "fn f#(x: f32) -> f32 = f%(x) * x + sin(f%(x));\n",
            "fn main(x: f32) -> f32 = deriv(f9)(x);",
        ),
    ];
    each.into_iter().map(|(name, first, piece, last)| chain(name, first, piece, last, bytes)).collect()
}

/// One long body.
pub fn bodies(bytes: usize) -> Vec<Text> {
    let head = "fn f(a: i32) -> i32 = if a < 1 { 1 } else { f(a - 1) + 1 };\n@task fn t(a: i32) -> i32 = a + 1;\nfn h(a: i32) -> i32 = a * 3;\nfn main(b: bool, n: i32, x: f32) -> i32 ";
    let each = [
        ("lets", "let a# = n + #; ", "a$"),
        ("lets of the last", "let a# = a% * 3; ", "a$"),
        ("lets of two", "let a# = a% * a% + n; ", "a$"),
        ("lets of pairs", "let a# = (a%, a%); ", "n"),
        ("lets of one name", "let n = n + 1; ", "n"),
        ("lets of lambdas", "let a# = |y| y; ", "n"),
        ("lets of sums", "let a# = |y| y + y; ", "n"),
        ("lets of lambdas of lambdas", "let a# = |y: i32| a0 + y + #; ", "a$(n)"),
        ("lets of calls of lambdas", "let g# = |y: i32| y + #; let a# = g#(a%); ", "a$"),
        ("lets of recursive calls", "let a# = f(n + #); ", "a$"),
        ("lets of recursive calls used", "let a# = f(a%); ", "a$"),
        ("lets of recursive calls added", "let a# = f(n + #) + a%; ", "a$"),
        ("lets of tasks", "let a# = t(a%); ", "a$"),
        ("lets of tasks and branches", "let a# = if a% < # { t(a%) } else { a% + 1 }; ", "a$"),
        ("lets of branches", "let a# = if a% < # { n } else { a% + 1 }; ", "a$"),
        ("lets of two branches", "let a# = if b { a% + h(n) } else { a% * 2 }; ", "a$"),
        ("lets of matches", "let a# = match a% { 1 => 2, # => 3, k => k + 1 }; ", "a$"),
        ("lets of folds", "let a# = fold(0..a%, n, |s, i| s + i * #); ", "a$"),
        ("lets of folds of tasks", "let a# = fold(0..a%, n, |s, i| s + t(i)); ", "a$"),
        ("lets of sums of tasks", "let a# = sum(0..a%, |i| t(i) + #); ", "a$"),
        ("lets of sums", "let a# = sum(0..a%, |i| i * i); ", "a$"),
        ("lets of any", "let a# = if any(0..a%, |i| i * i == n) { 1 } else { a% }; ", "a$"),
        ("lets of constant folds", "let a# = fold(0..2000000000, #, |s, i| s + i); ", "a$"),
        (
            "lets of options",
            "let a# = match if a% > 1 { Some(a%) } else { None } { Some(k) => k + 1, None => # }; ",
            "a$",
        ),
        ("lets of arrays", "let a# = [a%, n, #][n]; ", "a$"),
        ("lets of vectors", "let a# = i32((vec3(f32(a%), x, 1.0) * 2.0 + vec3(x)).y); ", "a$"),
        ("lets of matrices", "let a# = i32((mat4(f32(a%)) * vec4(x)).y); ", "a$"),
        ("lets of noise", "let a# = i32(sin(f32(a%)) * 10.0); ", "a$"),
        ("live across a task", "let a# = n * # + n; ", "t(n) + a$"),
        ("unknown types", "let a# = |y| y.x; ", "n"),
        ("open questions", "let a# = |y| a%.x; ", "n"),
        ("unused pairs", "let (a#, c#) = (n, a%); ", "n"),
        ("partial applications", "let a# = h(_); ", "a$(n)"),
        ("pipes", "let a# = a% |> h |> h; ", "a$"),
    ];
    let mut all: Vec<Text> = each
        .into_iter()
        .map(|(name, piece, last)| {
            chain(name, &format!("{head}{{ let a0 = n; "), piece, &format!("{last} }}"), bytes)
        })
        .collect();
    let wide = [
        ("a long sum", "n + ", "1"),
        ("a long sum of calls", "f(n) + ", "1"),
        ("a long sum of tasks", "t(n) + ", "1"),
        ("a long sum of branches", "(if b { 1 } else { n }) + ", "1"),
        ("a long else if", "if n == # { # } else ", "{ 1 }"),
        ("a long else if of calls", "if n == # { t(#) } else ", "{ 1 }"),
        ("a long else if of and", "if b && n > # { # } else ", "{ 1 }"),
    ];
    all.extend(
        wide.map(|(name, piece, last)| chain(name, &format!("{head}= "), piece, &format!("{last};"), bytes)),
    );
    let lists = [
        ("a long array", "[", "n, ", "1][n]"),
        ("a long array of calls", "[", "f(n), ", "1][n]"),
        ("a long array of numbers", "[", "#, ", "1][n]"),
        ("a long tuple", "(", "n, ", "1).0"),
        ("long nested tuples", "(", "(n, (x, b)), ", "1).1"),
        ("long arguments", "f(", "n, ", "1)"),
        ("long arguments of a lambda", "(|c: i32| c)(", "n, ", "1)"),
        ("long arguments of a built-in", "min(", "n, ", "1)"),
        ("long and", "if ", "b && ", "true { 1 } else { 2 }"),
        ("long or", "if ", "n == # || ", "true { 1 } else { 2 }"),
        ("a long comparison", "if ", "n == ", "1 { 1 } else { 2 }"),
        ("a long block", "{ ", "n; ", "1 }"),
    ];
    all.extend(lists.map(|(name, first, piece, last)| {
        chain(name, &format!("{head}= {first}"), piece, &format!("{last};"), bytes)
    }));
    let params = numbered("a#: i32, ", bytes);
    let n = count("a#: i32, ", bytes);
    all.push(text("many parameters", format!("fn main({params} z: i32) -> i32 = a{n};")));
    all.push(text(
        "many parameters of a lambda",
        format!("fn main(n: i32) -> i32 {{ let g = |{}z: i32| z; 1 }}", params),
    ));
    let third = bytes / 3;
    let (params, sums) = (numbered("a#: i32, ", third), numbered("a# + ", third));
    let args = numbered("a#, ", third);
    all.push(text(
        "many parameters of a recursive function",
        format!("fn g({params} z: i32) -> i32 = if z < 1 {{ {}1 }} else {{ g({args} z - 1) }}; fn main(n: i32) -> i32 = n;", {
            let n = count("a#: i32, ", third).min(count("a# + ", third));
            (1..=n.min(300)).fold(String::new(), |mut s, i| {
                let _ = write!(s, "a{i} + ");
                s
            })
        }),
    ));
    let _ = sums;
    all.push(text("many lets live across a call", {
        let lets: String = (0..900).map(|i| format!("let a{i} = n * {i} + n; ")).collect();
        let uses: String = (0..450).map(|i| format!("a{i} * a{} + ", i + 450)).collect();
        format!("{head}{{ {lets} let z = f(n); {uses} z }}")
    }));
    all
}

/// Small texts that ask for very much.
pub fn growing() -> Vec<Text> {
    let mut all = vec![
        grown(
            "doubling calls",
            "fn g0(x: i32) -> i32 = x;",
            "fn g#(x: i32) -> i32 = g%(x) + g%(x + 1);\n",
            "fn main(x: i32) -> i32 = g$(x);",
            60,
        ),
        grown(
            "doubling calls in place",
            "fn g0(x: i32) -> i32 = x;",
            "@inline fn g#(x: i32) -> i32 = g%(x) + g%(x + 1);\n",
            "fn main(x: i32) -> i32 = g$(x);",
            60,
        ),
        grown(
            "doubling tasks",
            "fn g0(x: i32) -> i32 = x;",
            "@task fn g#(x: i32) -> i32 = g%(x) + g%(x + 1);\n",
            "fn main(x: i32) -> i32 = g$(x);",
            60,
        ),
        grown(
            "doubling instances",
            "fn h0<A>(x: A) -> i32 = 1;",
            "fn h#<A>(x: A) -> i32 = h%((x, 1)) + h%((x, 1.0));\n",
            "fn main() -> i32 = h$(1);",
            40,
        ),
        grown(
            "doubling types",
            "fn h0<A>(x: A) -> i32 = 1;",
            "fn h#<A>(x: A) -> i32 = h%((x, x));\n",
            "fn main() -> i32 = h$(1);",
            60,
        ),
        grown(
            "tripling instances",
            "fn h0<A>(x: A) -> i32 = 1;",
            "fn h#<A>(x: A) -> i32 = h%(Some(x)) + h%([x, x]) + h%(|y: A| y);\n",
            "fn main() -> i32 = h$(1);",
            12,
        ),
        grown(
            "doubling lambdas",
            "fn main(x: i32) -> i32 { let g0 = |x: i32| x;",
            "let g# = |x: i32| g%(x) + g%(x + 1);\n",
            "g$(x) }",
            60,
        ),
        grown(
            "lambdas of lambdas",
            "fn main(x: i32) -> i32 { let g0 = |x: i32| x;",
            "let g# = if x > # { g% } else { |y: i32| g%(y) + # };\n",
            "g$(x) }",
            60,
        ),
        grown(
            "compositions",
            "fn c(f: fn(i32) -> i32, g: fn(i32) -> i32) -> fn(i32) -> i32 = |x| f(g(x)); fn main(x: i32) -> i32 { let g0 = |x: i32| x + 1;",
            "let g# = c(g%, g%);\n",
            "g$(x) }",
            60,
        ),
        grown(
            "doubling derivatives",
            "fn f0(x: f32) -> f32 = x * x;",
            "fn f#(x: f32) -> f32 = deriv(f%)(x) * sin(f%(x));\n",
            "fn main(x: f32) -> f32 = f$(x);",
            60,
        ),
        grown(
            "derivatives of derivatives",
            "fn f0(x: f32) -> f32 = sin(x * x) / x;",
            "fn f#(x: f32) -> f32 = deriv(f%)(x);\n",
            "fn main(x: f32) -> f32 = f$(x);",
            40,
        ),
        grown(
            "doubling constants",
            "const A0 = 1.5;",
            "const A# = A% * A% + A%;\n",
            "fn main() -> f32 = A$;",
            2000,
        ),
        grown(
            "doubling parameters",
            "param p0: i32 = 1;",
            "param p#: i32 = p% + p%;\n",
            "fn main() -> i32 = p$;",
            60,
        ),
        grown(
            "doubling function parameters",
            "fn g0(x: i32) -> i32 = x; param p0: fn(i32) -> i32 = g0;",
            "param p#: fn(i32) -> i32 = |x| p%(x) + p%(x + 1);\n",
            "fn main(x: i32) -> i32 = p$(x);",
            60,
        ),
        grown(
            "doubling matches",
            "fn main(x: i32) -> i32 { let a0 = x;",
            "let a# = match a% { 1 => Some(2), _ => None }; let a# = match a# { Some(k) => k + a%, None => a% };\n",
            "a$ }",
            2000,
        ),
        grown(
            "doubling structs",
            "struct S0(a: i32);",
            "struct S#(a: S%, b: S%);\n",
            "fn main(x: S11) -> S11 = x with (a: x.b);",
            60,
        ),
        grown(
            "wide structs",
            "struct S0(a: i32);",
            "struct S#(a: S%, b: S%);\n",
            "fn g(x: S11, n: i32) -> S11 = if n < 1 { x } else { g(x with (a: x.b), n - 1) }; fn main(x: S11, n: i32) -> S11 = g(x, n);",
            11,
        ),
        grown(
            "doubling enums",
            "enum E0 { A0(i32), B0(f32) }",
            "enum E# { A#(E%, E%), B#(E%, E%) }\n",
            "fn main(x: E9) -> bool = x == x;",
            11,
        ),
        grown(
            "comparisons of enums",
            "enum E0 { A0(i32), B0(f32) }",
            "enum E# { A#(E%), B#(E%) }\n",
            "fn main(x: E$) -> bool = x == x;",
            40,
        ),
        grown(
            "comparisons of enums at other words",
            "enum E0 { A0(i32), B0(f32) }",
            "enum E# { A#(E%), B#(f32, E%) }\n",
            "fn main(x: E$) -> bool = x == x;",
            40,
        ),
        grown(
            "comparisons of known enums",
            "enum E0 { A0(i32), B0(f32) }",
            "enum E# { A#(E%), B#(f32, E%) } fn f#() -> E# = A#(f%());\n",
            "fn f0() -> E0 = A0(1); fn main() -> bool = f$() == f$();",
            40,
        ),
    ];
    let plain = [
        ("a large array", "fn main(n: i32) -> i32 { let a: [i32; 1000000000] = a; 1 }"),
        ("an array of arrays", "fn main(a: [[i32; 1000000000]; 1000000000]) -> i32 = 1;"),
        ("an array of 4096", "fn main(a: [i32; 4096], n: i32) -> [i32; 4096] = a;"),
        (
            "an array of 4096 in recursion",
            "fn g(a: [i32; 4000], n: i32) -> i32 = if n < 1 { a[n] } else { g(a, n - 1) + a[n] }; fn main(a: [i32; 4000]) -> i32 = g(a, 9);",
        ),
        ("an array of 4096 compared", "fn main(a: [i32; 4000]) -> bool = a == a;"),
        (
            "an array of 4096 of a loop",
            "fn main(a: [i32; 4000], n: i32) -> i32 = fold(0..n, a, |s, i| if s[i] > 3 { s } else { a })[n];",
        ),
        (
            "arrays read by many indices",
            "fn main(a: [i32; 4000], n: i32) -> i32 = fold(0..n, 1, |s, i| s + a[i] + a[i + 1] + a[s] + a[n] + a[n + 1] + a[n + 2]);",
        ),
        ("a huge constant loop", "const A = fold(0..2147483647, 1, |a, i| a * 3 + i); fn main() -> i32 = A;"),
        (
            "huge constant loops in loops",
            "const A = fold(0..2147483647, 1, |a, i| a + fold(0..2147483647, 1, |c, j| c * 3 + j)); fn main() -> i32 = A;",
        ),
        (
            "a constant of an endless recursion",
            "fn f(n: i32) -> i32 = f(n + 1); const A = f(1); fn main() -> i32 = A;",
        ),
        (
            "a constant array length of a loop",
            "const N = fold(0..2147483647, 1, |a, i| a); fn main(a: [i32; N]) -> i32 = 1;",
        ),
        (
            "an array length that is a long way off",
            "const A = 1 + 1; fn main(a: [i32; A * 1000000 * 1000000]) -> i32 = 1;",
        ),
        (
            "a function that yields itself",
            "fn f(n: i32) -> fn(i32) -> i32 = if n > 1 { f(n - 1) } else { f(n + 1) }; fn main(n: i32) -> i32 = f(n)(n);",
        ),
        (
            "a growing function value",
            "fn f(n: i32, g: fn(i32) -> i32) -> i32 = if n < 1 { g(n) } else { f(n - 1, |x| g(x) + n) }; fn main(n: i32) -> i32 = f(n, |x| x);",
        ),
        ("a fold over functions", "fn main(n: i32) -> i32 = fold(0..n, |x: i32| x, |f, i| |x| f(x) + i)(1);"),
        (
            "y combinator",
            "struct R(f: fn(R) -> i32); fn main(n: i32) -> i32 { let w = R(|r: R| r.f(r)); (w.f)(w) }",
        ),
        ("self application", "fn main(n: i32) -> i32 { let w = |x| x(x); w(w) }"),
        (
            "endless with",
            "struct P(a: i32, b: f32); fn main(n: i32) -> i32 = (P(1, 2.0) with (a: 1) with (a: 2) with (b: 1.0)).a;",
        ),
    ];
    all.extend(plain.map(|(name, program)| text(name, program)));
    let large: String = (0..9_000).map(|i| format!("let n = (n + {i}) * (n ^ {i}); ")).collect();
    all.push(text("entries of one large function", {
        let entries: String =
            (0..400).map(|i| format!("fn main{i}(n: i32) -> i32 = f(n + {i});\n")).collect();
        format!("fn f(n: i32) -> i32 {{ {large} n }}\n{entries} fn main(n: i32) -> i32 = main1(n);")
    }));
    all.push(text("bakes of one large function", {
        let bakes: String =
            (0..250).map(|i| format!("@bake fn b{i}(p: vec2) -> f32 = f32(f(i32(p.x) + {i}));\n")).collect();
        let sum: Vec<String> = (0..250).map(|i| format!("b{i}(p)")).collect();
        format!(
            "fn f(n: i32) -> i32 {{ {large} n }}\n{bakes} fn pixel(p: vec2) -> f32 = {};",
            sum.join(" + ")
        )
    }));
    all.push(grown(
        "functions in branches",
        "fn f0(n: i32) -> i32 = n;",
        "fn f#(n: i32) -> i32 = if n < # { f%(n + 1) } else { 0 };\n",
        "fn main(n: i32) -> i32 = f$(n);",
        10_000,
    ));
    all.push(grown(
        "functions in loops",
        "fn f0(n: i32) -> i32 = n;",
        "fn f#(n: i32) -> i32 = fold(0..n, 1, |a, i| a + f%(i));\n",
        "fn main(n: i32) -> i32 = f$(n);",
        10_000,
    ));
    for n in [5, 8, 12, 16, 24, 40] {
        let lambdas: String = (0..n).map(|i| format!("|a{i}| ")).collect();
        all.push(text(
            format!("currying of {n}"),
            format!("fn main(n: i32) -> i32 = ({lambdas} a0){};", "(n)".repeat(n)),
        ));
    }
    for n in [6, 12, 100, 1000] {
        let arms: String = (0..n).map(|i| format!("if n == {i} {{ |x: i32| x + {i} + n }} else ")).collect();
        all.push(text(
            format!("a choice of {n}"),
            format!(
                "fn main(n: i32) -> i32 {{ let f = {arms} {{ |x: i32| x }}; f(1) + f(2) + f(3) + f(f(4)) }}"
            ),
        ));
    }
    for n in [10, 20, 30] {
        let lets: String = (1..n).map(|i| format!("let f{i} = if n > {i} {{ |x: i32| f{0}(x) + f{0}(x + 1) }} else {{ |x: i32| f{0}(x) }}; ", i - 1)).collect();
        all.push(text(
            format!("choices in choices, {n}"),
            format!("fn main(n: i32) -> i32 {{ let f0 = |x: i32| x; {lets} f{}(1) }}", n - 1),
        ));
    }
    all
}

/// Large types.
pub fn types(bytes: usize) -> Vec<Text> {
    let fields = numbered("a#: f32, ", bytes);
    let variants = numbered("V#, ", bytes);
    let held = numbered("V#(f32, i32, vec3), ", bytes);
    let generics = numbered("A#, ", bytes);
    let items = "i32, ".repeat(bytes / 5);
    vec![
        text("a struct of many fields", format!("struct S({fields} z: i32); fn main(n: i32) -> i32 = 1;")),
        text(
            "a struct of many fields, taken",
            format!("struct S({fields} z: i32); fn main(s: S) -> i32 = s.z;"),
        ),
        text(
            "a struct of one field many times",
            format!("struct S({} z: i32); fn main(n: i32) -> i32 = 1;", "a: i32, ".repeat(bytes / 8)),
        ),
        text("an enum of many variants", format!("enum E {{ {variants} Z }} fn main(e: E) -> E = e;")),
        text(
            "an enum of one variant many times",
            format!("enum E {{ {} Z }} fn main(e: E) -> E = e;", "V, ".repeat(bytes / 3)),
        ),
        text("an enum that holds much", format!("enum E {{ {held} Z }} fn main(e: E) -> bool = e == e;")),
        text(
            "an enum that holds much, passed on",
            format!(
                "enum E {{ {held} Z }} fn g(e: E, n: i32) -> E = if n < 1 {{ e }} else {{ g(e, n - 1) }}; fn main(e: E) -> E = g(e, 2);"
            ),
        ),
        text(
            "many type parameters",
            format!("fn f<{generics} Z>(z: Z) -> Z = z; fn main(n: i32) -> i32 = f(n);"),
        ),
        text(
            "a struct of many type parameters",
            format!("struct S<{generics} Z>(z: Z); fn main(n: i32) -> i32 = S(n).z;"),
        ),
        text("a long tuple type", format!("fn main(a: ({items} f32)) -> i32 = 1;")),
        text(
            "a long function type",
            format!("fn f(g: fn({items} f32) -> i32) -> i32 = 1; fn main(n: i32) -> i32 = n;"),
        ),
        text("many type arguments", format!("fn main(a: Option<{items} f32>) -> i32 = 1;")),
        text(
            "many tuples of types",
            numbered(
                "fn f#(a: (i32, (f32, [vec3; 9])), g: fn(Option<(i32, vec2)>) -> (i32, i32)) -> i32 = 1;\n",
                bytes,
            ),
        ),
        text("many large arrays", numbered("fn f#(a: [f32; 4000]) -> [f32; 4000] = a;\n", bytes)),
        text(
            "many large arrays reached",
            numbered("fn f#(a: [f32; 4000]) -> f32 = a[1];\n", bytes / 2)
                + &numbered("fn main#(a: [f32; 4000]) -> f32 = f#(a);\n", bytes / 2),
        ),
        text(
            "a long array literal of arrays",
            format!("fn main(n: i32) -> i32 = [{} [1, 2]][n][n];", "[n, 2], ".repeat(bytes / 8)),
        ),
        text(
            "many structs of 4000 words",
            numbered("struct S#(a: [f32; 4000]);\nfn f#(s: S#) -> S# = s with (a: s.a);\n", bytes),
        ),
        text(
            "many comparisons of 400 words",
            format!(
                "fn main(a: [f32; 400], n: i32) -> i32 {{ {} n }}",
                numbered("let n = if a == a { n + 1 } else { n }; ", bytes)
            ),
        ),
        text(
            "many live words",
            format!(
                "@task fn t(n: i32) -> i32 = n; fn main(a: [f32; 400], n: i32) -> f32 {{ {} a[n] }}",
                numbered("let n = t(n) + #; ", bytes)
            ),
        ),
        text(
            "many copies of 4000 words",
            format!(
                "struct S(a: [f32; 4000], n: i32); fn main(s: S, n: i32) -> i32 {{ {} s.n }}",
                numbered("let s = s with (n: s.n + n); ", bytes)
            ),
        ),
        text(
            "many choices of 400 words",
            format!(
                "fn main(a: [f32; 400], c: [f32; 400], n: i32) -> f32 {{ {} a[n] }}",
                numbered("let a = if n == # { a } else { c }; ", bytes)
            ),
        ),
        text(
            "some thousand choices of 400 words",
            format!(
                "fn main(a: [f32; 400], c: [f32; 400], n: i32) -> f32 {{ {} a[n] }}",
                numbered("let a = if n == # { a } else { c }; ", bytes / 5)
            ),
        ),
        text(
            "many updates of an option of 400 words",
            format!(
                "fn main(a: [f32; 400], n: i32) -> f32 {{ let o = Some(a); {} match o {{ Some(a) => a[n], None => 1.0 }} }}",
                numbered("let o = if n == # { o } else { None }; ", bytes)
            ),
        ),
    ]
}

/// Matches of many arms and columns.
pub fn matches(bytes: usize) -> Vec<Text> {
    let mut all = vec![
        text(
            "arms of numbers",
            format!("fn main(n: i32) -> i32 = match n {{ {} _ => 0 }};", numbered("# => %, ", bytes)),
        ),
        text(
            "arms of numbers, not all",
            format!("fn main(n: i32) -> i32 = match n {{ {} }};", numbered("# => %, ", bytes)),
        ),
        text(
            "arms of floats",
            format!("fn main(x: f32) -> i32 = match x {{ {} _ => 0 }};", numbered("#.5 => %, ", bytes)),
        ),
        text(
            "arms of tasks",
            format!(
                "@task fn t(n: i32) -> i32 = n; fn main(n: i32) -> i32 = match n {{ {} _ => 0 }};",
                numbered("# => t(%), ", bytes)
            ),
        ),
        text(
            "arms with guards",
            format!(
                "fn main(n: i32) -> i32 = match n {{ {} _ => 0 }};",
                numbered("k if k > # => k, ", bytes)
            ),
        ),
        text(
            "one arm many times",
            format!("fn main(n: i32) -> i32 = match n {{ {} _ => 0 }};", "5 => 1, ".repeat(bytes / 8)),
        ),
        text(
            "wild arms",
            format!("fn main(n: i32) -> i32 = match n {{ {} _ => 0 }};", "_ => 1, ".repeat(bytes / 8)),
        ),
        text(
            "alternatives",
            format!("fn main(n: i32) -> i32 = match n {{ {} 0 => 1, _ => 0 }};", numbered("# | ", bytes)),
        ),
        text(
            "alternatives of pairs",
            format!(
                "fn main(n: i32) -> i32 = match (n, n) {{ {} (0, 0) => 1, _ => 0 }};",
                numbered("(#, %) | ", bytes)
            ),
        ),
        text(
            "alternatives that bind",
            format!(
                "fn main(n: i32) -> i32 = match (n, n) {{ {} (k, 0) => k, _ => 0 }};",
                numbered("(k, #) | ", bytes)
            ),
        ),
        text(
            "alternatives in alternatives",
            format!(
                "fn main(n: i32) -> i32 = match (n, n, n, n) {{ {} _ => 0 }};",
                numbered("(1 | 2 | #, 3 | 4 | #, 5 | 6 | #, 7 | 8) => #, ", bytes)
            ),
        ),
        text(
            "arms of pairs",
            format!(
                "fn main(n: i32) -> i32 = match (n, n) {{ {} _ => 0 }};",
                numbered("(#, %) => #, ", bytes)
            ),
        ),
        text(
            "arms of half pairs",
            format!(
                "fn main(n: i32) -> i32 = match (n, n) {{ {} _ => 0 }};",
                numbered("(#, _) => #, (_, #) => %, ", bytes)
            ),
        ),
        text(
            "arms of half pairs, not all",
            format!(
                "fn main(n: i32) -> i32 = match (n, n) {{ {} }};",
                numbered("(#, _) => #, (_, #) => %, ", bytes)
            ),
        ),
        text(
            "variants",
            format!(
                "enum E {{ {} }} fn main(e: E) -> i32 = match e {{ {} }};",
                numbered("V#, ", bytes / 3),
                numbered("V# => %, ", bytes / 2)
            ),
        ),
        text(
            "variants that hold",
            format!(
                "enum E {{ {} }} fn main(e: E) -> i32 = match e {{ {} _ => 0 }};",
                numbered("V#(i32, f32), ", bytes / 2),
                numbered("V#(a, _) => a + %, ", bytes / 2)
            ),
        ),
        text(
            "pairs of variants",
            format!(
                "enum E {{ {} Z }} fn main(e: E) -> i32 = match (e, e) {{ {} _ => 0 }};",
                numbered("V#(i32, f32), ", bytes / 3),
                numbered("(V#(a, _), Z) => a + %, (Z, V#(1, _)) => 1, ", bytes / 2)
            ),
        ),
        text(
            "many matches",
            format!(
                "fn main(n: i32) -> i32 {{ {} n }}",
                numbered(
                    "let n = match (n, #) { (1, 2) => 3, (4, k) => k, (k, 5) => k, (a, c) => a + c }; ",
                    bytes
                )
            ),
        ),
        text(
            "matches on structs",
            format!(
                "struct P(a: i32, b: i32); fn main(n: i32) -> i32 {{ let p = P(n, n); {} n }}",
                numbered("let n = match p { P(a: 1, ..) => n, P(b: k, a: #) => k, P(..) => 2 }; ", bytes)
            ),
        ),
        text(
            "a pattern of many fields",
            format!(
                "fn main(n: i32) -> i32 = match ({}n) {{ ({}k) => k }};",
                "n, ".repeat(bytes / 6),
                "_, ".repeat(bytes / 6)
            ),
        ),
        text(
            "tests of many fields",
            format!(
                "fn main(n: i32) -> i32 = match ({}n) {{ ({}k) => k, _ => 1 }};",
                "n, ".repeat(1000),
                "1, ".repeat(1000)
            ),
        ),
        text(
            "names bound many times",
            format!(
                "fn main(n: i32) -> i32 = match ({}n) {{ ({}k) => k, _ => 1 }};",
                "n, ".repeat(bytes / 6),
                "k, ".repeat(bytes / 6)
            ),
        ),
    ];
    for n in [8usize, 12, 16, 24, 64] {
        let columns = vec!["b"; n].join(", ");
        let diagonal = |on: &str| -> String {
            let row = |k: usize| {
                let cells: Vec<&str> = (0..n).map(|i| if i == k { on } else { "_" }).collect();
                format!("({}) => {k}, ", cells.join(", "))
            };
            (0..n).map(row).collect()
        };
        let crossed: String = (0..n)
            .map(|k| {
                let cells: Vec<&str> = (0..n)
                    .map(|i| {
                        if i == k {
                            "true"
                        } else if i == (k * 7 + 3) % n {
                            "false"
                        } else {
                            "_"
                        }
                    })
                    .collect();
                format!("({}) => {k}, ", cells.join(", "))
            })
            .collect();
        all.push(text(
            format!("{n} columns, diagonal"),
            format!("fn main(b: bool) -> i32 = match ({columns}) {{ {} _ => 0 }};", diagonal("true")),
        ));
        all.push(text(
            format!("{n} columns, diagonal, not all"),
            format!("fn main(b: bool) -> i32 = match ({columns}) {{ {} }};", diagonal("true")),
        ));
        all.push(text(
            format!("{n} columns, crossed"),
            format!("fn main(b: bool) -> i32 = match ({columns}) {{ {crossed} _ => 0 }};"),
        ));
        all.push(text(
            format!("{n} columns, crossed, not all"),
            format!("fn main(b: bool) -> i32 = match ({columns}) {{ {crossed} }};"),
        ));
        let either = vec!["true | false"; n].join(", ");
        all.push(text(
            format!("{n} columns of alternatives"),
            format!("fn main(b: bool) -> i32 = match ({columns}) {{ ({either}) => 1, _ => 0 }};"),
        ));
        let options = vec!["o"; n].join(", ");
        let somes: String = (0..n)
            .map(|k| {
                let cells: Vec<&str> = (0..n)
                    .map(|i| {
                        if i == k {
                            "Some(1)"
                        } else if i < k {
                            "Some(_)"
                        } else {
                            "_"
                        }
                    })
                    .collect();
                format!("({}) => {k}, ", cells.join(", "))
            })
            .collect();
        all.push(text(
            format!("{n} columns of options"),
            format!("fn main(o: Option<i32>) -> i32 = match ({options}) {{ {somes} }};"),
        ));
    }
    all
}

/// Thousands of errors of every kind.
pub fn errors(bytes: usize) -> Vec<Text> {
    let pieces = [
        "fn f#() -> i32 = x#;\n",
        "fn f#(a: i32) -> i32 = g#(a);\n",
        "fn f#(a: T#) -> i32 = 1;\n",
        "type T# = U#;\n",
        "use m#;\n",
        "use \"m#.ghyll\";\n",
        "const a# = b#;\n",
        "const a = #;\n",
        "fn f#(a: vec3) -> f32 = a.q#;\n",
        "struct S#(a: i32); fn f#(s: S#) -> i32 = s.b;\n",
        "struct S#(a: i32); fn f#() -> S# = S#(b: 1);\n",
        "struct S#(a: i32, a: i32);\n",
        "struct S#();\n",
        "enum E# {}\n",
        "fn f#(a: i32) -> f32 = a;\n",
        "fn f#(a: i32) -> i32 = a + 1.0;\n",
        "fn f#(a: i32) -> i32 = a + true;\n",
        "fn f#(a: i32) -> i32 = f#(a, a);\n",
        "fn f#(a: i32) -> i32 = a(1);\n",
        "fn f#(a: i32) -> i32 = a[1];\n",
        "fn f#(a: i32) -> i32 = a.foo();\n",
        "fn f#(a: i32) -> i32 = 99999999999;\n",
        "fn f#(a: u32) -> u32 = -1;\n",
        "fn f#(a: i32) -> i32 = sin(a);\n",
        "fn f#(a: i32) -> i32 = clamp(a, 1);\n",
        "fn f#(a: i32) -> i32 = { let x = |y| y; 1 };\n",
        "fn f#(a: i32) -> i32 = { let x = None; 1 };\n",
        "fn f#(a: i32) -> bool = abs == abs;\n",
        "fn f#(a: i32) -> i32 = { let x = |y| y(y); 1 };\n",
        "fn f#(a: [i32; 0]) -> i32 = 1;\n",
        "fn f#(a: [i32; 99999]) -> i32 = 1;\n",
        "fn f#(a: [i32; -1]) -> i32 = 1;\n",
        "fn f#(a: Option) -> i32 = 1;\n",
        "fn f#(a: Option<i32, i32>) -> i32 = 1;\n",
        "fn f#(a: i32) -> i32 = sum;\n",
        "fn f#(a: i32) -> i32 = a with (x: 1);\n",
        "fn f#(a: i32) -> i32 = match a { 1 => 2 };\n",
        "fn f#(a: i32) -> i32 = match a { V# => 2, Some(1) => 3 };\n",
        "fn f#(a: Option<i32>) -> i32 = match a { Some(1, 2) => 2 };\n",
        "fn f#(a: Option<i32>) -> i32 { let Some(b) = a; b }\n",
        "fn f#(a: i32) -> i32 = match (a, a) { (x, 1) | (1, y) => 2, _ => 1 };\n",
        "fn f#(a: i32) -> i32 = match a { _ => 1, 2 => 2, 3 => 3 };\n",
        "struct S#(a: S#);\n",
        "type T# = T#;\n",
        "const a# = a#;\n",
        "fn f#<A>(x: A) -> i32 = f#((x, x));\n",
        "param p#: i32 = 1; const c# = p#;\n",
        "param p#: i32 = 9 in 0..5;\n",
        "param p#: bool = true in 0..5;\n",
        "@bake fn f#(a: i32) -> i32 = 1;\n",
        "raster r#: i32;\n",
        "@inline fn f#(a: i32) -> i32 = f#(a);\n",
        "@inline @task fn f#(a: i32) -> i32 = a;\n",
        "@foo fn f#(a: i32) -> i32 = a;\n",
        "fn f#(a, b) = a;\n",
        "fn f#(a: i32) -> i32 = if a { 1 };\n",
        "fn f#(a: i32) -> i32 = 1 < 2 < 3;\n",
        "fn f#(a: i32) -> i32 { a; }\n",
        "fn f#(a: i32) -> i32 = (1,);\n",
        "fn f#(a: i32) -> i32 = _;\n",
        "fn f#(a: i32) -> i32 = 0..1;\n",
        "fn f#(a: i32) -> i32 = \"text\";\n",
        "fn f#(a: i32) -> i32 = a as i32;\n",
        "fn f#(a: i32) -> i32 = a::b;\n",
        "fn f#(a: i32) -> i32 = &a;\n",
        "fn f#(a: i32) -> i32 { a = 1; a }\n",
        "fn f#(a: i32) -> i32 { fn g() -> i32 = 1; g() }\n",
        "fn f#(a: i32) -> i32 { for (;;) {} a }\n",
        "int f#(int a) { return a; }\n",
        "float a# = 1.0;\n",
        "struct S# { a: i32 }\n",
        "fn f#(a: i32) -> i32 = deriv(|x| i32(x))(a);\n",
        "fn f#(a: i32) -> i32 = 1 \n",
        "fn f#(a: i32 -> i32 = 1;\n",
        "fn f#(a: i32) -> i32 = (1;\n",
        "fn f#(a: i32) -> i32 = 1);\n",
        "fn f#(a: i32) -> i32 = 1 # 2;\n",
        "fn f#(a: i32) -> i32 = 0x;\n",
        "fn f#(a: i32) -> i32 = 1e;\n",
        "let a# = 1;\n",
        "fn f#(a: i32) -> i32 = x + y + z + w + v + u + t + s + r + q;\n",
        "fn (a: i32) -> i32 = 1;\n",
        "fn main(a: i32) -> i32 = 1;\n",
        "fn f#(unused: i32) -> i32 { let x = 1; let y = 2; 3 }\n",
    ];
    pieces
        .into_iter()
        .map(|piece| text(format!("many of `{}`", piece.trim_end()), numbered(piece, bytes)))
        .chain(["|x| ", "if ", "1 + |x| "].map(|piece| {
            let open = "match 1 { _ => ".repeat(60) + &piece.repeat(bytes / piece.len() / 2);
            let errors = "x +* ; let } fn (".repeat(bytes / 64);
            text(format!("errors behind many of `{piece}`"), main_of(&(open + &errors)))
        }))
        .collect()
}
