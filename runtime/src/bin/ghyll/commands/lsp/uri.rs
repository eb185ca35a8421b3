//! Addresses of documents and names of files.

use lsp_types::Uri;
use percent_encoding::{AsciiSet, CONTROLS, percent_decode_str, utf8_percent_encode};
use std::path::Path;

/// What stands for itself in the path of an address stays; the rest is escaped.
const ESCAPED: &AsciiSet = &CONTROLS
    .add(b' ')
    .add(b'"')
    .add(b'#')
    .add(b'%')
    .add(b'<')
    .add(b'>')
    .add(b'?')
    .add(b'[')
    .add(b'\\')
    .add(b']')
    .add(b'^')
    .add(b'`')
    .add(b'{')
    .add(b'|')
    .add(b'}');

/// The name that the compiler gets for a document: its file's path with `/` between folders, else its whole address.
pub fn name(uri: &Uri) -> String {
    let text = uri.as_str();
    let Some(rest) = text.strip_prefix("file://") else { return text.to_owned() };
    // A host before the path, such as `localhost`, says nothing here.
    let path = rest.find('/').map_or("", |start| &rest[start..]);
    let path = percent_decode_str(path).decode_utf8_lossy().replace('\\', "/");
    match path.as_bytes() {
        // `/C:/x` is `C:/x`.
        [b'/', drive, b':', ..] if drive.is_ascii_alphabetic() => path[1..].to_owned(),
        _ => path,
    }
}

/// The address of a file.
pub fn of_file(path: &Path) -> Option<Uri> {
    let absolute = std::path::absolute(path).ok()?;
    let text = absolute.to_str()?.replace('\\', "/");
    let slash = if text.starts_with('/') { "" } else { "/" };
    format!("file://{slash}{}", utf8_percent_encode(&text, ESCAPED)).parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_and_names_are_inverse() {
        for (uri, expected) in [
            ("file:///home/me/a.ghyll", "/home/me/a.ghyll"),
            ("file://localhost/a%20b/%C3%A4.ghyll", "/a b/ä.ghyll"),
            ("file:///c%3A/x/y.ghyll", "c:/x/y.ghyll"),
            ("file:///C:/x/y.ghyll", "C:/x/y.ghyll"),
            ("untitled:Untitled-1", "untitled:Untitled-1"),
        ] {
            assert_eq!(name(&uri.parse().unwrap()), expected, "{uri}");
        }
        for path in ["/home/me/a.ghyll", "/a b/größe [1] 100%#?.ghyll", "/x/雪.ghyll"] {
            assert_eq!(name(&of_file(Path::new(path)).unwrap()), path);
        }
    }
}
