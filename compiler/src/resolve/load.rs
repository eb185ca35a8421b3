//! Parses the user's text and the modules it uses, each once.

use std::collections::HashMap;

use super::path::join;
use crate::ast::{self, Item};
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::front::components::{MOST_SHOWN, components, on_cycles, shown, way_round};
use crate::source::{Files, Source, SourceId, Sources, Span};
use crate::{library, parse};

/// One parsed text; its index is that of its source. The user's is the first, the prelude the second.
pub struct File {
    /// Name of the library module; empty for the user's texts.
    pub module: String,
    pub items: ast::File,
    /// The library modules whose names are in scope.
    pub uses: Vec<usize>,
    /// The module of each `use`, in the order of the text.
    pub used: Vec<Option<usize>>,
    /// The modules in files whose names are in scope, with where they are named.
    pub files: Vec<(usize, Span)>,
}

impl File {
    pub fn library(&self) -> bool {
        !self.module.is_empty()
    }
}

pub const USER: usize = 0;
pub const PRELUDE: usize = 1;

/// Most files of one program.
const MOST_FILES: usize = 1_000;

#[derive(Default)]
pub struct Loaded {
    pub sources: Sources,
    pub files: Vec<File>,
    pub diagnostics: Vec<Diagnostic>,
    /// Files by name; nothing for those that cannot be read.
    known: HashMap<String, Option<usize>>,
}

pub fn load(source: Source, files: &dyn Files) -> Loaded {
    let mut loaded = Loaded::default();
    loaded.known.insert(join("", &source.name), Some(USER));
    loaded.parse(String::new(), source);
    loaded.library(library::PRELUDE);
    let mut next = USER;
    while next < loaded.files.len() {
        loaded.uses_of(next, files);
        next += 1;
    }
    loaded.cycles();
    loaded
}

impl Loaded {
    /// Parses a text; its index.
    fn parse(&mut self, module: String, source: Source) -> usize {
        let id = self.sources.add(source);
        let parsed = parse::file(id, &self.sources.get(id).text);
        self.diagnostics.extend(parsed.diagnostics);
        self.files.push(File {
            module,
            items: parsed.tree,
            uses: Vec::new(),
            used: Vec::new(),
            files: Vec::new(),
        });
        self.files.len() - 1
    }

    /// Index of a library module, which is parsed when it is met first.
    fn library(&mut self, name: &str) -> Option<usize> {
        if let Some(known) = self.files.iter().position(|f| f.module == name) {
            return Some(known);
        }
        let text = library::text(name)?;
        Some(self.parse(name.to_owned(), Source::new(library::file_name(name), text)))
    }

    fn uses_of(&mut self, file: usize, files: &dyn Files) {
        let uses: Vec<(ast::Name, bool)> = self.files[file]
            .items
            .iter()
            .filter_map(|item| match item {
                Item::Use(name) => Some((name.clone(), true)),
                Item::UseFile(path) => Some((path.clone(), false)),
                _ => None,
            })
            .collect();
        for (name, library) in uses {
            let used = match library {
                true => self.library(&name.text),
                false => self.file(file, &name, files),
            };
            match (used, library) {
                (Some(used), true) if used != file => self.files[file].uses.push(used),
                (Some(used), false) => self.files[file].files.push((used, name.span)),
                (None, true) => self.unknown(&name),
                _ => {}
            }
            self.files[file].used.push(used);
        }
    }

    /// Index of a module in a file, which is read when it is met first.
    fn file(&mut self, from: usize, path: &ast::Name, files: &dyn Files) -> Option<usize> {
        let name = join(&self.sources.get(SourceId(from as u32)).name, &path.text);
        if let Some(known) = self.known.get(&name) {
            return *known;
        }
        let text = match self.known.len() {
            MOST_FILES.. => Err(format!("a program has at most {MOST_FILES} files")),
            _ => files.read(&name),
        };
        let index = match text {
            Ok(text) => Some(self.parse(String::new(), Source::new(name.clone(), text))),
            Err(reason) => {
                let title = format!("cannot read the module \"{}\"", path.text);
                self.diagnostics.push(
                    Diagnostic::error(codes::UNREADABLE_MODULE, path.span, title)
                        .label(format!("`{name}`: {reason}"))
                        .help("a path is relative to the folder of the file that it stands in"),
                );
                None
            }
        };
        self.known.insert(name, index);
        index
    }

    fn unknown(&mut self, name: &ast::Name) {
        let known = library::MODULES.iter().map(|(module, _)| *module);
        let help = match super::similar(&name.text, known.clone()) {
            Some(meant) => format!("did you mean `{meant}`?"),
            None => format!(
                "the library modules are {}; a module in a file is used by its path, as in `use \"{}.ghyll\";`",
                known.collect::<Vec<_>>().join(", "),
                name.text
            ),
        };
        let title = format!("there is no module `{}`", name.text);
        self.diagnostics.push(Diagnostic::error(codes::UNKNOWN_MODULE, name.span, title).help(help));
    }

    /// Files that use each other in a circle: one diagnostic for each, with a shortest way round.
    fn cycles(&mut self) {
        let successors: Vec<Vec<usize>> =
            self.files.iter().map(|f| f.files.iter().map(|(used, _)| *used).collect()).collect();
        let component = components(&successors);
        for start in on_cycles(&successors, &component) {
            let way = way_round(&successors, &component, start);
            let diagnostic = self.cycle(&way);
            self.diagnostics.push(diagnostic);
        }
    }

    fn cycle(&self, way: &[usize]) -> Diagnostic {
        let name = |file: usize| self.sources.get(SourceId(file as u32)).name.as_str();
        let place = |i: usize| {
            let next = way[(i + 1) % way.len()];
            let used = self.files[way[i]].files.iter().find(|(used, _)| *used == next);
            used.expect("the way leads from use to use").1
        };
        let last = way.len() - 1;
        let title = format!("the module `{}` uses itself", name(way[0]));
        let diagnostic = Diagnostic::error(codes::MODULE_CYCLE, place(last), title)
            .label(shown(way, name))
            .help("put what both need into a module of its own");
        let others = (0..last).take(MOST_SHOWN);
        others.fold(diagnostic, |d, i| d.also(place(i), format!("`{}` uses this", name(way[i]))))
    }
}
