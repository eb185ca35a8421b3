//! Source texts and places in them.

/// Index of a text in [`Sources`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SourceId(pub u32);

/// A byte range of one text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Span {
    pub source: SourceId,
    pub start: u32,
    pub end: u32,
}

impl Span {
    pub fn new(source: SourceId, start: usize, end: usize) -> Span {
        Span { source, start: start as u32, end: end as u32 }
    }

    /// The smallest range that holds both.
    pub fn to(self, other: Span) -> Span {
        Span { source: self.source, start: self.start.min(other.start), end: self.end.max(other.end) }
    }
}

/// One text with the name that diagnostics show.
#[derive(Clone, Debug)]
pub struct Source {
    pub name: String,
    pub text: String,
}

impl Source {
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Source {
        Source { name: name.into(), text: text.into() }
    }
}

/// Gives the compiler the texts of modules in files, which it asks for by name.
pub trait Files: Sync {
    /// The text of a file, or why there is none.
    ///
    /// # Errors
    /// The reason in words, such as "no such file".
    fn read(&self, name: &str) -> Result<String, String>;
}

/// For programs that are one text.
pub struct NoFiles;

impl Files for NoFiles {
    fn read(&self, _name: &str) -> Result<String, String> {
        Err("modules in files cannot be read here".into())
    }
}

/// All texts of one compilation: the user's file first, then the modules that it uses.
#[derive(Clone, Debug, Default)]
pub struct Sources(Vec<Source>);

impl Sources {
    pub fn add(&mut self, source: Source) -> SourceId {
        self.0.push(source);
        SourceId(self.0.len() as u32 - 1)
    }

    /// One text.
    pub fn of(source: Source) -> Sources {
        Sources(vec![source])
    }

    /// Gives the first text another name, for what comes from elsewhere than a file.
    pub fn named(mut self, name: &str) -> Sources {
        if let Some(first) = self.0.first_mut() {
            first.name = name.to_owned();
        }
        self
    }

    pub fn get(&self, id: SourceId) -> &Source {
        &self.0[id.0 as usize]
    }

    pub fn iter(&self) -> impl Iterator<Item = &Source> {
        self.0.iter()
    }
}
