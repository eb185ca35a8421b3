//! Command-line arguments (LANGUAGE.md, section 10).

use crate::moving::Moving;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::ffi::OsString;
use std::path::PathBuf;
use std::time::Duration;

/// Ghyll: a small functional shader language whose programs run as token streams on the GPU.
///
/// Values go to standard output, everything else to standard error. Exit status: 0 success, 1 the program or an input file
/// is wrong, 2 wrong usage, 3 the run failed (did not terminate, out of memory, device lost).
#[derive(Parser)]
#[command(name = "ghyll", version, arg_required_else_help = true, max_term_width = 110)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Subcommand)]
pub enum Command {
    /// Evaluate a value entry (`fn main`) and print its value.
    #[command(after_help = "Example:\n  ghyll run lang-examples/fib.ghyll -- 25")]
    Run(Box<Run>),
    /// Render an image entry (`fn pixel`); without a file the built-in example on the built-in elevation data.
    #[command(
        after_help = "Examples:\n  ghyll render\n  ghyll render --view topdown --size 800x800 -o fuji.png\n  \
                            ghyll render my.ghyll --dem alps.tif --sun 315,30 -o alps.exr"
    )]
    Render(Box<Render>),
    /// Evaluate a map entry (`fn map`) for every sample of the elevation data and write it with its georeference.
    #[command(after_help = "Example:\n  ghyll map lang-examples/slope.ghyll --dem alps.tif -o slope.tif")]
    Map(Box<Map>),
    /// Look for mistakes only, or explain one.
    #[command(after_help = "Examples:\n  ghyll check my.ghyll --live detail\n  ghyll check --explain E0301")]
    Check(Check),
    /// Show what the compiler made.
    #[command(after_help = "Examples:\n  ghyll build lang-examples/fib.ghyll --emit table,stream -- 5\n  \
                            ghyll build lang-examples/fib.ghyll --emit svg -o fib.svg")]
    Build(Build),
    /// Tell what is fused, known and skipped of a program, what is left and what it costs.
    #[command(after_help = "Example:\n  ghyll explain lang-examples/fig9.ghyll --set detail=true")]
    Explain(Explain),
    /// Write programs in the usual layout.
    #[command(
        after_help = "Examples:\n  ghyll fmt my.ghyll\n  ghyll fmt --check *.ghyll\n  ghyll fmt - < my.ghyll"
    )]
    Fmt(Fmt),
    /// Evaluate expressions and items as they are typed.
    #[command(after_help = "Example:\n  echo 'sum(0..10, |i| i * i)' | ghyll repl")]
    Repl(Repl),
    /// Show the picture in a window, anew when the program's file changes.
    #[command(
        after_help = "The mouse turns the camera (left), moves it (right) and brings it nearer (wheel); H in the window lists the keys.\n\n\
                            Example:\n  ghyll view lang-examples/fig9.ghyll --dem alps.tif"
    )]
    View(Box<View>),
    /// Serve an editor: diagnostics, types, definitions, completion, formatting, names.
    #[command(after_help = "The editor starts it; docs/editors.md says how to tell it to.")]
    Lsp(Lsp),
    /// Print the stream s0, s1, .. round by round.
    #[command(after_help = "Example:\n  ghyll trace lang-examples/paper.ghyll")]
    Trace(Trace),
    /// Show adapters and limits, or what an elevation file holds.
    Info(Info),
    /// Run one of the project's benchmarks: overhead, calls, table1, scaling, stability, accuracy, numerics.
    Bench(Bench),
}

/// Which of the three machines evaluates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum On {
    /// The best GPU, else the CPU; says which.
    Auto,
    /// Any wgpu adapter, software ones included.
    Gpu,
    /// The CPU twin of the rewriter.
    Cpu,
    /// The direct evaluator in double precision.
    Oracle,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Rewriter {
    Auto,
    Block,
    Lane,
}

/// The program and what is fixed in it.
#[derive(Args)]
pub struct Program {
    /// Entry function instead of `main`, `pixel` or `map`.
    #[arg(long, value_name = "NAME")]
    pub entry: Option<String>,
    /// Value of a parameter, such as `detail=true`.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// Keep a parameter changeable without compiling again.
    #[arg(long = "live", value_name = "NAME")]
    pub live: Vec<String>,
    /// Call `@bake` functions instead of reading what they were evaluated to.
    #[arg(long)]
    pub no_bake: bool,
    /// Diagnostics as JSON on standard output.
    #[arg(long)]
    pub json: bool,
}

