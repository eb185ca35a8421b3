//! What is shown: a program, its scene and the pictures of it. A program that is wrong does not replace one that is not.

use super::knobs::{Knob, knobs};
use crate::arguments::View as Arguments;
use crate::commands::{checked, compiled_as, options, refused, scene};
use crate::failure::Failure;
use ghyll_compiler::compile::{self, Compiled, EntryKind, Options};
use ghyll_compiler::front::Checked;
use ghyll_compiler::source::Source;
use ghyll_runtime::config::Config;
use ghyll_runtime::image::Image;
use ghyll_runtime::machine::{Job, Machine};
use ghyll_runtime::renderer::Renderer;
use ghyll_runtime::terrain::{Orbit, Scene, SceneOptions};
use std::path::PathBuf;
use std::time::{Duration, Instant};

pub struct Picture<'a> {
    arguments: &'a Arguments,
    machine: &'a Machine,
    config: &'a Config,
    program: Program,
    /// Where the camera is; none where the program looks at no scene.
    pub orbit: Option<Orbit>,
    /// How many times the program was put onto the machine.
    #[cfg(test)]
    programs: usize,
}

/// A program that has been drawn.
struct Program {
    checked: Checked,
    compiled: Compiled,
    scene: Option<Scene>,
    renderer: Renderer,
    knobs: Vec<Knob>,
    selected: usize,
}

impl<'a> Picture<'a> {
    pub fn open(
        source: Source,
        arguments: &'a Arguments,
        machine: &'a Machine,
        config: &'a Config,
        size: (u32, u32),
    ) -> Result<Picture<'a>, Failure> {
        let program = Program::new(source, arguments, None, size)?;
        let orbit = match &program.scene {
            Some(scene) => Some(Orbit::of(scene).ok_or_else(|| {
                Failure::Usage("a panorama cannot be turned; choose another --view".into())
            })?),
            None => None,
        };
        Ok(Picture {
            arguments,
            machine,
            config,
            program,
            orbit,
            #[cfg(test)]
            programs: 1,
        })
    }

    /// The program's files.
    pub fn files(&self) -> Vec<PathBuf> {
        files(&self.program.checked.sources)
    }

    /// Takes another text of the program if it can be drawn, and says which files it consists of; else the one that is
    /// shown stays. What was changed by keys stays as far as the parameters do.
    pub fn replace(&mut self, source: Source, size: (u32, u32)) -> Result<(Image, Duration), Failure> {
        let mut program = Program::new(source, self.arguments, self.program.scene.as_ref(), size)?;
        program.take_values(&self.program.knobs);
        let selected = self.program.knobs.get(self.program.selected).map(|knob| knob.name.clone());
        program.selected =
            program.knobs.iter().position(|knob| Some(&knob.name) == selected.as_ref()).unwrap_or(0);
        let mut orbit = self.orbit;
        if let (None, Some(scene)) = (&orbit, &program.scene) {
            orbit = Orbit::of(scene);
        }
        let drawn = program.draw(self.machine, self.config, orbit, size)?;
        (self.program, self.orbit) = (program, orbit);
        #[cfg(test)]
        {
            self.programs += 1;
        }
        Ok(drawn)
    }

    pub fn draw(&mut self, size: (u32, u32)) -> Result<(Image, Duration), Failure> {
        self.program.draw(self.machine, self.config, self.orbit, size)
    }

    /// The camera as at first.
    pub fn reset(&mut self) {
        self.orbit = self.program.scene.as_ref().and_then(Orbit::of);
    }

    /// Size of the field in metres.
    pub fn field_size(&self) -> f64 {
        let extent = self.program.scene.as_ref().map(|scene| scene.terrain().extent());
        extent.map_or(1.0, |[x, y]| x.hypot(y))
    }

    /// The parameter that keys change, with its value.
    pub fn knob(&self) -> Option<&Knob> {
        self.program.knobs.get(self.program.selected)
    }

    pub fn select(&mut self, next: bool) {
        let count = self.program.knobs.len().max(1);
        self.program.selected = (self.program.selected + if next { 1 } else { count - 1 }) % count;
    }

    /// Changes the parameter by a step; whether there is anything to draw.
    pub fn step(&mut self, up: bool) -> Result<bool, Failure> {
        let program = &mut self.program;
        let Some(knob) = program.knobs.get_mut(program.selected) else { return Ok(false) };
        let Some(text) = knob.step(up) else { return Ok(false) };
        let name = knob.name.clone();
        program.set(&name, &text)?;
        Ok(true)
    }

    /// The options of `ghyll render` for the picture that is shown.
    pub fn command(&self) -> String {
        let mut words = vec!["ghyll render".to_owned()];
        words.extend(self.arguments.file.iter().map(|file| file.display().to_string()));
        if let Some(orbit) = &self.orbit {
            let [x, y, z] = orbit.eye().to_array();
            let [a, b, c] = orbit.target.to_array();
            words.push(format!(
                "--eye {x:.2},{y:.2},{z:.2} --look-at {a:.2},{b:.2},{c:.2} --fov {:.2}",
                orbit.fov
            ));
            words.extend(orbit.ortho.then(|| "--ortho".to_owned()));
        }
        let knobs = self.program.knobs.iter();
        words.extend(knobs.map(|knob| format!("--set {}={}", knob.name, knob.text())));
        words.join(" ")
    }
}

