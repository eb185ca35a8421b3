//! `ghyll bench table1`: the paper's Table 1 (section 6) done again. Four terrains of 512 x 512 samples, basic and detailed geometry,
//! static and dynamic lighting; what rewriting costs is measured by the same network without its work, frame by frame
//! in turn, and taken from the average.

mod measure;
mod paper;
mod report;

use super::errors::Distances;
use super::folder::Folder;
use super::network::Form;
use super::{machines, sites};
use crate::arguments::Bench;
use crate::failure::Failure;
use ghyll_runtime::config::Rewriter;
use ghyll_runtime::gpu::Gpu;
use serde_json::{Value, json};

/// How the network's rays are met and its stream is rewritten.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Way {
    name: &'static str,
    exact: bool,
    rewriter: Rewriter,
    depth: Option<u32>,
    /// Else on the built-in field alone.
    everywhere: bool,
    /// With both kinds of light, else with the static one alone.
    both_lights: bool,
}

const TRACE: Way = Way {
    name: "trace",
    exact: true,
    rewriter: Rewriter::Auto,
    depth: None,
    everywhere: true,
    both_lights: true,
};

const WAYS: &[Way] = &[
    TRACE,
    Way { name: "search(128, 8)", exact: false, both_lights: false, ..TRACE },
    Way {
        name: "trace, paper's rewriter",
        rewriter: Rewriter::Block,
        depth: Some(1),
        everywhere: false,
        ..TRACE
    },
];

const CONFIGURATIONS: [(bool, bool); 4] = [(false, false), (false, true), (true, false), (true, true)];

/// One measured row of the table.
#[derive(Clone, Debug)]
struct Cell {
    terrain: usize,
    terrain_name: String,
    way: Way,
    form: Form,
    backend: &'static str,
    /// Average, least and greatest milliseconds of a frame.
    ms: [f64; 3],
    /// Average of the network without its work.
    overhead: f64,
    /// Function tokens of a frame, where there is a stream.
    rewrites: Option<u64>,
    distances: Distances,
}

impl Cell {
    fn name(&self) -> String {
        name(&self.terrain_name, self.form, self.way, self.backend)
    }

    fn net(&self) -> f64 {
        self.ms[0] - self.overhead
    }

    fn paper_average(&self) -> f64 {
        paper::average(self.terrain, self.form.detail, self.form.dynamic)
    }

    fn json(&self) -> Value {
        json!({
            "name": self.name(),
            "terrain": self.terrain_name,
            "geometry": self.form.geometry(),
            "lighting": self.form.lighting(),
            "way": self.way.name,
            "backend": self.backend,
            "ms_average": self.ms[0],
            "ms_min": self.ms[1],
            "ms_max": self.ms[2],
            "overhead_ms": self.overhead,
            "net_ms": self.net(),
            "rewrites": self.rewrites,
            "disagreements_pixels": self.distances.disagreements,
            "distance_max_m": self.distances.metres.max,
            "error_footprints": self.distances.all,
            "paper_ms": self.paper_average(),
            "paper_net_ms": self.paper_average() - paper::OVERHEAD,
        })
    }
}

fn name(terrain: &str, form: Form, way: Way, backend: &str) -> String {
    format!("{terrain}, {}, {}, {}, {backend}", form.geometry(), form.lighting(), way.name)
}

/// What one choice costs against another, with the bound that is wanted.
#[derive(Clone, Debug)]
struct Ratio {
    what: &'static str,
    of: String,
    net: f64,
    average: f64,
    paper_net: f64,
    wanted: f64,
}

impl Ratio {
    fn new(what: &'static str, of: String, (dear, cheap): (&Cell, &Cell), wanted: f64) -> Ratio {
        let paper = |cell: &Cell| cell.paper_average() - paper::OVERHEAD;
        Ratio {
            what,
            of,
            net: dear.net() / cheap.net(),
            average: dear.ms[0] / cheap.ms[0],
            paper_net: paper(dear) / paper(cheap),
            wanted,
        }
    }

    fn reached(&self) -> bool {
        self.net <= self.wanted
    }

    fn json(&self) -> Value {
        json!({
            "name": format!("{}: {}", self.what, self.of),
            "net_ratio": self.net,
            "average_ratio": self.average,
            "paper_net_ratio": self.paper_net,
            "wanted_ratio": self.wanted,
            "reached": self.reached(),
        })
    }
}