/// Where and how programs are evaluated.
#[derive(Args)]
pub struct Machine {
    /// Machine to evaluate on.
    #[arg(long, value_enum, default_value_t = On::Auto)]
    pub on: On,
    /// Pick the GPU adapter whose name contains this.
    #[arg(long, value_name = "SUBSTRING")]
    pub adapter: Option<String>,
    /// Report times, rounds, rewrites and memory on standard error.
    #[arg(long, value_name = "FORMAT", num_args = 0..=1, require_equals = true, default_missing_value = "text",
          value_parser = ["text", "json"])]
    pub stats: Option<String>,
    /// How streams are rewritten: blocks in rounds, lanes depth first, or the better of both.
    #[arg(long, value_enum, default_value_t = Rewriter::Auto)]
    pub rewriter: Rewriter,
    /// Rewrites a lane makes before it publishes its window; `--rewriter block --depth 1 --block 512` is the paper's
    /// algorithm.
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u32).range(1..))]
    pub depth: Option<u32>,
    /// Tokens in a block; 512 if absent.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(32..=4096))]
    pub block: Option<u32>,
    /// Invocations in a workgroup, as many as the adapter can hold at most; threads on the CPU.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
    /// Workgroups that rewrite at a time.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=32768))]
    pub groups: Option<u32>,
    /// Give up after this many rewrites.
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub max_rewrites: Option<u64>,
    /// Most memory for stream, image and terrain together, such as 512M or 2G; 1G if absent.
    #[arg(long, value_name = "SIZE", value_parser = size, allow_hyphen_values = true)]
    pub max_memory: Option<u64>,
    /// Give up after this many seconds.
    #[arg(long, value_name = "S", default_value = "60", value_parser = seconds, allow_hyphen_values = true)]
    pub timeout: Duration,
    /// Let the driver check bounds and loops again, which the compiler has taken care of already.
    #[arg(long)]
    pub checked: bool,
}

#[derive(Args)]
pub struct Run {
    /// Program.
    pub file: PathBuf,
    #[command(flatten)]
    pub program: Program,
    #[command(flatten)]
    pub machine: Machine,
    #[command(flatten)]
    pub terrain: Terrain,
    /// Arguments of the entry, as Ghyll expressions: `-- 25`, `-- 'vec2(1, 2)' true`.
    #[arg(last = true, value_name = "ARGS")]
    pub args: Vec<String>,
}

/// How an elevation file is read.
#[derive(Args)]
pub struct Reading {
    /// Distance of samples in metres, east-west and north-south.
    #[arg(long, value_name = "DX[,DY]", value_parser = spacing, allow_hyphen_values = true)]
    pub spacing: Option<[f64; 2]>,
    /// What black and white mean in metres, for an image without units.
    #[arg(long, value_name = "LO,HI", value_parser = pair, allow_hyphen_values = true)]
    pub heights: Option<[f64; 2]>,
    /// How a PNG holds heights.
    #[arg(long, value_name = "ENCODING", value_parser = ["grey", "terrarium", "terrain-rgb"])]
    pub encoding: Option<String>,
    /// What missing samples are: holes, or filled from their neighbours.
    #[arg(long, value_name = "KIND", value_parser = ["hole", "fill"], default_value = "hole")]
    pub voids: String,
    /// The stored number that stands for a missing sample, where the file does not say it itself.
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true)]
    pub nodata: Option<f64>,
}

