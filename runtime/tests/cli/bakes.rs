//! `@bake` and `--no-bake`: whether a function is read or called shows between the samples.

use crate::support::{Folder, machines};

const FLAT: &str = "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\n0 0 0\n0 0 0\n";
const SQUARE: &str = "
    param on: bool = true;
    param k: f32 = 1.0;
    @bake fn square(p: vec2) -> f32 = k * p.x * p.x;
    fn pixel(p: vec2) -> f32 = if on { square(vec2(5.0, 0.0)) } else { p.x };
";

/// The first number of the picture, and what was said.
fn render(folder: &Folder, more: &str) -> (f32, String) {
    render_of(folder, "flat.asc", more)
}

fn render_of(folder: &Folder, field: &str, more: &str) -> (f32, String) {
    let ended = folder.ghyll(&format!("render p.ghyll --dem {field} --size 2x2 -o p.npy {more}"));
    ended.printed();
    let bytes = std::fs::read(folder.path("p.npy")).unwrap();
    let at = bytes.len() - 16;
    (f32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]), ended.err)
}

#[test]
fn a_bake_is_read_between_its_samples() {
    let folder = Folder::new("bake_between");
    folder.write("p.ghyll", SQUARE).write("flat.asc", FLAT);
    for machine in machines().iter().filter(|m| **m != "oracle") {
        let on = |more: &str| render(&folder, &format!("--on {machine} {more}")).0;
        assert_eq!(on(""), 50.0, "{machine}");
        assert_eq!(on("--no-bake"), 25.0, "{machine}");
        assert_eq!(on("--set k=2 --live k"), 100.0, "{machine}");
    }
    assert_eq!(render(&folder, "--on oracle").0, 25.0);
}

/// A field with many more samples than the picture has pixels is not baked, unless that is asked for.
#[test]
fn a_large_field_is_baked_only_if_asked_for() {
    let folder = Folder::new("bake_large");
    folder.write("p.ghyll", SQUARE);
    let side = 300;
    let mut field = format!("P5\n{side} {side}\n255\n").into_bytes();
    field.resize(field.len() + side * side, 0);
    std::fs::write(folder.path("flat.pgm"), field).unwrap();
    let first = |more: &str| render_of(&folder, "flat.pgm", &format!("--spacing 10 --on cpu {more}"));
    let (called, said) = first("");
    assert_eq!(called, 25.0);
    assert!(said.contains("not baking: the field has 90000 samples, for 4 rays"), "{said}");
    let (read, said) = first("--bake");
    assert_eq!(read, 50.0);
    assert!(!said.contains("not baking"), "{said}");
    let (called, said) = first("--no-bake");
    assert!(called == 25.0 && !said.contains("not baking"), "{said}");
}

#[test]
fn statistics_show_what_a_bake_takes_if_it_is_needed() {
    let folder = Folder::new("bake_statistics");
    folder.write("p.ghyll", SQUARE).write("flat.asc", FLAT);
    for machine in machines().iter().filter(|m| **m != "oracle") {
        let said = |more: &str| render(&folder, &format!("--on {machine} --stats json {more}")).1;
        // Three by two samples of four bytes.
        assert!(said("").contains("\"bakes\":24"), "{machine}");
        for none in ["--set on=false", "--no-bake"] {
            assert!(said(none).contains("\"bakes\":0"), "{machine} {none}");
        }
        assert!(render(&folder, &format!("--on {machine} --stats")).1.contains("baking"), "{machine}");
    }
}

#[test]
fn memory_that_is_advised_is_enough() {
    let folder = Folder::new("bake_memory");
    let text = "use terrain; @bake fn b(p: vec2) -> vec2 = p; fn pixel(p: vec2) -> f32 = b(p).x;";
    folder.write("p.ghyll", text);
    let field =
        format!("ncols 200\nnrows 200\nxllcorner 0\nyllcorner 0\ncellsize 9\n{}", "1 ".repeat(40_000));
    folder.write("d.asc", field);
    for on in machines().iter().filter(|on| **on != "oracle") {
        // A picture smaller than the bake, and a larger one.
        for size in ["8x8", "500x500"] {
            let line =
                format!("render p.ghyll --on {on} --bake --dem d.asc --size {size} -o b.png --max-memory");
            let refused = folder.ghyll(&format!("{line} 1K"));
            refused.failed(3, &["bakes ", "--no-bake"]);
            let advised = refused.err.split("--max-memory ").nth(1).unwrap();
            let least = advised.split([' ', ';', '\n']).next().unwrap();
            folder.ghyll(&format!("{line} {least}")).printed();
        }
    }
}
