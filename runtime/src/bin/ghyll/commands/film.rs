//! Which frames a film has, and what of the program changes from one to the next.

use super::{in_range, options, refused, setting};
use crate::arguments::Render;
use crate::failure::Failure;
use crate::moving::{mentions_t, with_t};
use ghyll_compiler::argument::{parse_arguments, parse_expression};
use ghyll_compiler::compile::{self, Compiled, EntryKind, Options};
use ghyll_compiler::front::Checked;
use ghyll_runtime::presets::Preset;
use std::path::{Path, PathBuf};

/// Parameters that follow the frame's number, with their expressions.
pub struct Film {
    pub frames: std::ops::Range<i64>,
    moving: Vec<(String, String)>,
}

impl Film {
    /// The film that was asked for, and what the compiler is told: moving parameters are live, so nothing is compiled
    /// again. Every frame's values are looked at before the first one is drawn.
    pub fn new(checked: &Checked, arguments: &Render) -> Result<(Option<Film>, Options), Failure> {
        let want = Some(EntryKind::Image);
        let mut options = options(&arguments.program, want)?;
        if let Some(preset) = arguments.preset.as_deref().and_then(Preset::named) {
            take(preset, checked, &mut options, arguments.samples.is_none());
        }
        let Some([first, end]) = arguments.frames else {
            let known = |name: &str| parse_expression(&checked.module, name).is_ok();
            if let Some((name, value)) =
                options.set.iter().find(|(_, value)| mentions_t(value)).filter(|_| !known("t"))
            {
                return Err(Failure::Usage(format!(
                    "--set {name}={value} speaks of `t`, the number of a frame; give --frames A..B"
                )));
            }
            return Ok((None, options));
        };
        let mut moving = Vec::new();
        for text in &arguments.program.set {
            let (name, value) = setting(text)?;
            if mentions_t(&value) {
                moving.push((name, value));
            }
        }
        let given = |name: &str| options.set.iter().any(|(set, _)| set == name);
        if checked.module.params.iter().any(|p| p.name == "t") && !given("t") {
            moving.push(("t".into(), "t".into()));
            options.set.push(("t".into(), "t".into()));
        }
        for (name, value) in &mut options.set {
            if mentions_t(value) {
                *value = with_t(value, first);
            }
            if moving.iter().any(|(moved, _)| moved == name) && !options.live.contains(name) {
                options.live.push(name.clone());
            }
        }
        let film = Film { frames: first..end, moving };
        for frame in film.frames.clone() {
            film.moving.iter().try_for_each(|(name, text)| in_range(checked, name, &with_t(text, frame)))?;
        }
        Ok((Some(film), options))
    }

    /// Gives the parameters their values of a frame.
    pub fn set(&self, checked: &Checked, compiled: &mut Compiled, frame: i64) -> Result<(), Failure> {
        self.moving.iter().try_for_each(|(name, text)| {
            let set = compile::set_live(checked, compiled, name, &with_t(text, frame));
            set.map_err(|error| refused(error, false))
        })
    }

    /// How far through the film a frame is, in degrees of a full turn.
    pub fn turn(&self, frame: i64) -> f64 {
        360.0 * (frame - self.frames.start) as f64 / (self.frames.end - self.frames.start) as f64
    }
}

/// The file of one frame: `out.png` becomes `out-0007.png`.
pub fn numbered(output: &Path, frame: i64) -> PathBuf {
    let stem = output.file_stem().unwrap_or_default().to_string_lossy();
    let ending = output.extension().unwrap_or_default().to_string_lossy();
    let sign = if frame < 0 { "m" } else { "" };
    output.with_file_name(format!("{stem}-{sign}{:04}.{ending}", frame.unsigned_abs()))
}

/// Sets what the preset says and the program can hold, but for what is set already, and tells what that is. Whether it decides
/// on samples is the caller's to say.
fn take(preset: &Preset, checked: &Checked, options: &mut Options, samples: bool) {
    let mut taken = Vec::new();
    for (name, value) in preset.set {
        let given =
            options.set.iter().any(|(set, _)| set == name) || options.live.iter().any(|live| live == name);
        let param = checked.module.params.iter().find(|param| param.name == *name).filter(|_| !given);
        if param.is_some_and(|param| parse_arguments(&checked.module, value, &param.ty).is_ok()) {
            options.set.push((name.to_string(), value.to_string()));
            taken.push(format!("{name}={value}"));
        }
    }
    if !preset.bake {
        options.no_bake = true;
        taken.push("no bake".into());
    }
    if samples && preset.samples > 1 {
        taken.push(format!("{} samples a pixel", preset.samples));
    }
    let taken = if taken.is_empty() { "nothing that this program has".into() } else { taken.join(", ") };
    eprintln!("preset {}: {taken}", preset.name);
}
