//! The interface for Rust programs that embed Ghyll.
//!
//! ```
//! use ghyll_runtime::api::{self, Options, Runtime};
//! use ghyll_runtime::terrain::{Terrain, View};
//! use ghyll_runtime::value::Value;
//! use ghyll_compiler::source::Source;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let runtime = Runtime::new(Options::default())?;
//! let fib = api::compile(Source::new("fib", "
//!     fn fib(n: i32) -> i32 = if n < 2 { n } else { fib(n - 1) + fib(n - 2) };
//!     fn main(n: i32) -> i32 = fib(n);
//! "))?;
//! assert_eq!(runtime.run(&fib, &[Value::I32(20)])?, Value::I32(6765));
//!
//! let depth = api::compile(Source::new("depth", "
//!     use terrain;
//!     param scale: f32 = 1.0;
//!     fn pixel(p: vec2) -> f32 = match trace(bilinear, camera(p)) { Some(t) => t * scale, None => -1.0 };
//! "))?;
//! let mut scene =
//!     runtime.scene(&depth).terrain(Terrain::builtin()).view(View::topdown()).set("scale", 0.001)?.build()?;
//! let image = scene.render(64, 64)?;
//! assert!(image.pixel(32, 32)[0] > 0.0);
//! # Ok(())
//! # }
//! ```

use crate::config::Config;
use crate::error::RunError;
use crate::files::{self, Disk};
use crate::gpu::{GpuError, GpuOptions};
use crate::image::Image;
use crate::machine::{Job, Machine, Wanted};
use crate::map::Map;
use crate::rasters::{self, BindError};
use crate::renderer::Renderer;
use crate::terrain::{DemError, Micro, Raster, Scene, SceneError, SceneOptions, Sun, Terrain, View};
use crate::value::Value;
use ghyll_compiler::compile::{self, CompileError, Compiled, EntryKind};
use ghyll_compiler::diagnostic::Report;
use ghyll_compiler::front::Checked;
use ghyll_compiler::report;
use ghyll_compiler::source::{Files, Source};
use std::path::Path;
use std::sync::Arc;

/// What can go wrong between source text and picture.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Diagnostics, ready for [`report::render`].
    #[error("{}", report::render(.0, false))]
    Program(Report),
    /// An entry, a parameter or an argument that the program does not have.
    #[error("{0}")]
    Request(String),
    #[error(transparent)]
    Raster(#[from] BindError),
    #[error(transparent)]
    Dem(#[from] DemError),
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Gpu(#[from] GpuError),
    #[error(transparent)]
    Run(#[from] RunError),
}

impl From<CompileError> for Error {
    fn from(error: CompileError) -> Error {
        match error {
            CompileError::Program(report) | CompileError::Value(report) => Error::Program(report),
            CompileError::Request(message) => Error::Request(message),
        }
    }
}

/// A program without errors; its entry and parameters are chosen when it is used.
#[derive(Clone, Debug)]
pub struct Program(Arc<Checked>);

impl Program {
    pub fn checked(&self) -> &Checked {
        &self.0
    }
}

/// Checks a program. Modules that it uses by path are read from disk, relative to the folder in the source's name.
///
/// # Errors
/// [`Error::Program`] with every diagnostic.
pub fn compile(source: Source) -> Result<Program, Error> {
    compile_with(source, &Disk)
}

/// Checks a program; `files` has the modules that it uses by path.
///
/// # Errors
/// [`Error::Program`] with every diagnostic.
pub fn compile_with(source: Source, files: &dyn Files) -> Result<Program, Error> {
    compile::check_with(source, files).map(|checked| Program(Arc::new(checked))).map_err(Error::Program)
}

/// Reads and checks a program.
///
/// # Errors
/// [`Error::Request`] if there is no such file, [`Error::Program`] with every diagnostic.
pub fn open(path: impl AsRef<Path>) -> Result<Program, Error> {
    compile(files::source(path.as_ref()).map_err(Error::Request)?)
}

/// Where programs run and within which limits.
#[derive(Clone, Debug)]
pub struct Options {
    pub on: Wanted,
    pub gpu: GpuOptions,
    pub config: Config,
}

impl Default for Options {
    /// The best GPU adapter, else the CPU twin.
    fn default() -> Options {
        Options { on: Wanted::Auto, gpu: GpuOptions::default(), config: Config::default() }
    }
}

/// An open machine.
pub struct Runtime {
    machine: Machine,
    config: Config,
}

impl Runtime {
    pub fn new(options: Options) -> Result<Runtime, Error> {
        Ok(Runtime { machine: Machine::open(options.on, &options.gpu)?, config: options.config })
    }

    /// A runtime on a machine that the caller has opened, such as [`crate::gpu::Gpu::from_device`].
    pub fn on(machine: Machine, config: Config) -> Runtime {
        Runtime { machine, config }
    }

    /// Which machine it is, for people.
    pub fn describe(&self) -> String {
        self.machine.describe()
    }

    /// Value of `fn main` for these arguments.
    pub fn run(&self, program: &Program, args: &[Value]) -> Result<Value, Error> {
        let options = compile::Options { want: Some(EntryKind::Value), ..Default::default() };
        let compiled = compile::compile(&program.0, &options)?;
        if args.len() != compiled.params.len() {
            let (wanted, given) = (compiled.params.len(), args.len());
            return Err(Error::Request(format!("`main` takes {wanted} arguments, {given} were given")));
        }
        let job = Job { checked: &program.0, compiled: &compiled, scene: None };
        Ok(job.run(&self.machine, args, &self.config)?.0)
    }

    /// A picture to be made of `fn pixel`.
    pub fn scene<'a>(&'a self, program: &Program) -> SceneBuilder<'a> {
        self.builder(program, EntryKind::Image)
    }

    /// A map to be made of `fn map`, by [`Picture::map`].
    pub fn map<'a>(&'a self, program: &Program) -> SceneBuilder<'a> {
        self.builder(program, EntryKind::Map)
    }

    fn builder<'a>(&'a self, program: &Program, want: EntryKind) -> SceneBuilder<'a> {
        SceneBuilder {
            runtime: self,
            program: program.clone(),
            terrain: None,
            rasters: Vec::new(),
            micro: None,
            options: SceneOptions::default(),
            samples: 1,
            compile: compile::Options { want: Some(want), ..Default::default() },
        }
    }
}

