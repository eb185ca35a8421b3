//! The front end: text to typed tree, or every error that is worth telling.
//!
//! load and parse; declare items; check bodies; check what only whole programs show. Syntax errors end the
//! work after parsing, everything else is collected.

pub(crate) mod components;
mod recursion;
mod unused;
pub(crate) mod walk;

pub use crate::argument::{Argument, parse_arguments};

use crate::analysis::notes::Notes;
use crate::codes;
use crate::diagnostic::{Diagnostic, Report, Severity};
use crate::infer::{Body, ConstState, Env};
use crate::resolve::declare::{Declared, declare};
use crate::resolve::load::{File, Loaded, load};
use crate::source::{Files, Source, SourceId, Sources};
use crate::typed::{self, ConstId, ExprKind, Literal, Module, UnaryOp};
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::{Mutex, PoisonError};

/// Trees are bounded but may be deep; this is ample for the deepest.
const STACK: usize = 256 << 20;

/// More diagnostics help nobody, and each costs time to show.
pub(crate) const MAX_DIAGNOSTICS: usize = 100;

/// A program without errors.
#[derive(Clone, Debug)]
pub struct Checked {
    pub module: Module,
    pub sources: Sources,
    pub warnings: Vec<Diagnostic>,
}

/// Checks a program; `files` has the modules that it names by path.
pub fn front(source: Source, files: &dyn Files) -> Result<Checked, Report> {
    on_large_stack(|| {
        let Loaded { sources, files, diagnostics, .. } = load(source, files);
        // A value that nothing uses leaves the tree as it is, and may be of names that do not exist.
        let (module, diagnostics) = match diagnostics.iter().all(|d| d.code == codes::UNUSED_VALUE) {
            true => {
                let (module, found, _) = check(&files, declare(&files, None));
                (module, diagnostics.into_iter().chain(found).collect())
            }
            false => (Module::default(), diagnostics),
        };
        let report = Report { sources, diagnostics: ordered(diagnostics) };
        match report.has_errors() {
            true => Err(report),
            false => Ok(Checked { module, sources: report.sources, warnings: report.diagnostics }),
        }
    })
}

/// Runs on a thread with much stack; on this one where there are no threads.
pub(crate) fn on_large_stack<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    let work = Mutex::new(Some(work));
    let take = || work.lock().unwrap_or_else(PoisonError::into_inner).take();
    let run = || take().expect("taken once")();
    std::thread::scope(|scope| match std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, run) {
        Ok(thread) => thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)),
        Err(_) => run(),
    })
}

/// Checks what was declared; with the notes that were asked for.
pub(crate) fn check(files: &[File], declared: Declared) -> (Module, Vec<Diagnostic>, Option<Notes>) {
    let Declared { module, names, functions, params, mut diagnostics } = declared;
    let (mut consts, mut defaults, mut bodies) = (Vec::new(), Vec::new(), Vec::new());
    {
        let env = Env::new(&module, &names, &functions);
        for (i, (_, written)) in names.consts.iter().enumerate() {
            env.const_type(ConstId(i as u32), written.name.span, &mut diagnostics);
        }
        consts.extend(env.consts.borrow_mut().drain(..).map(|state| match state {
            ConstState::Done(body) => Some(body),
            _ => None,
        }));
        // Bodies of functions read the types of constants only.
        let known = consts
            .iter()
            .map(|body| ConstState::Known(body.as_ref().map_or(typed::Type::Error, |b| b.expr.ty.clone())));
        env.consts.borrow_mut().extend(known);
        for (i, (file, written)) in params.iter().enumerate() {
            let stated = (&module.params[i].ty, written.ty.span);
            let default = env.expression(*file, &written.default, Some(stated));
            // A range on anything else was reported.
            let ordered = matches!(module.params[i].ty, typed::Type::I32 | typed::Type::F32);
            let range = written
                .range
                .as_ref()
                .filter(|_| ordered)
                .map(|(lo, hi)| [lo, hi].map(|end| env.expression(*file, end, Some(stated))));
            defaults.push((default, range));
        }
        let mut wrong = diagnostics.iter().filter(|d| d.severity == Severity::Error).count();
        for i in 0..functions.len() {
            // The rest would not be shown, and a program with errors goes no further than to an editor.
            if wrong > MAX_DIAGNOSTICS && names.notes.is_none() {
                break;
            }
            let body = env.function(i);
            wrong += body.diagnostics.iter().filter(|d| d.severity == Severity::Error).count();
            bodies.push(body);
        }
    }
    let mut module = module;
    let mut keep = |body: Body| {
        diagnostics.extend(body.diagnostics);
        (body.expr, body.locals)
    };
    for (item, body) in module.consts.iter_mut().zip(consts) {
        let Some(body) = body else { continue };
        (item.value, item.locals) = keep(body);
        item.ty = item.value.ty.clone();
    }
    for (item, (default, range)) in module.params.iter_mut().zip(defaults) {
        (item.default, item.locals) = keep(default);
        item.range = range.map(|[lo, hi]| (keep(lo).0, keep(hi).0));
    }
    for (item, body) in module.functions.iter_mut().zip(bodies) {
        (item.body, item.locals) = keep(body);
    }
    if !diagnostics.iter().any(|d| d.severity == Severity::Error) {
        recursion::check(&module, &mut diagnostics);
        ranges(&module, &mut diagnostics);
        if !diagnostics.iter().any(|d| d.severity == Severity::Error) {
            unused::check(files, &names.scopes, &module, &mut diagnostics);
        }
    }
    let notes = names.notes.as_ref().map(|notes| {
        let mut notes = notes.take();
        notes.visible(&names);
        notes
    });
    (module, diagnostics, notes)
}

