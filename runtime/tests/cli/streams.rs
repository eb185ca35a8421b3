//! Standard streams: what is read from, what is closed too early, what is written for programs.

use crate::support::Folder;
use serde_json::Value;
use std::process::{Command, Stdio};

const PROGRAM: &str = "fn fib(n: i32) -> i32 = if n < 2 { n } else { fib(n - 1) + fib(n - 2) };\nfn main(n: i32) -> i32 = fib(n);\nfn pixel(p: vec2) -> f32 = p.x;\n";

#[test]
fn a_program_comes_from_standard_input() {
    let folder = Folder::new("program_from_input");
    let fed = |arguments: &str| folder.ghyll_fed(&arguments.split(' ').collect::<Vec<_>>(), PROGRAM);
    assert_eq!(fed("run - --on cpu -- 10").printed(), "55");
    assert!(fed("check -").err.contains("no errors"));
    assert!(fed("trace - -- 2").printed().starts_with("s0: 2 fib"));
    assert!(fed("build - --emit table").printed().contains("task fib"));
    assert!(fed("explain -").printed().contains("fib"));
    fed("render - --on cpu --size 4x4 -o a.png").printed();
    assert!(folder.path("a.png").exists());
    folder.ghyll_fed(&["run", "-"], "fn main() -> i32 = x;").failed(1, &["<standard input>:1:20"]);
}

/// What closes its end, or takes nothing, is no reason to panic.
#[test]
#[cfg(target_os = "linux")]
fn streams_that_take_nothing_are_no_panic() {
    let folder = Folder::new("closed_streams");
    folder.write("p.ghyll", PROGRAM).write("bad.ghyll", "fn main() -> i32 = x;");
    let full = || Stdio::from(std::fs::File::options().write(true).open("/dev/full").expect("a device"));
    let run = |arguments: &str, out: Stdio, err: Stdio| {
        let arguments = arguments.split(' ');
        let mut command = Command::new(env!("CARGO_BIN_EXE_ghyll"));
        command.args(arguments).current_dir(folder.path("")).stdin(Stdio::null()).stdout(out).stderr(err);
        command.status().expect("it ends").code()
    };
    for (arguments, status) in [
        ("check bad.ghyll", 1),
        ("check p.ghyll", 0),
        ("run bad.ghyll", 1),
        ("run p.ghyll --on cpu --stats -- 3", 0),
        ("run nofile", 1),
        ("render p.ghyll --on cpu --size 4x4 -o a.png", 0),
        ("info nofile", 1),
        ("run", 2),
    ] {
        assert_eq!(run(arguments, Stdio::null(), full()), Some(status), "{arguments}");
    }
    // Standard output that is full is told, with the status of a failed run.
    assert_eq!(run("run p.ghyll --on cpu -- 3", full(), Stdio::null()), Some(3));
    assert_eq!(run("build p.ghyll --emit wgsl", full(), Stdio::null()), Some(3));
}

#[test]
fn reports_are_json_where_it_is_asked_for() {
    let folder = Folder::new("json_reports");
    folder.write("p.ghyll", PROGRAM);
    folder.write("map.ghyll", "use terrain; fn map(p: vec2) -> f32 = bilinear(p);");
    let report = |line: &str| -> Value {
        serde_json::from_str(folder.ghyll(line).printed()).unwrap_or_else(|e| panic!("{line}: {e}"))
    };
    let traced = report("trace p.ghyll --json -- 2");
    assert_eq!(traced["streams"][0], serde_json::json!(["2", "fib"]));
    assert_eq!(
        (&traced["finished"], &traced["streams"].as_array().expect("a list").last()),
        (&Value::Bool(true), &Some(&serde_json::json!(["1"])))
    );
    let built = report("build p.ghyll --entry main --emit table,spirv --json");
    assert!(built["table"].as_str().is_some_and(|table| table.contains("task fib")));
    assert_eq!(built["spirv"][0], 0x0723_0203);
    let drawn = report("render p.ghyll --on cpu --size 4x2 -o a.png --json");
    assert_eq!(
        (&drawn["files"][0], &drawn["width"], &drawn["machine"]),
        (&"a.png".into(), &4.into(), &"CPU twin".into())
    );
    let film = report("render p.ghyll --on cpu --size 4x2 --frames 0..2 -o a.png --json");
    assert_eq!(film["files"], serde_json::json!(["a-0000.png", "a-0001.png"]));
    let mapped = report("map map.ghyll --on cpu -o m.tif --json");
    assert_eq!((&mapped["files"][0], &mapped["height"]), (&"m.tif".into(), &512.into()));
}

#[test]
fn the_number_of_a_frame_needs_frames() {
    let folder = Folder::new("t_without_frames");
    folder.write("p.ghyll", "param s: f32 = 1.0; fn pixel(p: vec2) -> f32 = s;");
    folder.ghyll("render p.ghyll --on cpu --set s=t/2 -o a.png").failed(2, &["--set s=t/2", "--frames A..B"]);
    folder.write("q.ghyll", "const t = 3.0; param s: f32 = 1.0; fn pixel(p: vec2) -> f32 = s;");
    folder.ghyll("render q.ghyll --on cpu --set s=t --size 2x2 -o a.png").printed();
}
