//! One specialisation of a checked program: entry chosen, parameters fixed, table and code made.

use crate::argument::parse_arguments;
use crate::back::Back;
use crate::bake::{self, Bake};
use crate::diagnostic::{Diagnostic, Report};
use crate::entry;
use crate::front::{self, Checked, MAX_DIAGNOSTICS, on_large_stack};
use crate::infer::show::show_type;
use crate::layout;
use crate::lower::{self, Asked, Setting, Settings, Slot};
use crate::source::{Files, NoFiles, Source};
use crate::typed::{Expr, ExprKind, FunctionId, Literal, Module, Param, ParamId, RasterId, Type};
use std::collections::BTreeSet;

pub use crate::entry::EntryKind;

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
    /// Calls of baked functions stay calls.
    pub no_bake: bool,
}

/// Why a program could not be compiled.
#[derive(Clone, Debug)]
pub enum CompileError {
    /// The program is wrong.
    Program(Report),
    /// The host asked for something that the program does not have: an entry, a parameter.
    Request(String),
    /// A value that the host gives a parameter is none of its type.
    Value(Report),
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
    /// Live parameters of function type.
    pub slots: Vec<Slot>,
    pub back: Back,
    /// Rasters that the entry or a bake reads, in order.
    pub rasters: Vec<RasterId>,
    /// What is evaluated for the field's samples before the first picture, each after those that it reads.
    pub bakes: Vec<Bake>,
    pub warnings: Vec<Diagnostic>,
}

impl Compiled {
    /// Components of an image entry's value, 1 to 4; words of a value entry's.
    pub fn result_words(&self, module: &Module) -> u32 {
        layout::scalars(module, &self.result).map_or(0, |s| s.len() as u32)
    }

    /// The word of a slot for what it holds now.
    pub fn slot_word(&self, module: &Module, slot: &Slot) -> u32 {
        let setting = self.settings.set.get(&slot.param);
        let name = setting.and_then(|setting| function_name(module, &setting.value));
        name.and_then(|name| slot.word(name)).unwrap_or(slot.initial)
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
    let (entry, kind) = entry::find(checked, options)?;
    let settings = settings(module, options)?;
    let report =
        |diagnostics| CompileError::Program(Report { sources: checked.sources.clone(), diagnostics });
    // A value asks for few positions, far fewer than a field has samples.
    let bake = kind != EntryKind::Value && !options.no_bake;
    let asked = if kind == EntryKind::Map { Asked::ForSamples } else { Asked::Plainly };
    let (back, bakes) =
        on_large_stack(|| bake::backs(module, (entry, asked), &settings, bake)).map_err(report)?;
    let slots = on_large_stack(|| lower::slots(module, &settings)).map_err(report)?;
    let function = &module.functions[entry.0 as usize];
    let all = bakes.iter().flat_map(|bake| bake.reads.iter().copied()).chain(bake::slots(&back.core));
    let rasters = all.filter(|slot| (*slot as usize) < module.rasters.len());
    let rasters: BTreeSet<u32> = rasters.collect();
    Ok(Compiled {
        entry,
        kind,
        params: function.param_types().cloned().collect(),
        result: function.result.clone(),
        settings,
        slots,
        rasters: rasters.into_iter().map(RasterId).collect(),
        bakes,
        back,
        warnings: Vec::new(),
    })
}

/// Another value of a live parameter, without compiling again.
pub fn set_live(
    checked: &Checked,
    compiled: &mut Compiled,
    name: &str,
    text: &str,
) -> Result<(), CompileError> {
    let set = vec![(name.to_string(), text.to_string())];
    let changed = settings(&checked.module, &Options { set, ..Options::default() })?;
    if let Some(id) = changed.set.keys().find(|id| !compiled.settings.live.contains(id)) {
        let name = &checked.module.params[id.0 as usize].name;
        return Err(CompileError::Request(format!(
            "the parameter `{name}` was fixed when the program was compiled; declare it live to change it"
        )));
    }
    for slot in &compiled.slots {
        let Some(setting) = changed.set.get(&slot.param) else { continue };
        let word = function_name(&checked.module, &setting.value).and_then(|function| slot.word(function));
        if word.is_none() {
            let names = slot.names.join(", ");
            return Err(CompileError::Request(format!(
                "the parameter `{name}` can hold one of the functions {names}, not `{text}`"
            )));
        }
    }
    compiled.settings.set.extend(changed.set);
    Ok(())
}

/// The name of a function that is given by its name.
fn function_name<'a>(module: &'a Module, value: &Expr) -> Option<&'a str> {
    match &value.kind {
        ExprKind::Function(id, _) => Some(&module.functions[id.0 as usize].name),
        ExprKind::Builtin(builtin) => Some(builtin.name()),
        _ => None,
    }
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
            CompileError::Value(Report { sources, diagnostics })
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

/// What only specialisation finds, with the parameters as the host sets them: for the entry that is named, else for
/// every entry a host may ask for (see [`entry::asked_for`]).
pub fn reach(checked: &Checked, options: &Options) -> Result<Vec<Diagnostic>, CompileError> {
    let module = &checked.module;
    let settings = settings(module, options)?;
    let asked = match &options.entry {
        Some(_) => (vec![entry::find(checked, options)?.0], Vec::new()),
        None => entry::asked_for(module),
    };
    Ok(on_large_stack(|| reach_all(module, &settings, asked)))
}

fn reach_all(
    module: &Module,
    settings: &Settings,
    (entries, mut found): (Vec<FunctionId>, Vec<Diagnostic>),
) -> Vec<Diagnostic> {
    let mut lowered = 0;
    for entry in entries {
        match lower::lower(module, entry, Asked::Plainly, settings) {
            Ok(program) => lowered += program.statements(),
            Err(diagnostics) => {
                lowered += 1;
                for diagnostic in diagnostics {
                    if !found.contains(&diagnostic) {
                        found.push(diagnostic);
                    }
                }
            }
        }
        if lowered > MOST_LOWERED || found.len() > MAX_DIAGNOSTICS {
            break;
        }
    }
    found
}

/// Statements after which no further entry is tried: entries may share most of a large program.
const MOST_LOWERED: usize = 400_000;
