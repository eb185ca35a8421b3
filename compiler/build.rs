//! Makes the parser from `src/grammar.lalrpop`, and the table of pages from `docs/errors/`.

use std::fmt::Write;
use std::path::Path;
use std::{env, fs};

fn main() {
    println!("cargo:rerun-if-changed=src/grammar.lalrpop");
    lalrpop::Configuration::new()
        .use_cargo_dir_conventions()
        .emit_rerun_directives(true)
        .process()
        .expect("the grammar is free of conflicts");
    pages();
}

/// `[(code, text of its page), ..]`, in the order of the codes.
fn pages() {
    let folder = Path::new(&env::var_os("CARGO_MANIFEST_DIR").expect("set by cargo")).join("../docs/errors");
    println!("cargo:rerun-if-changed={}", folder.display());
    let entries = fs::read_dir(&folder).expect("the pages are part of the repository");
    let mut files: Vec<_> = entries.map(|entry| entry.expect("a readable folder").path()).collect();
    files.sort();
    let mut table = String::from("&[\n");
    for file in files.iter().filter(|file| file.extension().is_some_and(|e| e == "md")) {
        let code = file.file_stem().expect("a file with an ending").to_string_lossy();
        writeln!(table, "({code:?}, include_str!({file:?})),").expect("a text takes all that is written");
    }
    table.push(']');
    let out = Path::new(&env::var_os("OUT_DIR").expect("set by cargo")).join("pages.rs");
    fs::write(out, table).expect("cargo's folder can be written");
}
