//! Generated text is valid WGSL, and has the form that the window contract asks for.

use super::{Wgsl, emit, validate};
use crate::core::prims::{Operands, PRIMS};
use crate::core::{Const, Intrinsic, Scalar, parse, print, verify};
use crate::intrinsics::returns_struct;
use crate::split::split;

/// What the runtime declares before the generated text, with empty bodies.
const WINDOW: &str = "
const NO_TASK: u32 = 0xffffffffu;
var<private> invoke: u32;
var<private> fuel: i32;
var<private> exhausted: bool;
fn consume(n: u32) {}
fn operand(i: u32) -> u32 { return i; }
fn literal(word: u32) {}
fn later(word: u32) {}
fn live_word(i: u32) -> u32 { return i; }
fn constant_word(i: u32) -> u32 { return i; }
fn rounded(sum: f32) -> f32 { return sum; }
";

fn dummy(intrinsic: Intrinsic) -> String {
    let name = intrinsic.name();
    let params: Vec<_> =
        intrinsic.params().iter().enumerate().map(|(i, s)| format!("a{i}: {}", s.name())).collect();
    let results = intrinsic.results();
    let (declaration, result) = match results {
        [one] => (String::new(), one.name().to_string()),
        many if !returns_struct(intrinsic) => (String::new(), format!("vec{}<f32>", many.len())),
        many => {
            let fields: Vec<_> =
                many.iter().enumerate().map(|(i, s)| format!("r{i}: {}", s.name())).collect();
            (format!("struct {name}_result {{ {} }}\n", fields.join(", ")), format!("{name}_result"))
        }
    };
    format!("{declaration}fn {name}({}) -> {result} {{ return {result}(); }}\n", params.join(", "))
}

/// Generated text with everything it needs around it.
fn module(wgsl: &Wgsl) -> String {
    let intrinsics: String = wgsl.intrinsics.iter().map(|i| dummy(*i)).collect();
    let entry = "@compute @workgroup_size(1) fn main() { rewrite(invoke); }\n";
    format!("{WINDOW}{intrinsics}{}{entry}", wgsl.text)
}

/// Validates generated text. With `GHYLL_DUMP` set to a folder the module is kept there, to try other WGSL
/// compilers on it.
pub fn check(wgsl: &Wgsl) {
    let module = module(wgsl);
    if let Ok(folder) = std::env::var("GHYLL_DUMP") {
        let hash = module.bytes().fold(7u64, |h, b| h.wrapping_mul(31).wrapping_add(b.into()));
        std::fs::write(format!("{folder}/{hash:016x}.wgsl"), &module).expect("the folder can be written");
    }
    validate(&module).unwrap_or_else(|why| panic!("{why}\n{module}"));
}

/// Writes a program's table and checks it.
fn written(text: &str) -> Wgsl {
    let program = parse::program(text).unwrap_or_else(|why| panic!("{why}\n{text}"));
    verify::program(&program).expect("is core");
    let (table, entry) = split(&program).expect("few words");
    let wgsl = emit(&table, entry);
    check(&wgsl);
    wgsl
}

#[test]
fn programs_of_the_splitter_are_valid() {
    for text in crate::split::tests::PROGRAMS {
        written(text);
    }
}

#[test]
fn every_operation_is_valid_with_variables_and_with_constants() {
    for row in PRIMS {
        for scalar in row.on {
            let n = match row.operands {
                Operands::Same(n) => n as usize,
                Operands::Select => 3,
                Operands::Index => 4,
            };
            let scalars: Vec<_> = (0..n).map(|i| row.prim.operand(*scalar, i)).collect();
            let result = row.prim.result(*scalar).name();
            let op = format!("{}.{}", row.name, scalar.name());
            let params: Vec<_> =
                scalars.iter().enumerate().map(|(i, s)| format!("p{i}: {}", s.name())).collect();
            let mut body = String::new();
            // Bit i of the mask makes operand i a constant; zeros are the hard case.
            for mask in 0..1 << n {
                let arg = |(i, s): (usize, &Scalar)| match mask >> i & 1 {
                    0 => format!("p{i}"),
                    _ => print::constant(Const::from_word(*s, 0)),
                };
                let args: Vec<_> = scalars.iter().enumerate().map(arg).collect();
                body += &format!("r{mask}: {result} = {op}({})\n", args.join(", "));
            }
            let results: Vec<_> = (0..1 << n).map(|m| format!("r{m}")).collect();
            let kinds = vec![result; 1 << n].join(", ");
            written(&format!(
                "entry f fn f({}) -> ({kinds}) {{ {body} yield {} }}",
                params.join(", "),
                results.join(", ")
            ));
        }
    }
}

