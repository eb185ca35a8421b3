//! Texts that are far too much of something end with a diagnostic, and soon.

use super::*;
use crate::codes::*;

fn codes_of(text: &str) -> Vec<Code> {
    found(text).into_iter().map(|(code, _)| code).collect()
}

#[test]
fn long_and_deep_expressions() {
    accepts(&of_type("i32", &format!("{}1", "n + ".repeat(400))));
    accepts(&of_type("i32", &format!("{}n{}", "(".repeat(150), ")".repeat(150))));
    let nested = format!("{} n {}", "if b { 1 } else { ".repeat(90), "}".repeat(90));
    accepts(&of_type("i32", &nested));
    assert_eq!(codes_of(&of_type("i32", &format!("{}1", "n + ".repeat(10_000)))), [TOO_DEEP]);
    let chain = format!("{} {{ 2 }}", "if b { 1 } else ".repeat(5_000));
    assert_eq!(codes_of(&of_type("i32", &chain)), [TOO_DEEP]);
    assert_eq!(codes_of(&of_type("i32", &"[".repeat(5_000))), [TOO_DEEP]);
}

#[test]
fn types_that_grow() {
    let aliases: String = (1..60).map(|i| format!("type T{i} = (T{0}, T{0});", i - 1)).collect();
    assert!(codes_of(&format!("type T0 = f32; {aliases}")).contains(&TOO_LARGE));
    let structs: String = (1..60).map(|i| format!("struct S{i}(a: S{0}, b: S{0});", i - 1)).collect();
    assert!(codes_of(&format!("struct S0(a: f32); {structs}")).contains(&TOO_LARGE));
    let generic: String = (1..60).map(|i| format!("struct G{i}<A>(a: G{0}<(A, A)>);", i - 1)).collect();
    assert!(
        codes_of(&format!("struct G0<A>(a: A); {generic} fn f(x: G59<f32>) -> i32 = 1;"))
            .contains(&TOO_LARGE)
    );
    let lets: String = (1..100).map(|i| format!("let a{i} = (a{0}, a{0});", i - 1)).collect();
    assert!(codes_of(&format!("fn f() -> i32 {{ let a0 = 1; {lets} 1 }}")).contains(&TOO_LARGE));
    let calls = format!("{}1{}", "pair(".repeat(100), ")".repeat(100));
    let text = format!("fn pair<A>(a: A) -> (A, A) = (a, a); fn f() -> i32 {{ let x = {calls}; 1 }}");
    assert!(codes_of(&text).contains(&TOO_LARGE));
    let both = format!("fn pair<A>(a: A) -> (A, A) = (a, a); fn f() -> bool = {calls} == {calls};");
    assert!(codes_of(&both).contains(&TOO_LARGE));
}

/// Work is what counts, but nothing here counts it all: far more time than any of these needs.
fn soon(what: &str, text: &str) -> Vec<Code> {
    let started = std::time::Instant::now();
    let found = match check(text) {
        Ok(checked) => {
            let options = crate::compile::Options::default();
            crate::compile::reach(&checked, &options).expect("nothing is asked for");
            match crate::compile::compile(&checked, &options) {
                Err(crate::compile::CompileError::Program(report)) => {
                    report.diagnostics.iter().map(|d| d.code).collect()
                }
                _ => checked.warnings.iter().map(|d| d.code).collect(),
            }
        }
        Err(report) => {
            crate::report::render(&report, false);
            report.diagnostics.iter().map(|d| d.code).collect()
        }
    };
    let taken = started.elapsed();
    println!("{taken:?} {found:?} for {what}");
    assert!(taken.as_secs() < 20, "{taken:?} for {what}");
    found
}

const MIB: usize = 1 << 20;

#[test]
fn a_mebibyte_of_anything() {
    let body = |open: &str, close: &str| {
        let n = MIB / (open.len() + close.len());
        format!("fn main(b: bool, n: i32) -> i32 = {}n{};", open.repeat(n), close.repeat(n))
    };
    for (open, close) in [
        ("(", ""),
        ("(", ")"),
        ("[", "]"),
        ("{", "}"),
        ("-", ""),
        ("!", ""),
        ("- ", ""),
        ("|x| ", ""),
        ("|x: i32| ", ""),
        ("if b { n } else ", ""),
        ("if b { ", " } else { 1 }"),
        ("if ", ""),
        ("match n { _ => ", " }"),
        ("f(", ")"),
        ("n + ", ""),
        ("n |> ", ""),
        ("let x = ", ""),
        ("x: ", ""),
        ("", ".x"),
        ("", "[0]"),
        ("", " with (a: 1)"),
        ("/* ", ""),
        ("\"", ""),
        ("Some(", ")"),
        ("1 < ", ""),
        ("fold(0..", ", 1, |a, i| a)"),
    ] {
        let found = soon(&format!("{open}n{close}"), &body(open, close));
        assert!(!found.is_empty(), "a program of many `{open}{close}`");
    }
    for whole in [
        "(", ")", "-", "!", "|x|", "if", "fn", "match", "{", "<", "fn(", "[", "@task ", "use x;", "x", "0",
        "9", ".", "\u{e9}", "\n",
    ] {
        soon(whole, &whole.repeat(MIB / whole.len()));
    }
    for ty in ["fn(", "(", "[", "Option<"] {
        soon(ty, &format!("fn f(x: {}i32) -> i32 = 1;", ty.repeat(MIB / ty.len())));
    }
}

