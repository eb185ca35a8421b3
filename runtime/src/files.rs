//! Programs on disk.

use ghyll_compiler::source::{Files, Source};
use std::path::Path;

/// Longest program text that is read.
const LONGEST_PROGRAM: u64 = 64 << 20;

/// Modules from the file system; names are relative to the current folder.
pub struct Disk;

impl Files for Disk {
    fn read(&self, name: &str) -> Result<String, String> {
        read(Path::new(name))
    }
}

/// A program's text under the name of its file.
///
/// # Errors
/// Why there is none, with the file's name.
pub fn source(path: &Path) -> Result<Source, String> {
    let shown = path.display();
    let text = read(path).map_err(|reason| format!("cannot read {shown}: {reason}"))?;
    Ok(Source::new(shown.to_string(), text))
}

fn read(path: &Path) -> Result<String, String> {
    let found = std::fs::metadata(path).map_err(|e| e.to_string())?;
    if found.is_dir() {
        return Err("it is a folder; name a .ghyll file in it".into());
    }
    if found.len() > LONGEST_PROGRAM {
        return Err("it is longer than 64 MiB, so hardly a program".into());
    }
    let bytes = std::fs::read(path).map_err(|e| e.to_string())?;
    String::from_utf8(bytes).map_err(|e| {
        let at = e.utf8_error().valid_up_to();
        format!("it is not UTF-8 (first bad byte at offset {at}); save it as UTF-8")
    })
}
