//! What could stand at a place of a program: the text is analysed with a name there that nothing has.

use super::notes::{HERE, Here, Notes};
use super::{Analysis, Description, Meaning};
use crate::front::on_large_stack;
use crate::library;
use crate::parse::KEYWORDS;
use crate::resolve::types::PLAIN;
use crate::source::{Files, Source, SourceId, Span};
use crate::typed::{Attributes, StructId, Type};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CandidateKind {
    Local,
    Function,
    Constant,
    Param,
    Struct,
    Enum,
    Variant,
    Field,
    Type,
    Keyword,
    Module,
}

/// A word that could stand at the place.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    pub word: String,
    pub kind: CandidateKind,
    pub description: Description,
}

/// What could stand at a byte of the source, in place of the name that is there already, nearest first.
pub fn complete(source: Source, at: usize, files: &dyn Files) -> Vec<Candidate> {
    let at = at.min(source.text.len());
    if !source.text.is_char_boundary(at) {
        return Vec::new();
    }
    let part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let start = at - source.text[..at].chars().rev().take_while(|c| part(*c)).count();
    let end = at + source.text[at..].chars().take_while(|c| part(*c)).count();
    let line = source.text[..start].rsplit('\n').next().unwrap_or_default();
    if source.text[start..].starts_with(|c: char| c.is_ascii_digit()) || line.contains("//") {
        return Vec::new();
    }
    if let Some(words) = by_line(line) {
        return words;
    }
    let text = format!("{}{HERE}{}", &source.text[..start], &source.text[end..]);
    on_large_stack(|| {
        let notes = Notes { asked: true, ..Notes::default() };
        let (analysis, notes) = Analysis::of(Source { text, ..source }, files, notes);
        analysis.candidates(&notes, line)
    })
}

/// Where the line alone tells what can stand there.
fn by_line(line: &str) -> Option<Vec<Candidate>> {
    let plain =
        |word: &str, kind| Candidate { word: word.to_owned(), kind, description: Description::default() };
    let before = line.trim_start();
    if before == "use " {
        let modules = library::MODULES.iter().filter(|(name, _)| *name != library::PRELUDE);
        return Some(modules.map(|(name, _)| plain(name, CandidateKind::Module)).collect());
    }
    if before.ends_with('@') {
        return Some(Attributes::NAMES.iter().map(|name| plain(name, CandidateKind::Keyword)).collect());
    }
    None
}

impl Analysis {
    fn candidates(&self, notes: &Notes, line: &str) -> Vec<Candidate> {
        let at = Span::new(SourceId(0), 0, 0);
        match &notes.here {
            Some(Here::Field(ty)) => self.fields(ty, at),
            Some(Here::Type(generics)) => self.type_candidates(notes, generics),
            Some(Here::Pattern(ty)) => self.pattern_candidates(notes, ty),
            Some(Here::Value(locals, built)) => {
                let mut all: Vec<Candidate> = Vec::new();
                if let Some(id) = built {
                    all.extend(self.struct_fields(*id, &[], at));
                }
                all.extend(locals.iter().map(|(name, ty)| Candidate {
                    word: name.clone(),
                    kind: CandidateKind::Local,
                    description: self.describe(name, Meaning::Local(at), ty, at),
                }));
                let hidden = |name: &str| locals.iter().any(|(local, _)| local == name);
                all.extend(self.value_candidates(notes).into_iter().filter(|c| !hidden(&c.word)));
                all.extend(keywords(&["if", "match", "let", "with", "true", "false", "else", "in"]));
                all
            }
            // At top level only items begin.
            None if line.trim().is_empty() => {
                let begin = |word: &&str| {
                    ["use", "const", "param", "raster", "fn", "struct", "enum", "type"].contains(word)
                };
                keywords(&KEYWORDS.iter().copied().filter(begin).collect::<Vec<_>>())
            }
            None => {
                let mut all = self.value_candidates(notes);
                all.extend(keywords(KEYWORDS));
                all
            }
        }
    }

