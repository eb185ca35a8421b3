//! `ghyll bench accuracy`: frame time against error. Every terrain is seen from several views on several surfaces, traced exactly and
//! by the paper's search with many settings; the oracle traces the very rays that the machine computed, in double precision.

mod files;
mod measure;
mod pareto;
mod pictures;
mod plot;

use super::folder::Folder;
use super::{errors, machines, program_with, sites};
use crate::arguments::Bench;
use crate::failure::Failure;
use errors::{Apart, Distances};
use ghyll_compiler::compile::{Compiled, EntryKind, Options};
use ghyll_compiler::front::Checked;
use ghyll_runtime::gpu::Gpu;
use serde_json::{Value, json};

const PROGRAM: &str = include_str!("../../../../../../benches/accuracy/terrain.ghyll");

/// How a ray is met.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Method {
    Trace,
    /// Pieces and halvings (paper, section 3.1).
    Search(u32, u32),
}

impl std::fmt::Display for Method {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Method::Trace => write!(f, "trace"),
            Method::Search(pieces, halvings) => write!(f, "search({pieces}, {halvings})"),
        }
    }
}

/// Surfaces of the program, and the pieces of their searches. Without noise, for the oracle takes a second for a ray of it.
const SURFACES: &[(&str, &[u32])] = &[
    ("bilinear", &[16, 64, 256, 1024]),
    ("triangulated", &[256]),
    ("bicubic", &[16, 64, 256]),
    ("subdivided", &[256]),
];
const HALVINGS: &[u32] = &[0, 4, 12];

/// The terrain of the whole pictures, a third as wide and high as the others: the oracle's have many samples and long rays.
const PICTURED: &str = "Fuji";

fn methods(pieces: &[u32]) -> Vec<Method> {
    let searches = HALVINGS.iter().flat_map(|m| pieces.iter().map(|n| Method::Search(*n, *m)));
    std::iter::once(Method::Trace).chain(searches).collect()
}

/// What is seen, and where it is computed.
#[derive(Clone, Debug, PartialEq)]
struct Setting {
    terrain: String,
    view: &'static str,
    surface: String,
    backend: &'static str,
}

/// One configuration, measured.
#[derive(Clone, Debug)]
struct Row {
    setting: Setting,
    /// None where the whole picture is a program's own.
    method: Option<Method>,
    program: &'static str,
    lighting: &'static str,
    preset: Option<&'static str>,
    rewriter: &'static str,
    samples: u32,
    /// Median, least, greatest.
    ms: [f64; 3],
    distances: Option<Distances>,
    apart: Apart,
    /// No other method is as fast and as exact.
    front: bool,
}

impl Row {
    fn name(&self) -> String {
        let Setting { terrain, view, surface, backend } = &self.setting;
        let what = match (self.method, self.preset) {
            (Some(method), _) if self.samples == 1 && self.lighting == "facing" => method.to_string(),
            (_, Some(preset)) => format!("{}, preset {preset}", self.program),
            _ => format!("{}, {}, samples {}, {}", self.program, self.lighting, self.samples, self.rewriter),
        };
        format!("{terrain}, {view}, {surface}, {what}, {backend}")
    }

    fn json(&self) -> Value {
        let Setting { terrain, view, surface, backend } = &self.setting;
        let pieces = |pick: fn(u32, u32) -> u32| match self.method {
            Some(Method::Search(n, m)) => Some(pick(n, m)),
            _ => None,
        };
        let d = self.distances.as_ref();
        let number = |pick: fn(&Distances) -> f64| d.map(pick);
        json!({
            "name": self.name(),
            "terrain": terrain,
            "view": view,
            "surface": surface,
            "backend": backend,
            "program": self.program,
            "method": self.method.map(|method| if method == Method::Trace { "trace" } else { "search" }),
            "steps": pieces(|n, _| n),
            "refinements": pieces(|_, m| m),
            "samples": self.samples,
            "lighting": self.lighting,
            "preset": self.preset,
            "rewriter": self.rewriter,
            "ms_median": self.ms[0],
            "ms_least": self.ms[1],
            "ms_greatest": self.ms[2],
            "disagreements_pixels": d.map(|d| d.disagreements),
            "distance_max_m": number(|d| d.metres.max),
            "distance_p99_m": number(|d| d.metres.p99),
            "distance_rms_m": number(|d| d.metres.rms),
            "distance_max_footprints": number(|d| d.footprints.max),
            "distance_p99_footprints": number(|d| d.footprints.p99),
            "distance_rms_footprints": number(|d| d.footprints.rms),
            "error_footprints": number(|d| d.all),
            "psnr_db": self.apart.psnr.is_finite().then_some(self.apart.psnr),
            "ssim": self.apart.ssim,
            "flip": self.apart.flip,
            "front": d.map(|_| self.front),
        })
    }
}

pub fn rows(arguments: &Bench, gpu: Option<&Gpu>) -> Result<Vec<Value>, Failure> {
    let machines = machines(arguments.on, gpu)?;
    let size = arguments.size.map_or((160, 120), |[width, height]| (width, height));
    let wanted = |name: &str| arguments.only.as_deref().is_none_or(|part| name.contains(part));
    let mut rows = Vec::new();
    for site in sites::all(arguments.dem.as_deref())? {
        for view in sites::VIEWS {
            let seen = site.seen(view, size)?;
            for (surface, pieces) in SURFACES {
                for (machine, backend) in &machines {
                    let (terrain, surface) = (site.name.clone(), surface.to_string());
                    let setting = Setting { terrain, view: view.name, surface, backend };
                    let name = format!("{}, {}, {}", setting.terrain, setting.view, setting.surface);
                    if wanted(&name) {
                        eprintln!("ghyll: {name} on {backend}");
                        let methods = methods(pieces);
                        rows.extend(measure::curve(&seen, &setting, &methods, machine, arguments.repeat)?);
                    }
                }
            }
        }
        if site.name == PICTURED && wanted(&format!("{}, pictures", site.name)) {
            let seen = site.seen(&sites::VIEWS[0], (size.0 / 3, size.1 / 3))?;
            for (machine, backend) in &machines {
                eprintln!("ghyll: {}, pictures on {backend}", site.name);
                rows.extend(pictures::rows(&seen, &site.name, (machine, backend), arguments.repeat)?);
            }
        }
    }
    if rows.is_empty() {
        let message =
            "--only fits no configuration; they are named TERRAIN, VIEW, SURFACE and TERRAIN, pictures";
        return Err(Failure::Usage(message.into()));
    }
    pareto::mark(&mut rows);
    let verdicts = pareto::verdicts(&rows);
    if let Some(folder) = &arguments.output {
        files::write(&Folder::create(folder)?, &rows, &verdicts)?;
    }
    let all = rows.iter().map(Row::json);
    Ok(all.chain(verdicts.iter().map(pareto::Verdict::json)).collect())
}

/// The benchmark's program on a surface; searches take their numbers without compiling again.
fn traced(surface: &str, entry: &str, exact: bool, shadows: bool) -> Result<(Checked, Compiled), Failure> {
    let set = [("surface", surface), ("exact", &exact.to_string()), ("shadows", &shadows.to_string())];
    let set = set.iter().map(|(name, value)| (name.to_string(), value.to_string())).collect();
    let live = if exact { Vec::new() } else { vec!["steps".into(), "refinements".into()] };
    let entry = Some(entry.to_string());
    let options = Options { entry, want: Some(EntryKind::Image), set, live, ..Options::default() };
    program_with("accuracy/terrain", PROGRAM, &options)
}
