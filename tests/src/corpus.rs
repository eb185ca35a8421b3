//! Every program of the repository.

use std::path::Path;

const FOLDERS: &[&str] = &["tests/suite", "lang-examples", "benches", "compiler/std"];

/// Single programs: the cases of a case file are taken apart.
pub fn corpus() -> Vec<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut texts = Vec::new();
    for folder in FOLDERS {
        gather(&root.join(folder), &mut texts);
    }
    texts
}

fn gather(path: &Path, out: &mut Vec<String>) {
    if path.is_dir() {
        let entries = std::fs::read_dir(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let mut paths: Vec<_> = entries.filter_map(|entry| entry.ok().map(|e| e.path())).collect();
        paths.sort();
        paths.iter().for_each(|path| gather(path, out));
    } else if path.extension().is_some_and(|ending| ending == "ghyll") {
        let text = std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let mut case = String::new();
        for line in text.split_inclusive('\n') {
            let begins = line.starts_with("//# case") || line.starts_with("//# file");
            if begins && !case.trim().is_empty() {
                out.push(std::mem::take(&mut case));
            }
            if !line.starts_with("//#") {
                case.push_str(line);
            }
        }
        if !case.trim().is_empty() {
            out.push(case);
        }
    }
}
