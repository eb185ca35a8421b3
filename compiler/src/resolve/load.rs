//! Parses the user's text and the library modules it uses, each once.

use crate::ast::{self, Item};
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::source::{Source, SourceId, Sources};
use crate::{library, parse};

/// One parsed text. The user's is the first, the prelude the second.
pub struct File {
    /// Name of the library module; empty for the user's text.
    pub module: String,
    pub items: ast::File,
    /// Indices of the files whose names are in scope.
    pub uses: Vec<usize>,
}

impl File {
    pub fn library(&self) -> bool {
        !self.module.is_empty()
    }
}

pub const USER: usize = 0;
pub const PRELUDE: usize = 1;

#[derive(Default)]
pub struct Loaded {
    pub sources: Sources,
    pub files: Vec<File>,
    pub diagnostics: Vec<Diagnostic>,
}

pub fn load(source: Source) -> Loaded {
    let mut loaded = Loaded::default();
    loaded.parse(String::new(), source);
    loaded.library(library::PRELUDE);
    let mut next = USER;
    while next < loaded.files.len() {
        loaded.uses_of(next);
        next += 1;
    }
    loaded
}

impl Loaded {
    fn parse(&mut self, module: String, source: Source) -> SourceId {
        let id = self.sources.add(source);
        let parsed = parse::file(id, &self.sources.get(id).text);
        self.diagnostics.extend(parsed.diagnostics);
        self.files.push(File { module, items: parsed.tree, uses: Vec::new() });
        id
    }

    /// Index of a library module, which is parsed when it is met first.
    fn library(&mut self, name: &str) -> Option<usize> {
        if let Some(known) = self.files.iter().position(|f| f.module == name) {
            return Some(known);
        }
        let text = library::text(name)?;
        self.parse(name.to_owned(), Source::new(library::file_name(name), text));
        Some(self.files.len() - 1)
    }

    fn uses_of(&mut self, file: usize) {
        let mut names = Vec::new();
        for item in &self.files[file].items {
            match item {
                Item::Use(name) => names.push(name.clone()),
                Item::UseFile(path) => self.diagnostics.push(
                    Diagnostic::error(codes::FILE_MODULE, path.span, "modules in files are not supported yet")
                        .help("put the definitions into this file; library modules are used by name, as in `use terrain;`"),
                ),
                _ => {}
            }
        }
        for name in names {
            match self.library(&name.text) {
                Some(used) if used != file => self.files[file].uses.push(used),
                Some(_) => {}
                None => self.unknown(&name),
            }
        }
    }

    fn unknown(&mut self, name: &ast::Name) {
        let known = library::MODULES.iter().map(|(module, _)| *module);
        let help = match super::similar(&name.text, known.clone()) {
            Some(meant) => format!("did you mean `{meant}`?"),
            None => format!("the library modules are {}", known.collect::<Vec<_>>().join(", ")),
        };
        let title = format!("there is no module `{}`", name.text);
        self.diagnostics.push(Diagnostic::error(codes::UNKNOWN_MODULE, name.span, title).help(help));
    }
}
