use super::complete::{Candidate, complete};
use super::*;
use crate::source::NoFiles;

fn of(text: &str) -> Analysis {
    analyse(Source::new("a.ghyll", text), &NoFiles)
}

/// The place of the first `needle`.
fn at(text: &str, needle: &str) -> u32 {
    text.find(needle).unwrap_or_else(|| panic!("{needle} is not there")) as u32
}

const PROGRAM: &str = "use terrain;
struct Pair<A>(left: A, right: A);
enum Shape { Dot, Line(f32) }
type Maker = fn(f32) -> Shape;
const N = 3;
param gain: f32 = 1.5 in 0.0..2.0;
raster sat: vec3;
/// Swapped.
@task
fn swap<B>(p: Pair<B>) -> Pair<B> = Pair(left: p.right, right: p.left);
fn area(s: Shape) -> f32 = match s { Dot => 0.0, Line(w) | Line(w) => w * gain };
fn main(x: f32) -> f32 {
    let pair = swap(Pair(x, 1.0)) with (left: sat(vec2(x)).x);
    let add = |y| y + pair.left;
    let make: Maker = Line;
    let out = area(make(2.0)) |> add(_);
    out + sum(0..N, |i| f32(i)) + max(x, 1)
}
";

#[test]
fn every_name_has_its_meaning() {
    let analysis = of(PROGRAM);
    assert!(analysis.diagnostics.iter().all(|d| d.severity != Severity::Error), "{:?}", analysis.diagnostics);
    // Definition and mentions of each, by the text of the definition.
    for (definition, count) in [
        ("left: A", 5),
        ("Pair<A>", 5),
        ("Shape {", 3),
        ("Dot,", 2),
        ("Line(f32)", 4),
        ("Maker =", 2),
        ("N = 3", 2),
        ("gain:", 2),
        ("sat:", 2),
        ("swap<", 2),
        ("p: Pair<B>", 3),
        ("pair =", 2),
        ("y| y", 2),
        ("add =", 2),
        ("make: Maker", 2),
        ("i| f32", 2),
        ("w) | ", 3),
        ("x: f32) -> f32 {", 4),
        ("area(s", 2),
    ] {
        let mention = analysis.mention_at(SourceId(0), at(PROGRAM, definition));
        let mention = mention.unwrap_or_else(|| panic!("{definition} is no name"));
        let all: Vec<Span> = analysis.mentions_of(mention.meaning).collect();
        assert_eq!(all.len(), count, "{definition}: {all:?}");
        assert_eq!(
            analysis.definition(mention.meaning).map(|span| span.start),
            Some(at(PROGRAM, definition)),
            "{definition}"
        );
    }
}

#[test]
fn names_are_described() {
    let analysis = of(PROGRAM);
    let described = |needle: &str| {
        let mention = analysis.mention_at(SourceId(0), at(PROGRAM, needle)).unwrap();
        let name = analysis.text(mention.span).to_owned();
        analysis.describe(&name, mention.meaning, &mention.ty, mention.span)
    };
    for (needle, signature) in [
        ("swap(Pair", "@task fn swap<B>(p: Pair<B>) -> Pair<B>"),
        ("Pair(x", "struct Pair<A>(left: A, right: A)"),
        ("pair.left", "pair: Pair<f32>"),
        ("left;", "left: f32 // of struct Pair<A>"),
        ("p.right", "p: Pair<B>"),
        ("Line;", "Line(f32) // of enum Shape"),
        ("Shape) -> f32", "enum Shape { Dot, Line(f32) }"),
        ("Maker = Line", "type Maker = fn(f32) -> Shape"),
        ("N, |i|", "const N: i32 = 3"),
        ("gain }", "param gain: f32 = 1.5 in 0.0..2.0"),
        ("sat(vec2", "raster sat: vec3"),
        ("add(_)", "add: fn(f32) -> f32"),
        ("max(x", "max(N, N) -> N"),
        ("sum(0", "sum(0..n, |i| ..)"),
    ] {
        assert_eq!(described(needle).signature, signature, "{needle}");
    }
    assert_eq!(described("swap(Pair").text, "Swapped.");
    assert!(described("terrain;").text.starts_with("The height field"));
}

#[test]
fn expressions_have_types() {
    let analysis = of(PROGRAM);
    let ty = |needle: &str, plus: u32| {
        let (span, ty) = analysis.type_at(SourceId(0), at(PROGRAM, needle) + plus).unwrap();
        (analysis.text(span).to_owned(), analysis.show(ty, span))
    };
    assert_eq!(ty("* gain", 0), ("w * gain".into(), "f32".into()));
    assert_eq!(ty("|y| y", 0), ("|y| y + pair.left".into(), "fn(f32) -> f32".into()));
    assert_eq!(ty("p.right, right", 0).1, "Pair<B>");
}

#[test]
fn what_is_around_a_mistake_is_understood() {
    let text = "fn f(a: f32) -> f32 = a * ;\nfn g(b: i32) -> i32 { let c = b; c + zzz }\nfn h(v: vec2) -> f32 = f(v.x);";
    let analysis = of(text);
    assert!(analysis.diagnostics.iter().any(|d| d.severity == Severity::Error));
    for (needle, expected) in [("c + zzz", "c: i32"), ("v.x", "v: vec2"), ("f(v.x)", "fn f(a: f32) -> f32")] {
        let mention =
            analysis.mention_at(SourceId(0), at(text, needle)).unwrap_or_else(|| panic!("{needle}"));
        let name = analysis.text(mention.span).to_owned();
        assert_eq!(analysis.describe(&name, mention.meaning, &mention.ty, mention.span).signature, expected);
    }
}

