//! `ghyll fmt`: what is written, and what is left alone.

use crate::support::Folder;

const UGLY: &str = "\u{feff}fn  main( )->i32=1 ;// one\r\n";
const NEAT: &str = "fn main() -> i32 = 1;    // one\n";

#[test]
fn files_are_formatted_in_place_once() {
    let folder = Folder::new("files_are_formatted_in_place_once");
    folder.write("a.ghyll", UGLY).write("b.ghyll", NEAT);
    let read = |name: &str| std::fs::read_to_string(folder.path(name)).unwrap();
    let checked = folder.ghyll("fmt --check a.ghyll b.ghyll");
    checked.failed(1, &["a.ghyll: not formatted", "one file"]);
    assert!(!checked.err.contains("b.ghyll") && read("a.ghyll") == UGLY);
    let ended = folder.ghyll("fmt --json a.ghyll b.ghyll");
    let report = ended.printed();
    assert!(report.contains("\"changed\":true") && report.contains("\"changed\":false"), "{report}");
    assert_eq!((read("a.ghyll"), read("b.ghyll")), (NEAT.into(), NEAT.into()));
    let again = folder.ghyll("fmt a.ghyll b.ghyll --check");
    assert_eq!((again.printed(), again.err.as_str()), ("", ""));
}

#[test]
fn programs_with_errors_are_left_alone() {
    let folder = Folder::new("programs_with_errors_are_left_alone");
    let wrong = "fn main( -> i32 = 1;";
    folder.write("wrong.ghyll", wrong).write("a.ghyll", UGLY);
    folder.ghyll("fmt wrong.ghyll a.ghyll").failed(1, &["wrong.ghyll"]);
    assert_eq!(std::fs::read_to_string(folder.path("wrong.ghyll")).unwrap(), wrong);
    // The others are formatted all the same.
    assert_eq!(std::fs::read_to_string(folder.path("a.ghyll")).unwrap(), NEAT);
    folder.ghyll("fmt none.ghyll").failed(1, &["none.ghyll"]);
    folder.ghyll("fmt").failed(2, &["FILE"]);
    folder.ghyll("fmt - a.ghyll").failed(2, &["stands alone"]);
}

#[test]
fn standard_input_is_written_to_standard_output() {
    let folder = Folder::new("standard_input_is_written_to_standard_output");
    let ended = folder.ghyll_fed(&["fmt", "-"], UGLY);
    assert_eq!((ended.printed(), ended.err.as_str()), (NEAT.trim_end(), ""));
    folder.ghyll_fed(&["fmt", "-", "--check"], UGLY).failed(1, &["standard input: not formatted"]);
    folder.ghyll_fed(&["fmt", "-"], "fn").failed(1, &["standard input"]);
}
