//! Names of files. `/` separates folders; a name is relative to the file that it stands in.

/// The file that `from` calls `path`: without `.` and, as far as it can be told, without `..`. One file has one name
/// however it is written, so a module that two others use is one module.
pub fn join(from: &str, path: &str) -> String {
    let absolute = |p: &str| p.starts_with(['/', '\\']) || p.get(1..2) == Some(":");
    let folder = match from.rfind(['/', '\\']) {
        Some(end) if !absolute(path) => &from[..=end],
        _ => "",
    };
    let whole = format!("{folder}{path}");
    let root = if whole.starts_with(['/', '\\']) { "/" } else { "" };
    let mut parts: Vec<&str> = Vec::new();
    for part in whole.split(['/', '\\']) {
        match part {
            "" | "." => {}
            ".." if parts.last().is_some_and(|p| *p != "..") => drop(parts.pop()),
            ".." if !root.is_empty() => {}
            part => parts.push(part),
        }
    }
    format!("{root}{}", parts.join("/"))
}

#[cfg(test)]
mod tests {
    use super::join;

    #[test]
    fn names_are_relative_to_the_file() {
        for (from, path, expected) in [
            ("main.ghyll", "a.ghyll", "a.ghyll"),
            ("main.ghyll", "./lib/../a.ghyll", "a.ghyll"),
            ("x/main.ghyll", "a.ghyll", "x/a.ghyll"),
            ("x/main.ghyll", "../a.ghyll", "a.ghyll"),
            ("x/main.ghyll", "../../a.ghyll", "../a.ghyll"),
            ("../x/main.ghyll", "../a.ghyll", "../a.ghyll"),
            ("/x/main.ghyll", "../../../a.ghyll", "/a.ghyll"),
            ("/x/main.ghyll", "y//a.ghyll", "/x/y/a.ghyll"),
            ("x/main.ghyll", "/y/a.ghyll", "/y/a.ghyll"),
            ("x\\main.ghyll", "y\\a.ghyll", "x/y/a.ghyll"),
            ("c:/x/main.ghyll", "../a.ghyll", "c:/a.ghyll"),
            ("x/main.ghyll", "c:/a.ghyll", "c:/a.ghyll"),
        ] {
            assert_eq!(join(from, path), expected, "{path} in {from}");
        }
    }
}
