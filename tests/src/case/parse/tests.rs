use super::*;

fn one(header: &str) -> Case {
    let text = format!("//# case a\n{header}\nfn main() -> i32 = 1;\n");
    parse("topic", &text).expect(header).remove(0)
}

#[test]
fn a_file_holds_many_cases() {
    let text = "// what it is about\n\n//# case a\n//# run main() => 1\nfn main() -> i32 = 1;\n\n\
                //# case b/c\n//# run main(2, (3, 4)) => (1, 2.0) ~ 1e-3\n//# modes cpu gpu-lane\nfn main() = 2;\n";
    let cases = parse("topic", text).unwrap();
    assert_eq!(cases.len(), 2);
    assert_eq!((cases[0].line, cases[0].program.text.as_str()), (3, "fn main() -> i32 = 1;\n\n"));
    assert!(cases[0].modes.is_empty());
    assert_eq!(cases[1].modes, [Mode::CpuAuto, Mode::CpuBlock, Mode::CpuLane, Mode::GpuLane]);
    let Expectation::Run { call, value, tolerance } = &cases[1].expectations[0] else { panic!("no run") };
    assert_eq!(call, &Call { entry: "main".into(), args: vec!["2".into(), "(3, 4)".into()] });
    assert_eq!(value.to_string(), "(1, 2.0)");
    assert_eq!(*tolerance, Tolerance::Given(1e-3));
}

#[test]
fn every_word_is_understood() {
    let header = "//# set k=1\n//# live k\n//# timeout 2\n//# memory 64K\n\
        //# dem 2x2 spacing 10,20 : 1 2 3 4.5\n//# warning W0601 at 1:4 \"unused\"\n//# fails main() => 3 \"fib\"\n\
        //# tasks main => g f\n//# rounds main(3) <= 4\n//# trace main()\n//# stream 1 2 f\n//# stream 3\n\
        //# render pixel 4x3\n//# pixel 1,2 => vec2(0.0, 1.0) ~ 0.1\n//# tolerance 0.5 but 0.01 because \"edges\"";
    let case = one(header);
    assert_eq!(case.settings.set, [("k".to_string(), "1".to_string())]);
    assert_eq!(case.settings.dem.as_ref().map(|d| (d.spacing, d.heights[3])), Some(((10.0, 20.0), 4.5)));
    assert_eq!(case.settings.memory, Some(64 << 10));
    assert_eq!(case.expectations.len(), 6);
    assert_eq!(
        case.expectations[2],
        Expectation::Tasks { entry: "main".into(), functions: vec!["f".into(), "g".into()] }
    );
    let Expectation::Trace { streams, .. } = &case.expectations[4] else { panic!("no trace") };
    assert_eq!(streams, &["1 2 f", "3"]);
    let Expectation::Render(render) = &case.expectations[5] else { panic!("no render") };
    assert_eq!((render.width, render.height, render.pixels.len()), (4, 3, 1));
    assert_eq!(render.tolerance.as_ref().map(|t| t.share), Some(0.01));
}

#[test]
fn modules_follow_the_program() {
    let text = "//# case a\n//# run main() => 1\nuse \"m.ghyll\";\n//# file m.ghyll\nfn f() -> i32 = 1;\n";
    let case = parse("topic", text).unwrap().remove(0);
    assert_eq!(case.program.text, "use \"m.ghyll\";\n");
    assert_eq!(case.program.files, [("m.ghyll".to_string(), "fn f() -> i32 = 1;\n".to_string())]);
}

#[test]
fn a_program_may_be_a_file_of_the_repository() {
    let text = "//# case a\n//# program lang-examples/fib.ghyll\n//# run main(3) => 2\n\n// A note.\n";
    let case = parse("topic", text).unwrap().remove(0);
    assert_eq!(case.program.name, "lang-examples/fib.ghyll");
    assert!(case.program.text.contains("fn fib"));
    assert!(parse("topic", &format!("{text}fn main() -> i32 = 1;\n")).is_err());
}