/// Elevation data.
#[derive(Args)]
pub struct Terrain {
    /// Elevation data: GeoTIFF, .hgt, .asc, .bil, PNG, PGM, .npy, USGS .dem or raw .f32, .i16, .u16, also as .gz or .zip; the built-in Mt Fuji
    /// if absent.
    #[arg(long, value_name = "FILE")]
    pub dem: Option<PathBuf>,
    #[command(flatten)]
    pub reading: Reading,
    /// Data of a raster that the program reads: GeoTIFF, PNG, JPEG, EXR, .npy or any elevation format. It is placed by
    /// its georeference if both have one, else stretched over the field.
    #[arg(long = "raster", value_name = "NAME=FILE")]
    pub rasters: Vec<String>,
    /// Tile that `micro` reads: any raster of one channel, texels a metre apart; its lowest number counts as -1, its highest
    /// as 1.
    #[arg(long, value_name = "FILE")]
    pub micro: Option<PathBuf>,
    /// Factor on all heights.
    #[arg(long, value_name = "K", default_value_t = 1.0, allow_hyphen_values = true)]
    pub exaggerate: f64,
}

/// Where a picture is seen from, and its sun.
#[derive(Args)]
pub struct Camera {
    /// Size in pixels.
    #[arg(long, value_name = "WxH", value_parser = dimensions, allow_hyphen_values = true)]
    pub size: Option<[u32; 2]>,
    /// Named view that frames any field, or panorama: all around a point, by default over the summit; overview if absent.
    #[arg(long, value_name = "NAME",
          value_parser = ["overview", "topdown", "north", "south", "east", "west", "panorama"])]
    pub view: Option<String>,
    /// Camera position in world metres. A panorama may leave out Z and stands 3 m above the ground.
    #[arg(long, value_name = "X,Y,Z", value_parser = eye, allow_hyphen_values = true)]
    pub eye: Option<Moving>,
    /// Point in the middle of the picture.
    #[arg(long, value_name = "X,Y,Z", value_parser = target, requires = "eye", allow_hyphen_values = true)]
    pub look_at: Option<Moving>,
    /// Direction that is up in the picture.
    #[arg(long, value_name = "X,Y,Z", value_parser = triple, requires = "eye", allow_hyphen_values = true)]
    pub up: Option<[f64; 3]>,
    /// Vertical field of view in degrees.
    #[arg(long, value_name = "DEG", value_parser = fov, allow_hyphen_values = true)]
    pub fov: Option<Moving>,
    /// Parallel rays.
    #[arg(long)]
    pub ortho: bool,
    /// Direction of the sun in degrees: azimuth clockwise from north, elevation above the horizon.
    #[arg(long, value_name = "AZIMUTH,ELEVATION", value_parser = moving_sun, allow_hyphen_values = true)]
    pub sun: Option<Moving>,
    /// Sun of a time (UTC), such as 2026-06-21T15:00Z, over the elevation data or another place: 2026-06-21T15:00Z@46.5,8.0.
    #[arg(long, value_name = "TIME[@LAT,LON]", conflicts_with = "sun")]
    pub sun_at: Option<String>,
}

#[derive(Args)]
pub struct Render {
    /// Program; the built-in example if absent.
    #[arg(conflicts_with = "show")]
    pub file: Option<PathBuf>,
    #[command(flatten)]
    pub program: Program,
    #[command(flatten)]
    pub machine: Machine,
    #[command(flatten)]
    pub terrain: Terrain,
    /// Picture to write: .png, .jpg, .exr, .tif or .npy; float results go to .exr, .tif and .npy unscaled.
    #[arg(short, long, value_name = "FILE", default_value = "ghyll.png")]
    pub output: PathBuf,
    /// Evaluate `@bake` functions for every sample even where a large field has many more of them than the picture has pixels.
    #[arg(long, conflicts_with = "no_bake")]
    pub bake: bool,
    #[command(flatten)]
    pub camera: Camera,
    /// Lets heights fall off with the Earth's curvature; K is the part of it that refraction takes away.
    #[arg(long, value_name = "K", num_args = 0..=1, require_equals = true, default_missing_value = "0.13",
          value_parser = refraction)]
    pub curvature: Option<f64>,
    /// Samples of every pixel, whose mean it becomes; 1 if absent.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub samples: Option<u32>,
    /// Values for the parameters shadows, detail and lighting, samples and baking that favour one side; --set and --samples
    /// go before them.
    #[arg(long, value_name = "NAME", value_parser = ["time", "quality", "memory"])]
    pub preset: Option<String>,
    #[command(flatten)]
    pub tuning: Tuning,
    /// No program's picture, but what the beam pre-pass gives: where the rays of each tile may start.
    #[arg(long, value_name = "WHAT", value_parser = ["beams"], conflicts_with_all = ["preset", "frame_ms", "min_psnr", "tune", "entry"])]
    pub show: Option<String>,
    /// Frames A to B - 1 of a film; `t` is a frame's number in --set, --eye, --look-at, --fov, --sun and in a parameter `t`.
    #[arg(long, value_name = "A..B", value_parser = frames, allow_hyphen_values = true)]
    pub frames: Option<[i64; 2]>,
    /// Turns the camera once around over the frames.
    #[arg(long, requires = "frames")]
    pub turntable: bool,
    /// Frames a second of a film.
    #[arg(long, value_name = "N", default_value_t = 25.0, value_parser = rate, requires = "frames")]
    pub fps: f64,
}

