//! Random bodies of `fn f(p: vec2) -> f32` that stay small and are smooth nearly everywhere.

use ghyll_compiler::random::Random;
use std::time::{SystemTime, UNIX_EPOCH};

/// The seed that is asked for, or a new one.
pub fn random() -> (u64, Random) {
    let asked = std::env::var("GHYLL_SEED").ok().map(|text| text.parse().expect("GHYLL_SEED is a number"));
    let new =
        || SystemTime::now().duration_since(UNIX_EPOCH).map_or(1, |t| t.as_nanos() as u64 % 1_000_000_000);
    let seed = asked.unwrap_or_else(new);
    (seed, Random::new(seed))
}

/// `A`, `B` and `C` stand for parts, `N` for an integer.
const FORMS: &[&str] = &[
    "A + B",
    "A - B",
    "0.5 * (A) * (B)",
    "(A) / (2.0 + sin(B))",
    "sin(A + B)",
    "cos(2.0 * (A))",
    "exp(sin(A))",
    "sqrt(1.0 + (A) * (A))",
    "log(2.0 + cos(A))",
    "tanh(A - B)",
    "atan2(A, 2.0 + sin(B))",
    "pow(1.5 + 0.5 * sin(A), cos(B))",
    "min(A, B)",
    "max(A, B)",
    "abs(A)",
    "smoothstep(-1.0, 2.0, A)",
    "mix(A, B, 0.5 + 0.5 * sin(C))",
    "length(vec3(A, B, 1.0))",
    "dot(vec2(A, B), vec2(0.3, sin(C)))",
    "normalize(vec3(A, B, 2.0)).y",
    "(mat2(A, 0.5, 0.25, B) * vec2(0.5, sin(C))).x",
    "if (A) < (B) { C } else { A }",
    "match (sin(A), N) { (x, 0) => x, (x, _) if x > 0.0 => x * x, _ => B }",
    "area(if (A) > 0.3 { Circle(sin(A)) } else { Box(N, 0.3 * (B)) })",
    "{ let k = A; twice(|x| 0.5 * sin(x) + k, B) }",
    "{ let s = Span(lo: A, hi: B); width(s with (lo: sin(C))) }",
    "power(N, sin(A))",
    "even(2 * N, sin(A))",
    "wave(A, 1.5)",
    "fold(0..N, A, |s, i| sin(s + B) * 0.7)",
    "sum(1..4, |i| sin(A * f32(i)) / f32(i))",
    "[A, B, C][N]",
    "{ let k = A; (if N > 1 { |x: f32| x * sin(k) } else { cos })(B) }",
    "choose(N)(sin(A))",
    "deriv(|t| sin(t * (A)) * t)(sin(B))",
    "grad(|q| sin(q.x * q.y + A))(vec2(sin(B), 0.5)).x",
    "0.02 * bilinear(vec2(50.0 + 30.0 * sin(A), 50.0 + 40.0 * cos(B)))",
    "0.02 * layer(vec2(50.0 + 30.0 * sin(A), 50.0 + 40.0 * cos(B)))",
    "0.02 * baked(vec2(50.0 + 30.0 * sin(A), 50.0)) + noise(vec2(A, B))",
];

pub fn body(random: &mut Random, depth: usize) -> String {
    if depth == 0 {
        return ["p.x", "p.y", "p.x * p.y", "(p.x - 2.0 * p.y)", "0.7"][random.below(5)].into();
    }
    let form = FORMS[random.below(FORMS.len())];
    let mut text = String::new();
    // Each letter has one meaning in a form.
    let parts: Vec<String> = (0..3).map(|_| format!("({})", body(random, depth - 1))).collect();
    let n = random.below(4).to_string();
    let letter = |at: usize| {
        let beside = |i: Option<usize>| {
            i.and_then(|i| form.as_bytes().get(i)).is_some_and(|c| c.is_ascii_alphanumeric())
        };
        !beside(at.checked_sub(1)) && !beside(Some(at + 1))
    };
    for (at, c) in form.char_indices() {
        match c {
            'A' | 'B' | 'C' if letter(at) => text.push_str(&parts[c as usize - 'A' as usize]),
            'N' if letter(at) => text.push_str(&n),
            c => text.push(c),
        }
    }
    text
}
