//! Each construct of the language nested, repeated and multiplied with others.

use super::texts::{Text, chain, count, grown, numbered, text};

/// A word for every number, as texts take numbers for `#`.
fn repeated(n: usize, piece: impl Fn(usize) -> String) -> String {
    (0..n).map(piece).collect()
}

/// Function values in functions, variants, structs and arrays.
pub fn functions(bytes: usize) -> Vec<Text> {
    let mut all = vec![
        chain(
            "functions that yield functions of the last",
            "fn f0(n: i32) -> fn(i32) -> i32 = |y| y + n;",
            "fn f#(n: i32) -> fn(i32) -> i32 = |y| f%(n)(y) + #;\n",
            "fn main(n: i32) -> i32 = f$(n)(n);",
            bytes,
        ),
        grown(
            "functions that yield functions of the last twice",
            "fn f0(n: i32) -> fn(i32) -> i32 = |y| y + n;",
            "fn f#(n: i32) -> fn(i32) -> i32 = |y| f%(n)(y) + f%(y)(#);\n",
            "fn main(n: i32) -> i32 = f$(n)(n);",
            60,
        ),
        chain(
            "variants of functions",
            "enum F { A(fn(i32) -> i32), B(fn(i32) -> i32, i32), C } fn call(f: F, n: i32) -> i32 = match f { A(g) => g(n), B(g, k) => g(n + k), C => n };\nfn main(n: i32) -> i32 { let a0 = C; ",
            "let a# = if n > # { A(|x| x + n) } else { B(|x| call(a%, x), #) }; ",
            "call(a$, n) }",
            bytes,
        ),
        chain(
            "variants of functions, each called",
            "enum F { A(fn(i32) -> i32), C } fn call(f: F, n: i32) -> i32 = match f { A(g) => g(n), C => n };\nfn main(n: i32) -> i32 { let a0 = n; ",
            "let a# = call(if n > # { A(|x| x + a%) } else { C }, a%); ",
            "a$ }",
            bytes,
        ),
        chain(
            "an array of functions",
            "fn main(n: i32) -> i32 = [",
            "|x: i32| x * # + n, ",
            "|x: i32| x][n](n);",
            bytes,
        ),
        chain(
            "an array of top-level functions",
            "fn f0(n: i32) -> i32 = n;\n",
            "fn f#(n: i32) -> i32 = n * # + 1;\n",
            "fn main(n: i32) -> i32 = [f0, f$, f1, f2][n](n);",
            bytes,
        ),
        chain(
            "structs of functions updated",
            "struct S(f: fn(i32) -> i32, n: i32); fn main(n: i32) -> i32 { let s0 = S(|x| x, n); ",
            "let s# = s% with (f: if n > # { |x: i32| x + n } else { s%.f }); ",
            "(s$.f)(n) }",
            bytes,
        ),
        chain(
            "generic functions that pass functions on",
            "fn f0<A>(x: A, g: fn(A) -> A) -> A = g(x);",
            "fn f#<A>(x: A, g: fn(A) -> A) -> A = f%(g(x), g);\n",
            "fn main(n: i32) -> i32 = f$(n, |x| x + n);",
            bytes,
        ),
        chain(
            "generic functions that pass new functions on",
            "fn f0<A>(x: A, g: fn(A) -> A) -> A = g(x);",
            "fn f#<A>(x: A, g: fn(A) -> A) -> A = f%(x, |y| g(g(y)));\n",
            "fn main(n: i32) -> i32 = f$(n, |x| x + n);",
            bytes,
        ),
        chain(
            "one function of many functions",
            "fn twice(f: fn(i32) -> i32, n: i32) -> i32 = f(f(n)); fn main(n: i32) -> i32 { let a0 = n; ",
            "let a# = twice(|x| x + a%, n); ",
            "a$ }",
            bytes,
        ),
        chain(
            "a recursive function of many functions",
            "fn times(f: fn(i32) -> i32, k: i32, n: i32) -> i32 = if k < 1 { n } else { times(f, k - 1, f(n)) }; fn main(n: i32) -> i32 { let a0 = n; ",
            "let a# = times(|x| x + a%, #, n); ",
            "a$ }",
            bytes,
        ),
        chain(
            "function parameters of the host",
            "fn g0(n: i32) -> i32 = n;\n",
            "fn g#(n: i32) -> i32 = n + #; param p#: fn(i32) -> i32 = g#;\n",
            "fn main(n: i32) -> i32 = p$(p1(n));",
            bytes,
        ),
        chain(
            "holes",
            "fn f(",
            "a#: i32, ",
            &format!(
                "z: i32) -> i32 = z; fn main(n: i32) -> i32 {{ let g = f({} n); g(1) }}",
                "_, ".repeat(bytes / 6)
            ),
            bytes / 2,
        ),
        chain(
            "holes of holes",
            "fn f(a: i32, b: i32) -> i32 = a * b; fn main(n: i32) -> i32 { let a0 = f(_, n); ",
            "let h# = f(_, a%(#)); let a# = h#; ",
            "a$(n) }",
            bytes,
        ),
        chain(
            "functions equal to themselves in circles",
            "fn f0(n: i32, g: fn(i32) -> i32) -> i32 = g(n);",
            "fn f#(n: i32, g: fn(i32) -> i32) -> i32 = if n < # { g(n) } else { f%(n - 1, |x| x + #) };\n",
            "fn main(n: i32) -> i32 = f$(n, |x| x);",
            bytes,
        ),
        text("choices at many places", {
            let n = 60.min(bytes / 1000);
            let makers = repeated(n, |i| {
                format!(
                    "fn m{i}(n: i32) -> fn(i32) -> i32 = if n > {i} {{ |x| x + {i} }} else {{ |x| x * n }};\n"
                )
            });
            let pairs = repeated(n, |i| {
                repeated(n, |j| format!("let a = (if a > {i} {{ m{i}(a) }} else {{ m{j}(n) }})(a); "))
            });
            format!("{makers} fn main(n: i32) -> i32 {{ let a = n; {pairs} a }}")
        }),
        text("mutual recursion through values", {
            let n = bytes / 160;
            let each = repeated(n, |i| {
                format!(
                    "fn f{i}(n: i32, k: fn(i32) -> i32) -> i32 = if n < {i} {{ k(n) }} else {{ f{}(n - 1, |x| k(x) + {i}) }};\n",
                    (i + 1) % n
                )
            });
            format!("{each} fn main(n: i32) -> i32 = f0(n, |x| x);")
        }),
    ];
    for n in [4, 16, 64] {
        let inner = (0..n).rev().fold(String::from("a0 + n"), |body, i| {
            format!("(|a{i}: i32| if a{i} > {i} {{ |b{i}: i32| {body} + b{i} }} else {{ |c{i}: i32| c{i} * a{i} }})(n)(n)")
        });
        all.push(text(
            format!("chosen closures in closures, {n}"),
            format!("fn main(n: i32) -> i32 = {inner};"),
        ));
    }
    all
}

