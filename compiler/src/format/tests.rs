use super::*;
use crate::library::MODULES;

fn formatted(text: &str) -> String {
    let once = format(SourceId(0), text).unwrap_or_else(|e| panic!("{e:?}\n{text}"));
    assert_eq!(format(SourceId(0), &once).as_deref(), Ok(once.as_str()), "formatting is done once");
    once
}

#[track_caller]
fn becomes(text: &str, expected: &str) {
    let found = formatted(text);
    assert!(found == expected, "{text}\n-- became --\n{found}\n-- expected --\n{expected}");
}

#[test]
fn blanks_are_those_of_the_manual() {
    becomes(
        "fn  f<A,B>( x:A , g:fn(A)->B ) ->B=g( x ) ;use terrain;@task @bake fn h(p : vec2)->f32=- p . x+2*(a-b)%c;",
        "fn f<A, B>(x: A, g: fn(A) -> B) -> B = g(x);\nuse terrain;\n\
         @task @bake fn h(p: vec2) -> f32 = -p.x + 2 * (a - b) % c;\n",
    );
    becomes(
        "const C=|x:f32,( a|b )|x>>1|y;const D:[Option<Option<f32>>;2]=[- 1.,!a,t . 0 . 1];",
        "const C = |x: f32, (a | b)| x >> 1 | y;\nconst D: [Option<Option<f32>>; 2] = [-1., !a, t.0.1];\n",
    );
    becomes(
        "const E=sum(0 ..n,|i|i)+a[1]- f(_,x)(y)with(b:1);",
        "const E = sum(0..n, |i| i) + a[1] - f(_, x)(y) with (b: 1);\n",
    );
    becomes("const F=fold(1. .. .5,a<b,x)>=- 3;", "const F = fold(1. .. .5, a < b, x) >= -3;\n");
    becomes("enum E{A(f32),B}\nstruct S ( a:f32 );", "enum E { A(f32), B }\nstruct S(a: f32);\n");
}

#[test]
fn spellings_and_parentheses_stay() {
    let text = "const A = (0x2A + 1_000) * ((0.50) - 1e-3);\n";
    becomes(text, text);
}

#[test]
fn blocks_with_names_are_broken() {
    becomes(
        "fn f(x: i32) -> i32 { let a = x; let b = |y| { let c = y; c + a };\n\n\n b(1) }",
        "fn f(x: i32) -> i32 {\n    let a = x;\n    let b = |y| {\n        let c = y;\n        c + a\n    };\n\n    b(1)\n}\n",
    );
    becomes(
        "fn f(x: i32) -> i32 = if x < 1 { 1 }\nelse if x < 2 { 2 } else {\n 3 };",
        "fn f(x: i32) -> i32 = if x < 1 {\n    1\n} else if x < 2 {\n    2\n} else {\n    3\n};\n",
    );
}

#[test]
fn arms_have_lines_of_their_own() {
    becomes(
        "fn f(x: T) -> i32 = match x { A => 1, B(y) if y > -1 => { let z = y; z } -1 => 2, _ =>\n3 };",
        "fn f(x: T) -> i32 = match x {\n    A => 1,\n    B(y) if y > -1 => {\n        let z = y;\n        z\n    }\n    -1 => 2,\n    _ =>\n        3,\n};\n",
    );
    let text = "fn f(x: T) -> bool = match x { Some(_) => true, None => false };\n";
    becomes(text, text);
}

#[test]
fn lists_are_broken_where_the_writer_breaks_them() {
    becomes(
        "const A = f(\na, b,\nc);\nconst B = f(a,\n b, c,);",
        "const A = f(\n    a, b,\n    c,\n);\nconst B = f(a,\n    b, c);\n",
    );
    becomes(
        "fn f() -> f32 =\n a\n+ b * sum(0..3, |i| {\nlet c = i;\nc\n})\n+ d;",
        "fn f() -> f32 =\n    a\n    + b * sum(0..3, |i| {\n        let c = i;\n        c\n    })\n    + d;\n",
    );
}

#[test]
fn long_lines_are_broken() {
    let call = "dot(first, second) * dot(second, third) + dot(first, third)";
    becomes(
        &format!("fn long(first: vec3, second: vec3, third: vec3) -> f32 = {call} * 2.0;"),
        &format!("fn long(first: vec3, second: vec3, third: vec3) -> f32 =\n    {call} * 2.0;\n"),
    );
    let name = "a_name_that_is_rather_long_so_that_nothing_fits";
    becomes(
        &format!("const A = {name}({name}, {name}, 1);"),
        &format!("const A = {name}(\n    {name},\n    {name},\n    1,\n);\n"),
    );
    becomes(
        &format!("fn f() -> f32 {{ if {name} {{ {name}(1) }} else {{ {name}(2) }} }}"),
        &format!(
            "fn f() -> f32 {{\n    if {name} {{\n        {name}(1)\n    }} else {{\n        {name}(2)\n    }}\n}}\n"
        ),
    );
}

#[test]
fn comments_keep_their_places() {
    becomes(
        "\n\n// first\n\n\n/// doc\nfn f(a: i32 /* in */, b: i32) -> i32 { // behind\n  // alone\n  let c = a; // one\n  let dd = b;// two\n\n  /* x\n     y */\n  c // value\n  // last\n}\n// end",
        "// first\n\n/// doc\nfn f(a: i32 /* in */, b: i32) -> i32 {    // behind\n    // alone\n    let c = a;     // one\n    let dd = b;    // two\n\n    /* x\n     y */\n    c    // value\n    // last\n}\n// end\n",
    );
    becomes(
        "struct S(a: f32, // one\n  bb: f32 // two\n);",
        "struct S(\n    a: f32,     // one\n    bb: f32,    // two\n);\n",
    );
    becomes("const A = f(1, // one\n2);", "const A = f(1,    // one\n    2);\n");
    becomes("const A = if a { 1 } // yes\nelse { 2 };", "const A = if a { 1 }    // yes\nelse { 2 };\n");
    becomes(
        "/* head */ use terrain; /* a */ /* b */ use /* c */ shade; /* d */\n/* e */\nconst A = 1;",
        "/* head */ use terrain;\n/* a */ /* b */ use /* c */ shade; /* d */\n/* e */\nconst A = 1;\n",
    );
    becomes(
        "fn f() -> i32 { let a = 1; /* b */ let b = 2; match a { 0 => a, /* else */ _ => b } }",
        "fn f() -> i32 {\n    let a = 1;\n    /* b */ let b = 2;\n    match a { 0 => a, /* else */ _ => b }\n}\n",
    );
    becomes(
        "struct P<A, B>(x: f32, // xx\ny: f32);\nfn f(a: i32, // a\n b: i32) -> i32 = a;",
        "struct P<A, B>(\n    x: f32,    // xx\n    y: f32,\n);\nfn f(\n    a: i32,    // a\n    b: i32,\n) -> i32 = a;\n",
    );
    becomes("// only", "// only\n");
    becomes("", "");
}

#[test]
fn line_ends_and_byte_order_marks_are_of_one_kind() {
    becomes("\u{feff}// a \r\nuse terrain;\r\n\r\n\r\nuse shade;\r\n", "// a\nuse terrain;\n\nuse shade;\n");
}

#[test]
fn what_is_no_program_is_refused() {
    assert!(format(SourceId(0), "fn f( -> i32 = 1;").is_err_and(|d| !d.is_empty()));
}

#[test]
fn library_modules_are_formatted() {
    for (name, text) in MODULES {
        assert_eq!(formatted(text), *text, "{name}");
    }
}