/// A parameter's value, as the expression that sets it.
pub struct Setting(String);

macro_rules! settings {
    ($($ty:ty: $text:expr;)*) => {$(
        impl From<$ty> for Setting {
            fn from(value: $ty) -> Setting {
                let text: fn($ty) -> String = $text;
                Setting(text(value))
            }
        }
    )*};
}

settings! {
    bool: |b| b.to_string();
    i32: |i| i.to_string();
    u32: |u| format!("{u}u");
    f32: |x| format!("{x:?}");
    f64: |x| format!("{:?}", x as f32);
    &str: |text| text.to_string();
    &Value: |value| value.to_string();
}

/// A function of the program, by its name, as the value of a parameter.
pub struct Function<'a>(pub &'a str);

impl From<Function<'_>> for Setting {
    fn from(function: Function) -> Setting {
        Setting(function.0.to_string())
    }
}

/// What a scene is made of.
pub struct SceneBuilder<'a> {
    runtime: &'a Runtime,
    program: Program,
    terrain: Option<Terrain>,
    rasters: Vec<(String, Arc<Raster>)>,
    micro: Option<Arc<Micro>>,
    options: SceneOptions,
    samples: u32,
    compile: compile::Options,
}

impl<'a> SceneBuilder<'a> {
    /// The height field; the built-in one if this is not called.
    pub fn terrain(mut self, terrain: Terrain) -> Self {
        self.terrain = Some(terrain);
        self
    }

    /// Data of a raster of the program; it is used only if the entry reads it.
    pub fn raster(mut self, name: &str, raster: impl Into<Arc<Raster>>) -> Self {
        self.rasters.push((name.to_string(), raster.into()));
        self
    }

    /// The tile that `micro` reads in place of the one that comes with Ghyll: one number for each texel, a metre apart; its
    /// lowest counts as -1, its highest as 1.
    ///
    /// # Errors
    /// [`Error::Dem`] if the raster has more than one channel.
    pub fn micro(mut self, raster: &Raster) -> Result<Self, Error> {
        self.micro = Some(Arc::new(Micro::new(raster)?));
        Ok(self)
    }

    pub fn view(mut self, view: View) -> Self {
        self.options.view = view;
        self
    }

    pub fn sun(mut self, sun: Sun) -> Self {
        self.options.sun = sun;
        self
    }

    /// Factor on all heights.
    pub fn exaggerate(mut self, factor: f64) -> Self {
        self.options.exaggerate = factor;
        self
    }

