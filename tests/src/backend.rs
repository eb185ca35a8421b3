//! The only part of the suite that knows the interface of the runtime.

mod together;

use crate::case::{self, Call, Program, Render, Settings};
use crate::judge::{Answer, Backend, Failure, Picture};
use crate::mode::Mode;
use ghyll_compiler::argument::parse_arguments;
use ghyll_compiler::compile::{CompileError, Compiled, EntryKind, Options, check_with, compile, reach};
use ghyll_compiler::diagnostic::{Diagnostic, Report, Severity};
use ghyll_compiler::front::Checked;
use ghyll_compiler::interpret::NoHost;
use ghyll_compiler::source::{Files, Source, SourceId};
use ghyll_compiler::stream;
use ghyll_compiler::table::Table;
use ghyll_runtime::config::{Config, Rewriter};
use ghyll_runtime::error::RunError;
use ghyll_runtime::gpu::{Gpu, GpuOptions};
use ghyll_runtime::machine::{Job, Machine, evaluate_argument};
use ghyll_runtime::oracle::Precision;
use ghyll_runtime::rasters::{self, BindError};
use ghyll_runtime::terrain::{Raster, Scene, SceneOptions, Terrain, View};
use ghyll_runtime::value::Value;
use std::collections::{BTreeSet, VecDeque};
use std::panic::catch_unwind;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// A program asked for and what became of it.
type Recent = (Wanted, Result<Arc<Ready>, Failure>);

/// The project's own compiler and runtime.
pub struct Ghyll {
    gpu: Option<Gpu>,
    /// What was compiled last: the modes of a case ask for the same program one after the other.
    recent: Mutex<VecDeque<Recent>>,
    /// Programs that share a table on the GPU.
    groups: Vec<together::Group>,
    /// A wrong step of the compiler, for tests of what looks for one.
    plant: Option<fn(&mut Table)>,
}

/// How many compiled programs are kept.
const RECENT: usize = 8;

/// What a compiled entry was made of.
#[derive(Clone, PartialEq)]
struct Wanted {
    program: Program,
    settings: Settings,
    entry: String,
    kind: Option<EntryKind>,
    size: (u32, u32),
}

/// As on the command line. Ends what hangs; how fast a loaded machine is decides no case.
const TIMEOUT: Duration = Duration::from_secs(60);

/// The most streams of a trace.
const TRACE_ROUNDS: usize = 1000;

impl Ghyll {
    /// Opens an adapter if there is one; what went wrong is for the caller to tell.
    pub fn open() -> (Ghyll, Result<String, String>) {
        match Gpu::new(&GpuOptions::default()) {
            Ok(gpu) => {
                let told = format!("{} ({})", gpu.info().name, gpu.info().backend);
                (Ghyll::with(Some(gpu)), Ok(told))
            }
            Err(error) => (Ghyll::with(None), Err(error.to_string())),
        }
    }

    fn with(gpu: Option<Gpu>) -> Ghyll {
        Ghyll { gpu, recent: Mutex::default(), groups: Vec::new(), plant: None }
    }

    /// Without an adapter, and with a wrong step at the end of the compiler.
    pub fn planted(plant: fn(&mut Table)) -> Ghyll {
        Ghyll { plant: Some(plant), ..Ghyll::with(None) }
    }

    /// Whether the mode can be run on this machine.
    pub fn runs(&self, mode: Mode) -> bool {
        !mode.is_gpu() || self.gpu.is_some()
    }

    fn ready(&self, wanted: Wanted) -> Result<Arc<Ready>, Failure> {
        let kept = |recent: &VecDeque<(Wanted, Result<Arc<Ready>, Failure>)>| {
            recent.iter().find(|(known, _)| *known == wanted).map(|(_, ready)| ready.clone())
        };
        let lock = || self.recent.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(ready) = kept(&lock()) {
            return ready;
        }
        // What looks for programs that break the compiler goes on to shrink them.
        let compile = || Ready::compile(&wanted);
        let compiled =
            catch_unwind(compile).unwrap_or_else(|_| Err(Failure::Run("the compiler panicked".into())));
        let ready = compiled.map(|mut ready| {
            self.plant.iter().for_each(|plant| plant(&mut ready.compiled.back.table));
            Arc::new(ready)
        });
        let mut recent = lock();
        recent.push_front((wanted, ready.clone()));
        recent.truncate(RECENT);
        ready
    }

