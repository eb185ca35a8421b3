//! `ghyll view`: the picture in a window, which follows the program's file, the mouse and the keys.

mod knobs;
mod picture;
mod watch;
mod window;

use super::{machine, read};
use crate::arguments::View;
use crate::failure::Failure;
use ghyll_compiler::source::Source;
use picture::Picture;
use watch::Watch;
use window::Viewer;

/// What `ghyll view` shows without a file.
const EXAMPLE: &str = include_str!("../../../../../lang-examples/fuji.ghyll");

pub fn view(arguments: &View) -> Result<(), Failure> {
    window::display()?;
    let source = source(arguments)?;
    let (machine, config) = machine::open(&arguments.machine)?;
    eprintln!("showing on {}: {}", machine.describe(), machine::reason(&arguments.machine, &machine));
    let [width, height] = arguments.camera.size.unwrap_or([960, 640]);
    let picture = Picture::open(source, arguments, &machine, &config, (width, height))?;
    let mut watch = Watch::default();
    if arguments.file.is_some() {
        watch.follow(picture.files());
    }
    Viewer::open(picture, watch, arguments)?.run()
}

fn source(arguments: &View) -> Result<Source, Failure> {
    match &arguments.file {
        Some(path) => read(path),
        None => Ok(Source::new("lang-examples/fuji.ghyll", EXAMPLE)),
    }
}
