//! Programs that are fine, and what their trees must say.

use super::*;
use crate::typed::{ExprKind, Literal, Type};

#[test]
fn tastes() {
    let fib = accepts(
        "fn fib(n: i32) -> i32 = if n < 2 { n } else { fib(n - 1) + fib(n - 2) };
        fn main(n: i32) -> i32 = fib(n);",
    );
    assert!(fib.module.function("fib").is_some());
    accepts(
        "use terrain;
        use shade;
        param detail: bool = false;
        param lighting: fn(Hit) -> vec3 = baked;
        fn rough(p: vec2) -> f32 = bilinear(p) + 4.0 * fbm(p / 60.0, 5);
        @task fn basic(ray: Ray) -> Option<Hit> = cast(bilinear, ray);
        @task fn detailed(ray: Ray) -> Option<Hit> = cast(rough, ray);
        @bake fn openness(p: vec2) -> f32 = ambient(bilinear, p, 64);
        fn baked(h: Hit) -> vec3 = hypsometric(h.at.z) * (0.2 + 0.8 * openness(h.at.xy));
        fn sunlit(h: Hit) -> vec3 = hypsometric(h.at.z) * lambert(bilinear, h);
        fn pixel(p: vec2) -> vec3 {
            let ray = camera(p);
            match if detail { detailed(ray) } else { basic(ray) } {
                Some(h) => lighting(h),
                None => sky(ray.dir),
            }
        }",
    );
}

#[test]
fn expressions() {
    for (ty, body) in [
        // Abstract literals
        ("f32", "1"),
        ("u32", "1"),
        ("f32", "2 * x + 1"),
        ("vec3", "2 * v / 3"),
        ("u32", "u + 1 << 3"),
        ("f32", "f32(1) + f32(n)"),
        ("u32", "u32(4000000000)"),
        ("i32", "-2147483648"),
        ("i32", "2147483647 + 1"),
        ("f32", "sqrt(2)"),
        ("f32", "{ let two = 2; two * x }"),
        ("i32", "{ let two = 2; two + n }"),
        ("vec3", "clamp(v, vec3(0), vec3(1))"),
        ("f32", "clamp(x, 0, 1)"),
        ("i32", "abs(-3)"),
        ("f32", "mix(0, 1, x)"),
        ("vec3", "mix(v, v, 0.5)"),
        ("vec3", "mix(v, v, v)"),
        // Vectors and matrices
        ("vec3", "m * v"),
        ("vec3", "v * m"),
        ("mat3", "m * m"),
        ("mat3", "2 * m"),
        ("mat3", "m * x + m"),
        ("vec4", "vec4(v, 1)"),
        ("vec4", "vec4(w, w)"),
        ("vec3", "vec3(0)"),
        ("ivec2", "iv * 2 + ivec2(1, n)"),
        ("mat2", "mat2(w, w) * mat2(1, 0, 0, 1)"),
        ("vec3", "v.zyx + v.bgr"),
        ("f32", "m[0][1] + v[n] + v[u]"),
        ("i32", "iv.x"),
        ("f32", "dot(v, v) + length(w) + length(x) + distance(v, v)"),
        ("vec3", "normalize(cross(v, v)) + reflect(v, v) + refract(v, v, 0.5)"),
        ("mat3", "transpose(m) * determinant(m)"),
        // Operators
        ("bool", "n < 2 && x >= 1 || !b"),
        ("bool", "v == v && (n, x) != (1, 2.0)"),
        ("bool", "b & !b | b ^ b"),
        ("i32", "n >> 3u & !n | 0xff ^ n % 7"),
        ("u32", "u >> n"),
        ("f32", "x % 2"),
        ("u32", "countOneBits(u) + bitcast_u32(x)"),
        ("i32", "select(1, 2, b)"),
        ("vec3", "-v"),
        // Forms
        ("f32", "sum(0..n, |i| f32(i))"),
        ("vec3", "sum(0..n, |i| v * f32(i))"),
        ("i32", "sum(0..3, |i| i)"),
        ("f32", "fold(0..n, 0, |acc, i| acc + x)"),
        ("f32", "fold(0..n, x, |acc: f32, i| max(acc, f32(i)))"),
        ("i32", "fold(0..3, 0, max)"),
        ("(i32, f32)", "fold(0..n, (0, 1.0), |(a, c), i| (a + i, c * x))"),
        ("bool", "any(0..n, |i| i == 2) && all(n..n + 1, |i| i > n)"),
        ("vec2", "grad(|p| p.x * p.y)(w)"),
        ("f32", "x |> deriv(sin)"),
        // Functions
        ("f32", "(|a| a + 1)(x)"),
        ("f32", "x |> sin |> max(_, 0) |> |a| a * 2"),
        ("f32", "{ let g = max(_, x); g(1) }"),
        ("fn(f32) -> f32", "max(_, x + 1)"),
        ("fn(f32, f32) -> f32", "clamp(_, _, 1.0)"),
        ("f32", "{ let apply = |g, a| g(a) + 1; apply(|c| c * x, x) }"),
        ("fn(f32) -> f32", "sin"),
        ("fn(f32, f32) -> vec2", "vec2"),
        ("fn(f32) -> Option<f32>", "Some"),
        // Tuples, arrays, patterns
        ("f32", "{ let t = (1, (x, v)); t.1.0 + t.1.1.x }"),
        ("f32", "{ let (a, (_, c)) = (x, (n, v)); a + c.y }"),
        ("[f32; 3]", "[1, 2.5, x]"),
        ("i32", "[1, 2, 3][n]"),
        ("i32", "match n { 0 => 1, -1 | 2 => 3, k if k > 5 => k, _ => 0 }"),
        ("i32", "match (b, Some(n)) { (true, Some(k)) => k, (false, _) => 0, (_, None) => 1 }"),
        ("i32", "match b { true => 1 , false => { 2 } }"),
        ("f32", "match Some(x) { Some(k) => { k } None => 0 }"),
        ("f32", "{ let sin = 3.0; sin }"),
        ("i32", "{ let n = n + 1; let n = n * 2; n }"),
        ("Option<Option<i32>>", "Some(None)"),
        ("i32", "if b { 1 } else if n > 2 { 2 } else { 3 }"),
        ("Option<f32>", "if b { None } else { Some(1) }"),
        ("i32", "{ let x: Option<i32> = None; match x { None => 0, Some(i) => i } }"),
    ] {
        accepts(&of_type(ty, body));
    }
}