#[test]
fn huge_literals() {
    let digits = "9".repeat(MIB);
    for literal in [
        digits.clone(),
        format!("0x{digits}"),
        format!("{digits}.0"),
        format!("1e{digits}"),
        format!("0.{digits}"),
    ] {
        soon(&literal[..4], &format!("fn main() -> f32 = {literal};"));
    }
}

#[test]
fn matches_with_very_many_arms() {
    let numbers: String = (0..60_000).map(|i| format!("{i}=>{},", i % 7)).collect();
    let text = format!("fn main(n: i32) -> i32 = match n {{ {numbers} _ => 0 }};");
    assert_eq!(codes_of(&text), []);
    assert_eq!(codes_of(&text.replace("_ => 0", "")), [MISSING_CASE]);
    let twice = format!("fn main(n: i32) -> i32 = match n {{ {} _ => 0 }};", "5=>1,".repeat(40));
    assert_eq!(codes_of(&twice), [UNREACHABLE_ARM; 39]);
    let variants: String = (0..20_000).map(|i| format!("V{i},")).collect();
    let arms: String = (0..20_000).map(|i| format!("V{i}=>{},", i % 5)).collect();
    let text = format!("enum E {{ {variants} }} fn main(e: E) -> i32 = match e {{ {arms} }};");
    assert_eq!(codes_of(&text), []);
    assert_eq!(codes_of(&text.replace("V777=>2,", "")), [MISSING_CASE]);
    let either: String = (0..60_000).map(|i| format!("{i}|")).collect();
    assert_eq!(codes_of(&format!("fn main(n: i32) -> i32 = match n {{ {either} 9 => 1, _ => 0 }};")), []);
}

#[test]
fn many_items_that_refer_to_each_other() {
    let n = 20_000;
    let chain = |item: fn(usize) -> String| (1..n).map(item).collect::<String>();
    let constants = chain(|i| format!("const A{i} = A{} + 1;", i - 1));
    soon("constants", &format!("const A0 = 1; {constants} fn main() -> i32 = A{};", n - 1));
    soon("constants backwards", &chain(|i| format!("const A{} = A{i} + 1;", i - 1)));
    soon("constants in a circle", &format!("const A0 = A{}; {constants}", n - 1));
    soon("aliases", &format!("type T0 = i32; {}", chain(|i| format!("type T{i} = T{};", i - 1))));
    soon("aliases backwards", &chain(|i| format!("type T{} = T{i};", i - 1)));
    let circle = chain(|i| format!("type T{i} = T{};", i - 1));
    soon("aliases in a circle", &format!("type T0 = T{}; {circle}", n - 1));
    let structs = chain(|i| format!("struct S{i}(a: S{});", i - 1));
    soon("structs", &format!("struct S0(a: i32); {structs}"));
    soon("structs in a circle", &format!("struct S0(a: S{}); {structs}", n - 1));
    let params = chain(|i| format!("param p{i}: i32 = p{};", i - 1));
    soon("parameters", &format!("param p0: i32 = 1; {params} fn main() -> i32 = p{};", n - 1));
    let calls = chain(|i| format!("fn f{i}(n: i32) -> i32 = f{}(n);", i - 1));
    soon("functions", &format!("fn f0(n: i32) -> i32 = n; {calls}"));
    soon("recursive functions", &format!("fn f0(n: i32) -> i32 = f{}(n); {calls}", n - 1));
    let generic = chain(|i| format!("fn f{i}<A>(x: A) -> A = f{}(x);", i - 1));
    soon(
        "generic functions",
        &format!("fn f0<A>(x: A) -> A = x; {generic} fn main() -> i32 = f{}(1);", n - 1),
    );
    let growing = chain(|i| format!("fn f{i}<A>(x: A) -> A = f{}((x, x)).0;", i - 1));
    soon(
        "growing types",
        &format!("fn f0<A>(x: A) -> A = f{}(x); {growing} fn main() -> i32 = f9(1);", n - 1),
    );
    let doubling = (1..40)
        .map(|i| format!("fn g{i}(x: i32) -> i32 = g{0}(x) + g{0}(x + 1);", i - 1))
        .collect::<String>();
    soon("doubling calls", &format!("fn g0(x: i32) -> i32 = x; {doubling} fn main(x: i32) -> i32 = g39(x);"));
    let inline = doubling.replace("fn g", "@inline fn g");
    soon(
        "doubling calls in place",
        &format!("fn g0(x: i32) -> i32 = x; {inline} fn main(x: i32) -> i32 = g39(x);"),
    );
    let lambdas =
        (1..40).map(|i| format!("let g{i} = |x: i32| g{0}(x) + g{0}(x + 1);", i - 1)).collect::<String>();
    soon("doubling lambdas", &format!("fn main(x: i32) -> i32 {{ let g0 = |x: i32| x; {lambdas} g39(x) }}"));
    let generics = (1..40)
        .map(|i| format!("fn h{i}<A>(x: A) -> i32 = h{0}((x, 1)) + h{0}((x, 1.0));", i - 1))
        .collect::<String>();
    soon("doubling instances", &format!("fn h0<A>(x: A) -> i32 = 1; {generics} fn main() -> i32 = h39(1);"));
    let arrays = format!("fn main(i: i32) -> i32 = [{}][i];", "i,".repeat(400_000));
    soon("a long array", &arrays);
    let tuple = format!("fn main(i: i32) -> i32 = ({}).0;", "i,".repeat(400_000));
    soon("a long tuple", &tuple);
    soon("many arguments", &format!("fn main(i: i32) -> i32 = main({});", "i,".repeat(400_000)));
    let lets: String = (0..50_000).map(|i| format!("let a{i} = i;")).collect();
    soon("many lets", &format!("fn main(i: i32) -> i32 {{ {lets} i }}"));
    let shadows = "let i = i + 1;".repeat(60_000);
    soon("one name many times", &format!("fn main(i: i32) -> i32 {{ {shadows} i }}"));
    let unknown: String = (0..20_000).map(|i| format!("let a{i} = |x| x;")).collect();
    soon("many unknown types", &format!("fn main(i: i32) -> i32 {{ {unknown} i }}"));
    let late: String = (1..20_000).map(|i| format!("let a{i} = a{}.x;", i - 1)).collect();
    soon("many open questions", &format!("fn main(i: i32) -> i32 {{ let f = |a0| {{ {late} 1 }}; i }}"));
    let pairs: String = (0..20_000).map(|i| format!("let a{i} = |x| x + x;")).collect();
    soon("many open sums", &format!("fn main(i: i32) -> i32 {{ {pairs} i }}"));
}

