//! `ghyll repl`, from a pipe.

use crate::support::Folder;

#[test]
fn items_are_kept_and_expressions_evaluated() {
    let folder = Folder::new("items_are_kept_and_expressions_evaluated");
    folder.write(
        "m.ghyll",
        "use \"n.ghyll\";\nparam gain: f32 = 1.5;\nfn scaled(x: f32) -> f32 = gain * one() * x;",
    );
    folder.write("n.ghyll", "fn one() -> f32 = 1.0;");
    let input = "1 + 2\n\nfn twice(x: i32) -> i32 = 2 * x;\ntwice(21)\n\
        fn twice(x: i32) -> i32 = {\n  let y = x;\n  y + y\n};\ntwice(4);\nlet k = twice(3)\nk * k\n\
        :type |x: f32| vec2(x)\ntwice\n:load m.ghyll\nscaled(2.0)\nuse terrain;\nextent().x > 0.0\n0.1 + 0.2\n\
        sum(0..10,\n  |i| i)\n:quit\n1";
    let ended = folder.ghyll_fed(&["repl"], input);
    let expected =
        ["3", "42", "8", "36", "fn(f32) -> vec2", "a function: fn(i32) -> i32", "3.0", "true", "0.3", "45"];
    let lines: Vec<&str> = ended.printed().lines().collect();
    assert_eq!(lines, expected, "{}", ended.err);
}

#[test]
fn mistakes_are_told_and_change_nothing() {
    let folder = Folder::new("mistakes_are_told_and_change_nothing");
    let input = "fn f() -> i32 = 1;\nfn f() -> i32 = 1.5;\nf()\nf(2)\n:nonsense\nlet g = (\n";
    let ended = folder.ghyll_fed(&["repl"], input);
    ended.failed(1, &["E0301", "no command `:nonsense`", "4 inputs were wrong"]);
    assert_eq!(ended.out, "1\n");
    let ended = folder.ghyll_fed(&["repl"], "fn f() -> i32 = 1;\n:list\n:reset\n:list\n:help\n");
    assert!(ended.printed().starts_with("fn f() -> i32 = 1;\nType an expression"), "{}", ended.out);
}
