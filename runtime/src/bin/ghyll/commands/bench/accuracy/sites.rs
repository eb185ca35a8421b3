//! Terrains and views.

use super::super::stability::random::Random;
use crate::failure::Failure;
use ghyll_runtime::terrain::{DemOptions, NamedView, Scene, SceneOptions, Sun, Terrain, View};
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

/// The built-in field, smooth hills, white noise in hills, and the file that the user names.
pub fn all(file: Option<&Path>) -> Result<Vec<Site>, Failure> {
    let made = |name: &str, z: &mut dyn FnMut(f64, f64) -> f64| {
        let heights = (0..SIDE * SIDE).map(|i| z(f64::from(i % SIDE), f64::from(i / SIDE)) as f32).collect();
        let terrain = Terrain::from_heights(SIDE, SIDE, SPACING, heights);
        let terrain = Arc::new(terrain.map_err(|e| Failure::Run(e.to_string()))?);
        Ok::<Site, Failure>(Site { name: name.into(), terrain })
    };
    let hills = |x: f64, y: f64| {
        900.0 + 500.0 * (0.021 * x).sin() * (0.017 * y).cos() + 120.0 * (0.08 * x + 0.05 * y).sin()
    };
    let mut random = Random(5);
    let mut sites = vec![
        Site { name: "Fuji".into(), terrain: Arc::new(Terrain::builtin()) },
        made("hills", &mut |x, y| hills(x, y))?,
        made("rough hills", &mut |x, y| hills(x, y) + random.within(0.0, 45.0))?,
    ];
    if let Some(file) = file {
        let terrain =
            Terrain::open(file, &DemOptions::default()).map_err(|e| Failure::Input(e.to_string()))?;
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        sites.push(Site { name, terrain: Arc::new(terrain) });
    }
    Ok(sites)
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
