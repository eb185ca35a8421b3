//! The shaders of the example programs, as naga and, where it is installed, Tint see them.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use super::super::shader::{Kernel, source};
use super::super::shape::Shape;
use super::super::*;
use crate::machine::Job;
use crate::terrain::wgsl::{Format, wgsl};
use ghyll_compiler::compile::{Compiled, Options, check, compile};
use ghyll_compiler::front::Checked;
use ghyll_compiler::source::Source;

fn examples() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../lang-examples");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut programs: Vec<_> = files.filter(|p| p.extension().is_some_and(|e| e == "ghyll")).collect();
    programs.sort();
    programs
}

fn compiled(path: &Path) -> (Checked, Compiled) {
    let name = path.file_name().unwrap().to_string_lossy().into_owned();
    let checked = check(Source::new(name, std::fs::read_to_string(path).unwrap())).unwrap();
    let compiled = compile(&checked, &Options::default()).unwrap();
    (checked, compiled)
}

/// All kernels of a program: as it is and with its long loops as tasks, on fields of both formats.
fn kernels(path: &Path) -> Vec<(String, String)> {
    let (checked, compiled) = compiled(path);
    let job = Job { checked: &checked, compiled: &compiled, scene: None };
    let components = match compiled.back.wgsl.has_shade {
        true => compiled.result_words(&checked.module),
        false => 0,
    };
    let mut found = Vec::new();
    for format in [Format::I16, Format::F32] {
        let prelude = wgsl(&compiled.back.wgsl.intrinsics, format).text;
        let code = job.code(compiled.entry, &compiled.back, prelude.clone());
        let lifted = code.suspendable.iter().map(|s| Code { prelude: prelude.clone(), ..s.code() });
        for code in lifted.chain([code.clone()]) {
            for software in [false, true] {
                let shape = Shape::new(&code, &Config::default(), components, software).unwrap();
                let wanted = |kernel: &&Kernel| code.has_shade || **kernel != Kernel::Direct;
                for kernel in Kernel::ALL.iter().filter(wanted) {
                    let name = format!("{} {}", path.display(), kernel.name());
                    found.push((name, source(*kernel, &shape, &code).unwrap()));
                }
            }
        }
    }
    found.sort();
    found.dedup_by(|a, b| a.1 == b.1);
    found
}

/// Tint's opinion, none if it is not installed.
fn tint(text: &str) -> Option<Result<(), String>> {
    static FILES: AtomicU32 = AtomicU32::new(0);
    let name = format!("ghyll-{}-{}", std::process::id(), FILES.fetch_add(1, Relaxed));
    let [file, sink] = ["wgsl", "out.wgsl"].map(|end| std::env::temp_dir().join(format!("{name}.{end}")));
    std::fs::write(&file, text).unwrap();
    let output = Command::new("tint").args(["--format", "wgsl", "-o"]).args([&sink, &file]).output().ok()?;
    let _ = (std::fs::remove_file(&file), std::fs::remove_file(&sink));
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    Some(if output.status.success() { Ok(()) } else { Err(told) })
}

#[test]
fn every_shader_of_the_examples_is_valid() {
    use wgpu::naga::valid::{Capabilities, ValidationFlags, Validator};
    if tint("fn f() -> u32 { return 1u; }").is_none() {
        eprintln!("NOT TESTED WITH TINT: it is not installed");
    }
    let examples = examples();
    assert!(examples.len() > 5);
    for path in examples {
        for (name, text) in kernels(&path) {
            let module = wgpu::naga::front::wgsl::parse_str(&text)
                .unwrap_or_else(|error| panic!("{name}: {}", error.emit_to_string(&text)));
            Validator::new(ValidationFlags::all(), Capabilities::empty())
                .validate(&module)
                .unwrap_or_else(|error| panic!("{name}: {}", error.emit_to_string(&text)));
            tint(&text).unwrap_or(Ok(())).unwrap_or_else(|told| panic!("{name}: {told}"));
        }
    }
}

#[test]
fn a_wrong_shader_is_seen() {
    let wrong = tint("fn f() -> u32 { return 1i; }");
    assert!(wrong.is_none_or(|told| told.is_err_and(|text| text.contains("return"))));
}
