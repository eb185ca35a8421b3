//! The scene, from arguments.

use crate::arguments::{On, Reading, Render, Terrain as TerrainArguments};
use crate::failure::Failure;
use ghyll_compiler::compile::{Compiled, EntryKind};
use ghyll_compiler::front::Checked;
use ghyll_runtime::rasters::{self, BindError};
use ghyll_runtime::terrain::{
    DemError, DemOptions, Encoding, Micro, NAMED_FOV, NamedView, Raster, Scene, SceneOptions, Sun, Terrain,
    View, Voids,
};
use std::path::Path;
use std::sync::Arc;

/// Reads the elevation data, or takes the built-in field.
pub fn terrain(arguments: &TerrainArguments) -> Result<Terrain, Failure> {
    open(arguments.dem.as_deref(), &arguments.reading)
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

pub fn of_render(asked: &Asked, arguments: &Render) -> Result<Option<Scene>, Failure> {
    let view = match (arguments.eye, arguments.look_at) {
        (Some(eye), Some(target)) => {
            let up = arguments.up.unwrap_or([0.0, 0.0, 1.0]);
            let fov = arguments.fov.unwrap_or(45.0);
            View::LookAt { eye, target, up, fov, ortho: arguments.ortho }
        }
        _ => {
            let fov = arguments.fov.unwrap_or(NAMED_FOV);
            View::Named { view: named(&arguments.view)?, fov, ortho: arguments.ortho }
        }
    };
    let sun = match arguments.sun {
        Some([azimuth, elevation]) => Sun { azimuth, elevation },
        None => Sun::default(),
    };
    let [width, height] = arguments.size;
    let options = SceneOptions { view, size: (width, height), sun, exaggerate: arguments.terrain.exaggerate };
    asked.scene(&arguments.terrain, &options)
}

fn named(name: &str) -> Result<NamedView, Failure> {
    name.parse::<NamedView>().map_err(|e| Failure::Usage(e.to_string()))
}

/// A program that may look at a scene.
pub struct Asked<'a> {
    pub checked: &'a Checked,
    pub compiled: &'a Compiled,
    pub on: On,
}

impl Asked<'_> {
    /// What is not looked at is not read.
    fn scene(&self, arguments: &TerrainArguments, options: &SceneOptions) -> Result<Option<Scene>, Failure> {
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
        let terrain = terrain(arguments)?;
        let scene = Scene::new(Arc::new(terrain), options).map_err(|e| Failure::Usage(e.to_string()))?;
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
    Ok((name.trim(), file.trim()))
}
