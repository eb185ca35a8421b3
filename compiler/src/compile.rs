//! One specialisation of a checked program: entry chosen, parameters fixed, table and code made.

use crate::argument::parse_arguments;
use crate::back::{self, Back};
use crate::codes;
use crate::diagnostic::{Diagnostic, Report};
use crate::entry::{self, is_image};
use crate::front::{self, Checked, on_large_stack};
use crate::infer::show::show_type;
use crate::layout;
use crate::lower::{self, Setting, Settings};
use crate::source::{Files, NoFiles, Source};
use crate::typed::{FunctionId, Literal, Module, Param, ParamId, Type};

/// What the host decides.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Entry function; `main` (value) or `pixel` (image) if absent.
    pub entry: Option<String>,
    /// The entry must be of this kind.
    pub want: Option<EntryKind>,
    /// Values of parameters, as Ghyll expressions.
    pub set: Vec<(String, String)>,
    /// Parameters that stay changeable.
    pub live: Vec<String>,
}

/// LANGUAGE.md, section 8.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EntryKind {
    Value,
    Image,
}

/// Why a program could not be compiled.
#[derive(Clone, Debug)]
pub enum CompileError {
    /// The program is wrong.
    Program(Report),
    /// The host asked for something that the program does not have: an entry, a parameter, a value of its type.
    Request(String),
}

/// A program ready to run on every machine.
#[derive(Clone, Debug)]
pub struct Compiled {
    pub entry: FunctionId,
    pub kind: EntryKind,
    /// Parameters of the entry.
    pub params: Vec<Type>,
    pub result: Type,
    /// For the oracle, which evaluates the typed tree.
    pub settings: Settings,
    pub back: Back,
    pub warnings: Vec<Diagnostic>,
}

impl Compiled {
    /// Components of an image entry's value, 1 to 4; words of a value entry's.
    pub fn result_words(&self, module: &Module) -> u32 {
        layout::scalars(module, &self.result).map_or(0, |s| s.len() as u32)
    }
}

/// Text to checked program, where the program is that one text.
pub fn check(source: Source) -> Result<Checked, Report> {
    front::front(source, &NoFiles)
}

/// Text to checked program, with the modules that it uses.
pub fn check_with(source: Source, files: &dyn Files) -> Result<Checked, Report> {
    front::front(source, files)
}

/// Checked program to table and code.
pub fn compile(checked: &Checked, options: &Options) -> Result<Compiled, CompileError> {
    let module = &checked.module;
    let (entry, kind) = find_entry(checked, options)?;
    let settings = settings(module, options)?;
    let report =
        |diagnostics| CompileError::Program(Report { sources: checked.sources.clone(), diagnostics });
    let back = on_large_stack(|| lower::lower(module, entry, &settings).map(back::back)).map_err(report)?;
    let function = &module.functions[entry.0 as usize];
    let warnings = baked(module);
    Ok(Compiled {
        entry,
        kind,
        params: function.param_types().cloned().collect(),
        result: function.result.clone(),
        settings,
        back,
        warnings,
    })
}

/// The entry and what it is.
fn find_entry(checked: &Checked, options: &Options) -> Result<(FunctionId, EntryKind), CompileError> {
    let module = &checked.module;
    let fallback = match options.want {
        Some(EntryKind::Value) => &["main"][..],
        Some(EntryKind::Image) => &["pixel"][..],
        None => &["main", "pixel"][..],
    };
    let names: Vec<&str> = match &options.entry {
        Some(name) => vec![name.as_str()],
        None => fallback.to_vec(),
    };
    let mut misfits = Vec::new();
    for name in &names {
        let Some(id) = module.function(name) else { continue };
        let kind = options.want.unwrap_or(match *name != "main" && is_image(module, id) {
            true => EntryKind::Image,
            false => EntryKind::Value,
        });
        match entry::misfit(module, id, kind) {
            None => return Ok((id, kind)),
            Some(misfit) => misfits.push(misfit),
        }
    }
    if !misfits.is_empty() {
        let sources = checked.sources.clone();
        return Err(CompileError::Program(Report { sources, diagnostics: misfits }));
    }
    Err(CompileError::Request(match (&options.entry, options.want) {
        (Some(name), _) => {
            let mut have: Vec<&str> =
                module.functions.iter().filter(|f| !f.library).map(|f| f.name.as_str()).collect();
            have.truncate(8);
            format!("there is no function `{name}` (the program has: {})", have.join(", "))
        }
        (None, Some(EntryKind::Image)) => {
            let hint = match module.function("main") {
                Some(_) => "; it has a value entry: use `ghyll run`, or name another entry with --entry NAME",
                None => "; name another entry with --entry NAME",
            };
            format!("the program has no `fn pixel(p: vec2) -> vec3`{hint}")
        }
        (None, Some(EntryKind::Value)) => {
            let hint = match module.function("pixel") {
                Some(_) => "; it has an image entry: use `ghyll render`",
                None => "; name another entry with --entry NAME",
            };
            format!("the program has no `fn main`{hint}")
        }
        (None, None) => {
            "the program has neither `fn main` nor `fn pixel`; name an entry with --entry NAME".into()
        }
    }))
}

