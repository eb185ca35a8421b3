//! `ghyll map`: a value for each sample of the field.

use super::{checked, compiled, machine, read, scene, writable};
use crate::arguments::Map;
use crate::failure::Failure;
use crate::report;
use ghyll_compiler::compile::EntryKind;
use ghyll_runtime::image;
use ghyll_runtime::machine::Job;

pub fn map(arguments: &Map) -> Result<(), Failure> {
    writable(&arguments.output, false)?;
    let checked = checked(read(&arguments.file)?, arguments.program.json)?;
    let compiled = compiled(&checked, &arguments.program, Some(EntryKind::Map))?;
    let asked = scene::Asked::new(&checked, &compiled, arguments.machine.on);
    let scene = scene::of_terrain(&asked, &arguments.terrain)?;
    if arguments.terrain.reading.spacing.is_some()
        && scene.as_ref().is_some_and(|scene| scene.terrain().crs.is_some())
    {
        eprintln!("--spacing changes distances on the ground; the map keeps the place that the data states");
    }
    let (machine, mut config) = machine::open(&arguments.machine)?;
    eprintln!("mapping on {}: {}", machine.describe(), machine::reason(&arguments.machine, &machine));
    let job = Job { checked: &checked, compiled: &compiled, scene: scene.as_ref() };
    let machine = machine::settled(machine, &job)?;

    let progress = report::Bar::start("mapping");
    config.progress = progress.listener();
    let outcome = job.map(&machine, &config);
    progress.finish();
    let (map, stats) = outcome.map_err(Failure::run)?;
    let clamped = map.clamped();
    if clamped > 0 && image::Format::of(&arguments.output).is_ok_and(|format| !format.holds_floats()) {
        eprintln!(
            "{} of the map's {} numbers lie outside 0 to 1 and become black or white in {}; write .tif, .npy or .exr to keep \
             them",
            clamped,
            map.image().data.len(),
            arguments.output.display()
        );
    }
    map.save(&arguments.output).map_err(|e| Failure::Usage(e.to_string()))?;
    let (width, height) = (map.image().width, map.image().height);
    eprintln!("wrote {} ({width}x{height}, {:.2} s)", arguments.output.display(), stats.total.as_secs_f64());
    if arguments.program.json {
        let seconds = stats.total.as_secs_f64();
        report::wrote(std::slice::from_ref(&arguments.output), (width, height), seconds, &machine, None);
    }
    report::stats(&arguments.machine, &machine, &stats);
    Ok(())
}
