//! No option is taken and then ignored without a word.

use crate::support::Folder;

const HEIGHT: &str = "use terrain; fn main() -> (vec2, vec2) = (texel(), relief());";

#[test]
fn reading_options_hold_for_the_builtin_field_too() {
    let folder = Folder::new("builtin_reading");
    folder.write("p.ghyll", HEIGHT);
    let spaced = folder.ghyll("run p.ghyll --on cpu --spacing 7,9");
    assert!(spaced.printed().starts_with("(vec2(7.0, 9.0)"), "{}", spaced.out);
    folder.ghyll("run p.ghyll --on cpu --heights 0,1").failed(1, &["GeoTIFF", "--heights"]);
    folder.ghyll("run p.ghyll --on cpu --encoding terrarium").failed(1, &["GeoTIFF", "--encoding"]);
}

#[test]
fn a_named_view_and_a_camera_exclude_each_other() {
    let folder = Folder::new("view_and_eye");
    folder.ghyll("render --view north --eye 0,0,9 --look-at 1,1,1").failed(2, &["--view", "--eye"]);
}

#[test]
fn what_a_machine_cannot_use_is_named() {
    let folder = Folder::new("unused_options");
    folder.write("p.ghyll", "fn main() -> i32 = 1;");
    let said = |line: &str| {
        let ended = folder.ghyll(line);
        assert_eq!(ended.printed(), "1");
        ended.err
    };
    let oracle = said("run p.ghyll --on oracle --rewriter lane --adapter x --block 64");
    for option in ["--rewriter", "--adapter", "--block"] {
        assert!(oracle.contains(option), "{oracle}");
    }
    let twin = said("run p.ghyll --on cpu --rewriter lane --checked");
    assert!(twin.contains("--checked") && !twin.contains("--rewriter"), "{twin}");
    assert_eq!(said("run p.ghyll --on cpu"), "");
}

#[test]
fn negative_values_are_refused_as_values() {
    let folder = Folder::new("negative_values");
    folder.write("p.ghyll", "fn main() -> i32 = 1;").write("q.ghyll", "fn pixel(p: vec2) -> f32 = 0.5;");
    folder.ghyll("run p.ghyll --timeout -1").failed(2, &["--timeout", "0 or more"]);
    folder.ghyll("run p.ghyll --max-memory -1").failed(2, &["--max-memory", "positive"]);
    folder.ghyll("run p.ghyll --max-rewrites -1").failed(2, &["--max-rewrites", "invalid"]);
    folder.ghyll("render q.ghyll --spacing -1").failed(2, &["--spacing", "positive"]);
    folder.ghyll("render q.ghyll --fov -1").failed(2, &["--fov", "between 0 and 180"]);
    folder.ghyll("render q.ghyll --size -1x4").failed(2, &["--size", "whole number"]);
}

#[test]
fn a_byte_order_mark_is_no_part_of_a_program() {
    let folder = Folder::new("byte_order_mark");
    folder.write("p.ghyll", "\u{feff}use \"m.ghyll\";\nfn main() -> i32 = one();");
    folder.write("m.ghyll", "\u{feff}fn one() -> i32 = 1;");
    assert_eq!(folder.ghyll("run p.ghyll --on cpu").printed(), "1");
}
