//! Rays through surfaces that have no walk of their own. A program traces rays that two rasters hold; the oracle evaluates the same
//! program for the same rays, and for those beside them where it must tell a rounding at a silhouette from a fault.

use super::super::program_with;
use super::super::reference::PATIENCE;
use super::fields::Site;
use super::judge::{Answer, compare, look, moves, slack};
use super::random::Random;
use super::rays::{self, Family, Ray};
use super::{Machines, Tally, fields};
use crate::failure::Failure;
use ghyll_compiler::compile::{Compiled, EntryKind, Options};
use ghyll_compiler::core::Intrinsic;
use ghyll_compiler::front::Checked;
use ghyll_runtime::config::Config;
use ghyll_runtime::machine::{Job, Machine};
use ghyll_runtime::oracle::{OracleOptions, components};
use ghyll_runtime::rasters;
use ghyll_runtime::terrain::{Raster, Scene, Terrain};
use ghyll_runtime::world::World;
use serde_json::Value;
use std::sync::Arc;

const PROGRAM: &str = include_str!("../../../../../../../benches/stability/general.ghyll");

/// Without noise and microstructure: the oracle takes a second for a ray through these.
const SURFACES: &[&str] = &["nearest", "mixed", "wavy"];

type Place = (&'static str, fn() -> Result<Terrain, String>, &'static [(&'static str, Family)]);

const PLACES: &[Place] = &[
    (
        "Fuji",
        fields::fuji,
        &[
            ("random rays", rays::random),
            ("through vertices", rays::through_vertices),
            ("axis-parallel", rays::axis_parallel),
            ("vertical", rays::vertical),
            ("grazing 1e-6 rad", rays::grazing),
        ],
    ),
    (
        "white noise",
        fields::noise,
        &[("random rays", rays::random), ("along edges", rays::along_edges), ("vertical", rays::vertical)],
    ),
    ("plateau", fields::plateau, &[("level", rays::level)]),
    ("NaN and infinities", fields::voids, &[("random rays", rays::random)]),
    ("40 x 2", fields::row, &[("random rays", rays::random)]),
];

/// Pixels of a row, a power of two and one more.
const WIDTH: u32 = 65;
/// Rays for each that `--rays` asks for, at the most so many: the oracle takes a while for each.
const SHARE: f64 = 0.002;
const MOST: u64 = 16_640;

/// What single precision can tell of a surface that is a function of a position in metres. With e = 2^-24 a place on the way is the
/// origin's, the way to the field and the way in it, two roundings each, and the inverse spacing makes one more: 5 e of the
/// field's sides along either axis, which shift the surface as they would the ray.
fn grain(site: &Site) -> f64 {
    let e = f64::from(f32::EPSILON) / 2.0;
    5.0 * e * (site.extent[0] + site.extent[1]) / site.cell()
}

pub fn rows(rays: u64, wanted: impl Fn(&str) -> bool, machines: &Machines) -> Result<Vec<Value>, Failure> {
    let mut rows = Vec::new();
    for (field, make, families) in PLACES {
        let mut site: Option<Site> = None;
        for surface in SURFACES {
            for (seed, (family, make_ray)) in families.iter().enumerate() {
                let name = format!("{family}, {field}, {surface}");
                if !wanted(&name) {
                    continue;
                }
                let site = match &mut site {
                    Some(site) => site,
                    none => none.insert(make().and_then(Site::new).map_err(Failure::Run)?),
                };
                site.moved = site.moved.max(grain(site));
                let mut random = Random(seed as u64);
                let height = ((rays as f64 * SHARE) as u64).clamp(64, MOST) / u64::from(WIDTH);
                let height = (height.max(2) as u32).next_power_of_two() + 1;
                let list: Vec<Ray> = (0..WIDTH * height).map(|_| make_ray(site, &mut random)).collect();
                rows.extend(judged(&name, site, surface, &list, machines)?);
            }
        }
    }
    Ok(rows)
}

struct Programs {
    trace: (Checked, Compiled),
    slopes: (Checked, Compiled),
    /// Of the machines' pictures.
    height: u32,
}

fn program(surface: &str, entry: &str, height: u32) -> Result<(Checked, Compiled), Failure> {
    let last = format!("vec2({}.0, {}.0)", WIDTH - 1, height - 1);
    let set = vec![("surface".to_string(), surface.to_string()), ("last".to_string(), last)];
    let entry = Some(entry.to_string());
    let options = Options { entry, want: Some(EntryKind::Image), set, ..Options::default() };
    program_with("stability/general", PROGRAM, &options)
}

fn judged(
    name: &str,
    site: &Site,
    surface: &str,
    rays: &[Ray],
    machines: &Machines,
) -> Result<Vec<Value>, Failure> {
    let height = rays.len() as u32 / WIDTH;
    let programs = Programs {
        trace: program(surface, "pixel", height)?,
        slopes: program(surface, "slopes", height)?,
        height,
    };
    let wide: Vec<[f64; 8]> = rays.iter().map(|ray| ray.map(f64::from)).collect();
    let truth = traced(site, &programs, &wide)?;
    // A rim's rounding may put a hit outside, where surfaces are flat.
    let hit = |(ray, t): (&[f64; 8], &Option<f64>)| {
        let t = t.unwrap_or(0.0);
        let [x, y] = [0, 1].map(|k| (ray[k] + t * ray[k + 3]).clamp(0.0, site.extent[k]));
        [x, y, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0]
    };
    let at: Vec<[f64; 8]> = wide.iter().zip(&truth).map(hit).collect();
    let slopes: Vec<[f64; 2]> =
        seen(site, &programs.slopes, &at, height)?.chunks_exact(2).map(|s| [s[0], s[1]]).collect();
    let mut rows = Vec::new();
    let mut add = |machine: &Machine, backend: &str, adapter: &str| -> Result<(), Failure> {
        let answers = answers(site, &programs.trace, rays, machine)?;
        let tally = tally(site, &programs, (rays, &truth, &slopes), answers)?;
        rows.extend(tally.rows((name, site.moved), backend, adapter, [site.moved, 1e-3]));
        Ok(())
    };
    if machines.cpu {
        add(&Machine::Cpu, "cpu", "twin")?;
    }
    if let Some(gpu) = machines.gpu {
        add(&Machine::Gpu(Box::new(gpu.clone())), "gpu", &gpu.info().name)?;
    }
    Ok(rows)
}

fn tally(
    site: &Site,
    programs: &Programs,
    (rays, truth, slopes): (&[Ray], &[Option<f64>], &[[f64; 2]]),
    answers: Vec<Answer>,
) -> Result<Tally, Failure> {
    let mut tally = Tally::default();
    let mut doubts = Vec::new();
    for (i, answer) in answers.into_iter().enumerate() {
        match look(site, &rays[i], answer, truth[i], |_| slopes[i]) {
            Some(verdict) => tally.add(&rays[i], answer, verdict),
            None => doubts.push((i, answer, moves(site, &rays[i], answer))),
        }
    }
    let beside: Vec<[f64; 8]> = doubts.iter().flat_map(|(.., moved)| moved.iter().copied()).collect();
    let found = if beside.is_empty() { Vec::new() } else { traced(site, programs, &beside)? };
    let mut found = found.as_slice();
    for (i, answer, moved) in doubts {
        let (others, rest) = found.split_at(moved.len());
        found = rest;
        let slack = slack(site, &rays[i], answer, |_| slopes[i]);
        tally.add(&rays[i], answer, compare(others, answer, truth[i], slack));
    }
    Ok(tally)
}

/// What the machine says of the rays.
fn answers(
    site: &Site,
    (checked, compiled): &(Checked, Compiled),
    rays: &[Ray],
    machine: &Machine,
) -> Result<Vec<Answer>, Failure> {
    let height = rays.len() as u32 / WIDTH;
    let fault = |error: &dyn std::fmt::Display| Failure::Run(error.to_string());
    let raster = |first: usize| {
        let data = rays.iter().flat_map(|ray| ray[first..first + 3].iter().copied()).collect();
        Raster::from_floats(WIDTH, height, 3, data).map(Arc::new)
    };
    let bound = rasters::bind(&checked.module, compiled, &site.scene, |name| {
        Some(raster(if name == "from" { 0 } else { 3 }))
    });
    let scene = bound.map_err(|e| fault(&e))?;
    let job = Job { checked, compiled, scene: Some(&scene) };
    let config = Config { timeout: PATIENCE, ..Config::default() };
    let (image, _) = job.render(machine, (WIDTH, height), &config).map_err(Failure::run)?;
    let flag = |x: f32| u32::from(x != 0.0);
    let answer = |p: &[f32]| Answer { distance: p[0].to_bits(), hit: flag(p[1]), occluded: flag(p[2]) };
    Ok(image.data.chunks_exact(3).map(answer).collect())
}

/// The oracle's distances.
fn traced(site: &Site, programs: &Programs, rays: &[[f64; 8]]) -> Result<Vec<Option<f64>>, Failure> {
    let all = seen(site, &programs.trace, rays, programs.height)?;
    Ok(all.chunks_exact(3).map(|p| (p[1] != 0.0).then_some(p[0])).collect())
}

/// The oracle's components of a picture whose rays these are; it may be higher than the program takes it to be.
fn seen(
    site: &Site,
    (checked, compiled): &(Checked, Compiled),
    rays: &[[f64; 8]],
    taken: u32,
) -> Result<Vec<f64>, Failure> {
    let height = (rays.len() as u32).div_ceil(WIDTH);
    let world = Given { scene: &site.scene, rays, height: taken };
    let set = compiled.settings.set.iter().map(|(id, setting)| (*id, setting.clone())).collect();
    let options = OracleOptions { timeout: PATIENCE, set, ..OracleOptions::default() };
    let place = |column: u32, row: u32| [f64::from(column), f64::from(row)];
    let module = &checked.module;
    let mut all = components(module, compiled.entry, (WIDTH, height), &place, &options, Some(&world))
        .map_err(Failure::run)?;
    let each = all.len() / (WIDTH * height) as usize;
    all.truncate(each * rays.len());
    Ok(all)
}

/// A scene whose rasters are rays in double precision.
struct Given<'a> {
    scene: &'a Scene,
    rays: &'a [[f64; 8]],
    height: u32,
}

impl World for Given<'_> {
    fn eval_f64(&self, intrinsic: Intrinsic, args: &[f64], out: &mut [f64]) {
        match intrinsic {
            Intrinsic::Raster3 => {
                let [east, north] = self.scene.terrain().extent();
                let column = (args[1] / east * f64::from(WIDTH - 1)).round();
                let row = ((1.0 - args[2] / north) * f64::from(self.height - 1)).round();
                let at = row as usize * WIDTH as usize + column as usize;
                let ray = self.rays.get(at).copied().unwrap_or([0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
                let first = 3 * args[0] as usize;
                out.copy_from_slice(&ray[first..first + 3]);
            }
            _ => self.scene.eval_f64(intrinsic, args, out),
        }
    }

    fn eval_f32(&self, intrinsic: Intrinsic, args: &[u32], out: &mut [u32]) {
        self.scene.eval_f32(intrinsic, args, out);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_surface_is_traced_and_a_planted_difference_is_seen() {
        let site = Site::new(fields::noise().unwrap()).unwrap();
        let mut random = Random(3);
        let list: Vec<Ray> = (0..WIDTH * 3).map(|_| rays::random(&site, &mut random)).collect();
        let machines = Machines { cpu: true, gpu: None };
        for surface in SURFACES {
            let rows = judged("n", &site, surface, &list, &machines).unwrap();
            assert_eq!(super::super::broken(&rows), 0, "{surface}: {rows:?}");
        }
        // Answers of another surface are no answers of this one.
        let programs = Programs {
            trace: program("subdivided", "pixel", 3).unwrap(),
            slopes: program("subdivided", "slopes", 3).unwrap(),
            height: 3,
        };
        let wide: Vec<_> = list.iter().map(|ray| ray.map(f64::from)).collect();
        let truth = traced(&site, &programs, &wide).unwrap();
        let slopes = vec![[0.0; 2]; list.len()];
        let other = answers(&site, &program("nearest", "pixel", 3).unwrap(), &list, &Machine::Cpu).unwrap();
        let found = tally(&site, &programs, (&list, &truth, &slopes), other).unwrap();
        assert!(found.missed > 10 && found.phantom > 10, "{} {}", found.missed, found.phantom);
    }

    /// A hit just behind the rim of a hole, where the surface rises.
    #[test]
    fn what_stands_behind_a_rim_is_met() {
        let site = Site::new(fields::voids().unwrap()).unwrap();
        let ray = [869.2427, 1095.3109, 101.18674, -0.24959843, -0.96488124, -0.08188289, 0.0, 1e9];
        let list = vec![ray; WIDTH as usize * 3];
        let found = answers(&site, &program("mixed", "pixel", 3).unwrap(), &list, &Machine::Cpu).unwrap();
        assert!(found.iter().all(|a| (f32::from_bits(a.distance) - 718.1253).abs() < 1e-3), "{}", found[0]);
    }
}
