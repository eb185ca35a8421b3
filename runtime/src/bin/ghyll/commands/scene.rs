//! The scene, from arguments.

use crate::arguments::{Render, Terrain as TerrainArguments};
use crate::failure::Failure;
use ghyll_runtime::terrain::{
    DemOptions, Encoding, NamedView, Scene, SceneOptions, Sun, Terrain, View, Voids,
};
use std::path::Path;
use std::sync::Arc;

/// Reads the elevation data, or takes the built-in field.
pub fn terrain(arguments: &TerrainArguments) -> Result<Terrain, Failure> {
    let options = DemOptions {
        spacing: arguments.spacing,
        heights: arguments.heights,
        encoding: arguments.encoding.as_deref().and_then(encoding),
        voids: if arguments.voids == "fill" { Voids::Fill } else { Voids::Hole },
    };
    open(arguments.dem.as_deref(), &options)
}

fn encoding(name: &str) -> Option<Encoding> {
    Encoding::ALL.iter().find(|(known, _)| *known == name).map(|(_, encoding)| *encoding)
}

pub fn open(path: Option<&Path>, options: &DemOptions) -> Result<Terrain, Failure> {
    match path {
        Some(path) => Terrain::open(path, options).map_err(|e| Failure::Input(e.to_string())),
        None => Ok(Terrain::builtin()),
    }
}

/// A scene for programs that look at the terrain without a camera of their own.
pub fn of_terrain(arguments: &TerrainArguments) -> Result<Scene, Failure> {
    let options = SceneOptions { exaggerate: arguments.exaggerate, ..SceneOptions::default() };
    build(terrain(arguments)?, &options)
}

pub fn of_render(arguments: &Render) -> Result<Scene, Failure> {
    let fov = arguments.fov.unwrap_or(45.0);
    let view = match (arguments.eye, arguments.look_at) {
        (Some(eye), Some(target)) => {
            let up = arguments.up.unwrap_or([0.0, 0.0, 1.0]);
            View::LookAt { eye, target, up, fov, ortho: arguments.ortho }
        }
        _ => View::Named { view: named(&arguments.view)?, ortho: arguments.ortho },
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
