//! One way to run a compiled program on any of the three machines: the GPU, its CPU twin, the oracle.

use crate::config::{Config, Stats};
use crate::error::RunError;
use crate::gpu::{self, Gpu, GpuError, GpuOptions};
use crate::image::Image;
use crate::kernels::{self, Kernels};
use crate::map::Map;
use crate::memory::Memory;
use crate::needs::Needs;
use crate::oracle::{self, OracleOptions};
use crate::renderer::Renderer;
use crate::terrain::Scene;
use crate::twin::Twin;
use crate::value::Value;
use crate::world::World;
use ghyll_compiler::back::Back;
use ghyll_compiler::compile::{Compiled, EntryKind};
use ghyll_compiler::core::{Const, Intrinsic, Scalar};
use ghyll_compiler::front::Checked;
use ghyll_compiler::layout;
use ghyll_compiler::stream;
use ghyll_compiler::table::Token;
use ghyll_compiler::typed::{self, FunctionId, Type};
use std::time::{Duration, Instant};

/// Where programs are evaluated.
pub enum Machine {
    Gpu(Box<Gpu>),
    Cpu,
    Oracle(oracle::Precision),
}

/// What a caller asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    Auto,
    Gpu,
    Cpu,
    Oracle,
}

impl Machine {
    /// Opens a machine; `Auto` is the best GPU, else the CPU twin.
    pub fn open(wanted: Wanted, options: &GpuOptions) -> Result<Machine, GpuError> {
        match wanted {
            Wanted::Cpu => Ok(Machine::Cpu),
            Wanted::Oracle => Ok(Machine::Oracle(oracle::Precision::F64)),
            Wanted::Gpu => Ok(Machine::Gpu(Box::new(Gpu::new(options)?))),
            Wanted::Auto => match Gpu::new(options) {
                Ok(gpu) => Ok(Machine::Gpu(Box::new(gpu))),
                Err(GpuError::NoAdapter) => Ok(Machine::Cpu),
                Err(error) => Err(error),
            },
        }
    }

    /// Which machine it is, for people.
    pub fn describe(&self) -> String {
        match self {
            Machine::Gpu(gpu) => {
                let info = gpu.info();
                let kind = if info.software { ", a software adapter" } else { "" };
                format!("GPU {} ({}{kind})", info.name, info.backend)
            }
            Machine::Cpu => "CPU twin".into(),
            Machine::Oracle(_) => "oracle, double precision".into(),
        }
    }

    /// Why it is this one, for people: what was `wanted` and what was found.
    pub fn reason(&self, wanted: Wanted) -> &'static str {
        match (wanted, self) {
            (Wanted::Auto, Machine::Gpu(gpu)) if gpu.info().software => "no hardware adapter was found",
            (Wanted::Auto, Machine::Gpu(_)) => "the best adapter found",
            (Wanted::Auto, _) => "no GPU adapter was found; `ghyll info` says what to install",
            _ => "as asked for",
        }
    }
}

impl Machine {
    /// What evaluates a program in this machine's place: the twin, where the program walks through terrain and the adapter fails
    /// the proof of exact sums and products that the walk rests on, and where the scene is larger than the adapter binds.
    pub fn stand_in(&self, job: &Job) -> Result<Option<StandIn>, RunError> {
        const WALKS: [Intrinsic; 4] = [
            Intrinsic::TraceBilinear,
            Intrinsic::TraceTriangulated,
            Intrinsic::OccludedBilinear,
            Intrinsic::OccludedTriangulated,
        ];
        let Machine::Gpu(gpu) = self else { return Ok(None) };
        let twin = |why: String| Ok(Some(StandIn { machine: Machine::Cpu, why }));
        if let Some(why) = kernels::too_large(job, gpu) {
            return twin(why.to_string());
        }
        let backs = job.compiled.bakes.iter().map(|bake| &bake.back).chain([&job.compiled.back]);
        let walks = backs.flat_map(|back| &back.wgsl.intrinsics).any(|i| WALKS.contains(i));
        if walks && !gpu.keeps_rounding().map_err(RunError::Device)? {
            return twin(
                "it does not keep the rounding of sums and products that exact tracing rests on".into(),
            );
        }
        Ok(None)
    }
}

