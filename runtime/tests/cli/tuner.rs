//! `--frame-ms`, `--min-psnr`, `--max-memory`, `--tune`, `--tuning`.

use crate::support::{Ended, Folder};
use serde_json::Value;

/// Detail makes another picture, at the price of a long loop.
const PROGRAM: &str = "
    param detail: bool = false;
    fn slow(x: f32) -> f32 = fold(0..3000, x, |a, i| fract(a * 1.37 + 0.11));
    fn pixel(p: vec2) -> f32 = 0.2 + 0.05 * fract(0.37 * p.x * p.y) + (if detail { 0.5 * slow(fract(0.1 * p.x)) } else { 0.0 });
";
const LINE: &str = "render p.ghyll --on cpu --size 24x16 -o p.npy";

fn folder(test: &str) -> Folder {
    let folder = Folder::new(test);
    folder.write("p.ghyll", PROGRAM);
    folder
}

fn run(folder: &Folder, more: &str) -> Ended {
    folder.ghyll(&format!("{LINE} {more}"))
}

fn picture(folder: &Folder) -> Vec<u8> {
    std::fs::read(folder.path("p.npy")).expect("a picture")
}

/// The picture of what was chosen, and what was said.
fn tuned(folder: &Folder, more: &str) -> (Vec<u8>, String) {
    let ended = run(folder, more);
    ended.printed();
    (picture(folder), ended.err)
}

fn plain(folder: &Folder, more: &str) -> Vec<u8> {
    run(folder, more).printed();
    picture(folder)
}

fn file(folder: &Folder) -> Value {
    let text = std::fs::read_to_string(folder.path("ghyll.tuning.json")).expect("a tuning file");
    serde_json::from_str(&text).expect("JSON")
}

#[test]
fn errors_are_against_the_best_that_can_be_chosen() {
    let folder = folder("tuner_reference");
    // One sample is all there is, so detail with one sample is without error, however many decibels are asked for.
    let (drawn, said) = tuned(&folder, "--samples 1 --min-psnr 200");
    assert!(said.contains("chose detail=true, 1 sample a pixel"), "{said}");
    assert!(drawn == plain(&folder, "--samples 1 --set detail=true"));
    let measured = file(&folder)["tunings"][0]["choices"].clone();
    let choices = measured.as_array().expect("choices");
    assert_eq!(choices.len(), 2);
    let coarse = choices.iter().find(|c| c["set"]["detail"] == "false").expect("the other choice");
    let psnr = coarse["psnr_db"].as_f64().expect("a number");
    assert!((5.0..30.0).contains(&psnr), "{psnr}");
    // What the other one gives is enough.
    let (drawn, said) = tuned(&folder, &format!("--samples 1 --min-psnr {}", psnr - 0.5));
    assert!(said.contains("chose detail=false"), "{said}");
    assert!(drawn == plain(&folder, "--samples 1 --set detail=false"));
    // Samples are free: the most of them are the reference.
    let (drawn, said) = tuned(&folder, "--min-psnr 200");
    assert!(said.contains("chose detail=true, 8 samples"), "{said}");
    assert!(drawn == plain(&folder, "--samples 8 --set detail=true"));
}

#[test]
fn the_best_picture_within_the_time_is_chosen() {
    let folder = folder("tuner_time");
    let (_, said) = tuned(&folder, "--frame-ms 100000");
    assert!(said.contains("chose detail=true, 8 samples"), "{said}");
    // Fixed parameters stay.
    let (drawn, said) = tuned(&folder, "--frame-ms 100000 --set detail=false --samples 2");
    assert!(said.contains("chose 2 samples"), "{said}");
    assert!(drawn == plain(&folder, "--set detail=false --samples 2"));
    let (_, said) = tuned(&folder, "--tune --samples 3 --live detail");
    assert!(said.contains("chose 3 samples"), "{said}");
}

#[test]
fn limits_that_nothing_meets_are_told_with_how_much_is_missing() {
    let folder = folder("tuner_missed");
    run(&folder, "--frame-ms 0.0001")
        .failed(3, &["no choice meets the limits", "--frame-ms is missed by", "allow --frame-ms"]);
    assert!(!folder.path("p.npy").exists());
    // Alone a bound on the error can always be met; together with the time it is in the way, or the time is.
    run(&folder, "--frame-ms 0.0001 --min-psnr 100").failed(3, &["--frame-ms is missed by"]);
    run(&folder, "--tune --max-memory 1K")
        .failed(3, &["--max-memory is missed by", "needs at least", "allow --max-memory"]);
    run(&folder, "--frame-ms 5 --preset time").failed(2, &["--preset"]);
    run(&folder, "--frame-ms 0").failed(2, &["positive"]);
}

#[test]
fn what_was_measured_is_kept_and_used_again() {
    let folder = folder("tuner_file");
    let (_, said) = tuned(&folder, "--tune");
    assert!(said.contains("measuring 8 choices") && said.contains("chose detail=true, 8 samples"), "{said}");
    // Figures that are planted in the file decide what is chosen next.
    let mut planted = file(&folder);
    for choice in planted["tunings"][0]["choices"].as_array_mut().expect("choices") {
        let fast = choice["set"]["detail"] == "true" && choice["samples"] == 2;
        choice["frame_ms"] = (if fast { 5.0 } else { 5000.0 }).into();
    }
    folder.write("ghyll.tuning.json", planted.to_string());
    let (drawn, said) = tuned(&folder, "--frame-ms 10");
    assert!(said.contains("as measured before") && said.contains("chose detail=true, 2 samples"), "{said}");
    assert!(drawn == plain(&folder, "--set detail=true --samples 2"));
    let ended = run(&folder, "--frame-ms 1");
    ended.failed(3, &["missed by 4.0 ms", "detail=true, 2 samples a pixel"]);
    // Another size, another program and another file are measured anew.
    let smaller = folder.ghyll(&format!("{} --frame-ms 100000", LINE.replace("24x16", "20x16")));
    assert!(smaller.status == Some(0) && smaller.err.contains("measuring"), "{}", smaller.err);
    assert!(tuned(&folder, "--frame-ms 100000 --tuning other.json").1.contains("measuring"));
    assert_eq!(file(&folder)["tunings"].as_array().map(Vec::len), Some(2));
    folder.write("p.ghyll", PROGRAM.replace("0.11", "0.12"));
    assert!(tuned(&folder, "--frame-ms 100000").1.contains("measuring"));
}

#[test]
fn a_damaged_tuning_file_is_told() {
    let folder = folder("tuner_damaged");
    for text in ["{", "{}", r#"{"tunings": [{"about": "x"}]}"#] {
        folder.write("ghyll.tuning.json", text);
        run(&folder, "--tune").failed(1, &["ghyll.tuning.json is no tuning file", "--tuning"]);
    }
    run(&folder, "--tune --tuning nowhere/t.json").failed(2, &["cannot write nowhere/t.json"]);
}

#[test]
fn json_has_what_was_chosen() {
    let folder = folder("tuner_json");
    let ended = run(&folder, "--tune --samples 1 --json");
    let report: Value = serde_json::from_str(ended.printed()).expect("JSON");
    let tuned = &report["tuned"];
    assert_eq!((&tuned["set"]["detail"], &tuned["samples"]), (&"true".into(), &1.into()), "{report}");
    assert!(tuned["frame_ms"].as_f64().is_some_and(|ms| ms > 0.0) && tuned["memory_bytes"].is_u64());
}
