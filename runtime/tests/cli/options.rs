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
    folder.ghyll("render q.ghyll --fov -1").failed(2, &["--fov", "more than 0 and less than 180"]);
    folder.ghyll("render q.ghyll --size -1x4").failed(2, &["--size", "whole number"]);
}

#[test]
fn a_byte_order_mark_is_no_part_of_a_program() {
    let folder = Folder::new("byte_order_mark");
    folder.write("p.ghyll", "\u{feff}use \"m.ghyll\";\nfn main() -> i32 = one();");
    folder.write("m.ghyll", "\u{feff}fn one() -> i32 = 1;");
    assert_eq!(folder.ghyll("run p.ghyll --on cpu").printed(), "1");
}

const GREY: &str = "fn pixel(p: vec2) -> f32 = 0.5;";

#[test]
fn a_raster_without_name_or_file_is_told() {
    let folder = Folder::new("empty_raster");
    folder.write("p.ghyll", "use terrain; raster r: f32; fn pixel(p: vec2) -> f32 = r(p);");
    folder.ghyll("render p.ghyll --raster r=").failed(2, &["--raster r=", "r=photo.png"]);
    folder.ghyll("render p.ghyll --raster =a.png").failed(2, &["=a.png", "name"]);
}

#[test]
fn fields_of_view_have_open_ends() {
    let folder = Folder::new("field_of_view");
    folder.write("p.ghyll", "use terrain; fn pixel(p: vec2) -> f32 = camera(p).dir.z;");
    let line = "render p.ghyll --on cpu --size 2x2";
    folder.ghyll(&format!("{line} --fov 180")).failed(2, &["--fov 180", "less than 180", "panorama"]);
    folder.ghyll(&format!("{line} --fov 181")).failed(2, &["--fov", "less than 180", "panorama"]);
    folder.ghyll(&format!("{line} --fov 180 --view panorama")).printed();
}

#[test]
fn the_curvature_may_stand_behind_a_blank() {
    let folder = Folder::new("curvature_value");
    folder.write("p.ghyll", GREY);
    folder.ghyll("render p.ghyll --on cpu --size 1x1 --curvature 0.2").printed();
    folder.ghyll("render --curvature p.ghyll --on cpu --size 1x1").printed();
    folder.ghyll("render p.ghyll --curvature=1").failed(2, &["--curvature", "less than 1"]);
}

#[test]
fn what_cannot_be_written_is_known_before_the_work() {
    let folder = Folder::new("unwritable");
    // It would take longer than any test.
    folder.write("p.ghyll", "fn f(n: i32) -> i32 = f(n + 1); fn pixel(p: vec2) -> f32 = f32(f(0));");
    folder.write("m.ghyll", "fn f(n: i32) -> i32 = f(n + 1); fn map(p: vec2) -> f32 = f32(f(0));");
    folder.write("plain", "a file");
    for output in ["plain/out.png", "none/out.png"] {
        folder.ghyll(&format!("render p.ghyll --on cpu -o {output}")).failed(2, &[output, "folder"]);
        folder.ghyll(&format!("map m.ghyll --on cpu -o {output}")).failed(2, &[output, "folder"]);
        folder.ghyll(&format!("render p.ghyll --on cpu --tune --tuning {output}")).failed(2, &[output]);
    }
    if cfg!(target_os = "linux") {
        for line in ["-o /proc/out.png", "-o /proc/out.gif --frames 0..2", "--tune --tuning /proc/out.png"] {
            folder.ghyll(&format!("render p.ghyll --on cpu {line}")).failed(2, &["cannot write /proc/out."]);
        }
        folder.ghyll("render p.ghyll --on cpu -o /proc/o.png --frames 0..2").failed(2, &["/proc/o-0000.png"]);
    }
}

#[test]
fn a_run_that_fails_leaves_outputs_as_they_were() {
    let folder = Folder::new("left_alone");
    folder.write("p.ghyll", "fn f(n: i32) -> i32 = f(n + 1); fn pixel(p: vec2) -> f32 = f32(f(0));");
    folder.write("old.png", "kept");
    for output in ["new.png", "old.png"] {
        let line = format!("render p.ghyll --on cpu --size 1x1 --max-rewrites 10 --timeout 1 -o {output}");
        folder.ghyll(&line).failed(3, &["`f`"]);
    }
    assert!(!folder.path("new.png").exists());
    assert_eq!(std::fs::read(folder.path("old.png")).unwrap(), b"kept");
}

#[test]
fn a_tuning_file_without_the_tuner_is_told() {
    let folder = Folder::new("tuning_alone");
    folder.write("p.ghyll", GREY);
    let ended = folder.ghyll("render p.ghyll --on cpu --size 1x1 --tuning t.json");
    ended.printed();
    assert!(
        ended.err.contains("--tuning t.json has no effect") && ended.err.contains("--tune"),
        "{}",
        ended.err
    );
    let ended = folder.ghyll("render p.ghyll --on cpu --size 1x1 --samples 1 --tune --tuning t.json");
    ended.printed();
    assert!(ended.err.contains("measuring 1 choice\n"), "{}", ended.err);
}

#[test]
fn an_eye_in_the_ground_and_a_field_without_heights_are_told() {
    let folder = Folder::new("nothing_to_see");
    folder.write("p.ghyll", "use terrain; fn pixel(p: vec2) -> f32 = camera(p).dir.z + bilinear(p);");
    let grid = |a: &str| {
        format!("ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 9\nnodata_value -9\n{a} {a} {a} {a}\n")
    };
    folder.write("d.asc", grid("50")).write("v.asc", grid("-9"));
    let line = "render p.ghyll --on cpu --size 2x2 --dem";
    let said = |more: &str| {
        let ended = folder.ghyll(&format!("{line} d.asc {more}"));
        ended.printed();
        ended.err
    };
    let ground = said("--eye 4,4,20 --look-at 9,9,9");
    assert!(ground.contains("30.0 m under the ground") && ground.contains("--eye"), "{ground}");
    let around = said("--view panorama --eye 4,4,20 --frames 0..3");
    assert_eq!(around.matches("under the ground").count(), 1, "{around}");
    assert!(around.contains("leave it out"), "{around}");
    assert!(!said("--view panorama --eye 4,4").contains("under"));
    for more in ["", "--voids fill"] {
        folder
            .ghyll(&format!("{line} v.asc {more}"))
            .failed(1, &["v.asc", "each of its 4 samples", "--nodata"]);
    }
}