#[test]
fn every_intrinsic_and_live_word_is_valid() {
    for intrinsic in Intrinsic::ALL {
        let dst: Vec<_> =
            intrinsic.results().iter().enumerate().map(|(i, s)| format!("r{i}: {}", s.name())).collect();
        let names: Vec<_> = (0..dst.len()).map(|i| format!("r{i}")).collect();
        let arg = |s: &Scalar| if *s == Scalar::U32 { "3u" } else { "x" };
        let args = intrinsic.params().iter().map(arg).collect::<Vec<_>>().join(", ");
        let kinds: Vec<_> = intrinsic.results().iter().map(|s| s.name()).collect();
        let wgsl = written(&format!(
            "live a: (bool) live b: (f32) entry f
             fn f() -> ({}) {{ x: f32 = live(1) {} = @{}({args}) yield {} }}",
            kinds.join(", "),
            dst.join(", "),
            intrinsic.name(),
            names.join(", ")
        ));
        assert_eq!(
            wgsl.intrinsics,
            if wgsl.text.contains(intrinsic.name()) { vec![*intrinsic] } else { vec![] }
        );
        assert!(wgsl.uses_live || intrinsic.params().is_empty());
    }
}

#[test]
fn constants_are_exact_and_never_rejected() {
    let words =
        ["0.0", "-0.0", "inf", "-inf", "nan", "1e-45", "3.4028235e38", "-1.1754944e-38", "0.1", "-2.5"];
    let yields = words.join(", ");
    let kinds = vec!["f32"; words.len()].join(", ");
    written(&format!("entry f fn f() -> ({kinds}) {{ yield {yields} }}"));
    for word in words.iter().chain(&["-2147483648", "2147483647", "-1", "4294967295u", "true"]) {
        let kind = parse::constant(word).expect("a constant").scalar();
        if kind != Scalar::Bool {
            let kind = kind.name();
            written(&format!(
                "entry f fn f(x: {kind}) -> ({kind}, {kind}) {{
                   a: {kind} = sub.{kind}(x, {word})
                   c: bool = lt.{kind}({word}, x)
                   b: {kind} = if c {{ d: {kind} = mul.{kind}(a, {word}) yield d }} else {{ yield {word} }}
                   yield a, b
                 }}"
            ));
        }
    }
    assert_eq!(super::expression::constant(Const::I32(i32::MIN)), "i32(-2147483648)");
    assert_eq!(super::expression::constant(Const::f32(1e30)), "1e30f");
    assert_eq!(super::expression::constant(Const::f32(-0.0)), "f32_bits(0x80000000u)");
}

#[test]
fn emissions_go_to_the_two_stacks_in_the_stated_order() {
    let text = written(crate::split::tests::FIB).text;
    let expected = "\
        later(2u);
        later(bitcast<u32>(v3));
        later(65536u);
        literal(bitcast<u32>(v2));
        invoke = 0u;";
    // `n-1 fib n-2 fib fib.1`: the continuation is task 1 and has no literals of its own; n-2 fib has one.
    let lines = |s: &str| s.lines().map(|l| l.trim().to_string()).collect::<Vec<_>>();
    let expected = lines(&expected.replace("later(2u)", "later(1u)"));
    let found = lines(&text);
    assert!(found.windows(expected.len()).any(|w| w == expected), "{text}");
}

#[test]
fn only_unbounded_loops_spend_fuel() {
    let looped = |limit: &str| {
        written(&format!(
            "entry f fn f(n: i32) -> (i32) {{
               i: i32, s: i32 = loop fold (i0: i32 = 0, s0: i32 = 1) while {{
                 c: bool = lt.i32(i0, {limit}) yield c
               }} do {{
                 i1: i32 = add.i32(i0, 1) s1: i32 = mul.i32(s0, i1) yield i1, s1
               }}
               yield s
             }}"
        ))
        .text
        .contains("exhausted")
    };
    assert!(!looped("64"));
    assert!(looped("65"));
    assert!(looped("n"));
}

