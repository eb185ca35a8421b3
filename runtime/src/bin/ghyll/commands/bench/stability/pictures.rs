//! Hazards of whole programs: false shadows, pictures that must be finite, fields that must be refused.

use super::super::reference::PATIENCE;
use super::super::{program, program_with};
use super::fields::{self, Site};
use super::{Machines, row};
use crate::failure::Failure;
use ghyll_compiler::compile::{Compiled, EntryKind, Options};
use ghyll_compiler::front::Checked;
use ghyll_runtime::config::Config;
use ghyll_runtime::machine::{Job, Machine};
use ghyll_runtime::terrain::Terrain;
use serde_json::Value;

const SHADOW: &str = include_str!("../../../../../../../benches/stability/shadow.ghyll");
const MIRROR: &str = include_str!("../../../../../../../benches/stability/mirror.ghyll");

/// Fields that shade nothing at all, or nothing of their greatest height; with the surfaces of which that is true.
type Shadeless = (&'static str, fn() -> Result<Terrain, String>, bool, &'static [&'static str]);

const SHADELESS: &[Shadeless] = &[
    ("plane", fields::plane, true, LEVEL),
    ("level at 8848 m", fields::high, true, LEVEL),
    // A bicubic surface swells around the pits and shades what is behind.
    ("plateau at 8848 m with pits", fields::plateau, true, &["bilinear", "triangulated"]),
    ("slope of 23 degrees", fields::tilted, false, SURFACES),
    ("slope of 55 degrees", fields::steep, false, SURFACES),
];

const SURFACES: &[&str] = &["bilinear", "triangulated", "bicubic", "subdivided", "mixed"];
const LEVEL: &[&str] = &["bilinear", "triangulated", "bicubic", "subdivided", "mixed", "nearest"];
/// What is not planar along the rim of a slope.
const SPLINES: &[&str] = &["bicubic", "subdivided", "mixed"];

/// Falsely shadowed points among as many as there are rays, a million at the most.
pub fn shadows(points: u64, machines: &Machines) -> Result<Vec<Value>, Failure> {
    let side = (points.min(1_000_000) as f64).sqrt() as u32;
    let mut rows = Vec::new();
    for (name, field, summits, surfaces) in SHADELESS {
        let site = field().and_then(Site::new).map_err(Failure::Run)?;
        for surface in *surfaces {
            let rim = if SPLINES.contains(surface) { "1" } else { "0" };
            let set = [("surface", *surface), ("summits", &summits.to_string()), ("rim", rim)];
            let (checked, compiled) = with("shadow", SHADOW, &set)?;
            let name = format!("false shadows, sun at 0.05 to 90 degrees, {name}, {surface}: points");
            rows.extend(counted(&name, &site, (&checked, &compiled), side, machines, |x| x != 0.0)?);
        }
    }
    Ok(rows)
}

/// Components of a picture of mirrors that are not finite.
pub fn mirrors(site: &Site, name: &str, machines: &Machines) -> Result<Vec<Value>, Failure> {
    let (checked, compiled) = program("mirror", MIRROR, EntryKind::Image)?;
    let field = name.rsplit(", ").next().unwrap_or(name);
    let name = format!("64 reflections, {field}: components that are not finite");
    counted(&name, site, (&checked, &compiled), 96, machines, |x| !x.is_finite())
}

/// A row for each machine: components of the program's picture that are as they must not be.
fn counted(
    name: &str,
    site: &Site,
    (checked, compiled): (&Checked, &Compiled),
    side: u32,
    machines: &Machines,
    wrong: fn(f32) -> bool,
) -> Result<Vec<Value>, Failure> {
    let job = Job { checked, compiled, scene: Some(&site.scene) };
    // A million points, and fields of a gigabyte, are more than a run may take unasked.
    let config = Config { timeout: PATIENCE, max_memory: 8 << 30, ..Config::default() };
    let mut rows = Vec::new();
    let mut add = |machine: &Machine, backend: &str, adapter: &str| -> Result<(), Failure> {
        let (image, _) = job.render(machine, (side, side), &config).map_err(Failure::run)?;
        let count = image.data.iter().filter(|x| wrong(**x)).count();
        rows.push(row(name, backend, adapter, count as f64, 0.0, "components"));
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

fn with(name: &str, text: &str, set: &[(&str, &str)]) -> Result<(Checked, Compiled), Failure> {
    let set = set.iter().map(|(name, value)| (name.to_string(), value.to_string())).collect();
    program_with(name, text, &Options { want: Some(EntryKind::Image), set, ..Options::default() })
}

/// Fields without a cell are refused with their reason.
pub fn refusals() -> Vec<Value> {
    let accepted = |(w, h): &(u32, u32)| {
        let refused = fields::refusal(*w, *h).is_some_and(|reason| reason.contains("2 x 2"));
        let name = format!("field of {w} x {h}: accepted, or refused without the reason");
        row(&name, "cpu", "twin", f64::from(u8::from(!refused)), 0.0, "fields")
    };
    fields::TOO_SMALL.iter().map(accepted).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_programs_compile_and_a_plane_has_no_shadow() {
        let machines = Machines { cpu: true, gpu: None };
        let rows = shadows(400, &machines).unwrap();
        assert_eq!(rows.len(), SHADELESS.iter().map(|(.., surfaces)| surfaces.len()).sum::<usize>());
        assert!(rows.iter().all(|row| row["holds"] == true), "{rows:?}");
        assert!(refusals().iter().all(|row| row["holds"] == true));
    }

    #[test]
    fn points_in_true_shadow_are_found() {
        let machines = Machines { cpu: true, gpu: None };
        let site = Site::new(fields::noise().unwrap()).unwrap();
        let (checked, compiled) = with("shadow", SHADOW, &[]).unwrap();
        let rows = counted("noise", &site, (&checked, &compiled), 20, &machines, |x| x != 0.0).unwrap();
        assert_eq!(rows[0]["holds"], false);
    }
}
