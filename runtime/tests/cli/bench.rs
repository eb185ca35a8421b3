//! `ghyll bench accuracy` on a small picture.

use crate::support::Folder;
use serde_json::Value;

#[test]
fn accuracy_writes_json_tables_and_plots() {
    let folder = Folder::new("bench_accuracy");
    let line = "bench accuracy --size 32x24 --repeat 1 --on cpu --json -o out --only";
    let ended = folder
        .ghyll_with(&[&line.split(' ').collect::<Vec<_>>()[..], &["Fuji, overview, bilinear"]].concat());
    let report: Value = serde_json::from_str(ended.printed()).expect("one JSON object");
    assert_eq!(report["bench"], "accuracy");
    for key in ["machine", "adapter", "date"] {
        assert!(report[key].is_string(), "{key}");
    }
    let rows = report["rows"].as_array().expect("rows");
    let of = |method: &str| rows.iter().filter(|row| row["method"] == method).collect::<Vec<_>>();
    let (trace, searches) = (of("trace")[0], of("search"));
    // Whoever traces exactly is off by roundings; sixteen pieces are planted to be off by more.
    assert_eq!(trace["disagreements_pixels"], 0, "{trace}");
    let error = |row: &Value| row["error_footprints"].as_f64().expect("a number");
    assert!(error(trace) < 1e-3, "{trace}");
    let coarse = searches.iter().find(|row| row["steps"] == 16 && row["refinements"] == 0).expect("a row");
    assert!(error(coarse) > 0.1, "{coarse}");
    assert!(
        coarse["flip"].as_f64() > trace["flip"].as_f64() && coarse["ssim"].as_f64() < Some(0.999),
        "{coarse}"
    );
    assert!(rows.iter().any(|row| row["dominates"].is_boolean()));

    let read = |name: &str| std::fs::read(folder.path("out").join(name)).expect(name);
    let table = String::from_utf8(read("accuracy.md")).expect("text");
    assert!(table.contains("search(64, 4)") && table.contains("trace against search"), "{table}");
    assert_eq!(String::from_utf8(read("accuracy.csv")).expect("text").lines().count(), searches.len() + 2);
    let svg = String::from_utf8(read("accuracy.svg")).expect("text");
    assert!(svg.contains("footprints") && svg.contains("<polyline"), "{svg}");
    assert!(read("accuracy.png").starts_with(b"\x89PNG"));
}

#[test]
fn accuracy_says_what_only_must_fit() {
    let folder = Folder::new("bench_accuracy_only");
    folder.ghyll("bench accuracy --on cpu --only nowhere").failed(2, &["--only", "SURFACE"]);
}