/// A machine that takes another one's place for a program.
pub struct StandIn {
    pub machine: Machine,
    /// For people: what the other one cannot do.
    pub why: String,
}

/// A program with the scene it may look at.
#[derive(Clone, Copy)]
pub struct Job<'a> {
    pub checked: &'a Checked,
    pub compiled: &'a Compiled,
    pub scene: Option<&'a Scene>,
}

impl Job<'_> {
    /// Value of a value entry.
    pub fn run(
        &self,
        machine: &Machine,
        args: &[Value],
        config: &Config,
    ) -> Result<(Value, Stats), RunError> {
        let module = &self.checked.module;
        let back = &self.compiled.back;
        let stand_in = machine.stand_in(self)?;
        let (words, stats) = match stand_in.as_ref().map_or(machine, |other| &other.machine) {
            Machine::Oracle(precision) => {
                let started = Instant::now();
                let value = oracle::evaluate(
                    module,
                    self.compiled.entry,
                    args,
                    &self.oracle_options(*precision, config),
                    self.world(),
                )?;
                return Ok((value, Stats { total: started.elapsed(), ..Stats::default() }));
            }
            Machine::Cpu => {
                let stream = stream::initial(&back.table, back.entry, &self.constants(args)?);
                self.twin(config)?.run(&stream, config, self.world_of_code())?
            }
            Machine::Gpu(gpu) => {
                let mut engine = self.engine(gpu, config, 0)?;
                let outcome = engine.run(&self.stream(args)?)?;
                (outcome.words, gpu_stats(&outcome.stats))
            }
        };
        let value = Value::unflatten(&words, &self.compiled.result, module)?;
        Ok((value, self.looked_at(stats, Duration::ZERO)))
    }

    /// Picture of an image entry.
    pub fn render(
        &self,
        machine: &Machine,
        (width, height): (u32, u32),
        config: &Config,
    ) -> Result<(Image, Stats), RunError> {
        Renderer::default().render(self, machine, (width, height), config)
    }

    /// As [`Job::render`] of a scene that is not needed afterwards: where a GPU holds it, the host lets go of the samples
    /// before the picture is made.
    pub fn render_once(
        checked: &Checked,
        compiled: &Compiled,
        scene: Option<Scene>,
        (machine, config): (&Machine, &Config),
        (width, height): (u32, u32),
    ) -> Result<(Image, Stats), RunError> {
        let job = Job { checked, compiled, scene: scene.as_ref() };
        let stand_in = machine.stand_in(&job)?;
        let machine = stand_in.as_ref().map_or(machine, |other| &other.machine);
        let Machine::Gpu(gpu) = machine else { return job.render(machine, (width, height), config) };
        let components = compiled.result_words(&checked.module);
        let started = Instant::now();
        let needs = Needs::on_device(&job, (width, height));
        let mut kernels = Kernels::new(&job, gpu, config, components).map_err(|error| needs.whole(error))?;
        let figures = job.looked_at(Stats::default(), started.elapsed());
        drop(scene);
        let drawn = kernels.engine.render(width, height, compiled.back.entry.0);
        let frame = drawn.map_err(|error| needs.whole(error))?;
        let stats = gpu_stats(&frame.stats);
        let Memory { rasters, bakes, .. } = figures.memory;
        let terrain = stats.memory.terrain.saturating_sub(rasters + bakes);
        let memory = Memory { terrain, rasters, bakes, ..stats.memory };
        let image = Image::new(width, height, components, frame.words)
            .map_err(|e| RunError::Internal(e.to_string()))?;
        Ok((image, Stats { baking: figures.baking, memory, ..stats }))
    }

    /// Values of a map entry, one for each sample of the field.
    pub fn map(&self, machine: &Machine, config: &Config) -> Result<(Map, Stats), RunError> {
        let terrain = self
            .scene
            .map(Scene::terrain)
            .ok_or_else(|| RunError::Unsupported("a map without a field".into()))?;
        let (image, stats) = self.render(machine, (terrain.width, terrain.height), config)?;
        Ok((Map::new(image, terrain), stats))
    }

    pub(crate) fn oracle_picture(
        &self,
        size: (u32, u32),
        point: [f32; 2],
        options: &OracleOptions,
    ) -> Result<Vec<f64>, RunError> {
        let (module, entry) = (&self.checked.module, self.compiled.entry);
        let Some(scene) = self.scene.filter(|_| self.compiled.kind == EntryKind::Map) else {
            return oracle::render(module, entry, size, point.map(f64::from), options, self.world());
        };
        let spacing = scene.uniform().spacing.map(f64::from);
        let position = |column: u32, row: u32| {
            [f64::from(column) * spacing[0], f64::from(size.1 - 1 - row) * spacing[1]]
        };
        oracle::components(module, entry, size, &position, options, self.world())
    }

    pub(crate) fn render_twin(
        &self,
        scene: Option<&Scene>,
        size: (u32, u32),
        config: &Config,
    ) -> Result<(Vec<f32>, Stats), RunError> {
        let components = self.compiled.result_words(&self.checked.module);
        // What the code does not look at takes no memory.
        let scene = scene.filter(|_| !self.compiled.back.wgsl.intrinsics.is_empty());
        let world = scene.map(|scene| scene as &dyn World);
        self.twin(config)?.render(size, components, self.compiled.back.entry, config, world)
    }

    pub(crate) fn image(&self, (width, height): (u32, u32), data: Vec<f32>) -> Result<Image, RunError> {
        let components = self.compiled.result_words(&self.checked.module);
        Image::new(width, height, components, data).map_err(|e| RunError::Internal(e.to_string()))
    }

    /// The program's engine on a device, for repeated runs.
    pub fn engine(&self, gpu: &Gpu, config: &Config, components: u32) -> Result<gpu::Engine, RunError> {
        Ok(Kernels::new(self, gpu, config, components)?.engine)
    }

    /// What the engine runs for a compiled function, with the WGSL of the scene.
    pub(crate) fn code(&self, function: FunctionId, back: &Back, prelude: String) -> gpu::Code {
        let entry = &self.checked.module.functions[function.0 as usize].name;
        let suspendable = back.has_long_loops.then(|| {
            let (back, entry) = (back.clone(), entry.clone());
            gpu::Suspendable::new(move || code(&back.with_loops_as_tasks(), &entry))
        });
        gpu::Code { prelude, suspendable, ..code(back, entry) }
    }

    /// Initial stream as the GPU takes it.
    pub fn stream(&self, args: &[Value]) -> Result<Vec<(u32, bool)>, RunError> {
        let back = &self.compiled.back;
        let constants = self.constants(args)?;
        let stream = match back.has_long_loops {
            // The form with loops as tasks has the entry only in common.
            true => stream::call(back.entry, &constants),
            false => stream::initial(&back.table, back.entry, &constants),
        };
        let token = |token: &Token<Const>| match token {
            Token::Literal(constant) => (constant.word(), false),
            Token::Function(task) => (task.0, true),
        };
        Ok(stream.iter().map(token).collect())
    }

    /// Arguments as constants of the entry's parameters.
    pub fn constants(&self, args: &[Value]) -> Result<Vec<Const>, RunError> {
        let module = &self.checked.module;
        let mut constants = Vec::new();
        for (value, ty) in args.iter().zip(&self.compiled.params) {
            let scalars: Vec<Scalar> = layout::scalars(module, ty)
                .ok_or_else(|| RunError::Internal("an entry takes a function".into()))?;
            let words = value.flatten(ty, module)?;
            constants.extend(scalars.iter().zip(words).map(|(s, w)| Const::from_word(*s, w)));
        }
        Ok(constants)
    }

    /// The figures with how long the bakes took, and what part of the scene is not the field.
    pub(crate) fn looked_at(&self, stats: Stats, baking: Duration) -> Stats {
        let Some(scene) = self.scene else { return stats };
        let words = |slot: u32| scene.layers().get(slot).map_or(0, |layer| layer.raster().words());
        let samples = u64::from(scene.terrain().width) * u64::from(scene.terrain().height);
        let rasters = self.compiled.rasters.iter().map(|id| 4 * words(id.0)).sum();
        let bakes = self.compiled.bakes.iter().map(|bake| 4 * samples * u64::from(bake.components)).sum();
        let terrain = stats.memory.terrain.saturating_sub(rasters + bakes);
        let memory = Memory { terrain, rasters, bakes, ..stats.memory };
        Stats { baking: if bakes > 0 { baking } else { Duration::ZERO }, memory, ..stats }
    }

    fn twin(&self, config: &Config) -> Result<Twin, RunError> {
        let mut twin = Twin::new(&self.compiled.back.table)?;
        twin.set_live(&self.live_words(config)?);
        Ok(twin)
    }

    /// Words of the live parameters, one after the other. Single precision, as if the machine had computed them.
    pub fn live_words(&self, config: &Config) -> Result<Vec<u32>, RunError> {
        let module = &self.checked.module;
        let options = self.oracle_options(oracle::Precision::F32, config);
        let mut words = Vec::new();
        for id in &self.compiled.settings.live {
            if let Some(slot) = self.compiled.slots.iter().find(|slot| slot.param == *id) {
                words.resize(words.len() + slot.words(), self.compiled.slot_word(module, slot));
                continue;
            }
            let value = oracle::parameter(module, *id, &options, self.world())?;
            words.extend(value.flatten(&module.params[id.0 as usize].ty, module)?);
        }
        Ok(words)
    }

    fn world(&self) -> Option<&dyn World> {
        self.scene.map(|scene| scene as &dyn World)
    }

    /// The scene, if the code looks at it: else it takes no memory.
    fn world_of_code(&self) -> Option<&dyn World> {
        self.world().filter(|_| !self.compiled.back.wgsl.intrinsics.is_empty())
    }

    pub(crate) fn oracle_options(&self, precision: oracle::Precision, config: &Config) -> OracleOptions {
        let set = self.compiled.settings.set.iter().map(|(id, s)| (*id, s.clone())).collect();
        OracleOptions {
            precision,
            timeout: config.timeout,
            max_steps: config.max_rewrites,
            max_memory: config.max_memory,
            set,
            threads: config.threads,
        }
    }
}