/// Candidates where `^` stands.
fn candidates(marked: &str) -> Vec<Candidate> {
    let at = marked.find('^').expect("a mark");
    complete(Source::new("a.ghyll", marked.replacen('^', "", 1)), at, &NoFiles)
}

fn words(marked: &str) -> Vec<String> {
    candidates(marked).into_iter().map(|c| c.word).collect()
}

#[test]
fn candidates_fit_their_place() {
    let has = |marked: &str, expected: &[&str]| {
        let found = words(marked);
        for word in expected {
            assert!(found.iter().any(|w| w == word), "{word} is not among those of {marked}: {found:?}");
        }
        found
    };
    let begin = "struct Pair<A>(left: A, right: A); enum Shape { Dot, Line(f32) } const N = 3;";
    assert_eq!(words(&format!("{begin} fn f(p: Pair<i32>) -> i32 = p.^;")), ["left", "right"]);
    assert_eq!(words(&format!("{begin} fn f(p: Pair<i32>) -> i32 = p.le^ft + 1;")), ["left", "right"]);
    assert_eq!(words(&format!("{begin} fn f(p: Pair<i32>) -> Pair<i32> = p with (^);")), ["left", "right"]);
    assert_eq!(words("fn f(t: (i32, bool)) -> i32 = t.^;"), ["0", "1"]);
    assert_eq!(words("fn f(v: ivec2) -> i32 = v.^;"), ["x", "y", "xy", "r", "g", "rg"]);
    // What is bound inside and before comes first; nothing of elsewhere.
    let inner =
        has("fn f(a: i32) -> i32 { let b = 1; let c = |d: i32| ^; let e = 2; e }", &["sin", "f", "if"]);
    assert_eq!(inner[..3], ["d", "b", "a"]);
    assert!(!inner.iter().any(|w| w == "e" || w == "trace"));
    has("use terrain; fn f() -> f32 = ^;", &["trace", "bilinear", "FAR"]);
    let built = has(&format!("{begin} fn f(x: i32) -> Pair<i32> = Pair(^);"), &["x", "N"]);
    assert_eq!(built[..2], ["left", "right"]);
    assert_eq!(
        words(&format!("{begin} fn f(s: Shape) -> f32 = match s {{ ^ => 1.0, Line(x) => x }};")),
        ["Dot", "Line"]
    );
    let types =
        has(&format!("{begin} fn f<T>(s: ^) -> f32 = 1.0;"), &["Shape", "Pair", "Option", "T", "vec3"]);
    assert!(!types.iter().any(|w| w == "N" || w == "f"));
    has("^", &["fn", "struct", "use"]);
    assert!(!words("fn f() -> i32 = 1;\n^\n").iter().any(|w| w == "sin"));
    assert_eq!(words("use ^;"), ["terrain", "antialias", "chart", "data", "light", "shade", "sky", "water"]);
    assert_eq!(words("@^\nfn f() -> i32 = 1;"), ["task", "inline", "bake"]);
    assert!(words("fn f() -> i32 = 1; // si^").is_empty());
    assert!(words("fn f() -> f32 = 1.^5;").is_empty());
}

#[test]
fn candidates_are_described() {
    let found = candidates("/// Half.\nfn half(x: f32) -> f32 = x / 2.0;\nfn f(y: f32) -> f32 = ^;");
    let half = found.iter().find(|c| c.word == "half").unwrap();
    let expected = Description { signature: "fn half(x: f32) -> f32".into(), text: "Half.".into() };
    assert_eq!(half.description, expected);
    assert_eq!(found[0].description.signature, "y: f32");
}

#[test]
fn items_are_listed_with_their_parts() {
    let analysis = of(PROGRAM);
    let symbols = analysis.symbols();
    let names: Vec<&str> = symbols.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["Pair", "Shape", "Maker", "N", "gain", "sat", "swap", "area", "main"]);
    let parts: Vec<&str> = symbols[1].parts.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(parts, ["Dot", "Line"]);
    for symbol in symbols.iter().flat_map(|s| s.parts.iter().chain([s])) {
        assert!(symbol.whole.start <= symbol.at.start && symbol.at.end <= symbol.whole.end, "{symbol:?}");
    }
}

/// Whatever the text is, and wherever one asks, there is an answer.
#[test]
fn damaged_texts_are_analysed() {
    let mut random = 0x9e37_79b9_7f4a_7c15u64;
    let mut below = |n: usize| {
        random ^= random >> 12;
        random ^= random << 25;
        random ^= random >> 27;
        (random.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) as usize % n
    };
    const PIECES: &[&str] = &[
        "(",
        ")",
        "{",
        "}",
        "<",
        "|",
        ".",
        ";",
        "=",
        "match x {",
        "let ",
        "fn ",
        "with (",
        "Line",
        "p.",
        "Pair(",
        "ä",
        "_",
        "..",
    ];
    for _ in 0..150 {
        let mut text = PROGRAM.to_owned();
        for _ in 0..=below(3) {
            let mut place = below(text.len());
            while !text.is_char_boundary(place) {
                place -= 1;
            }
            match below(3) {
                0 => text.truncate(place),
                1 => text.insert_str(place, PIECES[below(PIECES.len())]),
                _ => {
                    let rest = text.split_off(place);
                    text.extend(rest.chars().skip(below(12)));
                }
            }
            text.push(' ');
        }
        let analysis = of(&text);
        for mention in &analysis.mentions {
            if mention.span.source == SourceId(0) {
                let name = analysis.text(mention.span).to_owned();
                assert!(!name.is_empty() || matches!(mention.meaning, Meaning::Module(_)), "{text}");
                analysis.describe(&name, mention.meaning, &mention.ty, mention.span);
            }
        }
        analysis.symbols();
        let place = below(text.len());
        complete(Source::new("a.ghyll", text), place, &NoFiles);
    }
}
