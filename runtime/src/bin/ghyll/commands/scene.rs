//! The scene, from arguments.

use crate::arguments::{Camera, On, Reading, Render, Terrain as TerrainArguments};
use crate::failure::Failure;
use crate::moving::Moving;
use ghyll_compiler::compile::{Compiled, EntryKind};
use ghyll_compiler::front::Checked;
use ghyll_runtime::rasters::{self, BindError};
use ghyll_runtime::terrain::{
    DemError, DemOptions, Encoding, Micro, NAMED_FOV, NamedView, Projection, Raster, Scene, SceneError,
    SceneOptions, Stand, Sun, Terrain, View, Voids, sun,
};
use std::cell::Cell;
use std::path::Path;
use std::sync::Arc;

/// Reads the elevation data, or takes the built-in field.
pub fn terrain(arguments: &TerrainArguments) -> Result<Terrain, Failure> {
    let terrain = open(arguments.dem.as_deref(), &arguments.reading)?;
    match &arguments.dem {
        Some(file) if terrain.voids == terrain.samples.len() => Err(nothing(file, &terrain)),
        _ => Ok(terrain),
    }
}

/// A field without a height: there is nothing to look at.
fn nothing(file: &Path, terrain: &Terrain) -> Failure {
    let stands = match terrain.nodata {
        Some(number) => format!(" ({number} stands for a missing one)"),
        None => String::new(),
    };
    Failure::Input(format!(
        "{} holds no height: each of its {} samples is missing{stands}; get other data, or say with --nodata NUMBER \
         what stands for a missing sample",
        file.display(),
        terrain.samples.len()
    ))
}

fn encoding(name: &str) -> Option<Encoding> {
    Encoding::ALL.iter().find(|(known, _)| *known == name).map(|(_, encoding)| *encoding)
}

pub fn open(path: Option<&Path>, reading: &Reading) -> Result<Terrain, Failure> {
    let options = DemOptions {
        spacing: reading.spacing,
        heights: reading.heights,
        encoding: reading.encoding.as_deref().and_then(encoding),
        voids: if reading.voids == "fill" { Voids::Fill } else { Voids::Hole },
        nodata: reading.nodata,
    };
    let wrong = |e: DemError| Failure::Input(e.to_string());
    let Some(path) = path else { return Terrain::builtin_as(&options).map_err(wrong) };
    let terrain = Terrain::open(path, &options).map_err(wrong)?;
    note_assumptions(&path.display(), &terrain, reading);
    Ok(terrain)
}

/// Says what was assumed because the file does not state it.
fn note_assumptions(file: &dyn std::fmt::Display, terrain: &Terrain, reading: &Reading) {
    if reading.spacing.is_none() && terrain.crs.is_none() && terrain.spacing == [1.0, 1.0] {
        eprintln!(
            "{file} does not say how far apart its samples are; 1 m is assumed, --spacing DX,DY sets it"
        );
    }
    if reading.heights.is_none() && terrain.format.ends_with("grey") {
        eprintln!(
            "{file} has no units; its numbers are taken for metres, --heights LO,HI says what black and white are"
        );
    }
}

/// A scene for programs that look at the terrain without a camera of their own.
pub fn of_terrain(asked: &Asked, arguments: &TerrainArguments) -> Result<Option<Scene>, Failure> {
    let options = SceneOptions { exaggerate: arguments.exaggerate, ..SceneOptions::default() };
    asked.scene(arguments, &options)
}

/// Camera and sun of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    pub view: View,
    pub sun: Option<Sun>,
}

/// What the arguments say of a frame; `turn` degrees are those of a turntable.
pub fn look(arguments: &Camera, frame: Option<i64>, turn: Option<f64>) -> Result<Look, Failure> {
    let usage = |message: &str| Failure::Usage(message.into());
    let at = |option: &str, moving: &Option<Moving>| match moving {
        Some(moving) => moving.at(option, frame).map(Some),
        None => Ok(None),
    };
    let eye = at("--eye", &arguments.eye)?;
    let target = at("--look-at", &arguments.look_at)?;
    let fov = at("--fov", &arguments.fov)?.map(|fov| fov[0]);
    let panorama = arguments.view.as_deref() == Some("panorama");
    if fov == Some(180.0) && !panorama {
        return Err(usage(
            "--fov 180: a field of view is less than 180 degrees; only a panorama may have 180",
        ));
    }
    if arguments.view.is_some() && eye.is_some() && !panorama {
        return Err(usage("--view and --eye exclude each other, but for --view panorama"));
    }
    let view = match (eye.as_deref(), target.as_deref()) {
        (eye, target) if panorama => {
            if arguments.ortho || arguments.up.is_some() {
                return Err(usage("a panorama has neither --ortho nor --up"));
            }
            let from = match eye {
                None => Stand::Summit,
                Some([x, y]) => Stand::Ground([*x, *y]),
                Some(eye) => Stand::At([eye[0], eye[1], eye[2]]),
            };
            let azimuth = match (eye, target) {
                (Some(eye), Some(target)) => (target[0] - eye[0]).atan2(target[1] - eye[1]).to_degrees(),
                _ => 0.0,
            };
            View::Panorama { from, azimuth, fov }
        }
        (Some([x, y, z]), Some([to_x, to_y, to_z])) => {
            let up = arguments.up.unwrap_or([0.0, 0.0, 1.0]);
            let (eye, target) = ([*x, *y, *z], [*to_x, *to_y, *to_z]);
            View::LookAt { eye, target, up, fov: fov.unwrap_or(45.0), ortho: arguments.ortho }
        }
        (Some(_), Some(_)) => {
            return Err(usage("--eye takes three numbers, X,Y,Z; only a panorama finds Z itself"));
        }
        (Some(_), None) => return Err(usage("--eye needs --look-at X,Y,Z, or --view panorama")),
        _ => {
            let view = named(arguments.view.as_deref().unwrap_or("overview"))?;
            View::Named { view, fov: fov.unwrap_or(NAMED_FOV), ortho: arguments.ortho }
        }
    };
    let sun = at("--sun", &arguments.sun)?.map(|sun| Sun { azimuth: sun[0], elevation: sun[1] });
    if sun.is_some_and(|sun| sun.elevation.abs() > 90.0) {
        return Err(usage("the sun's elevation must lie between -90 and 90"));
    }
    Ok(Look { view: turn.map_or(view, |turn| view.turned(turn)), sun })
}

