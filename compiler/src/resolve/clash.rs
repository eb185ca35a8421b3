//! Names that a file would have twice: of its own and from a file that it uses, or from two such files. Names of the
//! library are only hidden by others. What the host sets by name has one name in the whole program.

use std::collections::{HashMap, HashSet};

use super::load::File;
use super::scope::{Scopes, is_private};
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::source::Span;
use crate::typed::Module;

pub fn check(files: &[File], scopes: &Scopes, module: &Module, out: &mut Vec<Diagnostic>) {
    let mut reported = HashSet::new();
    for (file, written) in files.iter().enumerate() {
        let mut seen: HashMap<&str, usize> = HashMap::new();
        let mut used: Vec<usize> = Vec::new();
        for (other, at) in &written.files {
            if used.contains(other) || *other == file {
                continue;
            }
            used.push(*other);
            for name in scopes.0[*other].names().filter(|name| !is_private(name)) {
                let theirs = scopes.0[*other].place(name);
                if let Some(own) = scopes.0[file].clash(&scopes.0[*other], name) {
                    twice(name, own, theirs, "of the file used here", *at, &mut reported, out);
                } else if let Some(first) = seen.get(name)
                    && scopes.0[*first].clash(&scopes.0[*other], name).is_some()
                {
                    let earlier = scopes.0[*first].place(name);
                    if reported.insert((name.to_owned(), *at)) {
                        let title = format!("`{name}` comes from two files");
                        let labels = [(earlier, "first definition"), (theirs, "second definition")];
                        let diagnostic =
                            Diagnostic::error(codes::DUPLICATE, *at, title).label("used here as well").help(
                                "rename one of them, or begin its name with `_`, which keeps it in its file",
                            );
                        let labels = labels.into_iter().filter_map(|(span, text)| Some((span?, text)));
                        out.push(labels.fold(diagnostic, |d, (span, text)| d.also(span, text)));
                    }
                }
                seen.entry(name).or_insert(*other);
            }
        }
    }
    let params = module.params.iter().map(|p| (p.name.as_str(), p.span));
    host_names("parameter", params, out);
    host_names("raster", module.rasters.iter().map(|r| (r.name.as_str(), r.span)), out);
}

fn twice(
    name: &str,
    own: Span,
    theirs: Option<Span>,
    label: &str,
    used: Span,
    reported: &mut HashSet<(String, Span)>,
    out: &mut Vec<Diagnostic>,
) {
    if !reported.insert((name.to_owned(), own)) {
        return;
    }
    let diagnostic = Diagnostic::error(codes::DUPLICATE, own, format!("`{name}` is defined twice"))
        .label("second definition")
        .also(used, label)
        .help("rename one of them, or begin its name with `_`, which keeps it in its file");
    out.push(match theirs {
        Some(span) => diagnostic.also(span, "first definition"),
        None => diagnostic,
    });
}

/// Items of two files that the host could not tell apart.
fn host_names<'a>(what: &str, items: impl Iterator<Item = (&'a str, Span)>, out: &mut Vec<Diagnostic>) {
    let mut seen: HashMap<&str, Span> = HashMap::new();
    for (name, span) in items {
        let earlier = *seen.entry(name).or_insert(span);
        // Those of one file were reported.
        if earlier.source != span.source && !out.iter().any(|d| d.primary.0 == span || d.primary.0 == earlier)
        {
            out.push(
                Diagnostic::error(codes::DUPLICATE, span, format!("two files have a {what} called `{name}`"))
                    .label("second definition")
                    .also(earlier, "first definition")
                    .help("the host sets it by its name: rename one of them"),
            );
        }
    }
}
