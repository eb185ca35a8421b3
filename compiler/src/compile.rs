//! One specialisation of a checked program: entry chosen, parameters fixed, table and code made.

use crate::argument::parse_arguments;
use crate::back::{self, Back};
use crate::diagnostic::{Diagnostic, Report};
use crate::front::{self, Checked};
use crate::layout;
use crate::lower::{self, Setting, Settings};
use crate::source::Source;
use crate::typed::{FunctionId, Literal, Module, ParamId, Type};

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

/// Text to checked program.
pub fn check(source: Source) -> Result<Checked, Report> {
    front::front(source)
}

/// Checked program to table and code.
pub fn compile(checked: &Checked, options: &Options) -> Result<Compiled, CompileError> {
    let module = &checked.module;
    let (entry, kind) = find_entry(module, options)?;
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

/// Trees are bounded but may be deep; this is ample for the deepest.
const STACK: usize = 256 << 20;

/// Runs on a thread with much stack; on this one where there are no threads.
fn on_large_stack<T: Send>(work: impl Fn() -> T + Sync) -> T {
    std::thread::scope(|scope| {
        match std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, &work) {
            Ok(thread) => thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)),
            Err(_) => work(),
        }
    })
}

/// The entry and what it is.
fn find_entry(module: &Module, options: &Options) -> Result<(FunctionId, EntryKind), CompileError> {
    let fallback = match options.want {
        Some(EntryKind::Value) => &["main"][..],
        Some(EntryKind::Image) => &["pixel"][..],
        None => &["main", "pixel"][..],
    };
    let names: Vec<&str> = match &options.entry {
        Some(name) => vec![name.as_str()],
        None => fallback.to_vec(),
    };
    for name in &names {
        let Some(id) = module.function(name) else { continue };
        let kind = match options.want {
            Some(EntryKind::Image) if !is_image(module, id) => {
                return Err(CompileError::Request(format!(
                    "`{name}` is not an image entry: `fn {name}(p: vec2) -> f32`, `vec2`, `vec3` or `vec4` is needed"
                )));
            }
            Some(kind) => kind,
            None if *name != "main" && is_image(module, id) => EntryKind::Image,
            None => EntryKind::Value,
        };
        return Ok((id, kind));
    }
    Err(CompileError::Request(match (&options.entry, options.want) {
        (Some(name), _) => {
            let mut have: Vec<&str> =
                module.functions.iter().filter(|f| !f.library).map(|f| f.name.as_str()).collect();
            have.truncate(8);
            format!("there is no function `{name}` (the program has: {})", have.join(", "))
        }
        (None, Some(EntryKind::Image)) => {
            "the program has no `fn pixel(p: vec2) -> vec3`; name another entry with --entry NAME".into()
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

fn is_image(module: &Module, id: FunctionId) -> bool {
    let function = &module.functions[id.0 as usize];
    let params: Vec<&Type> = function.param_types().collect();
    params == [&Type::Vec(2)] && matches!(function.result, Type::F32 | Type::Vec(_))
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
            CompileError::Program(Report { sources, ..report })
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
            Diagnostic::warning("W0904", f.span, "`@bake` is not supported yet")
                .label("evaluated where it is used instead of once for each texel")
        })
        .collect()
}

/// What only specialisation finds, for every entry a host may ask for: `main`, `pixel` and `map`, else every
/// function that could be one.
pub fn reach(checked: &Checked) -> Vec<Diagnostic> {
    let module = &checked.module;
    let mut entries: Vec<FunctionId> =
        ["main", "pixel", "map"].iter().filter_map(|name| module.function(name)).collect();
    if entries.is_empty() {
        let eligible = |f: &crate::typed::Function| {
            let first_order = |t: &Type| layout::scalars(module, t).is_some();
            !f.library && f.generics.is_empty() && f.param_types().all(first_order) && first_order(&f.result)
        };
        let ids = (0..module.functions.len() as u32).map(FunctionId);
        entries = ids.filter(|id| eligible(&module.functions[id.0 as usize])).collect();
    }
    let mut found: Vec<Diagnostic> = baked(module);
    for entry in entries {
        let lowered = on_large_stack(|| lower::lower(module, entry, &Settings::default()).err());
        if let Some(diagnostics) = lowered {
            for diagnostic in diagnostics {
                if !found.contains(&diagnostic) {
                    found.push(diagnostic);
                }
            }
        }
    }
    found
}