    fn candidate(&self, word: &str, meaning: Meaning) -> Candidate {
        let kind = match meaning {
            Meaning::Local(_) => CandidateKind::Local,
            Meaning::Function(_) | Meaning::Raster(_) | Meaning::Builtin(_) | Meaning::Form(_) => {
                CandidateKind::Function
            }
            Meaning::Const(_) => CandidateKind::Constant,
            Meaning::Param(_) => CandidateKind::Param,
            Meaning::Struct(_) => CandidateKind::Struct,
            Meaning::Enum(_) => CandidateKind::Enum,
            Meaning::Variant(..) => CandidateKind::Variant,
            Meaning::Field(..) => CandidateKind::Field,
            Meaning::Alias(_) => CandidateKind::Type,
            Meaning::Module(_) => CandidateKind::Module,
        };
        let at = Span::new(SourceId(0), 0, 0);
        let description = self.describe(word, meaning, &Type::Error, at);
        Candidate { word: word.to_owned(), kind, description }
    }

    fn value_candidates(&self, notes: &Notes) -> Vec<Candidate> {
        notes.values.iter().map(|(name, meaning)| self.candidate(name, *meaning)).collect()
    }

    fn type_candidates(&self, notes: &Notes, generics: &[String]) -> Vec<Candidate> {
        let plain =
            PLAIN.iter().map(|(name, _)| *name).chain(generics.iter().map(String::as_str)).chain(["fn"]);
        let own = notes.type_names.iter().map(|(name, meaning)| self.candidate(name, *meaning));
        let plain = plain.map(|name| Candidate {
            word: name.to_owned(),
            kind: CandidateKind::Type,
            description: Description::default(),
        });
        own.chain(plain).collect()
    }

    /// Variants of the type that is matched first, then every struct and variant.
    fn pattern_candidates(&self, notes: &Notes, ty: &Type) -> Vec<Candidate> {
        let fits = |meaning: &Meaning| match (meaning, ty) {
            (Meaning::Variant(id, _), Type::Enum(of, _)) => id == of,
            (Meaning::Struct(id), Type::Struct(of, _)) => id == of,
            (Meaning::Variant(..) | Meaning::Struct(_), Type::Error) => true,
            _ => false,
        };
        let values = notes.values.iter().filter(|(_, meaning)| fits(meaning));
        let mut all: Vec<Candidate> = values.map(|(name, meaning)| self.candidate(name, *meaning)).collect();
        if *ty == Type::Bool {
            all.extend(keywords(&["true", "false"]));
        }
        all
    }

    fn fields(&self, ty: &Type, at: Span) -> Vec<Candidate> {
        let component = |word: String, ty: String| Candidate {
            description: Description { signature: format!("{word}: {ty}"), text: String::new() },
            word,
            kind: CandidateKind::Field,
        };
        match ty {
            Type::Struct(id, args) => self.struct_fields(*id, args, at),
            Type::Tuple(items) => {
                let items = items.iter().enumerate();
                items.map(|(i, ty)| component(i.to_string(), self.show(ty, at))).collect()
            }
            Type::Vec(n) | Type::IVec(n) => {
                let (scalar, vector) =
                    if matches!(ty, Type::Vec(_)) { ("f32", "vec") } else { ("i32", "ivec") };
                let mut all = Vec::new();
                for names in ["xyzw", "rgba"] {
                    all.extend(
                        names.chars().take((*n).into()).map(|c| component(c.to_string(), scalar.to_owned())),
                    );
                    all.extend(
                        (2..=*n)
                            .map(|k| component(names[..usize::from(k)].to_owned(), format!("{vector}{k}"))),
                    );
                }
                all
            }
            _ => Vec::new(),
        }
    }

    fn struct_fields(&self, id: StructId, args: &[Type], at: Span) -> Vec<Candidate> {
        let fields = self.module.structs[id.0 as usize].fields.iter().zip(0..);
        let field = |((name, ty), index): (&(String, Type), u32)| {
            let ty = if args.is_empty() { Type::Error } else { ty.substitute(args) };
            let description = self.describe(name, Meaning::Field(id, index), &ty, at);
            Candidate { word: name.clone(), kind: CandidateKind::Field, description }
        };
        fields.map(field).collect()
    }
}

fn keywords(words: &[&str]) -> Vec<Candidate> {
    let keyword = |word: &&str| Candidate {
        word: (*word).to_owned(),
        kind: CandidateKind::Keyword,
        description: Description::default(),
    };
    words.iter().map(keyword).collect()
}