/// Derivatives and bounds.
pub fn slopes(bytes: usize) -> Vec<Text> {
    let body = numbered("let a# = sin(a%) * a% + #.5 / x; ", bytes);
    let last = count("let a# = sin(a%) * a% + #.5 / x; ", bytes);
    let long = format!("fn f(x: f32) -> f32 {{ let a0 = x; {body} a{last} }}\n");
    let plane = format!(
        "use terrain; fn s(p: vec2) -> f32 {{ let a0 = bilinear(p); {} a{last} }}\n",
        numbered("let a# = sin(a%) * a% + #.5 * p.x; ", bytes).replace("p.x; ", "p.x;\n")
    );
    let plane_last = count("let a# = sin(a%) * a% + #.5 * p.x; ", bytes);
    let plane = plane.replace(&format!("a{last} }}"), &format!("a{plane_last} }}"));
    let arms = numbered("# => x * #.5, ", bytes);
    let mut all = vec![
        text("the derivative of a long function", format!("{long} fn main(x: f32) -> f32 = deriv(f)(x);")),
        text(
            "the third derivative of a long function",
            format!("{long} fn main(x: f32) -> f32 = deriv(deriv(deriv(f)))(x);"),
        ),
        text(
            "the gradient of the gradient of a long surface",
            format!("{plane} fn main(x: f32) -> f32 = grad(|p| grad(s)(p).x)(vec2(x)).y;"),
        ),
        text(
            "the gradient of a match of many arms",
            format!(
                "fn f(x: f32) -> f32 = match i32(x) {{ {arms} _ => x }}; fn main(x: f32) -> f32 = deriv(f)(x);"
            ),
        ),
        text(
            "derivatives of many lambdas",
            format!(
                "fn main(x: f32) -> f32 {{ let a0 = x; {} x }}",
                numbered("let a# = deriv(|y| y * y * a%)(x); ", bytes)
            ),
        ),
        text(
            "the derivative of a loop of a large state",
            format!(
                "fn f(x: f32) -> f32 = fold(0..9, ({} x), |s, i| ({} s.0)).0; fn main(x: f32) -> f32 = deriv(f)(x);",
                "x, ".repeat(900),
                (1..=900).map(|i| format!("s.{i} * s.0, ")).collect::<String>()
            ),
        ),
        text(
            "rays to a long surface",
            format!(
                "{plane} fn pixel(p: vec2) -> f32 = match cast(s, camera(p)) {{ Some(h) => h.distance, None => 0.0 }};"
            ),
        ),
        text(
            "shadows of a long surface",
            format!(
                "{plane} fn main(x: f32) -> bool = occluded(s, Ray(vec3(x), vec3(1.0, x, x), 0.0, 9.0));"
            ),
        ),
        text(
            "rays to many surfaces",
            format!(
                "use terrain; {} fn pixel(p: vec2) -> f32 {{ {} 1.0 }}",
                numbered("fn s#(p: vec2) -> f32 = bicubic(p) + #.5 * noise(p);\n", bytes / 2),
                repeated(
                    count("fn s#(p: vec2) -> f32 = bicubic(p) + #.5 * noise(p);\n", bytes / 2),
                    |i| format!("let o{i} = occluded(s{}, camera(p)); ", i + 1)
                )
            ),
        ),
        chain(
            "derivatives of the last in branches",
            "fn f0(x: f32) -> f32 = x * x;",
            "fn f#(x: f32) -> f32 = if x > #.0 { deriv(f%)(x) } else { f%(x * 2.0) };\n",
            "fn main(x: f32) -> f32 = f$(x);",
            bytes,
        ),
        grown(
            "some derivatives of the last in branches",
            "fn f0(x: f32) -> f32 = x * x;",
            "fn f#(x: f32) -> f32 = if x > #.0 { deriv(f%)(x) } else { f%(x * 2.0) };\n",
            "fn main(x: f32) -> f32 = f$(x);",
            60,
        ),
        grown(
            "rays to surfaces of two of the last",
            "use terrain; fn s0(p: vec2) -> f32 = bilinear(p);",
            "fn s#(p: vec2) -> f32 = s%(p) + s%(p * 2.0);\n",
            "fn pixel(p: vec2) -> f32 = match trace(s$, camera(p)) { Some(t) => t, None => 0.0 };",
            60,
        ),
        grown(
            "rays to surfaces of gradients",
            "use terrain; fn s0(p: vec2) -> f32 = bicubic(p);",
            "fn s#(p: vec2) -> f32 = s%(p) + length(grad(s%)(p));\n",
            "fn pixel(p: vec2) -> f32 = match trace(s$, camera(p)) { Some(t) => t, None => 0.0 };",
            20,
        ),
        grown(
            "surfaces that trace the last",
            "use terrain; fn s0(p: vec2) -> f32 = bilinear(p);",
            "fn s#(p: vec2) -> f32 = match trace(s%, camera(p)) { Some(t) => t, None => s%(p) };\n",
            "fn pixel(p: vec2) -> f32 = s$(p);",
            30,
        ),
        text(
            "a surface of many branches",
            format!(
                "use terrain; fn s(p: vec2) -> f32 {{ let a0 = bilinear(p); {} a{} }} fn pixel(p: vec2) -> f32 = match cast(s, camera(p)) {{ Some(h) => h.distance, None => 0.0 }};",
                numbered("let a# = if p.x > #.0 { a% + 1.0 } else { a% * p.y }; ", bytes),
                count("let a# = if p.x > #.0 { a% + 1.0 } else { a% * p.y }; ", bytes)
            ),
        ),
        text(
            "a surface of many loops",
            format!(
                "use terrain; fn s(p: vec2) -> f32 {{ let a0 = bilinear(p); {} a{} }} fn pixel(p: vec2) -> f32 = match cast(s, camera(p)) {{ Some(h) => h.distance, None => 0.0 }};",
                numbered("let a# = fold(0..9, a%, |s, i| s + sin(s)); ", bytes),
                count("let a# = fold(0..9, a%, |s, i| s + sin(s)); ", bytes)
            ),
        ),
    ];
    for n in [4, 8, 16, 64] {
        all.push(text(
            format!("derivatives of derivatives in place, {n}"),
            format!(
                "fn f(x: f32) -> f32 = sin(x * x) * exp(x) / (x + 1.0); fn main(x: f32) -> f32 = {}f{}(x);",
                "deriv(".repeat(n),
                ")".repeat(n)
            ),
        ));
    }
    all
}

