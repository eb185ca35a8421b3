//! `--set` and `--live`.

use crate::support::{Folder, machines};

const PROGRAM: &str = "
    param gain: i32 = 6;
    param at: vec2 = vec2(1.0, 2.0);
    param op: fn(i32) -> i32 = same;
    fn same(x: i32) -> i32 = x;
    fn main(x: i32) -> (i32, f32) = (op(x) * gain, at.y);
    fn pixel(p: vec2) -> f32 = f32(gain) * at.y;
";

#[test]
fn live_parameters_have_their_values_everywhere() {
    let folder = Folder::new("live_parameters");
    folder.write("p.ghyll", PROGRAM);
    for machine in machines() {
        let run = |more: &str| {
            let line = format!("run p.ghyll --on {machine} {more}");
            folder.ghyll(&line).printed().to_owned()
        };
        assert_eq!(run("--live gain --live at -- 2"), "(12, 2.0)", "{machine}");
        assert_eq!(run("--live gain --set gain=-7 -- 2"), "(-14, 2.0)", "{machine}");
        assert_eq!(run("--live at --set at=vec2(0,0.5) --live gain -- 1"), "(6, 0.5)", "{machine}");
        assert_eq!(run("--set gain=5 -- 2"), "(10, 2.0)", "{machine}");

        folder
            .ghyll(&format!("render p.ghyll --on {machine} --live gain --live at --size 2x1 -o p.npy"))
            .printed();
        let bytes = std::fs::read(folder.path("p.npy")).unwrap();
        assert_eq!(bytes[bytes.len() - 4..], 12f32.to_le_bytes(), "{machine}");
    }
    assert!(folder.ghyll("trace p.ghyll --live gain -- 2").printed().ends_with("12 2.0"));
}

#[test]
fn what_is_set_may_bind_names() {
    let folder = Folder::new("set_binds_names");
    folder.write("p.ghyll", PROGRAM);
    for machine in machines() {
        let set = ["run", "p.ghyll", "--on", machine, "--set", "op=|x| { let y = x + 1; y * y }", "--", "2"];
        assert_eq!(folder.ghyll_with(&set).printed(), "(54, 2.0)", "{machine}");
    }
}

#[test]
fn check_looks_at_live_parameters_as_such() {
    let folder = Folder::new("check_live");
    let program = "
        struct S(f: fn(i32) -> i32);
        param s: S = S(inc);
        fn inc(x: i32) -> i32 = x + 1;
        fn main(x: i32) -> i32 = (s.f)(x);
    ";
    folder.write("p.ghyll", program);
    folder.ghyll("check p.ghyll").printed();
    folder.ghyll("check p.ghyll --live s").failed(1, &["E0906", "holds functions inside of data"]);
    folder.ghyll("check p.ghyll --live t").failed(2, &["no parameter `t`"]);
}

#[test]
fn values_that_do_not_fit_are_wrong_usage() {
    let folder = Folder::new("wrong_values");
    folder.write(
        "p.ghyll",
        "param k: i32 = 3; param b: bool = true; fn main(x: i32) -> i32 = if b { x + k } else { x };",
    );
    for (line, part) in [
        ("run p.ghyll --set k=2.5 -- 1", "cannot be `2.5`"),
        ("run p.ghyll --set k= -- 1", "cannot be ``"),
        ("run p.ghyll --set b=yes -- 1", "cannot be `yes`"),
        ("check p.ghyll --set k=2.5", "cannot be `2.5`"),
        ("run p.ghyll -- 1.5", "expected `i32`"),
        ("run p.ghyll -- abc", "`abc`"),
        ("run p.ghyll 5", "after `--`: `-- 5`"),
    ] {
        folder.ghyll(line).failed(2, &[part]);
    }
    folder.write("wrong.ghyll", "fn main() -> i32 = 1.5;").ghyll("run wrong.ghyll").failed(1, &["E0301"]);
    folder.write("empty.ghyll", "").ghyll("run empty.ghyll").failed(1, &["no `fn main`"]);
    folder.write("other.ghyll", "fn f() -> i32 = 1;").ghyll("run other.ghyll").failed(2, &["--entry"]);
}

#[test]
fn what_is_set_reads_no_parameter() {
    let folder = Folder::new("set_reads_a_parameter");
    let program = "param a: i32 = 2; param f: fn(i32) -> i32 = same; fn same(x: i32) -> i32 = x * a; fn main() -> i32 = f(1);";
    folder.write("p.ghyll", program);
    folder
        .ghyll_with(&["run", "p.ghyll", "--set", "f=|x| x * a"])
        .failed(2, &["`a` is a parameter", "reads none"]);
}