/// Time and place of `--sun-at`.
pub fn sun_at(text: &str, terrain: &Terrain) -> Result<Sun, Failure> {
    let wrong = |message: String| Failure::Usage(format!("--sun-at {text}: {message}"));
    let form =
        || wrong("expected a time in UTC, such as 2026-06-21T15:00Z or 2026-06-21T15:00Z@46.5,8.0".into());
    let (time, place) = match text.split_once('@') {
        Some((time, place)) => (time, Some(place)),
        None => (text, None),
    };
    let bare = time.trim().strip_suffix(['Z', 'z']).ok_or_else(form)?;
    // Hours and minutes are enough.
    let full = if bare.matches(':').count() == 1 { format!("{bare}:00Z") } else { format!("{bare}Z") };
    let time = humantime::parse_rfc3339(&full).map_err(|_| form())?;
    let place = match place {
        Some(place) => {
            let degrees: Option<Vec<f64>> = place.split(',').map(|x| x.trim().parse().ok()).collect();
            <[f64; 2]>::try_from(degrees.unwrap_or_default()).map_err(|_| form())?
        }
        None => sun::place(terrain).map_err(|e| {
            wrong(format!(
                "{e}; write the place behind the time, as in 2026-06-21T15:00Z@46.5,8.0, or use --sun"
            ))
        })?,
    };
    Sun::at(time, place).map_err(|e| wrong(e.to_string()))
}

/// The scenes of a picture or of a film's frames.
pub struct Views {
    first: Option<Scene>,
    looks: Vec<Look>,
    sun: Option<Sun>,
    curvature: Option<f64>,
    size: (u32, u32),
    /// Whether an eye under the ground was told of: once is enough for a film.
    buried: Cell<bool>,
}

impl Views {
    pub fn open(asked: &Asked, arguments: &Render, looks: Vec<Look>) -> Result<Views, Failure> {
        let camera = &arguments.camera;
        let panorama = camera.view.as_deref() == Some("panorama");
        let [width, height] = camera.size.unwrap_or(if panorama { [2048, 384] } else { [1024, 1024] });
        let size = (width, height);
        let exaggerate = arguments.terrain.exaggerate;
        let options = SceneOptions { view: looks[0].view, size, exaggerate, ..SceneOptions::default() };
        let first = asked.scene(&arguments.terrain, &options)?;
        let sun = match (&camera.sun_at, &first) {
            (Some(text), Some(scene)) => Some(sun_at(text, scene.terrain())?),
            _ => None,
        };
        let set = looks.iter().filter_map(|look| look.sun).chain(sun);
        if let Some(below) = set.map(|sun| -sun.elevation).find(|below| *below > 0.0) {
            eprintln!("the sun is {below:.1} degrees below the horizon: it gives no light");
        }
        Ok(Views { first, looks, sun, curvature: arguments.curvature, size, buried: Cell::new(false) })
    }

    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// The field, if the program looks at it.
    pub fn field(&self) -> Option<&Arc<Terrain>> {
        self.first.as_ref().map(Scene::terrain)
    }

    /// The scene before any frame's look, if the program looks at one.
    pub fn first(&self) -> Option<&Scene> {
        self.first.as_ref()
    }

    /// The scene of the only frame, with nothing else kept of the field.
    pub fn only(self) -> Result<Option<Scene>, Failure> {
        self.scene(0)
    }