/// Detail to basic and dynamic to static, of cells that differ in nothing else.
fn ratios(cells: &[Cell]) -> Vec<Ratio> {
    let mut found = Vec::new();
    for cell in cells {
        let Cell { terrain_name, way, form, backend, .. } = cell;
        let other = |wanted: Form| {
            let same = |c: &&Cell| c.terrain == cell.terrain && c.way == *way && c.backend == *backend;
            cells.iter().filter(same).find(|c| c.form == wanted)
        };
        if let Some(basic) = other(Form { detail: false, ..*form }).filter(|_| form.detail) {
            let of = format!("{terrain_name}, {}, {}", form.lighting(), way.name);
            found.push(Ratio::new("detail to basic", of, (cell, basic), 4.0));
        }
        if let Some(fixed) = other(Form { dynamic: false, ..*form }).filter(|_| form.dynamic) {
            let of = format!("{terrain_name}, {}, {}", form.geometry(), way.name);
            found.push(Ratio::new("dynamic to static", of, (cell, fixed), 2.0));
        }
    }
    found.sort_by_key(|ratio| ratio.what);
    found
}

pub fn rows(arguments: &Bench, gpu: Option<&Gpu>) -> Result<Vec<Value>, Failure> {
    let size = arguments.size.map_or((128, 128), |[width, height]| (width, height));
    let mut cells = Vec::new();
    for (machine, backend) in &machines(arguments.on, gpu)? {
        for (terrain, site) in sites::paper()?.iter().enumerate() {
            let scene = site.seen(&sites::VIEWS[0], size)?;
            let ways = WAYS.iter().filter(|way| way.everywhere || site.name == "Fuji");
            let wanted: Vec<(Way, Form)> = ways
                .flat_map(|way| CONFIGURATIONS.map(|(detail, dynamic)| (*way, detail, dynamic)))
                .map(|(way, detail, dynamic)| (way, Form { detail, dynamic, exact: way.exact, work: true }))
                .filter(|(way, form)| way.both_lights || !form.dynamic)
                .filter(|(way, form)| {
                    let name = name(&site.name, *form, *way, backend);
                    arguments.only.as_deref().is_none_or(|part| name.contains(part))
                })
                .collect();
            if wanted.is_empty() {
                continue;
            }
            eprintln!("ghyll: {} on {backend}", site.name);
            let seat = measure::Seat { terrain, terrain_name: &site.name, scene: &scene, machine, backend };
            cells.extend(measure::cells(&seat, &wanted, arguments.repeat)?);
        }
    }
    if cells.is_empty() {
        let message = "--only fits no row; they are named TERRAIN, GEOMETRY, LIGHTING, WAY, MACHINE, such as \
                       `Fuji, detail, dynamic, trace, gpu`";
        return Err(Failure::Usage(message.into()));
    }
    let ratios = ratios(&cells);
    if let Some(path) = &arguments.output {
        report::write(&Folder::create(path)?, &cells, &ratios, size)?;
    }
    Ok(cells.iter().map(Cell::json).chain(ratios.iter().map(Ratio::json)).collect())
}

#[cfg(test)]
mod tests {
    use super::super::errors::Spread;
    use super::*;

    fn cell(detail: bool, dynamic: bool, average: f64) -> Cell {
        Cell {
            terrain: 2,
            terrain_name: "Fuji".into(),
            way: WAYS[0],
            form: Form { detail, dynamic, exact: true, work: true },
            backend: "cpu",
            ms: [average; 3],
            overhead: 10.0,
            rewrites: None,
            distances: Distances {
                disagreements: 0,
                metres: Spread::default(),
                footprints: Spread::default(),
                all: 0.0,
            },
        }
    }

    #[test]
    fn ratios_are_of_net_times() {
        let cells = [cell(false, false, 20.0), cell(false, true, 25.0), cell(true, false, 60.0)];
        let found = ratios(&cells);
        let nets: Vec<_> = found.iter().map(|r| (r.what, r.net, r.reached())).collect();
        assert_eq!(nets, [("detail to basic", 5.0, false), ("dynamic to static", 1.5, true)]);
        // The paper's own, of its Table 1.
        assert!((found[0].paper_net - 71.6 / 34.6).abs() < 1e-9);
    }
}