    fn machine(&self, mode: Mode) -> Result<Machine, Failure> {
        match mode {
            Mode::Oracle => Ok(Machine::Oracle(Precision::F64)),
            Mode::OracleSingle => Ok(Machine::Oracle(Precision::F32)),
            _ if !mode.is_gpu() => Ok(Machine::Cpu),
            _ => match &self.gpu {
                Some(gpu) => Ok(Machine::Gpu(Box::new(gpu.clone()))),
                None => Err(Failure::Run("no adapter".into())),
            },
        }
    }
}

impl Backend for Ghyll {
    fn check(&self, program: &Program, settings: &Settings) -> Vec<case::Diagnostic> {
        match checked(program) {
            Ok(checked) => {
                let mut all = checked.warnings.clone();
                // A setting that is refused is what `fails` expects.
                all.extend(reach(&checked, &options(settings)).unwrap_or_default());
                diagnostics(&Report { sources: checked.sources, diagnostics: all })
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
        let mut answers: Vec<Option<Result<Answer, Failure>>> = vec![None; calls.len()];
        for first in 0..calls.len() {
            if answers[first].is_some() {
                continue;
            }
            let same: Vec<usize> =
                (first..calls.len()).filter(|i| calls[*i].entry == calls[first].entry).collect();
            let wanted = Wanted::value(program, settings, &calls[first].entry);
            let asked: Vec<&Call> = same.iter().map(|i| &calls[*i]).collect();
            if let Some(found) = self.answer_together(&wanted, mode, &asked) {
                for (index, answer) in same.iter().zip(found) {
                    answers[*index] = Some(answer);
                }
                continue;
            }
            match self.ready(wanted) {
                Ok(ready) => {
                    let args: Vec<&[String]> = same.iter().map(|i| calls[*i].args.as_slice()).collect();
                    let found = self.run_entry(&ready, settings, mode, &args);
                    for (index, answer) in same.iter().zip(found) {
                        answers[*index] = Some(answer);
                    }
                }
                Err(failure) => same.iter().for_each(|i| answers[*i] = Some(Err(failure.clone()))),
            }
        }
        answers.into_iter().flatten().collect()
    }

    fn render(
        &self,
        program: &Program,
        settings: &Settings,
        mode: Mode,
        render: &Render,
    ) -> Result<Picture, Failure> {
        let size = (render.width, render.height);
        let wanted =
            Wanted { kind: Some(EntryKind::Image), size, ..Wanted::value(program, settings, &render.entry) };
        let ready = self.ready(wanted)?;
        let machine = self.machine(mode)?;
        let (image, _) = ready.job().render(&machine, size, &config(settings, mode)).map_err(failure)?;
        let components = ready.compiled.result_words(&ready.checked.module);
        let mut values = Vec::new();
        for y in 0..render.height {
            for x in 0..render.width {
                values.extend_from_slice(image.pixel(x, y));
            }
        }
        Ok(Picture { width: render.width, components, values })
    }

    fn tasks(&self, program: &Program, settings: &Settings, entry: &str) -> Result<Vec<String>, Failure> {
        let ready = self.ready(Wanted { kind: None, ..Wanted::value(program, settings, entry) })?;
        let names: BTreeSet<String> =
            ready.compiled.back.table.tasks.iter().map(|t| t.function.clone()).collect();
        Ok(names.into_iter().collect())
    }

    fn trace(&self, program: &Program, settings: &Settings, call: &Call) -> Result<Vec<String>, Failure> {
        let ready = self.ready(Wanted::value(program, settings, &call.entry))?;
        let words = ready.job().constants(&ready.values(&call.args)?).map_err(failure)?;
        let back = &ready.compiled.back;
        let first = stream::initial(&back.table, back.entry, &words);
        let streams = stream::rounds(&back.table, first, &NoHost, 1 << 24).take(TRACE_ROUNDS);
        streams
            .map(|s| s.map(|s| stream::print(&back.table, &s)).map_err(|_| Failure::Run("stopped".into())))
            .collect()
    }
}

impl Ghyll {
    /// One answer for each list of arguments of an entry; the GPU's pipelines are made once.
    fn run_entry(
        &self,
        ready: &Ready,
        settings: &Settings,
        mode: Mode,
        calls: &[&[String]],
    ) -> Vec<Result<Answer, Failure>> {
        let (job, config) = (ready.job(), config(settings, mode));
        let machine = match self.machine(mode) {
            Ok(machine) => machine,
            Err(failure) => return vec![Err(failure); calls.len()],
        };
        let engine = match &machine {
            Machine::Gpu(gpu) => Some(job.engine(gpu, &config, 0)),
            _ => None,
        };
        let mut engine = match engine.transpose() {
            Ok(engine) => engine,
            Err(error) => return vec![Err(failure(error)); calls.len()],
        };
        let mut run = |args: &[String]| -> Result<Answer, Failure> {
            let args = ready.values(args)?;
            let Some(engine) = &mut engine else {
                let (value, stats) = job.run(&machine, &args, &config).map_err(failure)?;
                let rounds = (mode.family() == "cpu").then_some(stats.rounds as u32);
                return Ok(Answer { value: value.to_string(), rounds });
            };
            let stream = job.stream(&args).map_err(failure)?;
            let outcome = engine.run(&stream).map_err(failure)?;
            let module = &ready.checked.module;
            let value = Value::unflatten(&outcome.words, &ready.compiled.result, module).map_err(failure)?;
            Ok(Answer { value: value.to_string(), rounds: Some(outcome.stats.rounds as u32) })
        };
        calls.iter().map(|args| run(args)).collect()
    }
}

/// A compiled entry with the scene it looks at.
struct Ready {
    checked: Checked,
    compiled: Compiled,
    scene: Option<Scene>,
}

impl Wanted {
    fn value(program: &Program, settings: &Settings, entry: &str) -> Wanted {
        let (program, settings) = (program.clone(), settings.clone());
        Wanted { program, settings, entry: entry.into(), kind: Some(EntryKind::Value), size: (1, 1) }
    }
}

impl Ready {
    fn compile(wanted: &Wanted) -> Result<Ready, Failure> {
        let Wanted { program, settings, entry, kind, size } = wanted;
        let checked = checked(program).map_err(|report| Failure::Diagnostics(diagnostics(&report)))?;
        let options = Options { entry: Some(entry.clone()), want: *kind, ..options(settings) };
        let compiled = compile(&checked, &options).map_err(|error| match error {
            CompileError::Program(report) => Failure::Diagnostics(diagnostics(&report)),
            CompileError::Value(report) => Failure::Value(diagnostics(&report)),
            CompileError::Request(text) => Failure::Usage(text),
        })?;
        let scene = match scene(settings, *size)? {
            Some(scene) => Some(bind(&checked, &compiled, &scene, settings)?),
            None => None,
        };
        Ok(Ready { checked, compiled, scene })
    }

    fn job(&self) -> Job<'_> {
        Job { checked: &self.checked, compiled: &self.compiled, scene: self.scene.as_ref() }
    }

    fn values(&self, texts: &[String]) -> Result<Vec<Value>, Failure> {
        let params = &self.compiled.params;
        if texts.len() != params.len() {
            return Err(Failure::Usage(format!(
                "{} arguments are needed, {} given",
                params.len(),
                texts.len()
            )));
        }
        let value = |(text, ty): (&String, _)| {
            let argument = parse_arguments(&self.checked.module, text, ty)
                .map_err(|report| Failure::Value(diagnostics(&report)))?;
            evaluate_argument(&self.checked, argument.expr, argument.locals, ty).map_err(failure)
        };
        texts.iter().zip(params).map(value).collect()
    }
}

/// What the header sets, for no entry in particular.
fn options(settings: &Settings) -> Options {
    let Settings { set, live, no_bake, .. } = settings.clone();
    Options { set, live, no_bake, ..Options::default() }
}

fn checked(program: &Program) -> Result<Checked, Report> {
    check_with(Source::new(&program.name, &program.text), &Modules(&program.files))
}

/// The modules of a case, which lie beside its program.
struct Modules<'a>(&'a [(String, String)]);

