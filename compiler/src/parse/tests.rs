use super::*;

fn codes_of(text: &str) -> Vec<(codes::Code, u32)> {
    file(SourceId(0), text).diagnostics.iter().map(|d| (d.code, d.primary.0.start)).collect()
}

/// Fully bracketed form of operators.
fn shape(e: &Expr, text: &str) -> String {
    match &e.kind {
        ExprKind::Binary(_, a, b) => format!("({} {})", shape(a, text), shape(b, text)),
        ExprKind::Unary(_, a) => format!("-{}", shape(a, text)),
        _ => text[e.span.start as usize..e.span.end as usize].to_owned(),
    }
}

fn shape_of(text: &str) -> String {
    let parsed = expression(SourceId(0), text);
    assert_eq!(parsed.diagnostics, vec![], "{text}");
    shape(&parsed.tree, text)
}

#[test]
fn precedence() {
    assert_eq!(shape_of("a + b * c"), "(a (b c))");
    assert_eq!(shape_of("a - b - c"), "((a b) c)");
    assert_eq!(shape_of("a |> b || c && d == e | f ^ g & h << i + j * -k.x"), {
        "(a (b (c (d (e (f (g (h (i (j -k.x))))))))))"
    });
    assert_eq!(shape_of("a * b + c << d & e ^ f | g < h && i || j |> k"), {
        "((((((((((a b) c) d) e) f) g) h) i) j) k)"
    });
    assert_eq!(shape_of("a >> b > c"), "((a b) c)");
    assert_eq!(shape_of("x |> |y| y + 1"), "(x |y| y + 1)");
}

#[test]
fn every_item_parses() {
    let text = "use terrain; use \"a/b.ghyll\"; const A = 1; const B: f32 = 2.0;
        param p: f32 = 1.0 in 0.0..2.0; param q: i32 in 0..9 = 3; raster r: vec3;
        struct S<A,>(a: A, b: [f32; 4],); enum E<A> { X(A, f32), Y, } type T<A> = fn(A, (A, bool)) -> fn() -> A;
        @task @bake fn f<A, B>(x: A, _: Option<Option<A>>,) -> B = g(x, _,);
        fn g() -> i32 { let (a, S(b, c: _, ..)): T = 1; a with (b: 2, ) }
        fn h() -> i32 = match x { 1 | -2 if y => 3, A(0..) => 1, } |> |(a, b), c: f32| [a[0], b.0.xy,][1];";
    let parsed = file(SourceId(0), text);
    // `0..` is no pattern: the only error.
    assert_eq!(parsed.diagnostics.len(), 1, "{:?}", parsed.diagnostics);
    let parsed = file(SourceId(0), &text.replace("A(0..)", "A(0, ..)"));
    assert_eq!(parsed.diagnostics, vec![]);
    assert_eq!(parsed.tree.len(), 13);
}

#[test]
fn several_errors_in_one_run() {
    let text =
        "fn a() -> i32 = 1 + ;\nfn b() -> i32 { let = 2; let y 3; 4 }\nconst = 4;\nfn c() -> i32 = (1;\n";
    let found = codes_of(text);
    assert!(found.len() >= 4, "{found:?}");
    let lines: Vec<usize> =
        found.iter().map(|(_, at)| text[..*at as usize].matches('\n').count() + 1).collect();
    for line in 1..=4 {
        assert!(lines.contains(&line), "no error on line {line}: {found:?}");
    }
}

#[test]
fn almost_right_has_its_own_message() {
    for (text, code) in [
        ("fn a() -> bool = 1 < 2 < 3;", codes::CHAINED),
        ("fn a() -> i32 { let x = 1; }", codes::BLOCK_VALUE),
        ("fn a() -> i32 { x; }", codes::UNUSED_VALUE),
        ("fn a() -> i32 = if x { 1 };", codes::IF_WITHOUT_ELSE),
        ("fn a() = 1;", codes::UNSTATED_TYPE),
        ("fn a(x) -> i32 = 1;", codes::UNSTATED_TYPE),
        ("@fast fn a() -> i32 = 1;", codes::UNKNOWN_ATTRIBUTE),
        ("@task @task fn a() -> i32 = 1;", codes::UNKNOWN_ATTRIBUTE),
        ("fn a() -> i32 = ();", codes::BAD_TUPLE),
        ("fn a() -> i32 = (1,);", codes::BAD_TUPLE),
        ("fn a() -> i32 = [];", codes::BAD_TUPLE),
        ("fn a() -> i32 = match x { S(.., a) => 1 };", codes::MISPLACED_REST),
        ("fn a() -> i32 = 1", codes::SYNTAX),
        ("fn a() -> i32 = || 1;", codes::SYNTAX),
        ("fn a() -> i32 { let with = 1; 2 }", codes::SYNTAX),
    ] {
        let found = codes_of(text);
        assert_eq!(found.iter().map(|(c, _)| *c).collect::<Vec<_>>(), [code], "{text}");
    }
}

#[test]
fn depth_is_bounded() {
    for text in [
        format!("fn a() -> i32 = {}1;", "1 + ".repeat(20_000)),
        format!("fn a() -> i32 = {}1;", "-".repeat(20_000)),
        format!("fn a() -> i32 = x{};", ".x".repeat(20_000)),
        format!("fn a() -> i32 = {}1;", "|x| ".repeat(20_000)),
        format!("fn a(x: {}i32) -> i32 = 1;", "fn() -> ".repeat(20_000)),
    ] {
        let found = codes_of(&text);
        assert_eq!(found.iter().map(|(c, _)| *c).collect::<Vec<_>>(), [codes::TOO_DEEP]);
    }
    let long = format!("fn a() -> i32 = {}1;", "1 + ".repeat(400));
    assert_eq!(codes_of(&long), []);
}
