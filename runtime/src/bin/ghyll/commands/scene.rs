//! The scene, from arguments.

use crate::arguments::{Reading, Render, Terrain as TerrainArguments};
use crate::failure::Failure;
use ghyll_runtime::terrain::{
    DemError, DemOptions, Encoding, NAMED_FOV, NamedView, Scene, SceneOptions, Sun, Terrain, View, Voids,
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
pub fn of_terrain(arguments: &TerrainArguments) -> Result<Scene, Failure> {
    let options = SceneOptions { exaggerate: arguments.exaggerate, ..SceneOptions::default() };
    build(terrain(arguments)?, &options)
}

pub fn of_render(arguments: &Render) -> Result<Scene, Failure> {
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
    build(terrain(&arguments.terrain)?, &options)
}

fn named(name: &str) -> Result<NamedView, Failure> {
    name.parse::<NamedView>().map_err(|e| Failure::Usage(e.to_string()))
}

fn build(terrain: Terrain, options: &SceneOptions) -> Result<Scene, Failure> {
    Scene::new(Arc::new(terrain), options).map_err(|e| Failure::Usage(e.to_string()))
}
