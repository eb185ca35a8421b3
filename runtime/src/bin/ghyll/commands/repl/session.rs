//! The items kept so far, and what is evaluated with them.

use crate::arguments::Repl;
use crate::commands::scene;
use crate::failure::{self, Failure};
use ghyll_compiler::argument::parse_expression;
use ghyll_compiler::ast::Item;
use ghyll_compiler::compile;
use ghyll_compiler::diagnostic::{Diagnostic, Report};
use ghyll_compiler::front::Checked;
use ghyll_compiler::print;
use ghyll_compiler::show_type;
use ghyll_compiler::source::{Source, SourceId, Sources};
use ghyll_compiler::{codes, parse};
use ghyll_runtime::files::{self, Disk};
use ghyll_runtime::machine::evaluate_in;
use ghyll_runtime::oracle::Precision;
use ghyll_runtime::terrain::{Scene, SceneOptions};
use std::path::Path;
use std::sync::Arc;

pub struct Session<'a> {
    arguments: &'a Repl,
    /// Texts of items with what they are called.
    items: Vec<(String, String)>,
    checked: Checked,
    /// Opened when the library is used first.
    scene: Option<Scene>,
}

pub enum Answer {
    /// An item.
    Kept,
    Value(String),
}

impl<'a> Session<'a> {
    pub fn new(arguments: &'a Repl) -> Result<Session<'a>, Failure> {
        let checked = check("")?;
        Ok(Session { arguments, items: Vec::new(), checked, scene: None })
    }

    pub fn reset(&mut self) {
        self.items.clear();
        if let Ok(checked) = check("") {
            self.checked = checked;
        }
    }

    /// All items.
    pub fn text(&self) -> String {
        self.items.iter().map(|(_, text)| text.as_str()).collect::<Vec<_>>().join("\n")
    }

    pub fn load(&mut self, file: &Path) -> Result<(), Failure> {
        let source = files::source(file).map_err(Failure::Input)?;
        let folder = file.parent().unwrap_or(Path::new(""));
        let items = items(&source.text, folder)
            .map_err(|diagnostics| wrong(Report { sources: Sources::of(source.clone()), diagnostics }))?;
        self.keep(items.unwrap_or_default())
    }

    /// Keeps items, or evaluates an expression.
    pub fn enter(&mut self, text: &str) -> Result<Answer, Failure> {
        let text = text.trim();
        let written = match text.strip_prefix("let ") {
            // `let` is for blocks; here it means a constant.
            Some(rest) => format!("const {};", rest.trim_end().trim_end_matches(';')),
            None => text.to_owned(),
        };
        match items(&written, Path::new("")) {
            Ok(Some(items)) => self.keep(items).map(|()| Answer::Kept),
            // Looks like an item.
            Err(_) if begins_item(&written) => Err(check(&written)
                .err()
                .unwrap_or_else(|| Failure::Input("this is neither an item nor an expression".into()))),
            _ => self.value(text.trim_end_matches(';')).map(Answer::Value),
        }
    }

    pub fn type_of(&self, text: &str) -> Result<String, Failure> {
        let found = parse_expression(&self.checked.module, text).map_err(wrong)?;
        Ok(show_type(&self.checked.module, &[], &found.expr.ty))
    }

    fn value(&mut self, text: &str) -> Result<String, Failure> {
        let found = parse_expression(&self.checked.module, text).map_err(wrong)?;
        let ty = found.expr.ty.clone();
        if ghyll_compiler::layout::scalars(&self.checked.module, &ty).is_none() {
            return Ok(format!("a function: {}", show_type(&self.checked.module, &[], &ty)));
        }
        if self.scene.is_none() && self.checked.module.functions.iter().any(|f| f.library) {
            let terrain = scene::open(self.arguments.dem.as_deref(), &self.arguments.reading)?;
            let opened = Scene::new(Arc::new(terrain), &SceneOptions::default());
            self.scene = Some(opened.map_err(|e| Failure::Input(e.to_string()))?);
        }
        let world = self.scene.as_ref().map(|scene| scene as _);
        let value = evaluate_in(&self.checked, found.expr, found.locals, &ty, (world, Precision::F32))
            .map_err(Failure::run)?;
        Ok(value.to_string())
    }

    /// Puts items in the place of those of the same names; if the program is wrong then, all stays.
    fn keep(&mut self, items: Vec<(String, String)>) -> Result<(), Failure> {
        let mut next = self.items.clone();
        for (name, text) in items {
            match next.iter_mut().find(|(known, _)| *known == name) {
                Some(old) => old.1 = text,
                None => next.push((name, text)),
            }
        }
        let all: Vec<&str> = next.iter().map(|(_, text)| text.as_str()).collect();
        self.checked = check(&all.join("\n"))?;
        self.items = next;
        Ok(())
    }
}

fn wrong(report: Report) -> Failure {
    Failure::Diagnostics { report, json: false }
}

fn check(text: &str) -> Result<Checked, Failure> {
    let checked = compile::check_with(Source::new("<input>", text), &Disk).map_err(wrong)?;
    // Items that nothing uses yet are no mistake here.
    let unused = [codes::UNUSED_NAME, codes::UNUSED_FUNCTION, codes::UNUSED_MODULE, codes::UNUSED_PARAM];
    let told = |d: &&Diagnostic| !unused.contains(&d.code);
    let diagnostics = checked.warnings.iter().filter(told).cloned().collect();
    failure::show(&Report { sources: checked.sources.clone(), diagnostics }, false);
    Ok(checked)
}

/// Items of a text with their names, printed; none if the text has no items. Files that they use are sought in `folder`.
fn items(text: &str, folder: &Path) -> Result<Option<Vec<(String, String)>>, Vec<Diagnostic>> {
    let parsed = parse::file(SourceId(0), text);
    if !parsed.diagnostics.is_empty() {
        return Err(parsed.diagnostics);
    }
    let named = |mut item: Item| {
        let name = match &mut item {
            Item::Use(name) => format!("use {}", name.text),
            Item::UseFile(path) => {
                path.text = folder.join(&path.text).display().to_string();
                format!("use {}", path.text)
            }
            Item::Const(c) => c.name.text.clone(),
            Item::Param(p) => p.name.text.clone(),
            Item::Raster(r) => r.name.text.clone(),
            Item::Struct(s) => s.name.text.clone(),
            Item::Enum(e) => e.name.text.clone(),
            Item::Alias(a) => a.name.text.clone(),
            Item::Function(f) => f.name.text.clone(),
        };
        (name, print::file(&[item]).trim_end().to_owned())
    };
    Ok(Some(parsed.tree)
        .filter(|items| !items.is_empty())
        .map(|items| items.into_iter().map(named).collect()))
}

fn begins_item(text: &str) -> bool {
    let word: String = text.chars().take_while(|c| c.is_ascii_alphanumeric() || *c == '@').collect();
    let words = ["use", "const", "param", "raster", "struct", "enum", "type", "fn"];
    word.starts_with('@') || words.contains(&word.as_str())
}