#[test]
fn an_image_fused_whole_has_a_shade() {
    let pixel =
        |body: &str| written(&format!("entry pixel fn pixel(x: f32, y: f32) -> (f32, f32) {{ {body} }}"));
    let whole = pixel(
        "c: bool = lt.f32(x, y) z: f32 = if c { a: f32 = sin.f32(x) yield a } else { yield y } yield z, x",
    );
    assert!(whole.has_shade);
    assert!(whole.text.contains("return vec4<f32>(v3, v0, 0.0f, 1.0f);"), "{}", whole.text);
    let split = pixel("a: f32, b: f32 = call pixel(y, x) c: f32 = add.f32(a, b) yield c, a");
    assert!(!split.has_shade);
}

#[test]
fn invalid_text_is_rejected() {
    assert!(validate("fn f() -> i32 { return 1.5; }").is_err());
    assert!(validate("fn f( {").is_err());
}

/// Most blocks around a statement of the text.
fn nesting(text: &str) -> usize {
    text.lines().map(|l| (l.len() - l.trim_start().len()) / 4).max().unwrap_or(0)
}

#[test]
fn nesting_is_bounded() {
    // A chain of 300 comparisons, once with plain values and once with a task call at the end.
    for last in ["yield 7", "d: i32 = sub.i32(n, 1000) r: i32 = call f(d) yield r"] {
        let mut body = format!("{last}\n");
        for i in (0..300).rev() {
            body = format!(
                "c{i}: bool = eq.i32(n, {i}) x{i}: i32 = if c{i} {{ a{i}: i32 = mul.i32(n, {i}) yield a{i} }}
                 else {{ {body} }} yield x{i}\n"
            );
        }
        let text = format!("entry f fn f(n: i32) -> (i32) {{ {body} }}");
        let run = move || {
            let source = parse::program(&text).expect("parses");
            let back = crate::back::back(source.clone()).expect("few words");
            check(&back.wgsl);
            assert!(nesting(&back.wgsl.text) < 40, "{}", nesting(&back.wgsl.text));
            for n in [0, 20, 299, 1200] {
                let args = [Const::I32(n)];
                let direct = crate::interpret::run(&source, &args, &crate::interpret::NoHost, 100_000);
                let rewritten = crate::split::tests::rewrite(&back.table, back.entry, &args, 100_000);
                assert_eq!(rewritten, direct);
            }
        };
        let thread = std::thread::Builder::new().stack_size(64 << 20).spawn(run).expect("the thread starts");
        thread.join().expect("nesting is bounded");
    }
}

#[test]
fn many_tasks_are_chosen_from_by_a_tree() {
    let calls: String = (0..200).map(|i| format!("a{}: i32 = call t{i}(a{i}) ", i + 1)).collect();
    let tasks: String = (0..200)
        .map(|i| format!("@task fn t{i}(x: i32) -> (i32) {{ y: i32 = xor.i32(x, {i}) yield y }}\n"))
        .collect();
    let text = written(&format!("entry f {tasks} fn f(a0: i32) -> (i32) {{ {calls} yield a200 }}")).text;
    assert!(nesting(&text) <= 9, "{}", nesting(&text));
    assert_eq!(text.matches("task_5();").count(), 1);
}

#[test]
fn sums_are_rounded_where_a_driver_would_cancel() {
    let body = |statements: &str| {
        let text =
            format!("entry main\n\nfn main(v0: f32, v1: f32) -> (f32) {{\n{statements}  yield v4\n}}\n");
        written(&text).text
    };
    let sum = "  v2: f32 = add.f32(v0, v1)\n";
    for (rest, expected) in [
        ("  v4: f32 = sub.f32(v2, v0)\n", "= rounded(v2) - v0;"),
        ("  v4: f32 = sub.f32(v1, v2)\n", "= v1 - rounded(v2);"),
        ("  v3: f32 = neg.f32(v2)\n  v4: f32 = add.f32(v0, v3)\n", "= v0 + rounded(v3);"),
        ("  v3: f32 = add.f32(v0, 0.5)\n  v4: f32 = sub.f32(v3, 0.25)\n", "= rounded(v2) - 0.25f;"),
        ("  v4: f32 = div.f32(v2, 0.0)\n", "= v2 / rounded(0.0f);"),
        // Nothing to cancel.
        ("  v3: f32 = mul.f32(v2, v2)\n  v4: f32 = sub.f32(v2, v3)\n", "= v2 - v3;"),
        ("  v4: f32 = add.f32(v2, 0.25)\n", "= v2 + 0.25f;"),
    ] {
        let text = body(&format!("{sum}{rest}"));
        assert!(text.contains(expected), "{expected}\n{text}");
        assert_eq!(text.contains("rounded("), expected.contains("rounded("), "{text}");
    }
}