/// Loops, constants, large values.
pub fn values(bytes: usize) -> Vec<Text> {
    let tuple = |n: usize, item: &dyn Fn(usize) -> String| {
        format!("({})", (0..n).map(item).collect::<Vec<_>>().join(", "))
    };
    let row = |n: usize| (0..n).map(|i| i.to_string()).collect::<Vec<_>>().join(", ");
    vec![
        text(
            "loops in loops of a large state",
            format!(
                "fn main(n: i32) -> i32 = fold(0..n, {}, |s, i| fold(0..i, s, |t, j| fold(0..j, t, |u, k| {}))).0;",
                tuple(500, &|i| format!("n + {i}")),
                tuple(500, &|i| format!("u.{} + u.{}", (i + 1) % 500, (i + 7) % 500))
            ),
        ),
        chain(
            "many loops of a large state",
            &format!("fn main(n: i32) -> i32 {{ let a0 = {}; ", tuple(200, &|i| format!("n + {i}"))),
            "let a# = fold(0..n, a%, |s, i| if s.0 > i { s } else { a0 }); ",
            "a$.0 }",
            bytes,
        ),
        chain(
            "branches of a large value",
            &format!(
                "fn main(n: i32) -> i32 {{ let a0 = {}; let b = {}; ",
                tuple(200, &|i| format!("n + {i}")),
                tuple(200, &|i| format!("n * {i}"))
            ),
            "let a# = if n > # { a% } else { b }; ",
            "a$.0 + a$.199 }",
            bytes,
        ),
        chain(
            "branches of large arrays by an index",
            &format!("fn main(n: i32) -> i32 {{ let a0 = [{}]; ", row(1000)),
            "let a# = if n > # { a% } else { a0 }; ",
            "a$[n] }",
            bytes,
        ),
        chain(
            "indices of indices",
            &format!("fn main(n: i32) -> i32 {{ let a = [{}]; let a0 = n; ", row(1000)),
            "let a# = a[a% + #]; ",
            "a$ }",
            bytes,
        ),
        chain(
            "arrays of arrays",
            "fn main(n: i32) -> i32 { let a0 = n; ",
            "let a# = [[[a%, n], [n, #]], [[a%, 1], [2, 3]]][n][a%][n]; ",
            "a$ }",
            bytes,
        ),
        chain(
            "products of matrices",
            "fn main(x: f32) -> f32 { let m0 = mat4(x); ",
            "let m# = m% * m%; ",
            "m$[1].x }",
            bytes,
        ),
        chain(
            "determinants",
            "fn main(x: f32) -> f32 { let m0 = mat4(x); ",
            "let m# = transpose(m% * determinant(m%)); ",
            "m$[1].x }",
            bytes,
        ),
        chain(
            "columns by an index",
            "fn main(x: f32, n: i32) -> f32 { let m0 = mat4(x); ",
            "let m# = mat4(m%[n], m%[n + 1], m%[#], m%[0]); ",
            "m$[1].x }",
            bytes,
        ),
        chain(
            "components of components",
            "fn main(v: vec4) -> f32 { let v0 = v; ",
            "let v# = v%.wzyx + v%.xxyy.zwzw.rgba; ",
            "v$.x }",
            bytes,
        ),
        chain(
            "reflections",
            "fn main(v: vec3) -> f32 { let v0 = v; ",
            "let v# = normalize(reflect(v%, cross(v, v%))) + refract(v%, v, 0.5); ",
            "v$.x }",
            bytes,
        ),
        chain(
            "wide updates",
            &format!(
                "struct S({} z: i32); fn main(n: i32, s: S) -> i32 {{ let s0 = s; ",
                repeated(1000, |i| format!("f{i}: i32, "))
            ),
            "let s# = s% with (f1: s%.f2 + #, f2: s%.f3, f999: n, z: #); ",
            "s$.f1 }",
            bytes,
        ),
        text(
            "an update of each field",
            format!(
                "struct S({} z: i32); fn main(n: i32, s: S) -> i32 = (s with ({} z: n)).f7;",
                repeated(4000, |i| format!("f{i}: i32, ")),
                repeated(4000, |i| format!("f{i}: s.z + {i}, "))
            ),
        ),
        text(
            "a field that is misspelt in a wide struct",
            format!(
                "struct S({} z: i32); fn main(s: S) -> i32 {{ {} 1 }}",
                repeated(4000, |i| format!("field_of_a_wide_struct_{i}: i32, ")),
                repeated(bytes / 60, |i| format!("let a{i} = s.field_of_a_wide_struct_x{i}; "))
            ),
        ),
        text(
            "a constant loop of a large state",
            format!(
                "const A = fold(0..2147483647, {}, |s, i| (s.1, {} s.0)); fn main() -> i32 = A.0;",
                tuple(2000, &|i| i.to_string()),
                repeated(1998, |i| format!("s.{}, ", i + 2))
            ),
        ),
        text(
            "a constant loop over an array",
            format!(
                "const T = [{}]; const A = fold(0..2147483647, 0, |s, i| s + T[s + i]); fn main() -> i32 = A;",
                row(4000)
            ),
        ),
        text(
            "a constant of a deep recursion",
            "fn f(n: i32) -> i32 = if n < 1 { 0 } else { 1 + f(n - 1) }; const A = f(100000000); fn main() -> i32 = A;",
        ),
        text(
            "a constant of a wide recursion",
            "fn f(n: i32) -> i32 = if n < 2 { n } else { f(n - 1) + f(n - 2) }; const A = f(60); fn main() -> i32 = A;",
        ),
        text(
            "a constant of an option that grows",
            "fn f(n: i32, o: Option<(i32, i32)>) -> i32 = match o { Some((a, b)) if n > 0 => f(n - 1, Some((b, a + b))), _ => n }; const A = f(2000000000, Some((1, 1))); fn main() -> i32 = A;",
        ),
        chain(
            "constants of loops",
            "const A0 = 1;",
            "const A# = fold(0..1000000, A%, |s, i| s * 3 + i);\n",
            "fn main() -> i32 = A$;",
            bytes,
        ),
        chain(
            "constants of arrays",
            "const A0 = [1, 2, 3];",
            "const A# = [A%[1], A%[2], A%[0] + #];\n",
            "fn main(n: i32) -> i32 = A$[n];",
            bytes,
        ),
        chain(
            "tables in many functions",
            &format!("const T = [{}];", row(4000)),
            "fn f#(n: i32) -> i32 = T[n + #];\n",
            "fn main(n: i32) -> i32 = f$(n) + f1(n);",
            bytes,
        ),
        text(
            "a table read at many places",
            format!(
                "const T = [{}]; fn main(n: i32) -> i32 {{ let a0 = n; {} n }}",
                row(4000),
                numbered("let a# = T[a% + n]; ", bytes)
            ),
        ),
        text(
            "a table read at many places, used",
            format!(
                "const T = [{}]; fn main(n: i32) -> i32 {{ let a0 = n; {} a{} }}",
                row(4000),
                numbered("let a# = T[a% + n]; ", bytes),
                count("let a# = T[a% + n]; ", bytes)
            ),
        ),
        text(
            "sums of large arrays",
            format!(
                "fn main(n: i32) -> i32 = sum(0..n, |i| [{}][i]) + sum(0..n, |i| sum(0..i, |j| [{}][j]));",
                row(4000),
                row(4000)
            ),
        ),
        text("operators of every kind", {
            let operators = ["+", "-", "*", "/", "%", "&", "|", "^", "<<", ">>"];
            format!(
                "fn main(n: i32) -> i32 {{ let a0 = n; {} a0 }}",
                repeated(bytes / 1200, |_| {
                    let terms: Vec<String> =
                        (0..200).map(|i| format!("n {}", operators[i * 7 % 10])).collect();
                    format!("let a0 = {} a0; ", terms.join(" "))
                })
            )
        }),
    ]
}

