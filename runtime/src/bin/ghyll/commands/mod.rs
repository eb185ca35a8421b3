//! One file a command.

mod baking;
pub mod bench;
pub mod build;
pub mod check;
pub mod explain;
mod film;
pub mod fmt;
pub mod info;
pub mod lsp;
mod machine;
pub mod map;
pub mod render;
pub mod repl;
pub mod run;
mod scene;
pub mod trace;
mod tune;
pub mod view;

use crate::arguments;
use crate::failure::{self, Failure};
use ghyll_compiler::argument::parse_arguments;
use ghyll_compiler::compile::{self, CompileError, Compiled, EntryKind, Options};
use ghyll_compiler::diagnostic::Report;
use ghyll_compiler::front::Checked;
use ghyll_compiler::source::Source;
use ghyll_compiler::typed::{Expr, Local};
use ghyll_runtime::files::{self, Disk};
use ghyll_runtime::image;
use ghyll_runtime::machine::evaluate_argument;
use ghyll_runtime::value::Value;
use std::fs::File;
use std::path::Path;

/// Reads a program's text; `-` is standard input.
fn read(path: &Path) -> Result<Source, Failure> {
    let source = if path.as_os_str() == "-" { files::input() } else { files::source(path) };
    source.map_err(Failure::Input)
}

/// A picture that cannot be written is known before it is computed.
fn writable(output: &Path, film: bool) -> Result<(), Failure> {
    if !film {
        image::Format::of(output).map_err(|e| Failure::Usage(e.to_string()))?;
    }
    writable_file(output)
}

/// A file that cannot be written is known before the work is done whose outcome it is to hold.
fn writable_file(output: &Path) -> Result<(), Failure> {
    let shown = output.display();
    let folder = output.parent().filter(|folder| !folder.as_os_str().is_empty());
    if folder.is_some_and(|folder| !folder.is_dir()) {
        return Err(Failure::Usage(format!(
            "cannot write {shown}: its folder does not exist; make it first"
        )));
    }
    if output.is_dir() {
        return Err(Failure::Usage(format!("cannot write {shown}: it is a folder; name a file in it")));
    }
    // Only a trial tells. What is there is kept, what was not there is taken away again.
    let tried = match output.try_exists() {
        Ok(true) if output.is_file() => File::options().append(true).open(output).map(drop),
        Ok(true) => Ok(()),
        Ok(false) => File::create_new(output).and_then(|_| std::fs::remove_file(output)),
        Err(error) => Err(error),
    };
    tried.map_err(|error| {
        Failure::Usage(format!("cannot write {shown}: {error}; check its permissions, or name another file"))
    })
}

/// Parses and checks a program, showing its warnings.
fn checked(source: Source, json: bool) -> Result<Checked, Failure> {
    let checked =
        compile::check_with(source, &Disk).map_err(|report| Failure::Diagnostics { report, json })?;
    if !json && !checked.warnings.is_empty() {
        let diagnostics = checked.warnings.clone();
        failure::show(&Report { sources: checked.sources.clone(), diagnostics }, false);
    }
    Ok(checked)
}

/// What the arguments ask of the compiler.
fn options(program: &arguments::Program, want: Option<EntryKind>) -> Result<Options, Failure> {
    let set = program.set.iter().map(|text| setting(text)).collect::<Result<_, _>>()?;
    let (entry, live) = (program.entry.clone(), program.live.clone());
    Ok(Options { entry, want, set, live, no_bake: program.no_bake })
}

/// Name and value of a parameter.
fn setting(text: &str) -> Result<(String, String), Failure> {
    let (name, value) = text.split_once('=').ok_or_else(|| {
        Failure::Usage(format!("--set {text}: expected NAME=VALUE, such as --set detail=true"))
    })?;
    Ok((name.trim().to_string(), value.trim().to_string()))
}

fn refused(error: CompileError, json: bool) -> Failure {
    match error {
        CompileError::Program(report) => Failure::Diagnostics { report, json },
        CompileError::Value(report) => Failure::Value { report, json },
        CompileError::Request(message) => Failure::Usage(message),
    }
}

/// Compiles a checked program as the arguments say.
fn compiled(
    checked: &Checked,
    program: &arguments::Program,
    want: Option<EntryKind>,
) -> Result<Compiled, Failure> {
    compiled_as(checked, program, &options(program, want)?)
}

/// The same with the options made already.
fn compiled_as(
    checked: &Checked,
    program: &arguments::Program,
    options: &Options,
) -> Result<Compiled, Failure> {
    let compiled = compile::compile(checked, options).map_err(|error| refused(error, program.json))?;
    options.set.iter().try_for_each(|(name, text)| in_range(checked, name, text))?;
    if !program.json && !compiled.warnings.is_empty() {
        let diagnostics = compiled.warnings.clone();
        failure::show(&Report { sources: checked.sources.clone(), diagnostics }, false);
    }
    Ok(compiled)
}

/// Refuses a computed value outside the range that its parameter states; the compiler has looked at plain numbers.
fn in_range(checked: &Checked, name: &str, text: &str) -> Result<(), Failure> {
    let Some(param) = checked.module.params.iter().find(|p| p.name == name) else { return Ok(()) };
    let Some((lo, hi)) = &param.range else { return Ok(()) };
    let value = parse_arguments(&checked.module, text, &param.ty)
        .map_err(|report| Failure::Value { report, json: false })?;
    let number = |expr: &Expr, locals: &[Local]| {
        let value =
            evaluate_argument(checked, expr.clone(), locals.to_vec(), &param.ty).map_err(Failure::run)?;
        Ok(match value {
            Value::I32(i) => f64::from(i),
            Value::U32(u) => f64::from(u),
            Value::F32(x) => x,
            _ => f64::NAN,
        })
    };
    let (lo, hi) = (number(lo, &param.locals)?, number(hi, &param.locals)?);
    let value = number(&value.expr, &value.locals)?;
    if (lo..=hi).contains(&value) {
        return Ok(());
    }
    Err(Failure::Usage(format!("parameter `{name}` must lie in {lo}..{hi}, not {value}")))
}