/// The files among a program's texts.
pub fn files(sources: &ghyll_compiler::source::Sources) -> Vec<PathBuf> {
    sources.iter().map(|s| PathBuf::from(&s.name)).filter(|file| file.is_file()).collect()
}

impl Program {
    fn new(
        source: Source,
        arguments: &Arguments,
        before: Option<&Scene>,
        size: (u32, u32),
    ) -> Result<Program, Failure> {
        let checked = checked(source, arguments.program.json)?;
        let compiled = compiled_live(&checked, arguments)?;
        let mut asked = scene::Asked::new(&checked, &compiled, arguments.machine.on);
        // The elevation data stays as it was.
        asked.field = before.map(|scene| scene.terrain().clone());
        let look = scene::look(&arguments.camera, None, None)?;
        let exaggerate = arguments.terrain.exaggerate;
        let options = SceneOptions { view: look.view, size, exaggerate, ..SceneOptions::default() };
        let scene = asked.scene(&arguments.terrain, &options)?;
        let scene = match scene {
            Some(scene) => {
                let sun_at = arguments.camera.sun_at.as_deref();
                let sun = sun_at.map(|text| scene::sun_at(text, scene.terrain())).transpose()?;
                let sun = look.sun.or(sun).unwrap_or_default();
                Some(scene.with_options(&SceneOptions { sun, ..options }).map_err(usage)?)
            }
            None => None,
        };
        let knobs = knobs(&checked, &compiled);
        Ok(Program { checked, compiled, scene, renderer: Renderer::default(), knobs, selected: 0 })
    }

    /// Gives parameters the values that they had in another program.
    fn take_values(&mut self, before: &[Knob]) {
        for i in 0..self.knobs.len() {
            let Some(old) = before.iter().find(|old| old.name == self.knobs[i].name) else { continue };
            // The new text may state another type or range.
            if self.set(&old.name, &old.text()).is_ok() {
                self.knobs = knobs(&self.checked, &self.compiled);
            }
        }
    }

    fn set(&mut self, name: &str, text: &str) -> Result<(), Failure> {
        compile::set_live(&self.checked, &mut self.compiled, name, text).map_err(|e| refused(e, false))
    }

    fn draw(
        &mut self,
        machine: &Machine,
        config: &Config,
        orbit: Option<Orbit>,
        size: (u32, u32),
    ) -> Result<(Image, Duration), Failure> {
        let scene = match (&self.scene, orbit) {
            (Some(scene), Some(orbit)) => {
                let options = SceneOptions { view: orbit.view(), size, ..*scene.options() };
                Some(scene.with_options(&options).map_err(usage)?)
            }
            _ => None,
        };
        let job = Job { checked: &self.checked, compiled: &self.compiled, scene: scene.as_ref() };
        let started = Instant::now();
        let (image, _) = self.renderer.render(&job, machine, size, config).map_err(Failure::run)?;
        Ok((image, started.elapsed()))
    }
}

fn usage(error: ghyll_runtime::terrain::SceneError) -> Failure {
    Failure::Usage(error.to_string())
}

