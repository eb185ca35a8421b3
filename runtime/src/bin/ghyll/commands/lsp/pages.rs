//! Texts that are part of the compiler, as files that an editor can open: library modules and pages of diagnostics.

use super::uri;
use lsp_types::Uri;
use std::path::PathBuf;

/// The address of a file with that text; none if it cannot be written.
pub fn page(name: &str, text: &str) -> Option<Uri> {
    let folder = folder().join(env!("CARGO_PKG_VERSION"));
    let file = folder.join(name);
    let current = std::fs::read_to_string(&file).is_ok_and(|written| written == text);
    if !current {
        std::fs::create_dir_all(&folder).ok()?;
        // Another server may read it at the same time.
        let part = folder.join(format!("{name}.{}", std::process::id()));
        std::fs::write(&part, text).ok()?;
        std::fs::rename(&part, &file).ok()?;
    }
    uri::of_file(&file)
}

/// Where programs keep what they can make again.
fn folder() -> PathBuf {
    let variable = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let cache = variable("XDG_CACHE_HOME")
        .or_else(|| variable("LOCALAPPDATA"))
        .or_else(|| variable("HOME").map(|home| home.join(".cache")));
    cache.unwrap_or_else(std::env::temp_dir).join("ghyll")
}
