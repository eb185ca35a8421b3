//! `ghyll render`: a picture of an image entry, or a film of it.

use super::film::{self, Film};
use super::{baking, checked, compiled_as, machine, read, scene, tune, writable};
use crate::arguments::Render;
use crate::failure::Failure;
use crate::report;
use ghyll_compiler::source::Source;
use ghyll_runtime::image::{self, FilmFormat, ImageError};
use ghyll_runtime::machine::{Job, Machine};
use ghyll_runtime::presets::Preset;
use ghyll_runtime::renderer::Renderer;
use std::time::Instant;

/// What `--show beams` draws.
const BEAMS: &str = include_str!("beams.ghyll");

/// What `ghyll render` shows without a file.
const EXAMPLE: &str = include_str!("../../../../../lang-examples/fuji.ghyll");

pub fn render(arguments: &Render) -> Result<(), Failure> {
    let film_format = FilmFormat::of(&arguments.output).filter(|_| arguments.frames.is_some());
    match arguments.frames {
        Some([first, _]) if film_format.is_none() => {
            writable(&film::numbered(&arguments.output, first), false)?
        }
        _ => writable(&arguments.output, film_format.is_some())?,
    }
    if let Some(fastest) =
        film_format.and_then(FilmFormat::fastest).filter(|fastest| arguments.fps > *fastest)
    {
        return Err(Failure::Usage(format!(
            "--fps {}: {} shows at most {fastest} frames a second, for its format counts hundredths of a second and players \
             slow down what is shorter than two; give --fps {fastest} or less, or write an .apng",
            arguments.fps,
            arguments.output.display()
        )));
    }

    let source = match &arguments.file {
        _ if arguments.show.is_some() => Source::new("beams.ghyll", BEAMS),
        Some(path) => read(path)?,
        None => Source::new("lang-examples/fuji.ghyll", EXAMPLE),
    };
    let checked = checked(source, arguments.program.json)?;
    let (film, mut options) = Film::new(&checked, arguments)?;
    let floats = image::Format::of(&arguments.output).is_ok_and(|format| format.holds_floats());
    if arguments.show.is_some() && floats {
        options.set.push(("metres".into(), "true".into()));
    }
    let first = film.as_ref().map(|film| film.frames.start);
    let turn = |frame| film.as_ref().filter(|_| arguments.turntable).map(|film| film.turn(frame));
    let camera = &arguments.camera;
    let looks: Vec<_> = match &film {
        Some(film) => {
            film.frames.clone().map(|t| scene::look(camera, Some(t), turn(t))).collect::<Result<_, _>>()?
        }
        None => vec![scene::look(camera, None, None)?],
    };
    let mut opened = None;
    let mut tuned = None;
    if let Some(limits) = tune::limits(arguments)? {
        let (machine, config) = opened.insert(machine::open(&arguments.machine)?);
        let seat = (&*machine, &*config);
        let chosen = tune::tune(&checked, &options, arguments, looks[0], seat, limits)?;
        options = tuned.insert(chosen).measured.choice.apply(&options);
    }
    let mut compiled = compiled_as(&checked, &arguments.program, &options)?;
    let mut asked = scene::Asked::new(&checked, &compiled, arguments.machine.on);
    asked.field = tuned.as_mut().and_then(|tuned| tuned.field.take());
    let views = scene::Views::open(&asked, arguments, looks)?;
    let (machine, mut config) = match opened {
        Some(opened) => opened,
        None => machine::open(&arguments.machine)?,
    };
    eprintln!("rendering on {}: {}", machine.describe(), machine::reason(&arguments.machine, &machine));
    let size @ (width, height) = views.size();
    let count = film.as_ref().map_or(1, |film| film.frames.clone().count() as u32);
    let preset = arguments.preset.as_deref().and_then(Preset::named);
    let chosen = tuned.as_ref().map(|tuned| tuned.measured.choice.samples);
    let samples = arguments.samples.or(chosen).or(preset.map(|preset| preset.samples)).unwrap_or(1);
    let rays = u64::from(width) * u64::from(height) * u64::from(samples) * u64::from(count);
    let is_free = !arguments.bake && tuned.is_none() && !matches!(machine, Machine::Oracle(_));
    let field = views.field().filter(|_| is_free);
    if let Some(why) = baking::refusal(&compiled, field.map(|field| &**field), rays) {
        eprintln!("{why}");
        options.no_bake = true;
        compiled = compiled_as(&checked, &arguments.program, &options)?;
    }
    let job = Job { checked: &checked, compiled: &compiled, scene: views.first() };
    let machine = machine::settled(machine, &job)?;

    let progress = report::Bar::start("rendering");
    config.progress = progress.listener();
    let started = Instant::now();
    let wrong = |e: ImageError| Failure::Usage(e.to_string());
    let mut open = match film_format {
        Some(format) => {
            Some(image::Film::create(&arguments.output, format, size, count, arguments.fps).map_err(wrong)?)
        }
        None => None,
    };
    let mut views = Some(views);
    let mut renderer = Renderer::default();
    let mut last = None;
    for index in 0..count {
        let frame = first.unwrap_or(0) + i64::from(index);
        if let Some(film) = &film {
            film.set(&checked, &mut compiled, frame)?;
        }
        let outcome = match views.take_if(|_| film.is_none() && samples == 1) {
            Some(views) => Job::render_once(&checked, &compiled, views.only()?, (&machine, &config), size),
            None => {
                let scene = views.as_ref().map_or(Ok(None), |views| views.scene(index as usize))?;
                let job = Job { checked: &checked, compiled: &compiled, scene: scene.as_ref() };
                renderer.render_samples(&job, &machine, size, &config, samples)
            }
        };
        let (picture, stats) = match outcome {
            Ok(drawn) => drawn,
            Err(error) => {
                progress.finish();
                return Err(Failure::run(error));
            }
        };
        match (&mut open, &film) {
            (Some(open), _) => open.add(&picture),
            (None, Some(_)) => picture.save(film::numbered(&arguments.output, frame)),
            (None, None) => picture.save(&arguments.output),
        }
        .map_err(wrong)?;
        last = Some(stats);
    }
    progress.finish();
    if let Some(open) = open {
        open.finish().map_err(wrong)?;
    }
    let seconds = started.elapsed().as_secs_f64();
    match &film {
        None => eprintln!("wrote {} ({width}x{height}, {seconds:.2} s)", arguments.output.display()),
        Some(film) => {
            let name = match film_format {
                Some(_) => arguments.output.display().to_string(),
                None => {
                    let file = |frame| film::numbered(&arguments.output, frame).display().to_string();
                    format!("{} to {}", file(film.frames.start), file(film.frames.end - 1))
                }
            };
            eprintln!("wrote {name} ({count} frames of {width}x{height}, {seconds:.2} s)");
        }
    }
    if arguments.program.json {
        let files = match (&film, film_format) {
            (Some(film), None) => film.frames.clone().map(|t| film::numbered(&arguments.output, t)).collect(),
            _ => vec![arguments.output.clone()],
        };
        report::wrote(&files, size, seconds, &machine, tuned.map(|tuned| tuned.json()));
    }
    if let Some(stats) = last {
        report::stats(&arguments.machine, &machine, &stats);
    }
    Ok(())
}
