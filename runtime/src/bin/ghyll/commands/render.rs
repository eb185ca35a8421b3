//! `ghyll render`: a picture of an image entry.

use super::{checked, compiled, machine, read, scene, writable};
use crate::arguments::Render;
use crate::failure::Failure;
use crate::report;
use ghyll_compiler::compile::EntryKind;
use ghyll_compiler::source::Source;
use ghyll_runtime::machine::Job;

/// What `ghyll render` shows without a file.
const EXAMPLE: &str = include_str!("../../../../../lang-examples/fuji.ghyll");

pub fn render(arguments: &Render) -> Result<(), Failure> {
    writable(&arguments.output)?;

    let source = match &arguments.file {
        Some(path) => read(path)?,
        None => Source::new("lang-examples/fuji.ghyll", EXAMPLE),
    };
    let checked = checked(source, arguments.program.json)?;
    let compiled = compiled(&checked, &arguments.program, Some(EntryKind::Image))?;
    let asked = scene::Asked { checked: &checked, compiled: &compiled, on: arguments.machine.on };
    let scene = scene::of_render(&asked, arguments)?;
    let (machine, mut config) = machine::open(&arguments.machine)?;
    eprintln!("rendering on {}: {}", machine.describe(), machine::reason(&arguments.machine, &machine));

    let [width, height] = arguments.size;
    let progress = report::Bar::start("rendering");
    config.progress = progress.listener();
    let outcome = Job::render_once(&checked, &compiled, scene, (&machine, &config), (width, height));
    progress.finish();
    let (picture, stats) = outcome.map_err(Failure::run)?;
    picture.save(&arguments.output).map_err(|e| Failure::Usage(e.to_string()))?;
    eprintln!("wrote {} ({width}x{height}, {:.2} s)", arguments.output.display(), stats.total.as_secs_f64());
    report::stats(&arguments.machine, &machine, &stats);
    Ok(())
}
