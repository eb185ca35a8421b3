//! Programs on disk.

use ghyll_compiler::source::{Files, Source};
use std::fs::File;
use std::io::Read;
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

/// The program on standard input.
///
/// # Errors
/// Why there is none.
pub fn input() -> Result<Source, String> {
    let text =
        read_from(std::io::stdin()).map_err(|reason| format!("cannot read standard input: {reason}"))?;
    Ok(Source::new("<standard input>", text))
}

fn read(path: &Path) -> Result<String, String> {
    if path.is_dir() {
        return Err("it is a folder; name a .ghyll file in it".into());
    }
    read_from(File::open(path).map_err(|e| e.to_string())?)
}

fn read_from(from: impl Read) -> Result<String, String> {
    let mut bytes = Vec::new();
    // Devices and pipes do not say how long they are.
    from.take(LONGEST_PROGRAM + 1).read_to_end(&mut bytes).map_err(|e| e.to_string())?;
    if bytes.len() as u64 > LONGEST_PROGRAM {
        return Err("it is longer than 64 MiB, so hardly a program".into());
    }
    let text = String::from_utf8(bytes).map_err(|e| {
        let at = e.utf8_error().valid_up_to();
        format!("it is not UTF-8 (first bad byte at offset {at}); save it as UTF-8")
    })?;
    // Some editors begin UTF-8 with a byte order mark.
    Ok(match text.strip_prefix('\u{feff}') {
        Some(rest) => rest.to_owned(),
        None => text,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(unix)]
    fn a_file_without_an_end_is_refused() {
        assert!(read(Path::new("/dev/zero")).unwrap_err().contains("64 MiB"));
    }
}
