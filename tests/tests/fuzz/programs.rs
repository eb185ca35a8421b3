//! Every program of the repository, damaged, through everything that the compiler does.

use ghyll_compiler::argument::parse_arguments;
use ghyll_compiler::compile::{self, CompileError, EntryKind, Options};
use ghyll_compiler::diagnostic::Report;
use ghyll_compiler::random::Random;
use ghyll_compiler::report::{render, to_json};
use ghyll_compiler::source::Source;
use ghyll_tests::hunt::Input;
use std::ops::Range;

/// Longer texts are not promised an answer in time.
const LONGEST: usize = 1 << 20;
/// Functions of one program that are compiled.
const ENTRIES: usize = 6;

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
    "/",
    "%",
    "<<",
    "==",
    "&&",
    "|>",
    "_",
    "@task",
    "@inline",
    "@bake",
    "\"",
    "/*",
    "*/",
    "//",
    "///",
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
    "param",
    "raster",
    "true",
    "x",
    "f",
    "n",
    "Some",
    "None",
    "vec2",
    "vec3",
    "f32",
    "i32",
    "bool",
    "mat3",
    "1",
    "0",
    "2.5",
    "0x",
    "-1",
    "2147483647",
    "2147483648",
    "4294967295u",
    "99999999999",
    "1e38",
    "1e39",
    "1e-46",
    "ä",
    "\u{0}",
    "\u{feff}",
    "\u{202e}",
    "\r",
    "1e",
    "sum(0..n, |i| i)",
    "fold(0..n, 0, |a, i| a + i)",
    "grad",
    "deriv",
    "f(_)",
    "main",
    "[1, 2, 3]",
    "(1, 2)",
    "[f32; 3]",
    "[f32; 100000]",
    "fn(f32) -> f32",
    "|x| x",
    "use terrain;",
    "use shade;",
    "if true { 1 } else { 2 }",
    "match x { _ => x }",
    "{ let a = 1; a }",
    "0..2147483647",
];
/// What is nested, with what closes it.
const NESTS: &[(&str, &str)] = &[
    ("(", ")"),
    ("{ ", " }"),
    ("[", "]"),
    ("-", ""),
    ("!", ""),
    ("|x| ", ""),
    ("if true { ", " } else { 0 }"),
    ("match 1 { _ => ", " }"),
    ("f(", ")"),
    ("Some(", ")"),
    ("(1, ", ")"),
    ("/*", "*/"),
    ("x |> ", ""),
    ("1 + ", ""),
    ("Option<", ">"),
    ("fn(", ") -> f32"),
    ("{ let a = ", "; a }"),
    ("sum(0..2, |i| ", ")"),
    ("grad(", ")"),
    ("if true { 0 } else ", ""),
    ("fold(0..2, 0, |a, i| ", ")"),
    ("x.", ""),
    ("", "[0]"),
    ("", "(1)"),
    ("", ".x"),
];

/// A program of the corpus with a few changes.
pub fn damaged(random: &mut Random, corpus: &[String]) -> Input {
    let mut text = corpus[random.below(corpus.len())].clone();
    if random.below(4) == 0 {
        text.push_str(&corpus[random.below(corpus.len())]);
    }
    for _ in 0..=random.below(5) {
        mutate(random, &mut text, corpus);
    }
    if random.below(200) == 0 {
        let times = LONGEST / text.len().max(1);
        text = text.repeat(times.min(1 + random.below(2_000)));
    }
    let mut bytes = text.into_bytes();
    bytes.truncate(LONGEST);
    for _ in 0..random.below(5).saturating_sub(2) {
        let at = random.below(bytes.len() + 1);
        match bytes.get_mut(at) {
            Some(byte) => *byte ^= 1 << random.below(8),
            None => bytes.push(random.word() as u8),
        }
    }
    Input { name: "find.ghyll".to_owned(), bytes, seed: random.word() }
}

fn place(random: &mut Random, text: &str) -> usize {
    boundary(text, random.below(text.len() + 1))
}

