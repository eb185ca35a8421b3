//! `ghyll bench stability`: every known hazard of tracing with the bound that its figures must keep. The rays go through
//! the intrinsics that programs use, on every machine, and the oracle judges each answer.

mod device;
mod fields;
mod general;
mod judge;
mod pictures;
pub mod random;
mod rays;

use crate::arguments::{Bench, On};
use crate::failure::Failure;
use device::{BATCH, Tracer};
use fields::MOVED;
use fields::Site;
use ghyll_runtime::gpu::Gpu;
use ghyll_runtime::terrain::Terrain;
use judge::{Answer, SURFACES, Surface, Verdict, judge, truth};
use random::Random;
use rayon::prelude::*;
use rays::{Family, Ray};
use serde_json::{Value, json};

/// One hazard: rays of a family over a field.
struct Hazard {
    name: &'static str,
    field: fn() -> Result<Terrain, String>,
    rays: Family,
    /// Rays for each that `--rays` asks for.
    share: f64,
    /// Only where at least so many rays are asked for.
    from: u64,
}

const fn hazard(
    name: &'static str,
    field: fn() -> Result<Terrain, String>,
    rays: Family,
    share: f64,
) -> Hazard {
    Hazard { name, field, rays, share, from: 0 }
}

/// The table. Hazards of one field stand together, for it is made once.
const HAZARDS: &[Hazard] = &[
    hazard("random rays, Fuji", fields::fuji, rays::random, 1.0),
    hazard("through vertices, Fuji", fields::fuji, rays::through_vertices, 0.1),
    hazard("along edges, Fuji", fields::fuji, rays::along_edges, 0.1),
    hazard("along diagonals, Fuji", fields::fuji, rays::along_diagonals, 0.1),
    hazard("axis-parallel, Fuji", fields::fuji, rays::axis_parallel, 0.1),
    hazard("vertical, Fuji", fields::fuji, rays::vertical, 0.1),
    hazard("grazing 1e-6 rad, Fuji", fields::fuji, rays::grazing, 0.1),
    hazard("from the surface, Fuji", fields::fuji, rays::from_the_surface, 0.1),
    hazard("from below, Fuji", fields::fuji, rays::from_below, 0.1),
    hazard("zero and denormal components, Fuji", fields::fuji, rays::odd, 0.1),
    hazard("100 km away, Fuji", fields::fuji, rays::from_100_km, 0.1),
    hazard("1000 km away, Fuji", fields::fuji, rays::from_1000_km, 0.1),
    hazard("10000 km away, Fuji", fields::fuji, rays::from_10000_km, 0.1),
    hazard("random rays, white noise", fields::noise, rays::random, 1.0),
    hazard("through vertices, white noise", fields::noise, rays::through_vertices, 0.1),
    hazard("along edges, white noise", fields::noise, rays::along_edges, 0.1),
    hazard("along diagonals, white noise", fields::noise, rays::along_diagonals, 0.1),
    hazard("axis-parallel, white noise", fields::noise, rays::axis_parallel, 0.1),
    hazard("vertical, white noise", fields::noise, rays::vertical, 0.1),
    hazard("grazing 1e-6 rad, white noise", fields::noise, rays::grazing, 0.1),
    hazard("1000 km away, white noise", fields::noise, rays::from_1000_km, 0.1),
    hazard("grazing 1e-6 rad, plane", fields::plane, rays::grazing, 0.1),
    hazard("level, plane", fields::plane, rays::level, 0.1),
    hazard("grazing 1e-6 rad, tilted plane", fields::tilted, rays::grazing, 0.1),
    hazard("level, plateau", fields::plateau, rays::level, 0.1),
    hazard("random rays, plateau", fields::plateau, rays::random, 0.1),
    hazard("random rays, spikes of 10^5 m", fields::spikes, rays::random, 0.1),
    hazard("through vertices, spikes of 10^5 m", fields::spikes, rays::through_vertices, 0.1),
    hazard("random rays, mm on 8848 m", fields::millimetres, rays::random, 0.1),
    hazard("level, mm on 8848 m", fields::millimetres, rays::level, 0.1),
    hazard("1000 km away, mm on 8848 m", fields::millimetres, rays::from_1000_km, 0.1),
    hazard("random rays, NaN and infinities", fields::voids, rays::random, 0.1),
    hazard("through vertices, NaN and infinities", fields::voids, rays::through_vertices, 0.1),
    hazard("random rays, 2 x 2", fields::smallest, rays::random, 0.1),
    hazard("through vertices, 2 x 2", fields::smallest, rays::through_vertices, 0.1),
    hazard("random rays, 2 x 40", fields::strip, rays::random, 0.1),
    hazard("random rays, 40 x 2", fields::row, rays::random, 0.1),
    hazard("random rays, 16384 x 128", fields::wide, rays::random, 0.02),
    hazard("along diagonals, 16384 x 128", fields::wide, rays::along_diagonals, 0.02),
    hazard("1000 km away, 16384 x 128", fields::wide, rays::from_1000_km, 0.02),
    hazard("random rays, 65536 x 8", fields::widest, rays::random, 0.005),
    hazard("random rays, cells 1 m x 1000 m", fields::unequal, rays::random, 0.1),
    hazard("random rays, cells of 1 mm", fields::fine, rays::random, 0.1),
    hazard("random rays, cells of 100 km", fields::coarse, rays::random, 0.1),
    Hazard { from: 1_000_000, ..hazard("random rays, 16384 x 16384", fields::large, rays::random, 0.001) },
    Hazard {
        from: 1_000_000,
        ..hazard("along diagonals, 16384 x 16384", fields::large, rays::along_diagonals, 0.001)
    },
    Hazard {
        from: 1_000_000,
        ..hazard("1000 km away, 16384 x 16384", fields::large, rays::from_1000_km, 0.001)
    },
];