    /// The scene of one frame; none if the program looks at none.
    pub fn scene(&self, index: usize) -> Result<Option<Scene>, Failure> {
        let Some(first) = &self.first else { return Ok(None) };
        let look = self.looks[index];
        let sun = look.sun.or(self.sun).unwrap_or_default();
        let options = SceneOptions { view: look.view, sun, ..*first.options() };
        let usage = |e: SceneError| Failure::Usage(e.to_string());
        let scene = first.with_options(&options).map_err(usage)?;
        self.note_buried(&scene);
        let Some(k) = self.curvature else { return Ok(Some(scene)) };
        let view = View::of(scene.camera()).ok_or_else(|| {
            Failure::Usage(
                "--curvature needs a camera that stands somewhere: not --ortho, not --view topdown".into(),
            )
        })?;
        let eye = scene.camera().eye;
        let curved = Arc::new(scene.terrain().curved([eye.x, eye.y], k));
        let scene = Scene::new(curved, &SceneOptions { view, ..options }).map_err(usage)?;
        Ok(Some(scene.with_layers(first.layers().clone()).with_micro(first.micro().clone())))
    }
}

impl Views {
    fn note_buried(&self, scene: &Scene) {
        let exaggerate = scene.options().exaggerate;
        let Some((depth, ground)) = scene.camera().buried(scene.terrain(), exaggerate) else { return };
        if self.buried.replace(true) {
            return;
        }
        let mend = match scene.camera().projection {
            Projection::Panorama => "raise the Z of --eye, or leave it out to stand on the ground",
            Projection::Perspective | Projection::Orthographic => "raise the Z of --eye",
        };
        eprintln!(
            "the eye is {depth:.1} m under the ground, which is {ground:.1} m high there: all it sees is the ground's \
             inside; {mend}"
        );
    }
}

fn named(name: &str) -> Result<NamedView, Failure> {
    name.parse::<NamedView>().map_err(|e| Failure::Usage(e.to_string()))
}

/// A program that may look at a scene.
pub struct Asked<'a> {
    pub checked: &'a Checked,
    pub compiled: &'a Compiled,
    pub on: On,
    /// The elevation data, if it was read already.
    pub field: Option<Arc<Terrain>>,
}

impl<'a> Asked<'a> {
    pub fn new(checked: &'a Checked, compiled: &'a Compiled, on: On) -> Asked<'a> {
        Asked { checked, compiled, on, field: None }
    }

    /// What is not looked at is not read.
    pub fn scene(
        &self,
        arguments: &TerrainArguments,
        options: &SceneOptions,
    ) -> Result<Option<Scene>, Failure> {
        let module = &self.checked.module;
        let bindings = bindings(&arguments.rasters)?;
        let refused = |e: BindError| match e.is_usage() {
            true => Failure::Usage(e.to_string()),
            false => Failure::Input(e.to_string()),
        };
        rasters::check_names(module, bindings.iter().map(|(name, _)| *name)).map_err(refused)?;
        if !self.looks() {
            if arguments.dem.is_some() {
                eprintln!("the program does not look at the terrain; --dem is not read");
            }
            return Ok(None);
        }
        let terrain = match &self.field {
            Some(field) => field.clone(),
            None => Arc::new(terrain(arguments)?),
        };
        let scene = Scene::new(terrain, options).map_err(|e| Failure::Usage(e.to_string()))?;
        let scene = match &arguments.micro {
            Some(file) => scene.with_micro(Arc::new(micro(file)?)),
            None => scene,
        };
        let open = |wanted: &str| {
            let (name, file) = bindings.iter().find(|(name, _)| *name == wanted)?;
            Some(Raster::open(file).map(|raster| {
                if raster.missing > 0 {
                    eprintln!(
                        "{file}: {} numbers of the raster `{name}` are missing and read as 0",
                        raster.missing
                    );
                }
                Arc::new(raster)
            }))
        };
        rasters::bind(module, self.compiled, &scene, open).map(Some).map_err(refused)
    }

    /// The oracle evaluates what the compiler has found to be of no consequence too.
    fn looks(&self) -> bool {
        if self.compiled.kind == EntryKind::Map {
            return true;
        }
        let library = self.checked.module.functions.iter().any(|f| f.library);
        !self.compiled.back.wgsl.intrinsics.is_empty() || (self.on == On::Oracle && library)
    }
}

fn micro(file: &Path) -> Result<Micro, Failure> {
    let read = Raster::open(file).and_then(|raster| Micro::new(&raster));
    read.map_err(|e| Failure::Input(e.to_string()))
}

/// Names with their files.
fn bindings(rasters: &[String]) -> Result<Vec<(&str, &str)>, Failure> {
    rasters.iter().map(|text| binding(text)).collect()
}

fn binding(text: &str) -> Result<(&str, &str), Failure> {
    let (name, file) = text.split_once('=').ok_or_else(|| {
        Failure::Usage(format!("--raster {text}: expected NAME=FILE, such as --raster satellite=photo.png"))
    })?;
    match (name.trim(), file.trim()) {
        ("", _) => {
            Err(Failure::Usage(format!("--raster {text}: the name of the raster is missing before the `=`")))
        }
        (name, "") => Err(Failure::Usage(format!(
            "--raster {text}: the file is missing; write --raster {name}=FILE, such as --raster {name}=photo.png"
        ))),
        named => Ok(named),
    }
}