fn boundary(text: &str, mut at: usize) -> usize {
    at = at.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

fn range(random: &mut Random, text: &str, most: usize) -> Range<usize> {
    let start = place(random, text);
    let end = boundary(text, start + random.below(most));
    start..end.max(start)
}

/// Words, numbers and single signs.
fn tokens(text: &str) -> Vec<Range<usize>> {
    let mut found: Vec<Range<usize>> = Vec::new();
    for (at, c) in text.char_indices() {
        let word = c.is_ascii_alphanumeric() || c == '_';
        let grows = found.last().is_some_and(|last| {
            last.end == at && text[last.clone()].chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
        });
        match found.last_mut() {
            Some(last) if word && grows => last.end = at + 1,
            _ if c.is_whitespace() => {}
            _ => found.push(at..at + c.len_utf8()),
        }
    }
    found
}

fn token(random: &mut Random, text: &str) -> Range<usize> {
    let all = tokens(text);
    if all.is_empty() { 0..0 } else { all[random.below(all.len())].clone() }
}

fn mutate(random: &mut Random, text: &mut String, corpus: &[String]) {
    let piece = |random: &mut Random| PIECES[random.below(PIECES.len())];
    match random.below(12) {
        0 => {
            let range = range(random, text, 12);
            text.replace_range(range, "");
        }
        1 => {
            let at = place(random, text);
            text.insert_str(at, piece(random));
        }
        2 | 3 => {
            let at = token(random, text);
            text.replace_range(at, piece(random));
        }
        // Programs that parse but do not fit.
        4..=6 => {
            let (to, from) = (token(random, text), token(random, text));
            let word = text[from].to_owned();
            text.replace_range(to, &word);
        }
        7 => {
            let other = &corpus[random.below(corpus.len())];
            let (to, from) = (token(random, text), token(random, other));
            text.replace_range(to, &other[from]);
        }
        8 => {
            let other = &corpus[random.below(corpus.len())];
            let (at, from) = (place(random, text), range(random, other, 200));
            text.insert_str(at, &other[from]);
        }
        9 => {
            let from = range(random, text, 100);
            let chunk = text[from.clone()].repeat([1, 2, 10, 300][random.below(4)]);
            if text.len() + chunk.len() <= LONGEST {
                text.insert_str(from.end, &chunk);
            }
        }
        10 => {
            let (at, times) = (token(random, text), [1, 3, 30, 120, 5_000][random.below(5)]);
            let (open, close) = NESTS[random.below(NESTS.len())];
            let inner = text[at.clone()].to_owned();
            text.replace_range(at, &format!("{}{inner}{}", open.repeat(times), close.repeat(times)));
        }
        _ => {
            let line = text.lines().nth(random.below(text.lines().count().max(1))).unwrap_or("").to_owned();
            let at = place(random, text);
            text.insert_str(at, &line);
        }
    }
}

/// Everything that the compiler is asked about a text; texts and drawings are made and dropped.
pub fn survive(input: &Input) {
    let text = String::from_utf8_lossy(&input.bytes).into_owned();
    let mut random = Random::new(input.seed);
    let checked = match compile::check(Source::new("find.ghyll", text)) {
        Ok(checked) => checked,
        Err(report) => {
            assert!(report.has_errors(), "refused without an error");
            return tell(&report);
        }
    };
    let reached = compile::reach(&checked, &Options::default()).expect("nothing is asked for");
    let warnings = [checked.warnings.clone(), reached].concat();
    tell(&Report { sources: checked.sources.clone(), diagnostics: warnings });

    let module = &checked.module;
    let mut names: Vec<&str> =
        module.functions.iter().filter(|f| !f.library).map(|f| f.name.as_str()).collect();
    while names.len() > ENTRIES {
        names.swap_remove(random.below(names.len()));
    }
    if random.below(20) == 0 {
        names.extend(
            module.functions.get(random.below(module.functions.len().max(1))).map(|f| f.name.as_str()),
        );
    }
    for name in names {
        let mut options = Options { entry: Some(name.to_owned()), ..Options::default() };
        request(&checked, &options);
        options.want = Some([EntryKind::Value, EntryKind::Image][random.below(2)]);
        for param in &module.params {
            match random.below(3) {
                0 => options.live.push(param.name.clone()),
                1 => options.set.push((param.name.clone(), argument(&mut random))),
                _ => {}
            }
        }
        request(&checked, &options);
        let Some(function) = module.functions.iter().find(|f| f.name == name) else { continue };
        for expected in function.param_types() {
            if let Err(report) = parse_arguments(module, &argument(&mut random), expected) {
                tell(&report);
            }
        }
    }
}

fn request(checked: &ghyll_compiler::front::Checked, options: &Options) {
    match compile::compile(checked, options) {
        Ok(compiled) => {
            compiled.result_words(&checked.module);
        }
        Err(CompileError::Program(report) | CompileError::Value(report)) => {
            assert!(report.has_errors(), "refused without an error");
            tell(&report);
        }
        Err(CompileError::Request(message)) => assert!(!message.is_empty()),
    }
}

/// What could stand on the command line.
fn argument(random: &mut Random) -> String {
    (0..=random.below(3)).map(|_| PIECES[random.below(PIECES.len())]).collect::<Vec<_>>().join(" ")
}

fn tell(report: &Report) {
    for diagnostic in &report.diagnostics {
        for (span, _) in diagnostic.secondary.iter().chain([&diagnostic.primary]) {
            let text = &report.sources.get(span.source).text;
            let place = text.get(span.start as usize..span.end as usize);
            assert!(place.is_some(), "{} lies outside the text", diagnostic.code);
        }
    }
    render(report, false);
    to_json(report);
}