/// Cells of distance along the surface: 99.9th percentile, greatest.
const BOUNDS: [f64; 2] = [1e-5, 1e-3];

/// What is counted of a hazard on one machine.
#[derive(Default)]
struct Tally {
    missed: u64,
    phantom: u64,
    faults: u64,
    errors: Vec<f32>,
    /// A ray with the worst verdict, and that of the greatest error, for the bug report.
    witness: Option<(Ray, Answer, Option<f64>)>,
    farthest: Option<(f64, Ray)>,
}

impl Tally {
    fn add(&mut self, ray: &Ray, answer: Answer, verdict: Verdict) {
        let truth = match verdict {
            Verdict::Right => return,
            Verdict::Hit(error) => {
                if self.farthest.is_none_or(|(most, _)| error > most) {
                    self.farthest = Some((error, *ray));
                }
                return self.errors.push(error as f32);
            }
            Verdict::Missed(truth) => {
                self.missed += 1;
                truth
            }
            Verdict::Phantom(truth) => {
                self.phantom += 1;
                truth
            }
            Verdict::Fault => {
                self.faults += 1;
                None
            }
        };
        self.witness.get_or_insert((*ray, answer, truth));
    }

    /// The bounds are those of the 99.9th percentile and of the greatest distance.
    fn rows(
        mut self,
        (name, moved): (&str, f64),
        backend: &str,
        adapter: &str,
        bounds: [f64; 2],
    ) -> Vec<Value> {
        let phantom = format!("phantom hits beyond {moved:.0e} cell");
        self.errors.sort_by(f32::total_cmp);
        let last = self.errors.len().saturating_sub(1);
        let error = |share: f64| self.errors.get((last as f64 * share) as usize).copied().unwrap_or(0.0);
        let figures = [
            ("missed hits", self.missed as f64, 0.0, "rays"),
            (phantom.as_str(), self.phantom as f64, 0.0, "rays"),
            ("NaN, or `occluded` disagrees", self.faults as f64, 0.0, "rays"),
            ("distance, 99.9th percentile", f64::from(error(0.999)), bounds[0], "cells"),
            ("distance, greatest", f64::from(error(1.0)), bounds[1], "cells"),
        ];
        if let Some((ray, answer, truth)) = self.witness {
            let truth = truth.map_or("none".to_string(), |t| t.to_string());
            eprintln!(
                "ghyll: broken: {name} on {backend}, such as the ray {ray:?}: {answer}; truth: {truth}"
            );
        }
        if let Some((most, ray)) = self.farthest
            && (error(0.999) > bounds[0] as f32 || most > bounds[1])
        {
            eprintln!("ghyll: broken: {name} on {backend}, off by {most:.1e} cells the ray {ray:?}");
        }
        figures
            .into_iter()
            .map(|(figure, value, bound, unit)| {
                row(&format!("{name}: {figure}"), backend, adapter, value, bound, unit)
            })
            .collect()
    }
}