/// Tasks, bakes, rasters, parameters and pictures.
pub fn networks(bytes: usize) -> Vec<Text> {
    let third = bytes / 3;
    let live = "let a# = n * # + n; ";
    let lives = numbered(live, third);
    let lived = count(live, third);
    vec![
        chain(
            "tasks of a picture",
            "@task fn t0(x: f32) -> f32 = x;",
            "@task fn t#(x: f32) -> f32 = t%(x) + #.0;\n",
            "fn pixel(p: vec2) -> f32 = t$(p.x);",
            bytes,
        ),
        chain(
            "tasks of a picture in last place",
            "@task fn t0(x: f32) -> f32 = x;",
            "@task fn t#(x: f32) -> f32 = t%(x + #.0);\n",
            "fn pixel(p: vec2) -> f32 = t$(p.x);",
            bytes,
        ),
        chain(
            "branches of tasks of a picture",
            "@task fn t0(x: f32) -> f32 = x;",
            "@task fn t#(x: f32) -> f32 = if x > #.0 { t%(x) } else { t0(x) };\n",
            "fn pixel(p: vec2) -> f32 = t$(p.x);",
            bytes,
        ),
        grown(
            "doubling tasks of a picture",
            "@task fn t0(x: f32) -> f32 = x;",
            "@task fn t#(x: f32) -> f32 = t%(x) + t%(x + 1.0);\n",
            "fn pixel(p: vec2) -> f32 = t$(p.x);",
            60,
        ),
        grown(
            "tasks of a picture at many depths",
            "@task fn t0(x: f32, y: f32) -> f32 = x + y;",
            "@task fn t#(x: f32, y: f32) -> f32 = t%(t%(x, y), t%(y, t%(x, #.0)));\n",
            "fn pixel(p: vec2) -> f32 = t$(p.x, p.y);",
            14,
        ),
        text(
            "a picture of many tasks",
            format!(
                "@task fn t(x: f32) -> f32 = x + 1.0; fn pixel(p: vec2) -> f32 {{ let a0 = p.x; {} a{} }}",
                numbered("let a# = t(a%) + #.0; ", bytes),
                count("let a# = t(a%) + #.0; ", bytes)
            ),
        ),
        text(
            "a picture of many tasks at once",
            format!(
                "@task fn t(x: f32) -> f32 = x + 1.0; fn pixel(p: vec2) -> f32 {{ let a0 = p.x; {} {} 0.0 }}",
                numbered("let a# = t(p.x + #.0); ", bytes / 2),
                numbered("a# + ", bytes / 4).split_inclusive("+ ").take(400).collect::<String>()
            ),
        ),
        text(
            "much that lives across tasks",
            format!(
                "@task fn t(n: i32) -> i32 = n; fn main(n: i32) -> i32 {{ let b0 = n; {lives} {} {} b1 }}",
                numbered("let b# = t(b%); ", third),
                repeated(lived, |i| format!("let b1 = b1 + a{}; ", i + 1))
            ),
        ),
        text(
            "much that lives across branches of tasks",
            format!(
                "@task fn t(n: i32) -> i32 = n; fn main(n: i32) -> i32 {{ let b0 = n; {lives} {} {} b1 }}",
                numbered("let b# = if b% > # { t(b%) } else { b% * 3 }; ", third),
                repeated(lived, |i| format!("let b1 = b1 + a{}; ", i + 1))
            ),
        ),
        text("many loops in each other with something to hoist in each", {
            let opening: String = (1..60)
                .rev()
                .map(|k| format!("fold(0..n + {k}, s, |s, i| {{ let s = s + n * {k} + n / {k}; "))
                .collect();
            let nest = format!("{opening}s + i{}", " })".repeat(59));
            let line = |_| format!("let s = {nest}; ");
            format!("fn main(n: i32) -> i32 {{ let s = 0; {} s }}", repeated(bytes / (nest.len() + 10), line))
        }),
        text(
            "arms with guards of tasks",
            format!(
                "@task fn t(n: i32) -> bool = n > 3; fn main(n: i32) -> i32 = match n {{ {} _ => 0 }};",
                numbered("k if t(k + #) => #, ", bytes)
            ),
        ),
        text(
            "arms with guards of calls",
            format!(
                "fn t(n: i32) -> bool = if n > 3 {{ t(n - 1) }} else {{ n < 2 }}; fn main(n: i32) -> i32 = match n {{ {} _ => 0 }};",
                numbered("# if t(n + #) => #, ", bytes)
            ),
        ),
        text("a long and of tasks", {
            let tests: Vec<String> = (0..400).map(|i| format!("t(n + {i})")).collect();
            let line = tests.join(" && ");
            format!(
                "@task fn t(n: i32) -> bool = n > 3; fn main(n: i32) -> i32 {{ {} n }}",
                repeated(bytes / (line.len() + 40), |_| format!(
                    "let n = if {line} {{ n + 1 }} else {{ n }}; "
                ))
            )
        }),
        grown(
            "bakes of two of the last",
            "@bake fn b0(p: vec2) -> f32 = p.x;",
            "@bake fn b#(p: vec2) -> f32 = b%(p) + b%(p * 2.0);\n",
            "fn pixel(p: vec2) -> f32 = b$(p);",
            60,
        ),
        chain(
            "bakes of many bakes",
            "@bake fn b0(p: vec2) -> f32 = p.x;",
            "@bake fn b#(p: vec2) -> vec4 = vec4(b0(p), p, #.0);\n",
            "fn pixel(p: vec2) -> vec4 = b$(p) + b1(p);",
            bytes,
        ),
        chain(
            "rasters of every kind",
            "use terrain;",
            "raster r#: vec4; raster s#: f32; fn f#(p: vec2) -> vec4 = r#(p) * s#(p);\n",
            "fn pixel(p: vec2) -> vec4 = f$(p) + f1(p);",
            bytes,
        ),
        text("many rasters, all read", {
            let piece = "raster r#: f32;\n";
            let n = count(piece, third);
            format!(
                "{} fn pixel(p: vec2) -> f32 {{ let a = 0.0; {} a }}",
                numbered(piece, third),
                repeated(n, |i| format!("let a = a + r{}(p); ", i + 1))
            )
        }),
        text("many parameters with ranges, all read", {
            let piece = "param p#: f32 = #.5 in 0.0..1e9;\n";
            let n = count(piece, third);
            format!(
                "{} fn pixel(p: vec2) -> f32 {{ let a = 0.0; {} a }}",
                numbered(piece, third),
                repeated(n, |i| format!("let a = a + p{}; ", i + 1))
            )
        }),
        chain(
            "slots of the host",
            "use terrain; use shade;",
            "param p#: fn(Hit) -> vec3 = c#; fn c#(h: Hit) -> vec3 = h.at * #.0;\n",
            "fn pixel(p: vec2) -> vec3 = match cast(bilinear, camera(p)) { Some(h) => p$(h) + p1(h), None => vec3(0.0) };",
            bytes,
        ),
        chain(
            "a library program many times",
            "use terrain; use shade; fn pixel(p: vec2) -> vec3 { let c0 = vec3(p, 1.0); ",
            "let c# = lit(c%, ambient(bilinear, p + c%.xy, 8), normal(bicubic, p * #.0)); ",
            "c$ }",
            bytes,
        ),
        text(
            "a loop of tasks of a large state",
            format!(
                "@task fn t(n: i32) -> i32 = n; fn main(n: i32) -> i32 = fold(0..n, ({} n), |s, i| ({} t(s.0))).0;",
                "n, ".repeat(400),
                (0..400).map(|i| format!("t(s.{}), ", i + 1)).collect::<String>()
            ),
        ),
        text(
            "loops of tasks in each other",
            format!(
                "@task fn t(n: i32) -> i32 = n; fn main(n: i32) -> i32 = {}t(n){};",
                (0..60).map(|i| format!("fold(0..n, {i}, |s{i}, i{i}| s{i} + ")).collect::<String>(),
                ")".repeat(60)
            ),
        ),
    ]
}

