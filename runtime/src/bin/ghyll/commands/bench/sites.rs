//! Terrains and views.

use super::stability::random::Random;
use crate::failure::Failure;
use ghyll_runtime::terrain::{DemOptions, NamedView, Scene, SceneOptions, Sun, Terrain, View, dem};
use std::path::Path;
use std::sync::Arc;

pub struct Site {
    pub name: String,
    terrain: Arc<Terrain>,
}

pub struct Look {
    pub name: &'static str,
    view: fn(&Terrain) -> View,
}

pub const VIEWS: &[Look] =
    &[Look { name: "overview", view: overview }, Look { name: "ground", view: ground }];

const SIDE: u32 = 512;
const SPACING: [f64; 2] = [30.0, 30.0];

static ACONCAGUA: &[u8] = include_bytes!("../../../../../../benches/table1/aconcagua.tif");

/// Those of the paper, and the file that the user names.
pub fn all(file: Option<&Path>) -> Result<Vec<Site>, Failure> {
    let mut sites = Vec::from(paper()?);
    if let Some(file) = file {
        let terrain =
            Terrain::open(file, &DemOptions::default()).map_err(|e| Failure::Input(e.to_string()))?;
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        sites.push(Site { name, terrain: Arc::new(terrain) });
    }
    Ok(sites)
}

/// Four fields of the paper's size in the order of its Table 1; the Andes stand for its Himalaya.
pub fn paper() -> Result<[Site; 4], Failure> {
    Ok([made("Terrain1", &mut hills)?, made("Terrain2", &mut ridges)?, fuji(), aconcagua()?])
}

fn fuji() -> Site {
    Site { name: "Fuji".into(), terrain: Arc::new(Terrain::builtin()) }
}

pub fn aconcagua() -> Result<Site, Failure> {
    let terrain = dem::read("Aconcagua", ACONCAGUA, &DemOptions::default());
    let terrain = Arc::new(terrain.map_err(|e| Failure::Run(e.to_string()))?);
    Ok(Site { name: "Aconcagua".into(), terrain })
}

fn made(name: &str, z: &mut dyn FnMut(f64, f64) -> f64) -> Result<Site, Failure> {
    let heights = (0..SIDE * SIDE).map(|i| z(f64::from(i % SIDE), f64::from(i / SIDE)) as f32).collect();
    let terrain = Terrain::from_heights(SIDE, SIDE, SPACING, heights);
    let terrain = Arc::new(terrain.map_err(|e| Failure::Run(e.to_string()))?);
    Ok(Site { name: name.into(), terrain })
}

fn hills(x: f64, y: f64) -> f64 {
    900.0 + 500.0 * (0.021 * x).sin() * (0.017 * y).cos() + 120.0 * (0.08 * x + 0.05 * y).sin()
}

/// Octaves of folded noise: crests, and valleys between them.
fn ridges(x: f64, y: f64) -> f64 {
    let octave = |k: u32| {
        let cell = 160.0 * 0.5f64.powi(k as i32);
        2200.0 * 0.5f64.powi(k as i32) * (1.0 - noise(x / cell, y / cell, u64::from(k)).abs())
    };
    (0..7).map(octave).sum()
}

/// Between random numbers in [-1, 1] at whole positions.
fn noise(x: f64, y: f64, seed: u64) -> f64 {
    let at = |i: f64, j: f64| Random((i as u64) << 40 | (j as u64) << 8 | seed).within(-1.0, 1.0);
    let fade = |t: f64| t * t * (3.0 - 2.0 * t);
    let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
    let (i, j) = (x.floor(), y.floor());
    let (u, v) = (fade(x - i), fade(y - j));
    mix(mix(at(i, j), at(i + 1.0, j), u), mix(at(i, j + 1.0), at(i + 1.0, j + 1.0), u), v)
}

impl Site {
    pub fn seen(&self, look: &Look, size: (u32, u32)) -> Result<Scene, Failure> {
        let sun = Sun { azimuth: 300.0, elevation: 20.0 };
        let options = SceneOptions { view: (look.view)(&self.terrain), size, sun, ..SceneOptions::default() };
        Scene::new(self.terrain.clone(), &options).map_err(|e| Failure::Run(e.to_string()))
    }
}

fn overview(_: &Terrain) -> View {
    View::Named { view: NamedView::Overview, fov: 45.0, ortho: false }
}

/// From where somebody stands at the southern rim, to the north: most rays graze.
fn ground(terrain: &Terrain) -> View {
    let [width, height] = terrain.extent();
    let (column, row) = (terrain.width / 2, terrain.height / 16);
    let stand = (0..terrain.height).find_map(|up| terrain.sample(column, (row + up) % terrain.height));
    let z = stand.unwrap_or(terrain.min) + 0.02 * (terrain.max - terrain.min) + 2.0;
    let eye = [f64::from(column) * terrain.spacing[0], f64::from(row) * terrain.spacing[1], z];
    let target = [0.5 * width + 1.0, height, z];
    View::LookAt { eye, target, up: [0.0, 0.0, 1.0], fov: 45.0, ortho: false }
}