fn code(back: &Back, entry: &str) -> gpu::Code {
    let tasks = &back.table.tasks;
    gpu::Code {
        functions: back.wgsl.text.clone(),
        has_shade: back.wgsl.has_shade,
        fused: back.wgsl.fused,
        arities: tasks.iter().map(|t| t.arity()).collect(),
        longest_emission: back.table.longest_emission(),
        widths: back.table.widths(),
        names: tasks.iter().map(|t| t.function.clone()).chain([entry.to_owned()]).collect(),
        live_words: back.core.live.iter().map(|(_, scalars)| scalars.len() as u32).sum(),
        constants: back.wgsl.constants.clone(),
        ..gpu::Code::default()
    }
}

/// Value of a closed expression such as a command-line argument.
pub fn evaluate_argument(
    checked: &Checked,
    value: typed::Expr,
    locals: Vec<typed::Local>,
    ty: &Type,
) -> Result<Value, RunError> {
    evaluate_in(checked, value, locals, ty, (None, oracle::Precision::F64))
}

/// Value of a closed expression that may look at a scene.
pub fn evaluate_in(
    checked: &Checked,
    value: typed::Expr,
    locals: Vec<typed::Local>,
    ty: &Type,
    (world, precision): (Option<&dyn World>, oracle::Precision),
) -> Result<Value, RunError> {
    let options = OracleOptions { precision, ..OracleOptions::default() };
    oracle::expression(&checked.module, (&value, locals.len(), ty), &options, world)
}

/// Figures of the engine in the common form.
pub fn gpu_stats(gpu: &gpu::Stats) -> Stats {
    Stats {
        rounds: gpu.rounds,
        rewrites: gpu.rewrites,
        direct: gpu.direct,
        tokens_moved: gpu.moved,
        memory: gpu.memory,
        dispatches: gpu.dispatches,
        submissions: gpu.submissions,
        suspended: gpu.suspended,
        compiling: gpu.compiling,
        total: gpu.time,
        ..Stats::default()
    }
}
