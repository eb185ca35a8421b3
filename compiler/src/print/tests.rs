use super::*;
use crate::library::MODULES;
use crate::parse;
use crate::random::Random;
use crate::source::{SourceId, Span};
use crate::typed::{BinaryOp, UnaryOp};

fn file_of(text: &str) -> File {
    let parsed = parse::file(SourceId(0), text);
    assert_eq!(parsed.diagnostics, vec![], "{text}");
    parsed.tree
}

/// Printing is undone by parsing, and printed text is printed as it is.
fn round_trip(text: &str) -> String {
    let tree = file_of(text);
    let printed = file(&tree);
    let again = file_of(&printed);
    assert!(same_tree(&again, &tree), "{text}\n{printed}");
    assert_eq!(file(&again), printed);
    printed
}

fn expression_of(text: &str) -> Expr {
    let parsed = parse::expression(SourceId(0), text);
    assert_eq!(parsed.diagnostics, vec![], "{text}");
    parsed.tree
}

#[test]
fn parentheses_are_those_that_are_needed() {
    let same = [
        "a + b * c - d",
        "(a + b) * c",
        "a - (b - c)",
        "-(-a).x",
        "--a",
        "-(a + b)",
        "(a < b) == (c < d)",
        "a |> f |> |x| x + 1",
        "(|x| x)(1)",
        "(|x| x) |> f",
        "a + (|x| x) + b",
        "f(|x| x, 0..n, y: |(a | b), _: f32| -a)",
        "(0).x",
        "(1.5).x",
        "t.0.1",
        "(if a { b } else { c }) + d",
        "d + if a { b } else { c }",
        "(if a { b } else { c }).x",
        "[a, b][0]",
        "a with (x: 1, y: 2u)",
        "!a && (b || c)",
        "1e-7 + 0.1 + 1e30",
        "f(_, a)(b)",
    ];
    for text in same {
        let tree = expression_of(text);
        assert_eq!(expression(&tree), text);
    }
    let fewer = [
        ("((a)) + (b * c)", "a + b * c"),
        ("(a + b) + c", "a + b + c"),
        ("f((a), (b + c))", "f(a, b + c)"),
        ("{ a }", "a"),
        ("(-a) + (b.x)", "-a + b.x"),
        ("(|x| (x))", "|x| x"),
        ("0x10 + 1_000", "16 + 1000"),
    ];
    for (text, expected) in fewer {
        assert_eq!(expression(&expression_of(text)), expected);
    }
}

#[test]
fn lines_are_broken_where_they_are_long() {
    let text = "use terrain; use shade; use \"a/b.ghyll\"; const A = 1; const B: [f32; 2] = [1, 2.5];
        param p: f32 = 1.0 in 0.0..2.0; raster r: vec3;
        struct S<A>(a: A, b: [f32; 4]); enum E<A> { X(A, f32), Y } type T<A> = fn(A, (A, bool)) -> fn() -> A;
        @task @bake fn f<A, B>(x: A, _: Option<Option<A>>) -> B = g(x, _);
        fn g() -> i32 { let (a, S(b, c: _, ..)): T = 1; a with (b: 2) }
        fn long(first: vec3, second: vec3, third: vec3) -> f32 = dot(first, second) * dot(second, third) + dot(first, third) * 2.0;
        fn h(x: i32) -> i32 = match x { 1 | -2 if y => 3, A(0, ..) => { let b = 1; b } _ => fold(0..x, 0, |acc, i| { let d = acc; d + i }), };
        fn k(x: i32) -> i32 = if x < 2 { x } else if x < 3 { 2 } else { k(x - 1) };";
    let expected = "\
use terrain;
use shade;

use \"a/b.ghyll\";

const A = 1;
const B: [f32; 2] = [1, 2.5];

param p: f32 = 1.0 in 0.0..2.0;

raster r: vec3;

struct S<A>(a: A, b: [f32; 4]);

enum E<A> { X(A, f32), Y }

type T<A> = fn(A, (A, bool)) -> fn() -> A;

@task @bake fn f<A, B>(x: A, _: Option<Option<A>>) -> B = g(x, _);

fn g() -> i32 {
    let (a, S(b, c: _, ..)): T = 1;
    a with (b: 2)
}

fn long(first: vec3, second: vec3, third: vec3) -> f32 =
    dot(first, second) * dot(second, third) + dot(first, third) * 2.0;

fn h(x: i32) -> i32 = match x {
    1 | -2 if y => 3,
    A(0, ..) => {
        let b = 1;
        b
    }
    _ => fold(0..x, 0, |acc, i| {
        let d = acc;
        d + i
    }),
};

fn k(x: i32) -> i32 = if x < 2 { x } else if x < 3 { 2 } else { k(x - 1) };
";
    assert_eq!(round_trip(text), expected);
}

#[test]
fn library_modules_survive() {
    for (_, text) in MODULES {
        let printed = round_trip(text);
        assert!(printed.lines().all(|line| line.trim_end() == line), "{printed}");
    }
}

fn node(kind: ExprKind) -> Expr {
    Expr { kind, span: Span::new(SourceId(0), 0, 0), depth: 0 }
}

fn label(text: &str) -> Name {
    Name { text: text.into(), span: Span::new(SourceId(0), 0, 0) }
}