#[test]
fn items() {
    for text in [
        // Order does not matter; constants may use each other and functions.
        "fn f() -> f32 = A; const A = B * 2; const B = g(1.5); fn g(x: f32) -> f32 = x;",
        "struct Ray(origin: vec3, dir: vec3, near: f32, far: f32);
        fn f(o: vec3) -> Ray = Ray(origin: o, far: 1e6, dir: o, near: 0) with (near: 2);
        fn g(r: Ray) -> f32 = match r { Ray(near: t, ..) => t };
        fn h(Ray: f32) -> f32 { let r = f; Ray }
        fn k() -> fn(vec3, vec3, f32, f32) -> Ray = Ray;
        fn l() -> fn(vec3) -> Ray = Ray(_, vec3(0), 0, 1);",
        "struct Pair<A, B>(a: A, b: B); type Same<A> = Pair<A, A>;
        fn f(p: Same<f32>) -> f32 = p.a + p.b; fn g() -> f32 = f(Pair(1, 2));
        fn swap<A, B>(p: Pair<A, B>) -> Pair<B, A> = Pair(p.b, p.a);
        fn h() -> bool = swap(swap(Pair(1, true))).b;",
        "fn map<A, B>(x: Option<A>, f: fn(A) -> B) -> Option<B> = match x { Some(a) => Some(f(a)), None => None };
        fn f(x: Option<vec3>) -> Option<f32> = map(x, |v| v.x);",
        "enum Shape { Disc(f32), Box(f32, f32), Point } type S = Shape;
        fn area(s: S) -> f32 = match s { Disc(r) => r * r, Box(a, b) => a * b, Point => 0 };
        fn same(a: S, b: S) -> bool = a == b;",
        // Names of built-ins can be taken.
        "fn sum(a: f32, b: f32) -> f32 = a + b; fn f() -> f32 = sum(1, 2); fn length(x: f32) -> f32 = x;",
        "use terrain; fn noise(p: vec2) -> f32 = p.x; fn f() -> f32 = noise(vec2(1, 2));",
        // The prelude's Option may be written out, or be something else.
        "use terrain; enum Option<T> { Some(T), None }
        fn f(r: Ray) -> Option<f32> = match trace(bilinear, r) { Some(t) => Some(t), None => None };",
        "enum Option { Maybe, None } fn f(o: Option) -> bool = match o { Maybe => true, None => false };",
        "param k: f32 = 1 in 0..10; param n: i32 = 3; param pick: fn(f32) -> f32 = |x| x * k; fn f() -> f32 = pick(k);",
        "raster satellite: vec3; fn f(p: vec2) -> vec3 = satellite(p); fn g() -> fn(vec2) -> vec3 = satellite;",
        "const N = 2 * 2; const T: [f32; N] = [1, 2, 3, 4]; fn f(a: [f32; N]) -> f32 = a[1] + T[0];",
        "fn even(n: i32) -> bool = n == 0 || odd(n - 1); fn odd(n: i32) -> bool = n != 0 && even(n - 1);",
        // A slot whose default calls the slot.
        "param step: fn(i32) -> i32 = down; fn down(n: i32) -> i32 = if n == 0 { 0 } else { step(n - 1) };",
        // Type arguments that go round without growing.
        "fn f<A, B>(a: A, b: B, n: i32) -> i32 = if n == 0 { 0 } else { f(b, a, n - 1) };",
        "fn f<A>(a: A, n: i32) -> i32 = if n == 0 { 0 } else { g((a, a), n) }; fn g<A>(a: A, n: i32) -> i32 = f(1, n);",
        "use terrain; use shade; @bake fn a(p: vec2) -> (vec3, f32) = (vec3(0), 1);",
        "/// doc\nfn f(_: i32, _: i32) -> i32 = 1; // end",
        "",
    ] {
        accepts(text);
    }
}

