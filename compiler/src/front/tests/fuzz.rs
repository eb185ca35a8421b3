//! Damaged programs: whatever the text, there is an answer and its places lie in the text.

use super::*;
use crate::report::{render, to_json};

const CORPUS: &[&str] = &[
    "fn fib(n: i32) -> i32 = if n < 2 { n } else { fib(n - 1) + fib(n - 2) };",
    "use terrain; use shade; param detail: bool = false; param l: fn(Hit) -> vec3 = b;
     @task fn basic(ray: Ray) -> Option<Hit> = cast(bilinear, ray);
     fn b(h: Hit) -> vec3 = hypsometric(h.at.z) * (0.2 + 0.8 * h.at.x);
     fn pixel(p: vec2) -> vec3 { let ray = camera(p); match basic(ray) { Some(h) => l(h), None => sky(ray.dir), } }",
    "struct Pair<A, B>(a: A, b: B); type Same<A> = Pair<A, A>; enum E { X(f32), Y(i32, bool), Z }
     fn swap<A, B>(p: Pair<A, B>) -> Pair<B, A> = Pair(b: p.a, a: p.b) with (a: p.b);
     fn g(e: E, t: (i32, [f32; 3])) -> f32 = match e { X(x) if x > 1.5 => x, Y(1 | -2, true) => t.1[0], Y(..) => .5, _ => 0 };",
    "const N = 0x2a + 1_000; const A: [f32; 2] = [1, 2e-3]; raster r: vec3; param k: f32 = 1 in 0..10;
     fn h(n: i32, v: vec3) -> f32 = fold(0..n, 0.0, |acc, i| acc + A[i]) + sum(0..n, |i| f32(i)) + (v.zyx |> dot(_, v));
     fn q(u: u32) -> bool = any(0..3, |i| u >> 3u == 1) && !(all(0..2, |i| i % 2 != 0) || true); /* c /* d */ */",
    "fn apply<A, B>(x: A, f: fn(A) -> B) -> B = f(x); fn m(p: vec2) -> vec2 = grad(|q| q.x * q.y)(p);
     fn z(x: f32) -> f32 { let g = max(_, x); let (a, b) = (g(1), apply(x, |y: f32| -y)); a + b }",
];

const PIECES: &[&str] = &[
    "(",
    ")",
    "{",
    "}",
    "[",
    "]",
    "<",
    ">",
    "|",
    "||",
    ",",
    ";",
    ":",
    "..",
    ".",
    "=",
    "=>",
    "->",
    "+",
    "-",
    "*",
    "==",
    "&&",
    "|>",
    "_",
    "@",
    "\"",
    "/*",
    "//",
    "fn",
    "let",
    "match",
    "if",
    "else",
    "with",
    "in",
    "struct",
    "enum",
    "type",
    "use",
    "const",
    "true",
    "x",
    "f",
    "Some",
    "None",
    "vec3",
    "f32",
    "1",
    "2.5",
    "0x",
    "99999999999",
    "ä",
    "\u{0}",
    "1e",
    "sum",
    "fold",
    "0..n",
    "f(_)",
];

/// xorshift64*
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) as usize % n.max(1)
    }

    fn place(&mut self, text: &str) -> usize {
        let mut at = self.below(text.len() + 1);
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        at
    }

    fn range(&mut self, text: &str) -> std::ops::Range<usize> {
        let a = self.place(text);
        let mut b = (a + self.below(12)).min(text.len());
        while !text.is_char_boundary(b) {
            b -= 1;
        }
        a..b.max(a)
    }

    fn mutate(&mut self, text: &mut String) {
        match self.below(5) {
            0 => {
                let range = self.range(text);
                text.replace_range(range, "");
            }
            1 => {
                let at = self.place(text);
                text.insert_str(at, PIECES[self.below(PIECES.len())]);
            }
            2 => {
                let range = self.range(text);
                text.replace_range(range, PIECES[self.below(PIECES.len())]);
            }
            3 => {
                let from = self.range(text);
                let piece = text[from].to_owned();
                let at = self.place(text);
                text.insert_str(at, &piece);
            }
            // Words for words: programs that parse but do not fit.
            _ => {
                let words = word_places(text);
                if let (Some(a), Some(b)) =
                    (words.get(self.below(words.len())), words.get(self.below(words.len())))
                {
                    let word = text[b.clone()].to_owned();
                    text.replace_range(a.clone(), &word);
                }
            }
        }
    }
}

fn word_places(text: &str) -> Vec<std::ops::Range<usize>> {
    let mut places = Vec::new();
    let mut start = None;
    for (i, c) in text.char_indices().chain([(text.len(), ' ')]) {
        match (c.is_ascii_alphanumeric() || c == '_', start) {
            (true, None) => start = Some(i),
            (false, Some(s)) => {
                places.push(s..i);
                start = None;
            }
            _ => {}
        }
    }
    places
}

fn survive(text: &str) {
    let report = match check(text) {
        Ok(Checked { sources, warnings, module }) => {
            let wrong = super::verify::verify(&module);
            assert!(wrong.is_empty(), "{text}\n{}", wrong.join("\n"));
            Report { sources, diagnostics: warnings }
        }
        Err(report) => {
            assert!(report.has_errors(), "{text}");
            report
        }
    };
    for d in &report.diagnostics {
        for (span, _) in d.secondary.iter().chain([&d.primary]) {
            let text = &report.sources.get(span.source).text;
            let (start, end) = (span.start as usize, span.end as usize);
            assert!(start <= end && end <= text.len(), "{d:?} lies outside\n{text}");
            assert!(
                text.is_char_boundary(start) && text.is_char_boundary(end),
                "{d:?} splits a character\n{text}"
            );
        }
    }
    render(&report, false);
    to_json(&report);
}

#[test]
fn damaged_programs_are_answered() {
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    for round in 0..3_000 {
        let mut text = CORPUS[round % CORPUS.len()].to_owned();
        for _ in 0..=random.below(6) {
            random.mutate(&mut text);
        }
        survive(&text);
    }
}

#[test]
fn the_corpus_itself_is_accepted() {
    for text in CORPUS {
        accepts(text);
    }
}