/// Limits for which operators are chosen by measurement.
#[derive(Args)]
pub struct Tuning {
    /// Let the tuner choose detail, shadows, samples and baking: the best picture whose frames take at most so many
    /// milliseconds.
    #[arg(long, value_name = "N", value_parser = milliseconds, conflicts_with = "preset", allow_hyphen_values = true)]
    pub frame_ms: Option<f64>,
    /// Let the tuner choose: the fastest way whose picture is as near as this to the best one's; with --frame-ms the best
    /// within the time.
    #[arg(long, value_name = "DB", value_parser = decibels, conflicts_with = "preset", allow_hyphen_values = true)]
    pub min_psnr: Option<f64>,
    /// Let the tuner choose without these limits too: the best picture within --max-memory.
    #[arg(long, conflicts_with = "preset")]
    pub tune: bool,
    /// File that keeps what the tuner measured, `ghyll.tuning.json` if absent; what is found there is not measured again.
    #[arg(long, value_name = "FILE")]
    pub tuning: Option<PathBuf>,
}

#[derive(Args)]
pub struct Map {
    /// Program.
    pub file: PathBuf,
    #[command(flatten)]
    pub program: Program,
    #[command(flatten)]
    pub machine: Machine,
    #[command(flatten)]
    pub terrain: Terrain,
    /// File to write: .tif keeps the georeference; .npy, .exr, .png and .jpg do not.
    #[arg(short, long, value_name = "FILE", default_value = "map.tif")]
    pub output: PathBuf,
}

#[derive(Args)]
pub struct Check {
    /// Program.
    #[arg(required_unless_present = "explain", conflicts_with = "explain")]
    pub file: Option<PathBuf>,
    /// Explain a diagnostic by its code, with an example and how it is mended.
    #[arg(long, value_name = "CODE")]
    pub explain: Option<String>,
    #[command(flatten)]
    pub program: Program,
}

#[derive(Args)]
pub struct Build {
    /// Program.
    pub file: PathBuf,
    #[command(flatten)]
    pub program: Program,
    /// What to show, in this order.
    ///
    /// core, table, stream: the compiler's forms. wgsl, spirv, msl, hlsl, glsl: the kernel that runs the program. dot, svg:
    /// the network of its tasks.
    #[arg(long, value_name = "FORMS", value_delimiter = ',', default_value = "table",
          value_parser = crate::commands::build::NAMES)]
    pub emit: Vec<String>,
    /// Write one form to this file, several into this folder.
    #[arg(short, long, value_name = "PATH")]
    pub output: Option<PathBuf>,
    /// Arguments of the entry, for `stream`.
    #[arg(last = true, value_name = "ARGS")]
    pub args: Vec<String>,
}

#[derive(Args)]
pub struct Explain {
    /// Program.
    pub file: PathBuf,
    #[command(flatten)]
    pub program: Program,
    /// Elevation data over which the sizes are told; the built-in Mt Fuji if absent.
    #[arg(long, value_name = "FILE")]
    pub dem: Option<PathBuf>,
    #[command(flatten)]
    pub reading: Reading,
}

#[derive(Args)]
pub struct Fmt {
    /// Programs; `-` is standard input, written to standard output.
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Change nothing; exit status 1 if a file would change.
    #[arg(long)]
    pub check: bool,
    /// What was done, or diagnostics, as JSON on standard output.
    #[arg(long)]
    pub json: bool,
}