impl Files for Modules<'_> {
    fn read(&self, name: &str) -> Result<String, String> {
        let found = self.0.iter().find(|(known, _)| known == name);
        found.map(|(_, text)| text.clone()).ok_or_else(|| "no such file".into())
    }
}

/// The scene with the rasters of the header.
fn bind(
    checked: &Checked,
    compiled: &Compiled,
    scene: &Scene,
    settings: &Settings,
) -> Result<Scene, Failure> {
    let refused = |error: BindError| match error.is_usage() {
        true => Failure::Usage(error.to_string()),
        false => Failure::Input(error.to_string()),
    };
    let given = &settings.rasters;
    rasters::check_names(&checked.module, given.iter().map(|r| r.name.as_str())).map_err(refused)?;
    let open = |name: &str| {
        let r = given.iter().find(|r| r.name == name)?;
        Some(Raster::from_floats(r.width, r.height, r.components, r.numbers.clone()).map(Arc::new))
    };
    rasters::bind(&checked.module, compiled, scene, open).map_err(refused)
}

/// The height field of the header, seen from above.
fn scene(settings: &Settings, size: (u32, u32)) -> Result<Option<Scene>, Failure> {
    let Some(dem) = &settings.dem else { return Ok(None) };
    let rows = dem.heights.chunks(dem.width as usize).rev();
    let south_first: Vec<f32> = rows.flatten().copied().collect();
    let spacing = [dem.spacing.0, dem.spacing.1];
    let terrain = Terrain::from_heights(dem.width, dem.height, spacing, south_first)
        .map_err(|error| Failure::Input(error.to_string()))?;
    let options = SceneOptions { view: View::overview(), size, ..SceneOptions::default() };
    Scene::new(Arc::new(terrain), &options).map(Some).map_err(|error| Failure::Input(error.to_string()))
}