/// A figure holds if it is a number and not above its bound.
fn row(name: &str, backend: &str, adapter: &str, figure: f64, bound: f64, unit: &str) -> Value {
    json!({
        "name": name,
        "backend": backend,
        "adapter": adapter,
        "figure": figure,
        "bound": bound,
        "unit": unit,
        "holds": figure <= bound,
    })
}

/// The machines that take part.
pub(super) struct Machines<'a> {
    cpu: bool,
    gpu: Option<&'a Gpu>,
}

impl Machines<'_> {
    fn of<'a>(on: On, gpu: Option<&'a Gpu>) -> Result<Machines<'a>, Failure> {
        match (on, gpu) {
            (On::Oracle, _) => {
                Err(Failure::Usage("the oracle is the judge; use --on cpu, gpu or auto".into()))
            }
            (On::Gpu, None) => Err(Failure::Usage("there is no GPU adapter; use --on cpu".into())),
            (On::Cpu, _) => Ok(Machines { cpu: true, gpu: None }),
            (On::Gpu, gpu) => Ok(Machines { cpu: false, gpu }),
            (On::Auto, gpu) => Ok(Machines { cpu: true, gpu }),
        }
    }
}

pub fn rows(arguments: &Bench, gpu: Option<&Gpu>) -> Result<Vec<Value>, Failure> {
    let machines = Machines::of(arguments.on, gpu)?;
    let mut rows = pictures::refusals();
    let wanted = |h: &Hazard| {
        arguments.rays >= h.from && arguments.only.as_deref().is_none_or(|part| h.name.contains(part))
    };
    let list: Vec<&Hazard> = HAZARDS.iter().filter(|h| wanted(h)).collect();
    for group in list.chunk_by(|a, b| std::ptr::fn_addr_eq(a.field, b.field)) {
        let mut site = (group[0].field)().and_then(Site::new).map_err(Failure::Run)?;
        for surface in SURFACES {
            site.moved = surface.moved(&site);
            rows.extend(traced(&site, *surface, group, &machines, arguments.rays)?);
        }
        rows.extend(pictures::mirrors(&site, group[0].name, &machines)?);
    }
    let named = |name: &str| arguments.only.as_deref().is_none_or(|part| name.contains(part));
    rows.extend(general::rows(arguments.rays, named, &machines)?);
    if arguments.only.as_deref().is_none_or(|part| "false shadows".contains(part)) {
        rows.extend(pictures::shadows(arguments.rays, &machines)?);
    }
    Ok(rows)
}

