//! `ghyll explain`: what has become of functions, parameters and resources.

use crate::support::Folder;

const PROGRAM: &str = "
    use terrain;
    param detail: bool = false;
    param gain: f32 = 2.0;
    param idle: f32 = 1.0;
    raster photo: vec3;
    @bake fn open(p: vec2) -> f32 = bilinear(p);
    @bake fn never(p: vec2) -> f32 = bilinear(p) * idle;
    fn fine(p: vec2) -> f32 = fbm(p, 9) + photo(p).x;
    fn double(x: f32) -> f32 = gain * x;
    @task fn token(x: f32) -> f32 = double(x) + 1.0;
    fn unused(x: f32) -> f32 = x + never(vec2(x));
    fn pixel(p: vec2) -> f32 = token(if detail { fine(p) } else { open(p) });
";

fn report(folder: &Folder, more: &str) -> serde_json::Value {
    let ended = folder.ghyll(&format!("explain p.ghyll --json {more}"));
    serde_json::from_str(ended.printed()).expect("JSON")
}

fn fate(report: &serde_json::Value, list: &str, name: &str) -> String {
    let all = report[list].as_array().expect("a list");
    let found =
        all.iter().find(|entry| entry["name"] == name).unwrap_or_else(|| panic!("no {name}: {report}"));
    found["fate"].as_str().expect("a word").to_owned()
}

#[test]
fn every_function_and_parameter_has_its_fate() {
    let folder = Folder::new("every_function_and_parameter_has_its_fate");
    folder.write("p.ghyll", PROGRAM);
    let plain = report(&folder, "");
    let functions = |report: &serde_json::Value| {
        ["pixel", "token", "double", "open", "fine", "unused"].map(|name| fate(report, "functions", name))
    };
    assert_eq!(functions(&plain), ["task", "task", "inlined", "baked", "ruled out", "unreached"]);
    let params =
        |report: &serde_json::Value| ["detail", "gain", "idle"].map(|name| fate(report, "params", name));
    assert_eq!(params(&plain), ["known", "known", "unread"]);
    let detailed = report(&folder, "--set detail=true --live gain");
    assert_eq!(functions(&detailed), ["task", "task", "inlined", "ruled out", "inlined", "unreached"]);
    assert_eq!(params(&detailed), ["known", "live", "unread"]);
    let size = |report: &serde_json::Value| report["programs"][0]["statements"].as_u64().expect("a number");
    let unknown = plain["with_all_params_live"]["statements"].as_u64().expect("a number");
    assert!(size(&plain) < size(&detailed) && size(&plain) < unknown, "{plain}");
}

#[test]
fn resources_are_those_of_the_field() {
    let folder = Folder::new("resources_are_those_of_the_field");
    folder.write("p.ghyll", PROGRAM);
    folder.write(
        "flat.asc",
        "ncols 5\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 10\n0 0 0 0 0\n0 0 0 0 0\n0 0 0 0 0\n",
    );
    let made = |report: &serde_json::Value| -> Vec<(String, Option<u64>, bool)> {
        let all = report["resources"].as_array().expect("a list");
        let one = |r: &serde_json::Value| {
            (r["name"].as_str().unwrap().into(), r["bytes"].as_u64(), r["made"] == true)
        };
        all.iter().map(one).collect()
    };
    let plain = made(&report(&folder, "--dem flat.asc"));
    let bakes =
        [("bake `open`".to_owned(), Some(4 * 15), true), ("bake `never`".to_owned(), Some(4 * 15), false)];
    assert_eq!(plain[6..], bakes);
    assert_eq!((plain[0].0.as_str(), plain[0].2, plain[1].2), ("heights", true, false));
    assert_eq!(plain[5], ("raster `photo`".to_owned(), None, false));
    let detailed = made(&report(&folder, "--dem flat.asc --set detail=true"));
    assert_eq!((detailed[0].2, detailed[5].2, detailed[6].2), (false, true, false));
}

#[test]
fn the_text_names_what_is_told() {
    let folder = Folder::new("the_text_names_what_is_told");
    folder.write("p.ghyll", PROGRAM).write("q.ghyll", "fn main(n: i32) -> i32 = sum(0..n, |i| i);");
    let ended = folder.ghyll("explain p.ghyll");
    let text = ended.printed();
    let said = [
        "Entry `pixel` (image)",
        "rules them out: fine",
        "does not lead to them: never, unused",
        "without effect on this entry: idle",
        "knowing them leaves",
        "task token: takes 1 word",
        "maximum mipmap: not made, which saves",
        "bake `open`:",
    ];
    for part in said.into_iter() {
        assert!(text.contains(part), "no {part:?} in {text}");
    }
    let ended = folder.ghyll("explain q.ghyll");
    let text = ended.printed();
    assert!(text.contains("loops of unknown length turned once") && !text.contains("Memory"), "{text}");
    folder.ghyll("explain none.ghyll").failed(1, &["none.ghyll"]);
    folder.ghyll("explain q.ghyll --entry nothing").failed(2, &["nothing"]);
}
