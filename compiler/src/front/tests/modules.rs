//! Modules in files.

use super::*;
use crate::codes::*;

struct Texts(&'static [(&'static str, &'static str)]);

impl Files for Texts {
    fn read(&self, name: &str) -> Result<String, String> {
        let found = self.0.iter().find(|(known, _)| *known == name);
        found.map(|(_, text)| (*text).to_owned()).ok_or_else(|| "no such file".to_owned())
    }
}

fn program(text: &str, files: &'static [(&'static str, &'static str)]) -> Result<Checked, Report> {
    front(Source::new("src/main.ghyll", text), &Texts(files))
}

/// Code, file and text pointed at of each diagnostic.
fn told(text: &str, files: &'static [(&'static str, &'static str)]) -> Vec<(Code, String, String)> {
    let report = program(text, files).expect_err("there are mistakes");
    let place = |d: &Diagnostic| {
        let (span, _) = d.primary;
        let source = report.sources.get(span.source);
        (d.code, source.name.clone(), source.text[span.start as usize..span.end as usize].to_owned())
    };
    report.diagnostics.iter().map(place).collect()
}

fn is(code: Code, file: &str, at: &str) -> (Code, String, String) {
    (code, file.to_owned(), at.to_owned())
}

#[test]
fn a_file_that_two_others_use_is_loaded_once() {
    let files = &[
        ("src/a.ghyll", "use \"lib/base.ghyll\"; fn a() -> i32 = base();"),
        ("src/lib/b.ghyll", "use \"../lib/./base.ghyll\"; fn b() -> i32 = base();"),
        ("src/lib/base.ghyll", "fn base() -> i32 = 1;"),
    ];
    let text = "use \"a.ghyll\"; use \"lib/b.ghyll\"; fn main() -> i32 = a() + b();";
    let checked = program(text, files).expect("no mistakes");
    assert_eq!(checked.module.functions.iter().filter(|f| f.name == "base").count(), 1);
    assert_eq!(checked.module.functions.iter().filter(|f| !f.library).count(), 4);
}

#[test]
fn names_are_not_passed_on() {
    let files =
        &[("src/a.ghyll", "use \"b.ghyll\"; fn a() -> i32 = b();"), ("src/b.ghyll", "fn b() -> i32 = 1;")];
    let found = told("use \"a.ghyll\"; fn main() -> i32 = a() + b();", files);
    assert_eq!(found, [is(UNKNOWN_NAME, "src/main.ghyll", "b")]);
}

#[test]
fn private_names_and_entries_stay_in_their_file() {
    let files =
        &[("src/a.ghyll", "fn _own() -> i32 = 1; fn main() -> i32 = _own(); fn a() -> i32 = main();")];
    let text = "use \"a.ghyll\"; fn _own() -> i32 = 2; fn main() -> i32 = _own() + a();";
    let checked = program(text, files).expect("no clash");
    let main = checked.module.function("main").expect("the program's");
    assert_eq!(checked.module.functions[main.0 as usize].span.source, crate::source::SourceId(0));
    assert_eq!(told("use \"a.ghyll\"; fn f() -> i32 = _own();", files)[0].0, UNKNOWN_NAME);
    assert!(program("use \"a.ghyll\";", files).expect("fine").module.function("main").is_none());
}

#[test]
fn mistakes_are_shown_in_their_file() {
    let files = &[("src/a.ghyll", "fn a() -> i32 = 1.5;\nfn b() -> i32 = nothing;")];
    let found = told("use \"a.ghyll\"; fn main() -> i32 = a(true);", files);
    let expected = [
        is(ARGUMENTS, "src/main.ghyll", "true"),
        is(MISMATCH, "src/a.ghyll", "1.5"),
        is(UNKNOWN_NAME, "src/a.ghyll", "nothing"),
    ];
    assert_eq!(found, expected);
    let report = program("use \"a.ghyll\";", files).expect_err("mistakes");
    assert!(crate::report::render(&report, false).contains("src/a.ghyll:1:17"));
    assert!(crate::report::to_json(&report).contains(r#""file":"src/a.ghyll""#));
}

#[test]
fn syntax_errors_of_a_module_are_told() {
    let found = told("use \"a.ghyll\";", &[("src/a.ghyll", "fn a() -> i32 = (1;")]);
    assert_eq!((found[0].0, found[0].1.as_str()), (UNCLOSED, "src/a.ghyll"));
}

#[test]
fn a_file_that_is_missing_is_named_with_its_path() {
    let report = program("use \"../lib/a.ghyll\";", &[]).expect_err("no such file");
    assert_eq!(report.diagnostics[0].code, UNREADABLE_MODULE);
    let text = crate::report::render(&report, false);
    for part in ["src/main.ghyll:1:5", "`lib/a.ghyll`", "no such file"] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
}

#[test]
fn circles_are_shown() {
    let files = &[
        ("src/a.ghyll", "use \"b.ghyll\";"),
        ("src/b.ghyll", "use \"c.ghyll\"; use \"d.ghyll\";"),
        ("src/c.ghyll", "use \"a.ghyll\";"),
        ("src/d.ghyll", "use \"d.ghyll\";"),
    ];
    let report = program("use \"a.ghyll\";", files).expect_err("circles");
    let labels: Vec<_> = report.diagnostics.iter().map(|d| (d.code, d.primary.1.as_str())).collect();
    let expected = [
        (MODULE_CYCLE, "src/a.ghyll -> src/b.ghyll -> src/c.ghyll -> src/a.ghyll"),
        (MODULE_CYCLE, "src/d.ghyll -> src/d.ghyll"),
    ];
    assert_eq!(labels, expected);
    assert_eq!(told("use \"main.ghyll\";", &[])[0], is(MODULE_CYCLE, "src/main.ghyll", "\"main.ghyll\""));
}

#[test]
fn long_chains_of_files_end() {
    struct Chain;
    impl Files for Chain {
        fn read(&self, name: &str) -> Result<String, String> {
            let n: u64 = name.trim_end_matches(".ghyll").parse().map_err(|_| "no number")?;
            Ok(format!("use \"{}.ghyll\";", n + 1))
        }
    }
    let report = front(Source::new("x", "use \"1.ghyll\";"), &Chain).expect_err("too many");
    assert_eq!(report.diagnostics[0].code, UNREADABLE_MODULE);
}

#[test]
fn two_definitions_of_a_name_are_told() {
    let files = &[
        ("src/a.ghyll", "fn same() -> i32 = 1; struct S(x: i32); param k: i32 = 1;"),
        ("src/b.ghyll", "fn same() -> i32 = 2;"),
        ("src/c.ghyll", "use \"d.ghyll\"; fn c() -> i32 = k;"),
        ("src/d.ghyll", "param k: i32 = 2; param _k: i32 = 3;"),
    ];
    let two = told("use \"a.ghyll\"; use \"b.ghyll\";", files);
    assert_eq!(two, [is(DUPLICATE, "src/main.ghyll", "\"b.ghyll\"")]);
    let own = told("use \"a.ghyll\"; type S = i32; fn same() -> i32 = 3;", files);
    assert_eq!(own, [is(DUPLICATE, "src/main.ghyll", "S"), is(DUPLICATE, "src/main.ghyll", "same")]);
    let host = told("use \"a.ghyll\"; use \"c.ghyll\";", files);
    assert_eq!(host, [is(DUPLICATE, "src/d.ghyll", "k")]);
}

#[test]
fn the_same_file_twice_is_no_clash() {
    let files = &[("src/a.ghyll", "fn a() -> i32 = 1;")];
    program("use \"a.ghyll\"; use \"./a.ghyll\"; fn main() -> i32 = a();", files).expect("one file");
}

#[test]
fn names_of_files_hide_names_of_the_library() {
    let files = &[("src/a.ghyll", "struct Ray(x: i32); fn lambert(x: i32) -> i32 = x;")];
    let text = "use \"a.ghyll\"; use terrain; use shade; fn main() -> i32 = lambert(Ray(x: 1).x);";
    program(text, files).expect("the file's");
}

#[test]
fn an_option_written_out_again_is_the_library_s_in_every_file() {
    let files = &[("src/a.ghyll", "enum Option<A> { Some(A), None } fn a() -> Option<i32> = Some(1);")];
    let text = "use \"a.ghyll\"; enum Option<A> { Some(A), None } fn main() -> Option<i32> = a();";
    program(text, files).expect("one type");
}
