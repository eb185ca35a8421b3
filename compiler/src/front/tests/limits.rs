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
