//! `ghyll build`: every form is what it claims to be.

use crate::support::Folder;
use ghyll_compiler::wgsl::validate;
use std::path::Path;

/// A value, a picture fused whole, a picture by tasks, a picture with bakes, a map.
const PROGRAMS: [(&str, &str); 5] = [
    ("fib", "execute"),
    ("mandelbrot", "direct"),
    ("sphere", "draw_pixels"),
    ("fig9", "direct"),
    ("slope", "direct"),
];

fn build(folder: &Folder, program: &str, forms: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../lang-examples/{program}.ghyll"));
    folder.ghyll_with(&["build", path.to_str().unwrap(), "--emit", forms, "-o", "."]).printed();
}

fn text(folder: &Folder, name: &str) -> String {
    std::fs::read_to_string(folder.path(name)).expect("a text")
}

/// Names of the entry points.
fn entry_points(spirv: &[u8]) -> Result<Vec<String>, String> {
    let module = rspirv::dr::load_bytes(spirv).map_err(|e| e.to_string())?;
    let name = |i: &rspirv::dr::Instruction| i.operands[2].unwrap_literal_string().to_owned();
    Ok(module.entry_points.iter().map(name).collect())
}

#[test]
fn every_language_has_the_kernel() {
    let folder = Folder::new("every_language_has_the_kernel");
    for (program, kernel) in PROGRAMS {
        build(&folder, program, "wgsl,spirv,msl,hlsl,glsl");
        let wgsl = text(&folder, &format!("{program}.wgsl"));
        validate(&wgsl).unwrap_or_else(|e| panic!("{program}: {e}"));
        assert!(wgsl.contains(&format!("fn {kernel}(")), "{program}");
        let spirv = std::fs::read(folder.path(&format!("{program}.spv"))).unwrap();
        assert_eq!(entry_points(&spirv), Ok(vec![kernel.to_owned()]), "{program}");
        assert!(text(&folder, &format!("{program}.metal")).contains(&format!("kernel void {kernel}(")));
        let hlsl = text(&folder, &format!("{program}.hlsl"));
        assert!(hlsl.contains("[numthreads(") && hlsl.contains(&format!("void {kernel}(")), "{program}");
        let glsl = text(&folder, &format!("{program}.glsl"));
        assert!(glsl.starts_with("#version 450") && glsl.contains("void main()"), "{program}");
    }
    // What is damaged is noticed.
    let spirv = std::fs::read(folder.path("fib.spv")).unwrap();
    assert!(entry_points(&spirv[..spirv.len() - 8]).is_err());
    assert!(validate(&text(&folder, "fib.wgsl").replacen("let ", "lte ", 1)).is_err());
}

/// Boxes and arrows of a Graphviz text.
fn counts(dot: &str) -> (usize, usize) {
    let lines = || dot.lines().map(str::trim);
    (
        lines().filter(|l| l.starts_with('n') && l.contains(" [label=") && !l.contains("->")).count(),
        lines().filter(|l| l.contains("->")).count(),
    )
}

#[test]
fn networks_have_every_task() {
    let folder = Folder::new("networks_have_every_task");
    for (program, _) in PROGRAMS {
        // Bakes have tables of their own, which `table` does not show.
        let forms = "table,dot,svg";
        build(&folder, program, forms);
        let table = text(&folder, &format!("{program}.table"));
        let tasks = table.lines().filter(|l| l.starts_with("task ")).count();
        let dot = text(&folder, &format!("{program}.dot"));
        let bakes = dot.matches("subgraph").count();
        let (boxes, arrows) = counts(&dot);
        assert_eq!(boxes, tasks + bakes, "{program}: {dot}");
        let svg = text(&folder, &format!("{program}.svg"));
        let drawn = roxmltree::Document::parse(&svg).unwrap_or_else(|e| panic!("{program}: {e}"));
        let within = |tag: &str| {
            drawn
                .descendants()
                .filter(|n| n.has_tag_name(tag) && !n.ancestors().any(|a| a.has_tag_name("defs")))
                .count()
        };
        // One rectangle is the ground.
        assert_eq!((within("rect") - 1, within("path")), (boxes, arrows), "{program}");
    }
    let dot = text(&folder, "fib.dot");
    assert_eq!(counts(&dot), (3, 3));
    assert_ne!(counts(&dot.replacen("n0_1 [", "x0_1 [", 1)), (3, 3));
}

#[test]
fn forms_go_where_they_are_sent() {
    let folder = Folder::new("forms_go_where_they_are_sent");
    folder.write("p.ghyll", "fn main(n: i32) -> i32 = n + 1;");
    assert!(folder.ghyll("build p.ghyll --emit dot,svg").printed().contains("// svg\n<svg"));
    folder.ghyll("build p.ghyll --emit spirv,wgsl").failed(2, &["binary", "-o FOLDER"]);
    folder.ghyll("build p.ghyll --emit spirv -o out.spv").printed();
    assert_eq!(std::fs::read(folder.path("out.spv")).unwrap()[..4], 0x0723_0203u32.to_le_bytes());
    folder.ghyll("build p.ghyll --emit wgsl,dot -o made").printed();
    assert!(folder.path("made/p.dot").exists() && folder.path("made/p.wgsl").exists());
    folder.ghyll("build p.ghyll --emit stream -o p.ghyll -- 1").failed(2, &["the program itself"]);
    folder.ghyll("build p.ghyll --emit dot -o none/p.dot").failed(2, &["cannot write", "none"]);
    folder.ghyll("build p.ghyll --emit llvm").failed(2, &["llvm", "spirv"]);
    let many: String = (0..450).map(|i| format!("@task fn f{i}(x: i32) -> i32 = x * {i};")).collect();
    let calls: Vec<String> = (0..450).map(|i| format!("f{i}(n)")).collect();
    folder.write("many.ghyll", format!("{many} fn main(n: i32) -> i32 = {};", calls.join(" + ")));
    folder.ghyll("build many.ghyll --emit svg").failed(2, &["too many for a drawing", "dot"]);
}