#[test]
fn a_place_may_come_with_a_code_and_a_part() {
    for (line, code, part) in [
        ("//# error at 1:2", "", ""),
        ("//# error E0301 at 1:2", "E0301", ""),
        ("//# error E0301 at 1:2 \"type\"", "E0301", "type"),
    ] {
        let Expectation::Diagnostic(d) = &one(line).expectations[0] else { panic!("no diagnostic") };
        assert_eq!((d.line, d.column, d.code.as_str(), d.part.as_str()), (1, 2, code, part));
    }
}

#[test]
fn a_place_may_be_in_a_module() {
    let Expectation::Diagnostic(d) = &one("//# error at lib/a.ghyll:3:4").expectations[0] else {
        panic!("no diagnostic")
    };
    assert_eq!((d.file.as_str(), d.line, d.column), ("lib/a.ghyll", 3, 4));
}

#[test]
fn what_is_not_understood_is_refused() {
    for header in [
        "//# rnu main() => 1",
        "//# run main() = 1",
        "//# run main => 1",
        "//# run main( => 1",
        "//# run (1) => 1",
        "//# run main() => 1 2",
        "//# run main() => ",
        "//# run main() => 1.0 ~ small",
        "//# fails main() => three \"x\"",
        "//# fails main() => 3 x",
        "//# error",
        "//# error at 1",
        "//# error at 0:1",
        "//# error at a.ghyll:1",
        "//# error at a.ghyll:1:0",
        "//# error X0301 at 1:1",
        "//# error E301 at 1:1",
        "//# error E0301 1:1",
        "//# error at 1:1 unquoted",
        "//# error at 1:1\n//# run main() => 1",
        "//# tasks main",
        "//# rounds main() <= few",
        "//# rounds main() = 3",
        "//# stream 1 2",
        "//# render pixel",
        "//# render pixel 0x4",
        "//# pixel 0,0 => 1.0",
        "//# render pixel 4x4\n//# pixel 0 => 1.0",
        "//# render pixel 4x4\n//# tolerance 0.1",
        "//# render pixel 4x4\n//# tolerance 0.1 because it is",
        "//# run main() => 1\n//# modes fast",
        "//# run main() => 1\n//# set k",
        "//# run main() => 1\n//# live",
        "//# run main() => 1\n//# timeout long",
        "//# run main() => 1\n//# memory 64X",
        "//# run main() => 1\n//# view north",
        "//# run main() => 1\n//# dem 2x2 spacing 1 : 1 2 3",
        "//# run main() => 1\n//# dem 2x2 : 1 2 3 4",
        "//# run main() => 1\n//# program no/such/file.ghyll",
        "//# run main() => 1\n//# file",
        "//# set k=1",
    ] {
        let text = format!("//# case a\n{header}\nfn main() -> i32 = 1;\n");
        assert!(parse("topic", &text).is_err(), "accepted: {header}");
    }
    for text in [
        "",
        "fn main() -> i32 = 1;\n",
        "//# run main() => 1\n//# case a\nfn main() -> i32 = 1;\n",
        "//# case\n//# run main() => 1\nfn main() -> i32 = 1;\n",
        "//# case a b\n//# run main() => 1\nfn main() -> i32 = 1;\n",
        "//# case a\n//# run main() => 1\n",
        "//# case a\n//# run main() => 1\nfn main() -> i32 = 1;\n//# run main() => 2\n",
        "//# case a\n//# run main() => 1\nfn main();\n//# case a\n//# run main() => 1\nfn main();\n",
    ] {
        assert!(parse("topic", text).is_err(), "accepted: {text}");
    }
}

#[test]
fn lines_are_repeated() {
    let text = "//# case a\n//# repeat 3\n//# error at 1:1\nfn f#() = #;\nfn g() = 1;\n//# case b\n//# error at 1:1\n#\n";
    let cases = parse("topic", text).unwrap();
    assert_eq!(cases[0].program.text, "fn f0() = 0;\nfn f1() = 1;\nfn f2() = 2;\nfn g() = 1;\n");
    assert_eq!(cases[1].program.text, "#\n");
    assert!(parse("topic", "//# case a\n//# repeat often\n//# error at 1:1\nf\n").is_err());
}