fn text(piece: &str) -> String {
    (0..(1 << 18) / piece.len()).map(|i| piece.replace('#', &i.to_string())).collect()
}

#[test]
fn more_errors_than_anybody_reads() {
    let pieces = [
        ") ",
        "if a { z } el ",
        "fn f() -> i32 = x;\n",
        "let 1;\n",
        "f(|x| ",
        "/ ",
        "Option<",
        "1 < ",
        "\u{1} ",
        "fn f() -> i32 = 1 \n",
        "let a = 1 ",
    ];
    // What differs in each repetition is written `#`.
    let numbered =
        ["type T# = U#;\n", "fn f#() -> i32 = x#;\n", "fn f#(a: i32) -> i32 = match a { V#(_) => 1 };\n"];
    for piece in pieces.into_iter().chain(numbered) {
        let started = std::time::Instant::now();
        let report = check(&text(piece)).unwrap_err();
        assert!(report.diagnostics.len() <= 101, "{} errors for {piece}", report.diagnostics.len());
        crate::report::render(&report, false);
        crate::report::to_json(&report);
        let taken = started.elapsed();
        println!("{piece:?}: {taken:?}");
        assert!(taken.as_secs() < 30, "{taken:?} for {piece}");
    }
    let codes = codes_of(&"fn f() -> i32 = x;\n".repeat(300));
    assert_eq!((codes.len(), codes.last()), (101, Some(&TOO_MANY)));
}

#[test]
fn places_are_whole_characters() {
    for text in ["fn n()=|\u{fffd}|;", "fn n() -> i32 = (\u{fffd}", "fn n() -> i32 = 1 \u{fffd} fn"] {
        for diagnostic in check(text).unwrap_err().diagnostics {
            let (span, _) = diagnostic.primary;
            assert!(text.get(span.start as usize..span.end as usize).is_some(), "{diagnostic:?} in {text}");
        }
    }
}

#[test]
fn many_of_everything() {
    let lets: String = (0..3_000).map(|i| format!("let a{i} = abs({i});")).collect();
    accepts(&of_type("i32", &format!("{{ {lets} a2999 }}")));
    let functions: String =
        (0..2_000).map(|i| format!("fn f{i}(n: i32) -> i32 = f{}(n);", (i + 1) % 2_000)).collect();
    accepts(&functions);
    let arms: String = (0..500).map(|i| format!("{i} => {i},")).collect();
    accepts(&of_type("i32", &format!("match n {{ {arms} _ => 0 }}")));
}

#[test]
fn matches_with_exponentially_many_cases() {
    let n = 24;
    let params: Vec<String> = (0..n).map(|i| format!("b{i}: bool")).collect();
    let names: Vec<String> = (0..n).map(|i| format!("b{i}")).collect();
    let row = |k: usize| {
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
        format!("({}) => 1,", cells.join(", "))
    };
    let arms: String = (0..n).map(row).collect();
    let text = format!("fn f({}) -> i32 = match ({}) {{ {arms} }};", params.join(", "), names.join(", "));
    let codes = codes_of(&text);
    assert!(codes == [MISSING_CASE] || codes == [TOO_COMPLEX], "{codes:?}");
}