#[derive(Args)]
pub struct Repl {
    /// Program whose items are there from the start.
    pub file: Option<PathBuf>,
    /// Elevation data that terrain functions look at; the built-in Mt Fuji if absent.
    #[arg(long, value_name = "FILE")]
    pub dem: Option<PathBuf>,
    #[command(flatten)]
    pub reading: Reading,
}

#[derive(Args)]
pub struct View {
    /// Program; the built-in example if absent.
    pub file: Option<PathBuf>,
    #[command(flatten)]
    pub program: Program,
    #[command(flatten)]
    pub machine: Machine,
    #[command(flatten)]
    pub terrain: Terrain,
    #[command(flatten)]
    pub camera: Camera,
}

#[derive(Args)]
pub struct Lsp {
    /// Speak over standard input and output, as is done without it: some editors say so.
    #[arg(long)]
    pub stdio: bool,
}

#[derive(Args)]
pub struct Trace {
    /// Program.
    pub file: PathBuf,
    #[command(flatten)]
    pub program: Program,
    /// Print at most this many streams.
    #[arg(long, value_name = "N", default_value_t = 1000)]
    pub rounds: usize,
    /// Arguments of the entry, as Ghyll expressions.
    #[arg(last = true, value_name = "ARGS")]
    pub args: Vec<String>,
}

#[derive(Args)]
pub struct Info {
    /// Elevation file; without one the adapters are listed.
    pub dem: Option<PathBuf>,
    #[command(flatten)]
    pub reading: Reading,
    /// The report as JSON.
    #[arg(long)]
    pub json: bool,
}

#[derive(Args)]
pub struct Bench {
    /// overhead: a picture by a hand-written kernel and by Ghyll; calls: rewrites per second; table1, scaling: the paper's
    /// evaluation done again; stability: hazards of tracing with their bounds; accuracy: frame time against error; numerics: largest error of every
    /// built-in function. All if absent.
    #[arg(value_parser = ["overhead", "calls", "table1", "scaling", "stability", "accuracy", "numerics"])]
    pub name: Option<String>,
    /// One JSON object on standard output.
    #[arg(long)]
    pub json: bool,
    /// Measured repetitions; medians are reported.
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub repeat: u32,
    /// Pick the GPU adapter whose name contains this.
    #[arg(long, value_name = "SUBSTRING")]
    pub adapter: Option<String>,
    /// Machines that are measured, where a benchmark has a choice.
    #[arg(long, value_enum, default_value_t = On::Auto)]
    pub on: On,
    /// Random rays over each field of `stability`; of each other hazard there are a tenth.
    #[arg(long, value_name = "N", default_value_t = 20_000, value_parser = clap::value_parser!(u64).range(1..=1_000_000_000))]
    pub rays: u64,
    /// Only hazards of `stability`, or terrains, views and surfaces of `accuracy`, functions of `numerics`, rows of `table1`, or
    /// series of `scaling`, whose name contains this.
    #[arg(long, value_name = "SUBSTRING")]
    pub only: Option<String>,
    /// Size of the pictures in pixels: of `accuracy`, 160x120 if absent, `table1`, 128x128, and `scaling`, 96x96; of
    /// `numerics`: values of each function, 256x256.
    #[arg(long, value_name = "WxH", value_parser = dimensions, allow_hyphen_values = true)]
    pub size: Option<[u32; 2]>,
    /// One more terrain for `accuracy`.
    #[arg(long, value_name = "FILE")]
    pub dem: Option<PathBuf>,
    /// Folder for the report as JSON, and the Markdown and plots (SVG, PNG) of those that have some.
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
}

/// Whether a word is the value of the option before it.
type IsValue = fn(&str) -> bool;

/// Options whose value may be left out.
const OPTIONAL: [(&str, IsValue); 2] = [
    ("--stats", |next| next == "json" || next == "text"),
    ("--curvature", |next| next.parse::<f64>().is_ok()),
];