/// All rays of some hazards of one field on one surface.
fn traced(
    site: &Site,
    surface: Surface,
    hazards: &[&Hazard],
    machines: &Machines,
    rays: u64,
) -> Result<Vec<Value>, Failure> {
    let mut rows = Vec::new();
    // No distance is known better than heights are; under a cosine of a half an error of height counts twice.
    let bounds = if site.moved > MOVED { BOUNDS.map(|bound| bound.max(site.moved)) } else { BOUNDS };
    let bounds = [bounds[0].max(2.0 * surface.rounded(site)), bounds[1]];
    let tracer = match machines.gpu.map(|gpu| Tracer::new(gpu, &site.scene, surface)) {
        None => None,
        Some(Ok(tracer)) => Some(tracer),
        Some(Err(error)) => {
            eprintln!("ghyll: not on this adapter: {}: {error}", hazards[0].name);
            None
        }
    };
    for (seed, hazard) in hazards.iter().enumerate() {
        let count = ((rays as f64 * hazard.share) as u64).max(64);
        let mut random = Random(seed as u64);
        let (mut cpu, mut gpu) = (Tally::default(), Tally::default());
        for first in (0..count).step_by(BATCH) {
            let batch = (count - first).min(BATCH as u64);
            let rays: Vec<Ray> = (0..batch).map(|_| (hazard.rays)(site, &mut random)).collect();
            let truths: Vec<Option<f64>> =
                rays.par_iter().map(|ray| truth(site, surface, &ray.map(f64::from))).collect();
            let mut judged = Judged::default();
            if machines.cpu {
                let answers = rays.par_iter().map(|ray| twin(site, surface, ray)).collect();
                judged = judged.judge((site, surface), &rays, &truths, answers);
                judged.count(&rays, &mut cpu);
            }
            if let Some(tracer) = &tracer {
                let answers = tracer.trace(&rays).map_err(Failure::Run)?;
                judged = judged.judge((site, surface), &rays, &truths, answers);
                judged.count(&rays, &mut gpu);
            }
        }
        let name = format!("{}, {}", hazard.name, surface.name);
        if machines.cpu {
            rows.extend(cpu.rows((&name, site.moved), "cpu", "twin", bounds));
        }
        if let (Some(_), Some(adapter)) = (&tracer, machines.gpu) {
            rows.extend(gpu.rows((&name, site.moved), "gpu", &adapter.info().name, bounds));
        }
    }
    Ok(rows)
}

/// Answers of a batch with their verdicts.
#[derive(Default)]
struct Judged(Vec<(Answer, Verdict)>);

impl Judged {
    /// Verdicts on another machine's answers; an answer that is the same keeps the one it has.
    fn judge(
        self,
        (site, surface): (&Site, Surface),
        rays: &[Ray],
        truths: &[Option<f64>],
        answers: Vec<Answer>,
    ) -> Judged {
        let verdict = |(i, answer): (usize, Answer)| match self.0.get(i) {
            Some((same, verdict)) if *same == answer => (answer, *verdict),
            _ => (answer, judge(site, surface, &rays[i], truths[i], answer)),
        };
        Judged(answers.into_par_iter().enumerate().map(verdict).collect())
    }

    fn count(&self, rays: &[Ray], tally: &mut Tally) {
        rays.iter().zip(&self.0).for_each(|(ray, (answer, verdict))| tally.add(ray, *answer, *verdict));
    }
}

/// The twin's answer.
fn twin(site: &Site, surface: Surface, ray: &Ray) -> Answer {
    let words: Vec<u32> = ray.iter().copied().chain(surface.parts).map(f32::to_bits).collect();
    let (mut found, mut dark) = ([0; 2], [0]);
    site.scene.eval_f32(surface.trace, &words, &mut found);
    site.scene.eval_f32(surface.occluded, &words, &mut dark);
    Answer { hit: found[0], distance: found[1], occluded: dark[0] }
}

/// Rows whose figure does not hold.
pub fn broken(rows: &[Value]) -> usize {
    rows.iter().filter(|row| row["holds"] == false).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_beyond_its_bound_is_broken() {
        let row = |figure| row("n", "cpu", "twin", figure, 1e-3, "cells");
        assert_eq!(broken(&[row(0.0), row(1e-3)]), 0);
        assert_eq!(broken(&[row(0.0), row(2e-3), row(f64::NAN)]), 2);
    }

    /// The whole table with few rays, on the twin.
    #[test]
    fn every_hazard_is_a_row() {
        let machines = Machines { cpu: true, gpu: None };
        for hazard in HAZARDS.iter().filter(|h| h.from == 0 && h.share >= 0.1) {
            let mut site = Site::new((hazard.field)().unwrap()).unwrap();
            for surface in SURFACES {
                site.moved = surface.moved(&site);
                let rows = traced(&site, *surface, &[hazard], &machines, 300).unwrap();
                assert_eq!(rows.len(), 5, "{}", hazard.name);
                assert_eq!(broken(&rows), 0, "{}: {rows:?}", hazard.name);
            }
        }
    }
}