    /// Samples of every pixel, whose mean it becomes.
    pub fn samples(mut self, count: u32) -> Self {
        self.samples = count;
        self
    }

    /// Another entry than `pixel`.
    pub fn entry(mut self, name: &str) -> Self {
        self.compile.entry = Some(name.to_string());
        self
    }

    /// Fixes a parameter before code is made.
    ///
    /// # Errors
    /// [`Error::Request`] if the program has no such parameter.
    pub fn set(mut self, name: &str, value: impl Into<Setting>) -> Result<Self, Error> {
        if !self.program.0.module.params.iter().any(|p| p.name == name) {
            return Err(Error::Request(format!("there is no parameter `{name}`")));
        }
        self.compile.set.push((name.to_string(), value.into().0));
        Ok(self)
    }

    /// Keeps a parameter changeable by [`Picture::set`]. What is not live is fixed when the picture is built.
    pub fn live(mut self, name: &str) -> Self {
        self.compile.live.push(name.to_string());
        self
    }

    /// Calls `@bake` functions instead of reading what they were evaluated to.
    pub fn no_bake(mut self) -> Self {
        self.compile.no_bake = true;
        self
    }

    pub fn build(self) -> Result<Picture<'a>, Error> {
        let compiled = compile::compile(&self.program.0, &self.compile)?;
        let terrain = Arc::new(self.terrain.unwrap_or_else(Terrain::builtin));
        let scene = Scene::new(terrain, &self.options)?;
        let scene = self.micro.into_iter().fold(scene, |scene, micro| scene.with_micro(micro));
        let module = &self.program.0.module;
        rasters::check_names(module, self.rasters.iter().map(|(name, _)| name.as_str()))?;
        let data = |wanted: &str| self.rasters.iter().find(|(name, _)| name == wanted);
        let scene = rasters::bind(module, &compiled, &scene, |name| Some(Ok(data(name)?.1.clone())))?;
        Ok(Picture {
            runtime: self.runtime,
            program: self.program,
            compiled,
            scene,
            samples: self.samples,
            renderer: Renderer::default(),
        })
    }
}

/// A program with its scene, ready to render; kernels and buffers are kept between pictures.
pub struct Picture<'a> {
    runtime: &'a Runtime,
    program: Program,
    compiled: Compiled,
    scene: Scene,
    samples: u32,
    renderer: Renderer,
}

impl Picture<'_> {
    /// Evaluates the entry of [`Runtime::map`] for every sample of the field.
    pub fn map(&mut self) -> Result<Map, Error> {
        if self.compiled.kind != EntryKind::Map {
            return Err(Error::Request("a picture has no map; begin with `Runtime::map`".into()));
        }
        let terrain = self.scene.terrain().clone();
        Ok(Map::new(self.evaluate(terrain.width, terrain.height)?, &terrain))
    }

    /// Renders `width` x `height` pixels.
    pub fn render(&mut self, width: u32, height: u32) -> Result<Image, Error> {
        if self.compiled.kind == EntryKind::Map {
            return Err(Error::Request(
                "a map has the size of its field; make it with `Picture::map`".into(),
            ));
        }
        self.evaluate(width, height)
    }

    fn evaluate(&mut self, width: u32, height: u32) -> Result<Image, Error> {
        let options = SceneOptions { size: (width, height), ..*self.scene.options() };
        self.scene = self.scene.with_options(&options)?;
        let job = Job { checked: &self.program.0, compiled: &self.compiled, scene: Some(&self.scene) };
        let (machine, config) = (&self.runtime.machine, &self.runtime.config);
        let samples = if self.compiled.kind == EntryKind::Map { 1 } else { self.samples };
        Ok(self.renderer.render_samples(&job, machine, (width, height), config, samples)?.0)
    }

    /// Another value of a live parameter for the pictures to come.
    ///
    /// # Errors
    /// [`Error::Request`] if the parameter is not live, [`Error::Program`] if the value does not fit.
    pub fn set(&mut self, name: &str, value: impl Into<Setting>) -> Result<(), Error> {
        Ok(compile::set_live(&self.program.0, &mut self.compiled, name, &value.into().0)?)
    }

    /// Another camera, sun or exaggeration for the pictures to come.
    pub fn look(&mut self, view: View, sun: Sun) -> Result<(), Error> {
        let options = SceneOptions { view, sun, ..*self.scene.options() };
        self.scene = self.scene.with_options(&options)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests;