/// Defaults outside the range of their parameter, as far as literals show it.
fn ranges(module: &Module, out: &mut Vec<Diagnostic>) {
    for param in &module.params {
        let Some((lo, hi)) = &param.range else { continue };
        let (Some(low), Some(value), Some(high)) = (number(lo), number(&param.default), number(hi)) else {
            continue;
        };
        let (span, title) = match low <= high {
            true if (low..=high).contains(&value) => continue,
            true => (param.default.span, format!("the default of `{}` lies outside its range", param.name)),
            false => (lo.span.to(hi.span), format!("the range of `{}` is empty", param.name)),
        };
        out.push(
            Diagnostic::error(codes::PARAM_RANGE, span, title)
                .help("the range is `in lowest..highest`, both included, and the default lies in it"),
        );
    }
}

/// The value of a literal, perhaps negative.
fn number(e: &typed::Expr) -> Option<f64> {
    match &e.kind {
        ExprKind::Literal(Literal::I32(n)) => Some(f64::from(*n)),
        ExprKind::Literal(Literal::F32(x)) => Some(*x),
        ExprKind::Unary(UnaryOp::Neg, e) => number(e).map(|x| -x),
        _ => None,
    }
}

/// In the order of the text, the user's first; each once. Far too many are cut off, which is the last error then.
pub(crate) fn ordered(mut diagnostics: Vec<Diagnostic>) -> Vec<Diagnostic> {
    diagnostics.sort_by_key(|d| (d.primary.0.source, d.primary.0.start, d.primary.0.end, d.code));
    diagnostics.dedup_by(|a, b| a.code == b.code && a.primary.0 == b.primary.0 && a.title == b.title);
    one_for_each_module(&mut diagnostics);
    if let Some(next) = diagnostics.get(MAX_DIAGNOSTICS).map(|d| d.primary.0) {
        let hidden = diagnostics.split_off(MAX_DIAGNOSTICS);
        let title = "there are more errors or warnings from here on";
        // Warnings alone do not refuse a program.
        let last = match hidden.iter().any(|d| d.severity == Severity::Error) {
            true => Diagnostic::error(codes::TOO_MANY, next, title),
            false => Diagnostic::warning(codes::MANY_WARNINGS, next, title),
        };
        diagnostics.push(last.help("mend the ones above first"));
    }
    diagnostics
}

/// Names in need of one module are one message.
fn one_for_each_module(diagnostics: &mut Vec<Diagnostic>) {
    const MOST_PLACES: usize = 4;
    let mut kept: Vec<Diagnostic> = Vec::new();
    let mut first: HashMap<(SourceId, Option<String>), usize> = HashMap::new();
    for diagnostic in diagnostics.drain(..) {
        if diagnostic.code == codes::NEEDS_MODULE {
            match first.entry((diagnostic.primary.0.source, diagnostic.help.clone())) {
                Entry::Vacant(new) => drop(new.insert(kept.len())),
                Entry::Occupied(first) => {
                    let first = &mut kept[*first.get()];
                    if first.secondary.len() < MOST_PLACES {
                        first.secondary.push((diagnostic.primary.0, "in that module too".into()));
                    }
                    continue;
                }
            }
        }
        kept.push(diagnostic);
    }
    *diagnostics = kept;
}

#[cfg(test)]
mod tests;