/// The program with the parameters live that are named by `--live`; without that all that are not set, if the program
/// allows it.
fn compiled_live(checked: &Checked, arguments: &Arguments) -> Result<Compiled, Failure> {
    let options = options(&arguments.program, Some(EntryKind::Image))?;
    if options.live.is_empty() {
        let module = &checked.module;
        let set = |name: &str| options.set.iter().any(|(set, _)| set == name);
        let free = module.params.iter().filter(|p| !module.is_library(p.span) && !set(&p.name));
        let live: Vec<String> = free.map(|p| p.name.clone()).collect();
        if let Ok(compiled) = compile::compile(checked, &Options { live, ..options.clone() }) {
            return Ok(compiled);
        }
    }
    compiled_as(checked, &arguments.program, &options)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::{Arguments as Line, Command};
    use clap::Parser;

    fn arguments(words: &[&str]) -> Box<Arguments> {
        let line = Line::parse_from(["ghyll", "view", "--on", "cpu"].iter().chain(words));
        match line.command {
            Command::View(arguments) => arguments,
            _ => panic!("`view` was asked for"),
        }
    }

    fn source(text: &str) -> Source {
        Source::new("test", text)
    }

    const SIZE: (u32, u32) = (8, 4);
    const FLAT: &str = "param k: f32 = 0.25; fn pixel(p: vec2) -> f32 = k;";

    fn with(words: &[&str], text: &str, test: impl FnOnce(Picture)) {
        let arguments = arguments(words);
        let (machine, config) = (Machine::Cpu, Config::default());
        test(Picture::open(source(text), &arguments, &machine, &config, SIZE).ok().unwrap());
    }

    #[test]
    fn a_wrong_text_leaves_the_last_good_one() {
        with(&[], FLAT, |mut picture| {
            let first = picture.draw(SIZE).ok().unwrap().0;
            for wrong in [
                "fn pixel(p: vec2) -> f32 = ",
                "fn pixel(p: vec2) -> f32 = q;",
                "fn main() -> f32 = 1.0;",
                "",
            ] {
                assert!(picture.replace(source(wrong), SIZE).is_err(), "{wrong}");
                assert_eq!(picture.draw(SIZE).ok().unwrap().0, first);
            }
            let endless = "fn f(n: i32) -> f32 = f(n + 1); fn pixel(p: vec2) -> f32 = f(i32(p.x));";
            picture.config = Box::leak(Box::new(Config { max_rewrites: Some(1000), ..Config::default() }));
            assert!(picture.replace(source(endless), SIZE).is_err());
            assert_eq!(picture.draw(SIZE).ok().unwrap().0, first);
            let other = "param k: f32 = 0.25; fn pixel(p: vec2) -> f32 = k * 2.0;";
            assert_eq!(picture.replace(source(other), SIZE).ok().unwrap().0.pixel(0, 0), [0.5]);
            assert_eq!(picture.programs, 2);
        });
    }

    #[test]
    fn keys_change_parameters_of_the_same_program() {
        with(&[], FLAT, |mut picture| {
            assert!(picture.step(true).ok().unwrap());
            let changed = picture.draw(SIZE).ok().unwrap().0;
            assert!((changed.pixel(0, 0)[0] - 0.2625).abs() < 1e-6);
            assert_eq!(picture.programs, 1);
            // The value stays when the text changes, as long as it fits.
            let other = "param new: bool = true; param k: f32 = 0.25; fn pixel(p: vec2) -> f32 = select(0.0, k, new);";
            let drawn = picture.replace(source(other), SIZE).ok().unwrap().0;
            assert!((drawn.pixel(0, 0)[0] - 0.2625).abs() < 1e-6);
            assert_eq!(picture.knob().map(|knob| knob.name.as_str()), Some("k"));
            let narrow = "param k: f32 = 0.25 in 0.0..0.26; fn pixel(p: vec2) -> f32 = k;";
            assert_eq!(picture.replace(source(narrow), SIZE).ok().unwrap().0.pixel(0, 0), [0.25]);
        });
        with(&["--set", "k=0.5"], FLAT, |picture| assert!(picture.knob().is_none()));
    }

    #[test]
    fn turning_the_camera_changes_the_picture() {
        let terrain = "use terrain; fn pixel(p: vec2) -> vec3 = camera(p).dir;";
        with(&["--view", "north"], terrain, |mut picture| {
            let first = picture.draw(SIZE).ok().unwrap().0;
            // It looks north, so east is to the right.
            assert!(first.pixel(7, 2)[0] > 0.1 && first.pixel(4, 2)[1] > 0.9, "{first:?}");
            if let Some(orbit) = &mut picture.orbit {
                orbit.turn(180.0, 0.0);
            }
            let turned = picture.draw(SIZE).ok().unwrap().0;
            assert!(turned.pixel(7, 2)[0] < -0.1 && turned.pixel(4, 2)[1] < -0.9, "{turned:?}");
            let command = picture.command();
            assert!(
                command.starts_with("ghyll render --eye ") && command.contains(" --look-at "),
                "{command}"
            );
            picture.reset();
            assert_eq!(picture.draw(SIZE).ok().unwrap().0, first);
        });
    }
}