fn random_pattern(random: &mut Random, depth: usize) -> Pattern {
    let below = |random: &mut Random| random_pattern(random, depth.saturating_sub(1));
    let kind = match random.below(if depth == 0 { 7 } else { 10 }) {
        0 => PatternKind::Wild,
        1 => PatternKind::Name("a".into()),
        2 => PatternKind::Bool(true),
        3 => PatternKind::Int(random.below(9) as u64, random.below(2) == 0),
        4 => PatternKind::Uint(3),
        5 | 6 => PatternKind::Float([0.5, -1e-9, 3.0][random.below(3)]),
        7 => PatternKind::Tuple((0..2).map(|_| below(random)).collect()),
        8 => {
            let field = |random: &mut Random| FieldPattern {
                name: (random.below(2) == 0).then(|| label("x")),
                pattern: below(random),
            };
            let rest = [Rest::Absent, Rest::Present][random.below(2)];
            let count = random.below(3);
            PatternKind::Constructor(label("S"), (0..count).map(|_| field(random)).collect(), rest)
        }
        _ => PatternKind::Or((0..2).map(|_| below(random)).collect()),
    };
    Pattern { kind, span: Span::new(SourceId(0), 0, 0) }
}

const OPERATORS: &[Operator] = &[
    Operator::Pipe,
    Operator::Or,
    Operator::And,
    Operator::Plain(BinaryOp::Eq),
    Operator::Plain(BinaryOp::Gt),
    Operator::Plain(BinaryOp::BitOr),
    Operator::Plain(BinaryOp::BitXor),
    Operator::Plain(BinaryOp::BitAnd),
    Operator::Plain(BinaryOp::Shr),
    Operator::Plain(BinaryOp::Sub),
    Operator::Plain(BinaryOp::Div),
];

/// Any tree that the grammar can give.
fn random_tree(random: &mut Random, depth: usize) -> Expr {
    if depth == 0 {
        return node(match random.below(8) {
            0 => ExprKind::Bool(false),
            1 => ExprKind::Int(7),
            2 => ExprKind::Uint(7),
            3 => ExprKind::Float([1.0, 1e20, 1.5e-8][random.below(3)]),
            4 => ExprKind::Hole,
            _ => ExprKind::Name("a".into()),
        });
    }
    let below = |random: &mut Random| {
        let less = random.below(depth);
        random_tree(random, depth - 1 - less)
    };
    let boxed = |random: &mut Random| Box::new(below(random));
    let arguments = |random: &mut Random| {
        (0..random.below(3))
            .map(|_| match random.below(4) {
                0 => Argument { name: None, value: node(ExprKind::Range(boxed(random), boxed(random))) },
                1 => Argument { name: Some(label("x")), value: below(random) },
                _ => Argument { name: None, value: below(random) },
            })
            .collect::<Vec<_>>()
    };
    node(match random.below(15) {
        0 | 1 => ExprKind::Unary([UnaryOp::Neg, UnaryOp::Not][random.below(2)], boxed(random)),
        2..=4 => ExprKind::Binary(OPERATORS[random.below(OPERATORS.len())], boxed(random), boxed(random)),
        5 => ExprKind::Call(boxed(random), arguments(random)),
        6 => ExprKind::With(boxed(random), arguments(random)),
        7 => ExprKind::Field(boxed(random), label(["x", "0", "12"][random.below(3)])),
        8 => ExprKind::Index(boxed(random), boxed(random)),
        9 => ExprKind::Tuple(vec![below(random), below(random)]),
        10 => ExprKind::Array(vec![below(random); 1 + random.below(2)]),
        11 => {
            let ty = parse::file(SourceId(0), "type T = fn(A) -> [B<C>; 2];");
            let note = match &ty.tree[0] {
                Item::Alias(alias) if random.below(2) == 0 => Some(alias.ty.clone()),
                _ => None,
            };
            let param = LambdaParam { pattern: random_pattern(random, 2), ty: note };
            ExprKind::Lambda(vec![param; 1 + random.below(2)], boxed(random))
        }
        12 => {
            let branches = (0..1 + random.below(2)).map(|_| (below(random), below(random))).collect();
            ExprKind::If(branches, boxed(random))
        }
        13 => {
            let arm = |random: &mut Random| Arm {
                pattern: random_pattern(random, 2),
                guard: (random.below(3) == 0).then(|| below(random)),
                value: below(random),
            };
            ExprKind::Match(boxed(random), (0..random.below(3)).map(|_| arm(random)).collect())
        }
        _ => {
            let value = below(random);
            let bound = Let { pattern: random_pattern(random, 2), ty: None, value: below(random) };
            ExprKind::Block(vec![bound; 1 + random.below(2)], Box::new(value))
        }
    })
}

/// Random trees are not well typed, but they meet every construct below every other.
#[test]
fn random_trees_survive() {
    // Heights are counted by the parser.
    let without_height = |text: String| {
        let mut parts = text.split("depth: ");
        let first = parts.next().unwrap_or_default().to_owned();
        parts.fold(first, |all, part| all + part.trim_start_matches(|c: char| c.is_ascii_digit()))
    };
    for seed in 0..3000 {
        let tree = random_tree(&mut Random::new(seed), 5);
        let text = expression(&tree);
        let parsed = parse::expression(SourceId(0), &text);
        assert_eq!(parsed.diagnostics, vec![], "seed {seed}: {text}");
        assert_eq!(without_height(bare(&parsed.tree)), without_height(bare(&tree)), "seed {seed}: {text}");
    }
}

#[test]
fn other_trees_are_told_apart() {
    let trees: Vec<String> =
        ["a - (b - c)", "a - b - c", "-a.x", "(-a).x", "|x| x + 1", "(|x| x) + 1", "1", "1.0", "1u"]
            .iter()
            .map(|text| bare(&expression_of(text)))
            .collect();
    for (i, tree) in trees.iter().enumerate() {
        assert_eq!(trees.iter().position(|t| t == tree), Some(i));
    }
}
