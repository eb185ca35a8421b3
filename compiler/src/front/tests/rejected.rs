//! Programs with mistakes: the code of each, and the text it points at.

use super::*;
use crate::codes::*;

/// Notes a program whose diagnostics are not the one expected.
fn expect(text: &str, code: Code, at: &str, wrong: &mut Vec<String>) {
    let found = found(text);
    if found != [(code, at.to_owned())] {
        wrong.push(format!("{text}\n  expected {code} at {at}, found {found:?}"));
    }
}

#[test]
fn expressions() {
    let mut wrong = Vec::new();
    for (ty, body, code, at) in [
        ("i32", "x", MISMATCH, "x"),
        ("f32", "n + x", OPERATOR, "n + x"),
        ("f32", "x + v", MISMATCH, "x + v"),
        ("vec3", "v + w", OPERATOR, "v + w"),
        ("vec3", "n * v", OPERATOR, "n * v"),
        ("mat3", "m + 1", OPERATOR, "m + 1"),
        ("mat3", "m / 2", OPERATOR, "m / 2"),
        ("vec2", "m * w", OPERATOR, "m * w"),
        ("bool", "b + b", OPERATOR, "b + b"),
        ("bool", "b < b", OPERATOR, "b < b"),
        ("bool", "v < v", OPERATOR, "v < v"),
        ("bool", "n == x", OPERATOR, "n == x"),
        ("bool", "n && b", MISMATCH, "n"),
        ("i32", "x & 1", OPERATOR, "x & 1"),
        ("f32", "x << 1", OPERATOR, "x << 1"),
        ("u32", "-u", OPERATOR, "-u"),
        ("bool", "!x", OPERATOR, "!x"),
        ("bool", "sin == cos", UNKNOWN_TYPE_HERE, "sin"),
        ("bool", "(|a: f32| a) == (|a: f32| a)", EQUALITY, "(|a: f32| a) == (|a: f32| a)"),
        ("i32", "2147483648", LITERAL_RANGE, "2147483648"),
        ("i32", "-2147483649", LITERAL_RANGE, "-2147483649"),
        ("u32", "u + 4294967296", LITERAL_RANGE, "4294967296"),
        ("u32", "4294967296u", LITERAL_RANGE, "4294967296u"),
        ("u32", "-1", LITERAL_RANGE, "-1"),
        ("u32", "u32(-1)", LITERAL_RANGE, "-1"),
        ("i32", "unknown", UNKNOWN_NAME, "unknown"),
        ("f32", "sinn(x)", UNKNOWN_NAME, "sinn"),
        ("f32", "bilinear(w)", NEEDS_MODULE, "bilinear"),
        ("f32", "fbm(w, 5)", NEEDS_MODULE, "fbm"),
        ("f32", "__pixel_width().x", UNKNOWN_NAME, "__pixel_width"),
        ("f32", "v.w", UNKNOWN_FIELD, "w"),
        ("f32", "v.xg", UNKNOWN_FIELD, "xg"),
        ("f32", "x.y", UNKNOWN_FIELD, "y"),
        ("f32", "(1, x).2", UNKNOWN_FIELD, "2"),
        ("f32", "x[0]", BAD_INDEX, "x[0]"),
        ("f32", "v[x]", MISMATCH, "x"),
        ("f32", "x(1)", NOT_A_FUNCTION, "x"),
        ("f32", "sin(x, x)", ARGUMENTS, "x"),
        ("f32", "max(x)", ARGUMENTS, "max(x)"),
        ("f32", "sin(n)", BUILTIN, "n"),
        ("f32", "sqrt(b)", BUILTIN, "b"),
        ("vec3", "max(v, 0.0)", BUILTIN, "0.0"),
        ("f32", "max(x, n)", BUILTIN, "n"),
        ("f32", "dot(x, x)", BUILTIN, "x"),
        ("vec3", "vec3(1, 2)", ARGUMENTS, "vec3(1, 2)"),
        ("vec3", "vec3(v, 1)", ARGUMENTS, "vec3(v, 1)"),
        ("vec2", "vec2(n, 1)", MISMATCH, "n"),
        ("mat2", "mat2(1, 2, 3)", ARGUMENTS, "mat2(1, 2, 3)"),
        ("f32", "f32(v)", BUILTIN, "v"),
        ("f32", "max(a: x, x)", NAMED_ARGUMENT, "a"),
        ("i32", "if n { 1 } else { 2 }", MISMATCH, "n"),
        ("i32", "if b { 1 } else { 2.5 }", MISMATCH, "2.5"),
        ("i32", "{ let y = if b { 1.5 } else { n }; 1 }", MISMATCH, "n"),
        ("[f32; 2]", "[1, 2, 3]", MISMATCH, "[1, 2, 3]"),
        ("[f32; 2]", "[1, true]", MISMATCH, "true"),
        ("i32", "{ let y: f32 = n; 1 }", MISMATCH, "n"),
        ("i32", "_", MISPLACED_HOLE, "_"),
        ("f32", "sum(n, |i| 1.0)", MISPLACED_RANGE, "n"),
        ("f32", "max(0..n, 1)", MISPLACED_RANGE, "0..n"),
        ("f32", "sum(0..x, |i| 1.0)", MISMATCH, "x"),
        ("bool", "sum(0..n, |i| true)", OPERATOR, "|i| true"),
        ("f32", "fold(0..n, 0.0)", ARGUMENTS, "fold(0..n, 0.0)"),
        ("f32", "fold(0..n, 0.0, |a| a)", ARGUMENTS, "|a| a"),
        ("f32", "fold(0..n, 0.0, |a, i| n)", MISMATCH, "n"),
        ("f32", "fold", FORM_AS_VALUE, "fold"),
        ("i32", "{ let f = |a| a.x; 1 }", UNKNOWN_TYPE_HERE, "a"),
        ("i32", "{ let f = |a| a; 1 }", UNKNOWN_TYPE_HERE, "a"),
        ("i32", "{ let o = None; 1 }", UNKNOWN_TYPE_HERE, "None"),
        ("i32", "{ let f = |g| g(g); 1 }", INFINITE_TYPE, "g"),
        ("i32", "{ let (a, a) = (1, 2); a }", DUPLICATE, "a"),
        ("i32", "(|a: i32, a: i32| a)(1, 2)", DUPLICATE, "a"),
        ("i32", "{ let (a, c, d) = (1, 2); a }", MISMATCH, "(a, c, d)"),
        ("i32", "{ let Some(a) = Some(1); a }", REFUTABLE, "Some(a)"),
        ("i32", "{ let 1 = n; 2 }", REFUTABLE, "1"),
        ("i32", "(|(1, a)| a)((1, 2))", REFUTABLE, "(1, a)"),
        ("i32", "match Some(n) { None => 1 }", MISSING_CASE, "match Some(n)"),
        ("i32", "match n { 1 => 1 }", MISSING_CASE, "match n"),
        ("i32", "match b { true => 1, false if n > 1 => 2 }", MISSING_CASE, "match b"),
        ("i32", "match n { 1.5 => 1, _ => 2 }", MISMATCH, "1.5"),
        ("i32", "match Some(n) { Some => 1, _ => 2 }", PATTERN_FIELDS, "Some"),
        ("i32", "match Some(n) { Some(a, c) => 1, _ => 2 }", PATTERN_FIELDS, "Some(a, c)"),
        ("i32", "match Some(n) { Sum(a) => 1, _ => 2 }", NOT_A_CONSTRUCTOR, "Sum"),
        ("i32", "match (n, n) { (a, 1) | (1, c) => 1, _ => 2 }", OR_PATTERN, "(1, c)"),
        ("Option<i32>", "n", MISMATCH, "n"),
        ("vec3", "v with (x: 1)", NOT_A_STRUCT, "x"),
    ] {
        expect(&of_type(ty, body), code, at, &mut wrong);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn items() {
    let mut wrong = Vec::new();
    for (text, code, at) in [
        ("fn f() -> i32 = 1; fn f() -> i32 = 2;", DUPLICATE, "f"),
        ("fn f(a: i32, a: i32) -> i32 = 1;", DUPLICATE, "a"),
        ("fn f<A, A>(a: A) -> i32 = 1;", DUPLICATE, "A"),
        ("struct S(a: f32, a: f32);", DUPLICATE, "a"),
        ("enum A { X } enum B { X }", DUPLICATE, "X"),
        ("fn f(a: Foo) -> i32 = 1;", UNKNOWN_TYPE, "Foo"),
        ("fn f(a: Hit) -> i32 = 1;", UNKNOWN_TYPE, "Hit"),
        ("fn f(a: Option) -> i32 = 1;", GENERIC_ARGUMENTS, "Option"),
        ("fn f(a: vec3<f32>) -> i32 = 1;", GENERIC_ARGUMENTS, "vec3<f32>"),
        ("use terrian;", UNKNOWN_MODULE, "terrian"),
        ("use \"a.ghyll\";", UNREADABLE_MODULE, "\"a.ghyll\""),
        ("struct A(x: A);", RECURSIVE_TYPE, "A"),
        ("struct A(x: Option<(f32, [B; 2])>); enum B { X(A), Y }", RECURSIVE_TYPE, "A"),
        ("enum List { Cons(f32, List), Nil }", RECURSIVE_TYPE, "List"),
        ("type A = (B, B); type B = A;", CYCLIC_ALIAS, "A"),
        ("const A = B; const B = A;", CYCLIC_CONSTANT, "A"),
        ("const A: i32 = f(); fn f() -> i32 = A;", CYCLIC_CONSTANT, "A"),
        ("param a: i32 = b; param b: i32 = 1; const C = f(); fn f() -> i32 = a;", CONSTANT_PARAM, "f"),
        ("param p: f32 = 20 in -1.0..10;", PARAM_RANGE, "20"),
        ("param p: f32 = 2 in 3..1;", PARAM_RANGE, "3..1"),
        (
            "fn same<A>(a: A, b: A) -> bool = a == b; fn both<A>(a: A) -> bool = same((a, 1), (a, 1));
            fn f() -> bool = both(1); fn g() -> bool = both(f);",
            EQUALITY,
            "both",
        ),
        ("@inline fn f(n: i32) -> i32 = g(n); fn g(n: i32) -> i32 = f(n);", INLINE_RECURSION, "f"),
        ("fn same<A>(x: A, y: A) -> A = x; fn f() -> i32 = same(1u, 2.5);", MISMATCH, "2.5"),
        ("fn f(x: i32) -> i32 = x $ 1;", BAD_CHARACTER, "$"),
        ("fn f(x: i32) -> i32 { x", UNCLOSED, "{"),
        ("param p: vec2 = vec2(1) in 0..1;", PARAM_RANGE, "0..1"),
        ("@bake fn f(p: vec3) -> f32 = 1;", BAKED_SHAPE, "f"),
        ("@bake fn f(p: vec2) -> i32 = 1;", BAKED_SHAPE, "f"),
        ("raster r: i32;", RASTER_TYPE, "i32"),
        ("struct S();", EMPTY_ITEM, "S"),
        ("enum E {}", EMPTY_ITEM, "E"),
        (
            "fn f<A>(a: A, n: i32) -> i32 = if n == 0 { 0 } else { f((a, a), n - 1) };",
            POLYMORPHIC_RECURSION,
            "f",
        ),
        ("fn f<A>(a: A) -> A = 1;", MISMATCH, "1"),
        ("fn f<A>(a: A) -> A = a + a;", OPERATOR, "a + a"),
        ("fn f(a: [f32; 0]) -> i32 = 1;", ARRAY_LENGTH, "0"),
        ("fn f(a: [f32; 1.5]) -> i32 = 1;", ARRAY_LENGTH, "1.5"),
        ("fn f(a: [f32; n]) -> i32 = 1;", ARRAY_LENGTH, "n"),
        ("fn f(a: [f32; 5000]) -> i32 = 1;", TOO_LARGE, "[f32; 5000]"),
        ("struct S(a: f32, b: f32); fn f() -> S = S(a: 1);", MISSING_FIELD, "S(a: 1)"),
        ("struct S(a: f32, b: f32); fn f() -> S = S(a: 1, b: 2, a: 3);", DUPLICATE_FIELD, "a"),
        ("struct S(a: f32, b: f32); fn f() -> S = S(a: 1, c: 2, b: 1);", UNKNOWN_FIELD, "c"),
        ("struct S(a: f32, b: f32); fn f() -> S = S(a: 1, 2);", NAMED_ARGUMENT, "2"),
        ("struct S(a: f32, b: f32); fn f() -> S = S(1);", ARGUMENTS, "S(1)"),
        ("struct S(a: f32); fn f(s: S) -> S = s with (b: 1);", UNKNOWN_FIELD, "b"),
        ("struct S(a: f32); fn f(s: S) -> S = s with (a: 1, a: 2);", DUPLICATE_FIELD, "a"),
        ("struct S(a: f32); fn f(s: S) -> S = s with (a: true);", MISMATCH, "true"),
        (
            "struct S(a: f32, b: f32); fn f(s: S) -> f32 = match s { S(a: x) => x };",
            PATTERN_FIELDS,
            "S(a: x)",
        ),
        ("fn g() -> i32 = 1; fn f() -> i32 = g + 1;", OPERATOR, "g + 1"),
        ("fn g(a: f32) -> i32 = 1; fn f() -> i32 = g(true);", MISMATCH, "true"),
        (
            "fn g<A>() -> Option<A> = None; fn f() -> i32 { let x = match g() { Some(_) => 1, None => 2 }; x }",
            UNKNOWN_TYPE_HERE,
            "g",
        ),
        ("const A = 1; fn f() -> i32 = A(2);", NOT_A_FUNCTION, "A"),
        ("use terrain; fn f(r: Ray) -> f32 = trace(bilinear, r);", MISMATCH, "trace(bilinear, r)"),
        ("fn f(x: i32) -> i32 = match x { 1 => 1, _ => 2, 3 => 4 };", UNREACHABLE_ARM, "3"),
    ] {
        expect(text, code, at, &mut wrong);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The case that a message names.
fn missing(items: &str, params: &str, body: &str) -> String {
    let text = format!("{items} fn f({params}) -> i32 = {body};");
    let report = check(&text).err().unwrap_or_else(|| panic!("{text} is accepted"));
    let titles: Vec<&str> = report.diagnostics.iter().map(|d| d.title.as_str()).collect();
    let [title] = titles[..] else { panic!("{titles:?}") };
    title.strip_prefix("the case `").and_then(|t| t.strip_suffix("` is missing")).unwrap_or(title).to_owned()
}

#[test]
fn missing_cases_are_named() {
    let option = |body| missing("", "o: Option<bool>, b: bool, n: i32", body);
    assert_eq!(option("match o { None => 1 }"), "Some(_)");
    assert_eq!(option("match o { Some(true) => 1, None => 2 }"), "Some(false)");
    assert_eq!(option("match (b, o) { (false, _) => 1, (true, Some(_)) => 2 }"), "(true, None)");
    assert_eq!(option("match (b, n) { (true, _) => 1, (false, 3) => 2 }"), "(false, 0)");
    assert_eq!(option("match n { 1 => 1, 2 => 2 }"), "0");
    assert_eq!(option("match o { Some(x) if x => 1, None => 2 }"), "Some(_)");
    assert_eq!(option("match o { }"), "_");
    let shapes = "enum E { A, B(i32, bool), C } struct S(e: E, b: bool);";
    let shape = |body| missing(shapes, "e: E, s: S", body);
    assert_eq!(shape("match e { A | C => 1 }"), "B(_, _)");
    assert_eq!(shape("match s { S(B(1, _), _) => 1, S(A | C, true) => 2, S(B(..), _) => 3 }"), "S(A, false)");
    assert_eq!(shape("match e { A => 1, C => 2, B(_, true) => 3 }"), "B(_, false)");
}

#[test]
fn errors_of_all_functions_come_together() {
    let text = "fn a() -> i32 = x; fn b() -> f32 = 1 + true; const C = y; fn d(p: Foo) -> i32 = a(p);
        fn e() -> i32 = bad(1) + bad(2) * bad(|x| x.y).z;";
    let codes: Vec<_> = found(text).into_iter().map(|(code, _)| code).collect();
    assert_eq!(
        codes,
        [
            UNKNOWN_NAME,
            OPERATOR,
            UNKNOWN_NAME,
            UNKNOWN_TYPE,
            ARGUMENTS,
            UNKNOWN_NAME,
            UNKNOWN_NAME,
            UNKNOWN_NAME
        ]
    );
}

#[test]
fn help_says_what_to_do() {
    for (ty, body, help) in [
        ("f32", "n", "f32(..)"),
        ("f32", "x + n", "f32(..)"),
        ("vec3", "max(v, 0.0)", "vec3(..)"),
        ("Option<i32>", "n", "Some(..)"),
        ("f32", "sinn(x)", "`sin`"),
        ("f32", "bilinear(w)", "use terrain;"),
        ("i32", "2147483648", "2147483648u"),
        ("bool", "b + b", "&&"),
    ] {
        let text = of_type(ty, body);
        let report = check(&text).err().unwrap_or_else(|| panic!("{text} is accepted"));
        let given = report.diagnostics[0].help.clone().unwrap_or_default();
        assert!(given.contains(help), "{body}: {given}");
    }
}

#[test]
fn the_other_side_is_shown() {
    let text = "fn g(a: f32) -> i32 = 1; fn f(n: i32) -> i32 = g(n);";
    let report = check(text).expect_err("n is no f32");
    let (span, _) = &report.diagnostics[0].secondary[0];
    assert_eq!(&text[span.start as usize..span.end as usize], "f32");
}

#[test]
fn habits_are_answered() {
    for (text, help) in [
        ("fn f(x: f32) -> f32 = 2 x;", "2.0 * x"),
        ("fn f(x: f32): f32 = x;", "->"),
        ("fn f(x f32) -> f32 = x;", "`x: f32`"),
        ("fn f(x: f32) -> f32 = Sin(x);", "`sin`"),
        ("fn f(x: f32) -> f32 = [x; 3][0];", "[a, a, a]"),
        ("fn f(x: i32) -> i32 = match x { 1: 2, _ => 3 };", "pattern => value"),
        ("fn f(x: i32) -> i32 = match x { 1..3 => 2, _ => 3 };", "guard"),
        ("fn f(x: i32) -> i32 = match x { x > 3 => 2, _ => 3 };", "behind the pattern"),
        ("enum E { A; B }", "commas"),
        ("param x = 1;", "state the type"),
        ("param x: f32 = 1.0 in 0.0, 2.0;", "lo..hi"),
        ("fn f(x: Option<f32>) -> f32 = x;", "None => .."),
        ("fn f(a: [f32; 3]) -> f32 = a.0;", "a[i]"),
        ("fn f<T>(x: T) -> T = x + x;", "pass a function"),
        ("fn f(m: mat3, v: vec2) -> vec2 = m * v;", "vec3"),
        ("fn f(x: f32) -> f32 = null;", "Option"),
        ("fn f(x: string) -> f32 = 1.0;", "no texts"),
        ("const A = 1.0f;", "suffix"),
        ("#define A 1", "const"),
        ("fn f(x: f32) -> f32 = x.sin();", "sin(value"),
        ("fn f(x: f32) -> f32 = x.lerp(1.0);", "mix"),
    ] {
        let report = check(text).err().unwrap_or_else(|| panic!("{text} is accepted"));
        let given = report.diagnostics[0].help.clone().unwrap_or_default();
        assert!(given.contains(help), "{text}: {given}");
    }
}

#[test]
fn help_and_labels_name_what_was_meant() {
    for (text, part) in [
        ("fn main(o: Option<i32>) -> i32 = if let Some(x) = o { x } else { 0 };", "match"),
        ("fn main(n: i32) -> i32 = let x = n + 1 in x * 2;", "{ let x = ..; value }"),
        ("static X: i32 = 3;\nfn main() -> i32 = X;", "const"),
        ("fn main(n: i32) -> i32 = x where x = n + 1;", "{ let x = ..; value }"),
        ("struct P(x: i32);\nfn main() -> i32 = (P(x = 1)).x;", "`x: ..`"),
        ("fn id<T>(x: T) -> T = x;\nfn main() -> i32 = id<i32>(3);", "inferred"),
        (
            "struct P(x: f32, y: f32);\nfn main(a: f32) -> P = P(1, 2) with { x: 3 };",
            "value with (field: new)",
        ),
        ("fn main(n: (i32, i32)) -> i32 = match n { (a, ..) => a };", "(a, _, _)"),
        ("fn main(v: vec2) -> f32 = v.length;", "length(value)"),
        ("fn f(a: i32, b: i32 c: i32) -> i32 = a;\nfn main() -> i32 = f(1 2);", "a comma is missing"),
        ("fn f(a: i32, b: i32 c: i32) -> i32 = a;\nfn main() -> i32 = f(1 2);", "a comma is missing"),
        ("fn main(v: [i32]) -> i32 = v[0];", "states its length"),
        ("fn main(m: mat2) -> f32 = m[0, 1];", "one number"),
        ("main :: Int\nfn f() -> i32 = 1;", "an item begins with"),
        (
            "fn main(n: i32) -> i32 {\n    let x = n + 1;\n    x * 2\n\nfn other(a: i32) -> i32 = a;",
            "next item",
        ),
        (
            "fn f(n: i32) -> i32 {\n    let x = if n > 0 {\n        1\n    else {\n        2\n    };\n    x\n}\n@task fn g(n: i32) -> i32 = f(n);\nfn main(n: i32) -> i32 = g(n);",
            "indented",
        ),
        ("fn main() -> i32 = max(1, min(3, 4);", "`)` belongs"),
        ("fn main(n: i32 -> i32 { n }", "`)` belongs"),
        ("fn main() -> i32 = max(1, [3, 4);", "`]` belongs"),
        ("fn main(n: i32) -> i32 = [1, 2, 3)[n];", "`]` belongs"),
        (
            "fn main(n: i32) -> i32 {\n    let x = if n > 0 {\n        1\n        }}\n    else { 2 };\n    x\n}",
            "one too many",
        ),
        (
            "fn pixel(p: vec2) -> vec3 = hypsometric(bilinear(p)) + 0.0 * hypsometric(nearest(p));",
            "use shade",
        ),
        (
            "fn pixel(p: vec2) -> vec3 = hypsometric(bilinear(p)) + 0.0 * hypsometric(nearest(p));",
            "use terrain",
        ),
        ("fn main(n: i32) -> i32 { let f = |x: i32| if x == 0 { 0 } else { f(x - 1) }; f(n) }", "top level"),
        ("enum C { Red, Green }\nfn main() -> i32 = C(1);", "`Red`"),
        ("fn same(x: T) -> i32 = 1;\nfn main(x: Weather) -> i32 = same(x);", "fn f<T>(x: T) -> T"),
        ("fn same(x: T) -> i32 = 1;\nfn main(x: Weather) -> i32 = same(x);", "`struct`"),
        ("fn main(n: i32) -> i32 = match n { x if x > 0 => 1, x if x <= 0 => 2 };", "a guard does not count"),
        (
            "enum C { Red, Green, Blue }\nfn main(n: i32) -> i32 = match colour(n) { Red => 1, Gren => 2, Blue => 3 };\nfn colour(n: i32) -> C = if n == 0 { Red } else { if n == 1 { Green } else { Blue } };",
            "`Green`",
        ),
        (
            "enum C { Red, Green }\nfn main(n: i32) -> i32 = match if n < 9 { Green } else { Red } { red => 1 };",
            "`Red`",
        ),
        ("const limit = 3;\nfn main(n: i32) -> i32 = match n { limit => 1, _ => 2 };", "x == limit"),
        ("fn main(n: Option<i32>) -> i32 = match n { None => 0, Some(X) => X };", "small letter"),
        ("fn main() -> i32 { let a: [i32; 3] = [1, 2]; a[0] }", "3 are needed"),
        ("fn f(x: f32) -> f32 = x;\nfn main() -> f32 = grad(f)(1.0);", "`deriv`"),
    ] {
        let found = match check(text) {
            Ok(checked) => checked.warnings,
            Err(report) => report.diagnostics,
        };
        let labels = |d: &Diagnostic| d.secondary.iter().map(|(_, label)| label.clone()).collect::<String>();
        let said = |d: &Diagnostic| format!("{} {} {:?}", d.primary.1, labels(d), d.help);
        let all: String = found.iter().map(said).collect();
        assert!(all.contains(part), "{text}: {all}");
    }
}
