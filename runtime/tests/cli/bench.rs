//! Benchmarks of pictures, on small ones.

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

/// A benchmark takes minutes: where its report cannot be kept is said before.
#[test]
fn a_report_that_cannot_be_written_is_refused_at_once() {
    let folder = Folder::new("bench_taken");
    std::fs::write(folder.path("file"), "kept").unwrap();
    std::fs::create_dir_all(folder.path("out").join("stability.json")).unwrap();
    let line = "bench stability --rays 1000000000 --on cpu -o";
    folder.ghyll(&format!("{line} file")).failed(2, &["cannot write", "file"]);
    folder.ghyll(&format!("{line} out")).failed(2, &["cannot write", "stability.json", "folder"]);
    assert_eq!(std::fs::read_to_string(folder.path("file")).unwrap(), "kept");
}

/// The report that is printed, and whether the folder has it and these files.
fn report(folder: &Folder, line: &str, only: &str, name: &str) -> Value {
    let line = format!("bench {name} --repeat 2 --json -o out {line} --only");
    let ended = folder.ghyll_with(&[&line.split(' ').collect::<Vec<_>>()[..], &[only]].concat());
    let report: Value = serde_json::from_str(ended.printed()).expect("one JSON object");
    assert_eq!(report["bench"], name);
    let read = |ending: &str| {
        std::fs::read(folder.path("out").join(format!("{name}.{ending}"))).expect("the folder has it")
    };
    assert_eq!(serde_json::from_slice::<Value>(&read("json")).expect("JSON"), report);
    let svg = String::from_utf8(read("svg")).expect("text");
    roxmltree::Document::parse(&svg).expect("an SVG document");
    assert!(read("png").starts_with(b"\x89PNG") && !read("md").is_empty());
    report
}

#[test]
fn table1_has_net_times_and_ratios() {
    let folder = Folder::new("table1_has_net_times_and_ratios");
    let found = report(&folder, "--on cpu --size 24x16", "Fuji, ", "table1");
    let rows = found["rows"].as_array().expect("rows");
    let of = |name: &str| rows.iter().find(|row| row["name"] == name).unwrap_or_else(|| panic!("no {name}"));
    let n = |row: &Value, key: &str| row[key].as_f64().expect("a number");
    let basic = of("Fuji, basic, static, trace, cpu");
    assert!((n(basic, "ms_average") - n(basic, "overhead_ms") - n(basic, "net_ms")).abs() < 1e-9);
    assert!(n(basic, "ms_min") <= n(basic, "ms_average") && n(basic, "ms_average") <= n(basic, "ms_max"));
    assert_eq!((n(basic, "paper_ms"), n(basic, "paper_net_ms").round()), (99.6, 35.0));
    // What is traced exactly has no error worth it, the search has.
    for geometry in ["basic", "detail"] {
        let traced = of(&format!("Fuji, {geometry}, static, trace, cpu"));
        let searched = of(&format!("Fuji, {geometry}, static, search(128, 8), cpu"));
        assert!(n(traced, "error_footprints") < 0.1, "{traced}");
        assert!(n(searched, "error_footprints") > 10.0 * n(traced, "error_footprints"), "{searched}");
    }
    let ratio = of("detail to basic: Fuji, static, trace");
    let detail = of("Fuji, detail, static, trace, cpu");
    assert!((n(ratio, "net_ratio") - n(detail, "net_ms") / n(basic, "net_ms")).abs() < 1e-9);
    assert_eq!(ratio["reached"], n(ratio, "net_ratio") <= 4.0);
    assert!(rows.iter().any(|row| row["name"] == "dynamic to static: Fuji, detail, trace, paper's rewriter"));
    let table = std::fs::read_to_string(folder.path("out/table1.md")).expect("a table");
    assert!(table.contains("| Fuji | detail | dynamic |") && table.contains("paper: net"), "{table}");
}

#[test]
fn scaling_has_a_row_for_each_number_of_threads() {
    let folder = Folder::new("scaling_has_a_row_for_each_number_of_threads");
    let found = report(&folder, "--on cpu --size 16x16", "basic, ", "scaling");
    let rows = found["rows"].as_array().expect("rows");
    let first = rows.iter().find(|row| row["name"] == "basic, block, threads, cpu: 1").expect("a row");
    assert_eq!((&first["speedup_ratio"], &first["doubling_ratio"]), (&1.0.into(), &Value::Null));
    let second = rows.iter().find(|row| row["name"] == "basic, lane, threads, cpu: 2").expect("a row");
    assert_eq!(second["doubling_ratio"], second["speedup_ratio"]);
    folder.ghyll("bench scaling --on cpu --only nowhere").failed(2, &["--only", "GEOMETRY"]);
}

#[test]
fn scaling_counts_workgroups() {
    if !crate::support::machines().contains(&"gpu") {
        return;
    }
    let folder = Folder::new("scaling_counts_workgroups");
    let found = report(&folder, "--on gpu --size 32x24", "basic, lane", "scaling");
    let rows = found["rows"].as_array().expect("rows");
    let counts = |axis: &str| -> Vec<u64> {
        rows.iter().filter(|row| row["axis"] == axis).filter_map(|row| row["count"].as_u64()).collect()
    };
    assert_eq!(counts("workgroups"), [1, 2, 4, 8, 16, 32, 64]);
    assert_eq!(counts("invocations in a workgroup"), [4, 8, 16, 32, 64]);
}