/// Makes `--stats json` and bare `--stats` both unmistakable for the parser, and `--curvature` alike.
pub fn prepared(raw: impl Iterator<Item = OsString>) -> Vec<OsString> {
    let mut prepared = Vec::new();
    let mut raw = raw.peekable();
    while let Some(argument) = raw.next() {
        if argument == "--" {
            prepared.push(argument);
            prepared.extend(raw);
            break;
        }
        let value = OPTIONAL
            .iter()
            .find(|(option, _)| argument == *option)
            .and_then(|(_, is_value)| raw.next_if(|next| next.to_str().is_some_and(is_value)));
        prepared.push(match value {
            Some(value) => {
                let mut joined = argument;
                joined.push("=");
                joined.push(value);
                joined
            }
            None => argument,
        });
    }
    prepared
}

/// The error with what to do where arguments of the entry stand among those of the command.
pub fn told(mut error: clap::Error) -> clap::Error {
    let shown = |kind| error.get(kind).map(ToString::to_string).unwrap_or_default();
    let stray = shown(ContextKind::InvalidArg);
    let entry = shown(ContextKind::Usage).contains("-- <ARGS>");
    if error.kind() == ErrorKind::UnknownArgument && entry && !stray.starts_with('-') {
        let tip = format!("write the arguments of the entry after `--`: `-- {stray}`");
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    }
    error
}

fn numbers<const N: usize>(text: &str, form: &str) -> Result<[f64; N], String> {
    let parts: Vec<f64> = text
        .split(',')
        .map(|part| part.trim().parse::<f64>().ok().filter(|x| x.is_finite()))
        .collect::<Option<_>>()
        .ok_or_else(|| format!("expected {form}; it must be finite"))?;
    parts.try_into().map_err(|_| format!("expected {form}"))
}

fn pair(text: &str) -> Result<[f64; 2], String> {
    numbers(text, "two numbers with a comma between")
}

fn sun(text: &str) -> Result<[f64; 2], String> {
    let [azimuth, elevation] = pair(text)?;
    if elevation.abs() <= 90.0 {
        Ok([azimuth, elevation])
    } else {
        Err("elevation must lie between -90 and 90".into())
    }
}

fn triple(text: &str) -> Result<[f64; 3], String> {
    numbers(text, "three numbers with commas between")
}

fn eye(text: &str) -> Result<Moving, String> {
    let point = |text: &str| pair(text).map(Vec::from).or_else(|_| triple(text).map(Vec::from));
    Moving::parse(text, &[2, 3], point)
}

fn target(text: &str) -> Result<Moving, String> {
    Moving::parse(text, &[3], |text| triple(text).map(Vec::from))
}

fn fov(text: &str) -> Result<Moving, String> {
    Moving::parse(text, &[1], |text| Ok(vec![angle(text)?]))
}

fn moving_sun(text: &str) -> Result<Moving, String> {
    Moving::parse(text, &[2], |text| sun(text).map(Vec::from))
}

fn milliseconds(text: &str) -> Result<f64, String> {
    let [ms] = numbers::<1>(text, "milliseconds")?;
    if ms > 0.0 { Ok(ms) } else { Err("must be positive".into()) }
}

fn decibels(text: &str) -> Result<f64, String> {
    let [decibels] = numbers::<1>(text, "decibels")?;
    if decibels > 0.0 { Ok(decibels) } else { Err("must be positive".into()) }
}

fn refraction(text: &str) -> Result<f64, String> {
    let [k] = numbers::<1>(text, "a number")?;
    if (0.0..1.0).contains(&k) { Ok(k) } else { Err("must be at least 0 and less than 1".into()) }
}

fn rate(text: &str) -> Result<f64, String> {
    let [rate] = numbers::<1>(text, "frames a second")?;
    if (0.1..=1000.0).contains(&rate) { Ok(rate) } else { Err("must lie between 0.1 and 1000".into()) }
}

/// The most frames of a film.
const MOST_FRAMES: i64 = 100_000;

fn frames(text: &str) -> Result<[i64; 2], String> {
    let form = "expected A..B, such as 0..100: frames A to B - 1";
    let (first, end) = text.split_once("..").ok_or(form)?;
    let number = |text: &str| text.trim().parse::<i64>().map_err(|_| form.to_string());
    let (first, end) = (number(first)?, number(end)?);
    match end.checked_sub(first) {
        Some(1..=MOST_FRAMES) if first.abs() <= 1 << 30 => Ok([first, end]),
        _ => Err(format!("there must be 1 to {MOST_FRAMES} frames; the last one, B, is not drawn")),
    }
}