/// Parameters set from outside, checked.
fn settings(module: &Module, options: &Options) -> Result<Settings, CompileError> {
    let find = |name: &str| -> Result<ParamId, CompileError> {
        let at = module.params.iter().position(|p| p.name == name);
        at.map(|i| ParamId(i as u32)).ok_or_else(|| {
            let have: Vec<&str> = module.params.iter().map(|p| p.name.as_str()).collect();
            CompileError::Request(match have.is_empty() {
                true => format!("there is no parameter `{name}`: the program has none"),
                false => format!("there is no parameter `{name}` (the program has: {})", have.join(", ")),
            })
        })
    };
    let mut settings = Settings::default();
    for (name, text) in &options.set {
        let id = find(name)?;
        let param = &module.params[id.0 as usize];
        let argument = parse_arguments(module, text, &param.ty).map_err(|report| {
            let sources = report.sources.named(&format!("--set {name}"));
            let diagnostics = report.diagnostics.into_iter().map(|d| unset(module, param, text, d)).collect();
            CompileError::Program(Report { sources, diagnostics })
        })?;
        in_range(module, id, name, &argument.expr)?;
        settings.set.insert(id, Setting { value: argument.expr, locals: argument.locals });
    }
    for name in &options.live {
        let id = find(name)?;
        if !settings.live.contains(&id) {
            settings.live.push(id);
        }
    }
    Ok(settings)
}

/// What is wrong with a parameter's value, told so that it needs no source text beside it.
fn unset(module: &Module, param: &Param, text: &str, diagnostic: Diagnostic) -> Diagnostic {
    let ty = show_type(module, &[], &param.ty);
    let shown: String = match text.char_indices().nth(LONGEST_SHOWN) {
        Some((end, _)) => format!("{}..", &text[..end]),
        None => text.to_owned(),
    };
    let title = format!("the parameter `{}: {ty}` cannot be `{shown}`: {}", param.name, diagnostic.title);
    Diagnostic { title, ..diagnostic }
}

/// Characters of a parameter's value that a title repeats.
const LONGEST_SHOWN: usize = 60;

/// A literal outside the range that a parameter states is refused.
fn in_range(
    module: &Module,
    id: ParamId,
    name: &str,
    value: &crate::typed::Expr,
) -> Result<(), CompileError> {
    let Some((lo, hi)) = &module.params[id.0 as usize].range else { return Ok(()) };
    let (Some(value), Some(lo), Some(hi)) = (number(value), number(lo), number(hi)) else { return Ok(()) };
    if value < lo || value > hi {
        return Err(CompileError::Request(format!("parameter `{name}` must lie in {lo}..{hi}, not {value}")));
    }
    Ok(())
}

fn number(expr: &crate::typed::Expr) -> Option<f64> {
    use crate::typed::{ExprKind, UnaryOp};
    match &expr.kind {
        ExprKind::Literal(Literal::I32(i)) => Some(f64::from(*i)),
        ExprKind::Literal(Literal::U32(u)) => Some(f64::from(*u)),
        ExprKind::Literal(Literal::F32(x)) => Some(*x),
        ExprKind::Unary(UnaryOp::Neg, inner) => number(inner).map(|x| -x),
        _ => None,
    }
}

/// `@bake` changes nothing but speed; it is not used yet.
fn baked(module: &Module) -> Vec<Diagnostic> {
    let marked = module.functions.iter().filter(|f| f.attributes.bake && !f.library);
    marked
        .map(|f| {
            Diagnostic::warning(codes::BAKE, f.span, "`@bake` is not supported yet")
                .label("evaluated where it is used instead of once for each texel")
        })
        .collect()
}

/// What only specialisation finds, for every entry a host may ask for: see [`entry::asked_for`].
pub fn reach(checked: &Checked) -> Vec<Diagnostic> {
    let module = &checked.module;
    let mut found: Vec<Diagnostic> = baked(module);
    let (entries, misfits) = entry::asked_for(module);
    found.extend(misfits);
    for entry in entries {
        let lowered = on_large_stack(|| lower::lower(module, entry, &Settings::default()).err());
        for diagnostic in lowered.into_iter().flatten() {
            if !found.contains(&diagnostic) {
                found.push(diagnostic);
            }
        }
    }
    found
}