/// The body of the function `f`.
fn body(text: &str) -> (ExprKind, Type) {
    let checked = accepts(text);
    let id = checked.module.function("f").expect("the test defines it");
    let body = checked.module.functions[id.0 as usize].body.clone();
    (body.kind, body.ty)
}

#[test]
fn literals_have_their_final_type() {
    let literal = |ty: &str, text: &str| match body(&format!("fn f() -> {ty} = {text};")).0 {
        ExprKind::Literal(l) => l,
        other => panic!("{other:?}"),
    };
    assert_eq!(literal("i32", "-2147483648"), Literal::I32(i32::MIN));
    assert_eq!(literal("u32", "0xffffffff"), Literal::U32(u32::MAX));
    assert_eq!(literal("f32", "-3"), Literal::F32(-3.0));
    assert_eq!(literal("f32", ".5"), Literal::F32(0.5));
}

#[test]
fn swizzles_and_fields_are_told_apart() {
    let kind = |text: &str| format!("{:?}", body(text).0);
    assert!(kind("fn f(v: vec3) -> vec2 = v.zx;").contains("[2, 0]"));
    assert!(kind("struct S(x: f32, xy: f32); fn f(s: S) -> f32 = s.xy;").starts_with("Field"));
    // Also where the type is found later.
    assert!(kind("fn f() -> f32 = (|v, w: vec3| v.x + w.x)(vec2(1), vec3(1));").contains("Swizzle"));
}

#[test]
fn shift_counts_take_the_type_of_what_is_shifted() {
    let (ExprKind::Binary(_, l, r), _) = body("fn f(n: i32, u: u32) -> i32 = n << u;") else { panic!() };
    assert_eq!((l.ty, r.ty), (Type::I32, Type::I32));
}

#[test]
fn holes_keep_what_is_given() {
    let (kind, _) = body("fn f(x: f32) -> fn(f32) -> f32 = max(x * 2, _);");
    let ExprKind::Block(lets, value) = kind else { panic!("{kind:?}") };
    assert_eq!(lets.len(), 1);
    assert!(matches!(value.kind, ExprKind::Lambda(..)));
    // A name needs no keeping.
    assert!(matches!(body("fn f(x: f32) -> fn(f32) -> f32 = max(x, _);").0, ExprKind::Lambda(..)));
}

#[test]
fn warnings_do_not_fail_a_program() {
    let checked = accepts("fn f(b: bool) -> i32 = match b { true => 1, _ => 2, false => 3 };");
    let codes: Vec<_> = checked.warnings.iter().map(|w| w.code).collect();
    assert_eq!(codes, [crate::codes::UNREACHABLE_ARM]);
}