/// Modules in files; each after the first begins with a line [`MODULE`] and its name.
pub const MODULE: &str = "\n//// module ";

/// Names, modules, types.
pub fn names(bytes: usize) -> Vec<Text> {
    let long = "n".repeat(bytes / 400);
    let longer = "n".repeat(bytes / 40);
    let files = |n: usize, uses: &dyn Fn(usize) -> String, item: &dyn Fn(usize) -> String| {
        repeated(n, |i| format!("{MODULE}m{i}.ghyll\n{} {}\n", uses(i), item(i)))
    };
    let n = (bytes / 80).min(999);
    vec![
        text(
            "modules in a chain",
            format!(
                "use \"m0.ghyll\"; fn main(n: i32) -> i32 = f0(n);{}",
                files(
                    n,
                    &|i| if i + 1 < n { format!("use \"m{}.ghyll\";", i + 1) } else { String::new() },
                    &|i| if i + 1 < n {
                        format!("fn f{i}(n: i32) -> i32 = f{}(n) + 1;", i + 1)
                    } else {
                        format!("fn f{i}(n: i32) -> i32 = n;")
                    }
                )
            ),
        ),
        text("modules that all use each other", {
            let n = 100.min(bytes / 2000);
            format!(
                "use \"m0.ghyll\"; fn main(n: i32) -> i32 = f0(n);{}",
                files(
                    n,
                    &|i| repeated(n, |j| if i == j { String::new() } else { format!("use \"m{j}.ghyll\";") }),
                    &|i| format!("fn f{i}(n: i32) -> i32 = n;")
                )
            )
        }),
        text("modules that use all before them", {
            let n = 200.min(bytes / 4000);
            format!(
                "use \"m{}.ghyll\"; fn main(n: i32) -> i32 = f{}(n);{}",
                n - 1,
                n - 1,
                files(n, &|i| repeated(i, |j| format!("use \"m{j}.ghyll\";")), &|i| format!(
                    "fn f{i}(n: i32) -> i32 = n{};",
                    repeated(i.min(400), |j| format!(" + f{j}(n)"))
                ))
            )
        }),
        text(
            "modules with one name in all",
            format!(
                "{} fn main(n: i32) -> i32 = f(n);{}",
                repeated(n, |i| format!("use \"m{i}.ghyll\";")),
                files(n, &|_| String::new(), &|_| "fn f(n: i32) -> i32 = n;".into())
            ),
        ),
        text(
            "modules that are not there",
            format!(
                "{} fn main(n: i32) -> i32 = n;",
                repeated(bytes / 30, |i| format!("use \"missing/m{i}.ghyll\";"))
            ),
        ),
        text(
            "a module by many paths",
            format!(
                "{} fn main(n: i32) -> i32 = f0(n);{}",
                repeated(bytes / 40, |i| format!("use \"{}m0.ghyll\";", "a/../".repeat(i % 7))),
                files(1, &|_| String::new(), &|_| "fn f0(n: i32) -> i32 = n;".into())
            ),
        ),
        text(
            "long names, misspelt",
            format!(
                "{} fn main(n: i32) -> i32 {{ {} n }}",
                repeated(100, |i| format!("fn {long}{i}(n: i32) -> i32 = n;\n")),
                repeated(200, |i| format!("let a = {long}x{i}(n);\n"))
            ),
        ),
        text(
            "very long names, misspelt",
            format!(
                "{} fn main(n: i32) -> i32 {{ {} n }}",
                repeated(10, |i| format!("fn {longer}{i}(n: i32) -> i32 = n;\n")),
                repeated(10, |i| format!("let a = {longer}x{i}(n);\n"))
            ),
        ),
        text(
            "many names, each misspelt",
            format!(
                "{} fn main(n: i32) -> i32 {{ {} n }}",
                numbered("fn name_of_a_function_#(n: i32) -> i32 = n;\n", bytes / 2),
                numbered("let a# = name_of_a_fonction_#(n);\n", bytes / 2)
            ),
        ),
        text(
            "many locals, each misspelt",
            format!(
                "fn main(n: i32) -> i32 {{ {} {} n }}",
                numbered("let name_of_a_local_# = n;\n", bytes / 2),
                numbered("let a# = name_of_a_lokal_#;\n", bytes / 2)
            ),
        ),
        text(
            "many variants, each misspelt",
            format!(
                "enum E {{ {} Z }} fn main(e: E) -> i32 = match e {{ {} _ => 0 }};",
                numbered("Variant_of_an_enum_#, ", bytes / 2),
                numbered("Variant_of_an_enom_#(_) => #, ", bytes / 2)
            ),
        ),
        text(
            "names of other alphabets",
            format!(
                "fn main(n: i32) -> i32 {{ {} n }}",
                numbered("let \u{e9}t\u{e9}# = \u{3b1}\u{3b2}# + n; ", bytes)
            ),
        ),
        text(
            "comments of other alphabets",
            format!(
                "{} fn main(n: i32) -> i32 = x;",
                numbered("// \u{1f600}\u{10ffff}\u{202e} # \u{e9}\n", bytes)
            ),
        ),
        text(
            "an error behind a long line",
            format!(
                "fn main(n: i32) -> i32 {{ let s = {} n; m + k + l }}",
                "(n, \t n).0 + n; let s = ".repeat(bytes / 24)
            ),
        ),
        text(
            "errors of two long types",
            format!(
                "fn main(n: i32) -> i32 {{ {} n }}",
                repeated(200, |i| format!(
                    "let a{i}: ({} i32) = ({} 1.5); ",
                    "i32, ".repeat(bytes / 2400),
                    "1, ".repeat(bytes / 2400)
                ))
            ),
        ),
        text(
            "errors of functions of functions",
            format!(
                "fn f(g: {} i32{}) -> i32 = 1; fn main(n: i32) -> i32 {{ {} n }}",
                "fn(fn(i32) -> i32, ".repeat(40),
                ") -> i32".repeat(40),
                numbered("let a# = f(#.5); ", bytes)
            ),
        ),
        grown(
            "types that double by inference",
            "fn main(n: i32) -> i32 { let a0 = |x: i32| x; ",
            "let a# = |x: i32| (a%(x), a%(x)); ",
            "n }",
            60,
        ),
        grown(
            "types of functions that double",
            "fn pair<A>(x: A) -> fn(A) -> (A, A) = |y| (x, y); fn main(n: i32) -> i32 { let a0 = n; ",
            "let a# = pair(a%); ",
            "n }",
            60,
        ),
        grown(
            "types of functions of functions",
            "fn main(n: i32) -> i32 { let a0 = |x: i32| x; ",
            "let a# = |f| f(a%); ",
            "n }",
            60,
        ),
        text(
            "a type that grows in circles",
            "struct S<A>(f: fn(S<(A, A)>) -> i32, a: A); fn g(s: S<i32>) -> i32 = s.a; fn main(n: i32) -> i32 = g(S(|x| 1, n));",
        ),
        text(
            "an enum that grows in circles",
            "enum L<A> { Cons(A, fn(i32) -> L<Option<A>>), End } fn len(l: L<i32>) -> i32 = match l { Cons(a, f) => a, End => 0 }; fn main(n: i32) -> i32 = len(Cons(n, |x| End));",
        ),
        text(
            "a recursion of ever larger types through a function",
            "fn f<A>(a: A, g: fn(A) -> i32, n: i32) -> i32 = if n < 1 { g(a) } else { f((a, a), |p| g(p.0), n - 1) }; fn main(n: i32) -> i32 = f(n, |x| x, n);",
        ),
        text(
            "generic structs in each other",
            format!(
                "{} fn main(n: i32) -> i32 {{ let a = {}n{}; 1 }}",
                "struct S<A, B>(a: A, b: B);",
                "S(1, ".repeat(60),
                ")".repeat(60)
            ),
        ),
        chain(
            "instances of many types",
            "fn id<A>(x: A) -> A = x; fn main(n: i32) -> i32 { let a0 = n; ",
            "let a# = id((a%, (n, id(#))).0); ",
            "a$ }",
            bytes,
        ),
        chain(
            "a generic function of many structs",
            "fn id<A>(x: A) -> A = x; struct S0(a: i32);\n",
            "struct S#(a: S%); fn f#(n: i32) -> i32 = id((n, S0(n))).0;\n",
            "fn main(n: i32) -> i32 = f$(n);",
            bytes,
        ),
    ]
}