fn config(settings: &Settings, mode: Mode) -> Config {
    let rewriter = match mode {
        Mode::CpuBlock | Mode::GpuBlock | Mode::GpuTinyBlocks => Rewriter::Block,
        Mode::CpuLane | Mode::GpuLane => Rewriter::Lane,
        _ => Rewriter::Auto,
    };
    let usual = Config::default();
    Config {
        rewriter,
        depth: matches!(mode, Mode::CpuBlock | Mode::GpuBlock | Mode::GpuTinyBlocks).then_some(1),
        block: if mode == Mode::GpuTinyBlocks { 32 } else { usual.block },
        max_memory: settings.memory.unwrap_or(match mode {
            Mode::GpuTinyArena => 256 << 10,
            _ => usual.max_memory,
        }),
        timeout: settings.timeout.map_or(TIMEOUT, Duration::from_secs_f64),
        trusted: mode == Mode::GpuTrusted,
        ..usual
    }
}

fn failure(error: RunError) -> Failure {
    Failure::Run(error.to_string())
}

/// Diagnostics at places of the program's texts.
fn diagnostics(report: &Report) -> Vec<case::Diagnostic> {
    report.diagnostics.iter().map(|d| placed(report, d)).collect()
}

fn placed(report: &Report, d: &Diagnostic) -> case::Diagnostic {
    let (span, label) = &d.primary;
    let source = report.sources.get(span.source);
    let head = &source.text[..(span.start as usize).min(source.text.len())];
    case::Diagnostic {
        severity: match d.severity {
            Severity::Error => case::Severity::Error,
            Severity::Warning => case::Severity::Warning,
        },
        file: if span.source == SourceId(0) { String::new() } else { source.name.clone() },
        code: d.code.to_string(),
        line: head.matches('\n').count() as u32 + 1,
        column: head.rsplit('\n').next().unwrap_or_default().chars().count() as u32 + 1,
        part: if label.is_empty() { d.title.clone() } else { format!("{}: {label}", d.title) },
    }
}
