//! The only file of the suite that knows the interface of the runtime.

use crate::case::{self, Call, Program, Render, Settings};
use crate::judge::{Answer, Backend, Failure, Picture};
use crate::mode::Mode;
use ghyll_compiler::argument::parse_arguments;
use ghyll_compiler::diagnostic::{Report, Severity};
use ghyll_compiler::front::{Checked, front};
use ghyll_compiler::source::Source;
use ghyll_compiler::typed::{Attributes, Expr, Function, FunctionId, Local, ParamId, Type};
use ghyll_runtime::error::RunError;
use ghyll_runtime::oracle::{self, OracleOptions, Precision};
use ghyll_runtime::value::Value;
use std::time::Duration;

/// The project's own compiler and runtime.
pub struct Ghyll;

impl Ghyll {
    /// Whether the mode can be run on this machine.
    pub fn runs(&self, mode: Mode) -> bool {
        !mode.is_gpu() && mode.family() != "cpu"
    }
}

impl Backend for Ghyll {
    fn check(&self, program: &Program) -> Vec<case::Diagnostic> {
        match front(source(program)) {
            Ok(checked) => {
                let Checked { sources, warnings, .. } = checked;
                diagnostics(&Report { sources, diagnostics: warnings })
            }
            Err(report) => diagnostics(&report),
        }
    }

    fn run(
        &self,
        program: &Program,
        settings: &Settings,
        mode: Mode,
        calls: &[Call],
    ) -> Vec<Result<Answer, Failure>> {
        let run = |call: &Call| -> Result<Answer, Failure> {
            let mut checked =
                front(source(program)).map_err(|report| Failure::Diagnostics(diagnostics(&report)))?;
            let options = options(&mut checked, settings, mode)?;
            let entry = entry(&checked, &call.entry)?;
            let types: Vec<Type> =
                checked.module.functions[entry.0 as usize].param_types().cloned().collect();
            if types.len() != call.args.len() {
                return Err(Failure::Input(format!("{} arguments are needed", types.len())));
            }
            let mut args = Vec::new();
            for (text, ty) in call.args.iter().zip(&types) {
                args.push(value(&mut checked, text, ty)?);
            }
            match oracle::evaluate(&checked.module, entry, &args, &options, None) {
                Ok(value) => Ok(Answer { value: value.to_string(), rounds: None }),
                Err(error) => Err(failure(error)),
            }
        };
        calls.iter().map(run).collect()
    }

    fn render(
        &self,
        program: &Program,
        settings: &Settings,
        mode: Mode,
        render: &Render,
    ) -> Result<Picture, Failure> {
        let mut checked =
            front(source(program)).map_err(|report| Failure::Diagnostics(diagnostics(&report)))?;
        let options = options(&mut checked, settings, mode)?;
        let entry = entry(&checked, &render.entry)?;
        let (width, height) = (render.width, render.height);
        let image =
            oracle::render(&checked.module, entry, (width, height), &options, None).map_err(failure)?;
        let components = image.len() as u32 / (width * height);
        Ok(Picture { width, components, values: image.into_iter().map(|v| v as f32).collect() })
    }

    fn tasks(&self, _: &Program, _: &Settings, _: &str) -> Result<Vec<String>, Failure> {
        Err(Failure::Run("no table".into()))
    }

    fn trace(&self, _: &Program, _: &Settings, _: &Call) -> Result<Vec<String>, Failure> {
        Err(Failure::Run("no trace".into()))
    }
}

fn failure(error: RunError) -> Failure {
    Failure::Run(error.to_string())
}

fn source(program: &Program) -> Source {
    Source::new(&program.name, &program.text)
}

fn entry(checked: &Checked, name: &str) -> Result<FunctionId, Failure> {
    checked.module.function(name).ok_or_else(|| Failure::Input(format!("no function {name}")))
}

fn value(checked: &mut Checked, text: &str, ty: &Type) -> Result<Value, Failure> {
    let argument = parse_arguments(&checked.module, text, ty).map_err(|r| Failure::Input(shown(&r)))?;
    constant(checked, argument.expr, argument.locals, ty)
}

fn constant(checked: &mut Checked, body: Expr, locals: Vec<Local>, ty: &Type) -> Result<Value, Failure> {
    let span = body.span;
    let function = Function {
        name: "argument".into(),
        generics: Vec::new(),
        params: Vec::new(),
        result: ty.clone(),
        locals,
        body,
        attributes: Attributes::default(),
        library: false,
        span,
    };
    checked.module.functions.push(function);
    let id = FunctionId(checked.module.functions.len() as u32 - 1);
    oracle::evaluate(&checked.module, id, &[], &OracleOptions::default(), None).map_err(failure)
}

fn options(checked: &mut Checked, settings: &Settings, mode: Mode) -> Result<OracleOptions, Failure> {
    let mut options = OracleOptions::default();
    if mode == Mode::OracleSingle {
        options.precision = Precision::F32;
    }
    if let Some(timeout) = settings.timeout {
        options.timeout = Duration::from_secs_f64(timeout);
    }
    for (name, text) in &settings.set {
        let at = checked.module.params.iter().position(|p| p.name == *name);
        let at = at.ok_or_else(|| Failure::Input(format!("no parameter {name}")))?;
        let ty = checked.module.params[at].ty.clone();
        let argument = parse_arguments(&checked.module, text, &ty).map_err(|r| Failure::Input(shown(&r)))?;
        options.set.push((ParamId(at as u32), argument.expr));
    }
    Ok(options)
}

fn shown(report: &Report) -> String {
    report.diagnostics.iter().map(|d| d.title.clone()).collect::<Vec<_>>().join("; ")
}

fn diagnostics(report: &Report) -> Vec<case::Diagnostic> {
    let place = |d: &ghyll_compiler::diagnostic::Diagnostic| {
        let (span, label) = &d.primary;
        let text = &report.sources.get(span.source).text;
        let head = &text[..(span.start as usize).min(text.len())];
        let line = head.matches('\n').count() as u32 + 1;
        let column = head.rsplit('\n').next().unwrap_or("").chars().count() as u32 + 1;
        let severity = match d.severity {
            Severity::Error => case::Severity::Error,
            Severity::Warning => case::Severity::Warning,
        };
        let part = format!("{} / {}", d.title, label);
        case::Diagnostic { severity, code: d.code.into(), line, column, part }
    };
    report.diagnostics.iter().map(place).collect()
}