fn spacing(text: &str) -> Result<[f64; 2], String> {
    let spacing = match numbers::<1>(text, "one or two numbers") {
        Ok([d]) => [d, d],
        Err(_) => numbers::<2>(text, "one or two numbers")?,
    };
    if spacing.iter().any(|d| *d <= 0.0) { Err("spacing must be positive".into()) } else { Ok(spacing) }
}

fn angle(text: &str) -> Result<f64, String> {
    let [degrees] = numbers::<1>(text, "an angle in degrees")?;
    let mend = "must be more than 0 and less than 180; in a panorama 180 at most";
    if degrees > 0.0 && degrees <= 180.0 { Ok(degrees) } else { Err(mend.into()) }
}

fn seconds(text: &str) -> Result<Duration, String> {
    let [seconds] = numbers::<1>(text, "seconds")?;
    Duration::try_from_secs_f64(seconds).map_err(|_| "expected seconds, 0 or more".into())
}

fn size(text: &str) -> Result<u64, String> {
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit = &text[digits.len()..];
    let factor = match unit.to_ascii_lowercase().as_str() {
        "" | "b" => 1,
        "k" | "kb" | "kib" => 1u64 << 10,
        "m" | "mb" | "mib" => 1 << 20,
        "g" | "gb" | "gib" => 1 << 30,
        _ => return Err(format!("unknown unit `{unit}`: use K, M or G")),
    };
    let number: f64 = digits.parse().map_err(|_| "expected a size such as 512M".to_string())?;
    if number > 0.0 { Ok((number * factor as f64) as u64) } else { Err("must be positive".into()) }
}

fn dimensions(text: &str) -> Result<[u32; 2], String> {
    let (width, height) = text.split_once(['x', 'X']).ok_or("expected WIDTHxHEIGHT, such as 1024x768")?;
    let side = |text: &str| match text.trim().parse::<u32>() {
        Ok(n @ 1..=16384) => Ok(n),
        _ => Err("each side must be a whole number from 1 to 16384".to_string()),
    };
    Ok([side(width)?, side(height)?])
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    fn prepare(words: &[&str]) -> Vec<String> {
        prepared(words.iter().map(OsString::from)).into_iter().map(|s| s.into_string().unwrap()).collect()
    }

    #[test]
    fn stats_takes_json_or_nothing() {
        assert_eq!(prepare(&["g", "--stats", "json", "f"]), ["g", "--stats=json", "f"]);
        assert_eq!(prepare(&["g", "--stats", "f"]), ["g", "--stats", "f"]);
        assert_eq!(prepare(&["g", "--", "--stats", "json"]), ["g", "--", "--stats", "json"]);
        assert_eq!(prepare(&["g", "--curvature", "0.13", "f"]), ["g", "--curvature=0.13", "f"]);
        assert_eq!(prepare(&["g", "--curvature", "f"]), ["g", "--curvature", "f"]);
    }

    /// Every command and every option is in the reference manual.
    #[test]
    fn the_manual_is_complete() {
        let manual = include_str!("../../../../docs/language.md");
        let mut missing = Vec::new();
        for command in Arguments::command().get_subcommands() {
            let name = command.get_name();
            if !manual.contains(&format!("`ghyll {name}")) {
                missing.push(format!("ghyll {name}"));
            }
            let long = command.get_arguments().filter_map(|argument| argument.get_long());
            let documented = |option: &&str| manual.contains(&format!("--{option}"));
            missing.extend(long.filter(|o| !documented(o)).map(|option| format!("{name} --{option}")));
        }
        assert!(missing.is_empty(), "not in docs/language.md: {}", missing.join(", "));
    }

    #[test]
    fn sizes_have_units() {
        assert_eq!(size("512M"), Ok(512 << 20));
        assert_eq!(size("2g"), Ok(2 << 30));
        assert!(size("2X").is_err());
        assert!(size("-1").is_err());
    }

    #[test]
    fn dimensions_are_bounded() {
        assert_eq!(dimensions("640x480"), Ok([640, 480]));
        assert!(dimensions("0x480").is_err());
        assert!(dimensions("640").is_err());
    }
}
