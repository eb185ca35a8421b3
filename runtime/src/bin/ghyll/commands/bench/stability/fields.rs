//! The fields that hazards need.

use super::random::Random;
use ghyll_runtime::terrain::{Scene, SceneOptions, Terrain, View};
use std::sync::Arc;

/// Cells by which a ray may be moved: what is nearer is a rounding at a silhouette.
pub const MOVED: f64 = 1e-4;

/// A field with what rays aim at.
pub struct Site {
    pub scene: Scene,
    pub extent: [f64; 2],
    /// Lowest and highest height, apart from each other even where the field is level.
    pub relief: [f64; 2],
    /// Cells by which a ray may be moved.
    pub moved: f64,
}

impl Site {
    pub fn new(terrain: Terrain) -> Result<Site, String> {
        let extent = terrain.extent();
        let relief = [terrain.min, terrain.max.max(terrain.min + terrain.spacing[0])];
        let options = SceneOptions { view: View::overview(), size: (96, 96), ..SceneOptions::default() };
        let scene = Scene::new(Arc::new(terrain), &options).map_err(|e| e.to_string())?;
        Ok(Site { scene, extent, relief, moved: MOVED })
    }

    /// The shorter side of a cell in metres.
    pub fn cell(&self) -> f64 {
        let [dx, dy] = self.scene.terrain().spacing;
        dx.min(dy)
    }
}

type Made = Result<Terrain, String>;

fn field(width: u32, height: u32, spacing: [f64; 2], mut z: impl FnMut(u32, u32) -> f32) -> Made {
    let mut heights = Vec::with_capacity(width as usize * height as usize);
    for r in 0..height {
        heights.extend((0..width).map(|c| z(c, r)));
    }
    Terrain::from_heights(width, height, spacing, heights).map_err(|e| e.to_string())
}

pub fn fuji() -> Made {
    Ok(Terrain::builtin())
}

/// White noise, two cells high.
pub fn noise() -> Made {
    let mut random = Random(1);
    field(257, 201, [30.0, 20.0], |_, _| random.within(0.0, 60.0) as f32)
}

pub fn plane() -> Made {
    field(512, 512, [30.0, 30.0], |_, _| 1234.5)
}

pub fn tilted() -> Made {
    field(512, 512, [30.0, 30.0], |c, r| 1000.0 + 11.1 * c as f32 - 6.3 * r as f32)
}

/// Level at 8848.125 m.
pub fn high() -> Made {
    field(257, 257, [30.0, 30.0], |_, _| 8848.125)
}

/// Level at 8848.125 m, with pits.
pub fn plateau() -> Made {
    field(257, 257, [30.0, 30.0], |c, r| if c % 16 == 7 && r % 16 == 9 { 8500.0 } else { 8848.125 })
}

/// Tilted as steeply as 45 degrees along both axes.
pub fn steep() -> Made {
    field(257, 257, [10.0, 10.0], |c, r| 10.0 * (c + r) as f32)
}

/// 10^5 m beside 1 m spacing.
pub fn spikes() -> Made {
    field(101, 90, [1.0, 1.0], |c, r| if c % 7 == 3 && r % 5 == 2 { 1e5 } else { 0.0 })
}

/// Millimetres of relief on 8848 m.
pub fn millimetres() -> Made {
    field(129, 129, [1.0, 1.0], |c, r| 8848.0 + 0.001 * ((c * 31 + r * 17) % 11) as f32)
}

pub fn voids() -> Made {
    let mut random = Random(2);
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    let z = |_, _| if random.one_in(9) { random.pick(&bad) } else { random.within(0.0, 50.0) as f32 };
    field(101, 97, [10.0, 10.0], z)
}

pub fn smallest() -> Made {
    field(2, 2, [10.0, 10.0], |c, r| (c * 7 + r * 3) as f32)
}

pub fn strip() -> Made {
    field(2, 40, [10.0, 1.0], |c, r| ((c + r) % 3) as f32)
}

pub fn row() -> Made {
    field(40, 2, [1.0, 100.0], |c, r| ((c * r) % 5) as f32)
}

fn hills(c: u32, r: u32) -> f32 {
    let (x, y) = (f64::from(c), f64::from(r));
    (40.0 * (0.07 * x).sin() * (0.05 * y).cos() + 9.0 * (0.7 * x + 0.9 * y).sin()) as f32
}

pub fn wide() -> Made {
    field(16_384, 128, [30.0, 30.0], hills)
}

pub fn widest() -> Made {
    field(65_536, 8, [30.0, 30.0], hills)
}

/// A gibibyte of samples.
pub fn large() -> Made {
    field(16_384, 16_384, [30.0, 30.0], |c, r| ((c * 7 + r * 13) % 31) as f32 + ((c ^ r) & 63) as f32)
}

pub fn unequal() -> Made {
    field(200, 40, [1.0, 1000.0], |c, r| hills(c, 10 * r))
}

pub fn fine() -> Made {
    field(100, 100, [1e-3, 2e-3], |c, r| ((c * r) % 7) as f32 * 1e-3)
}

pub fn coarse() -> Made {
    field(100, 100, [1e5, 1e5], |c, r| 100.0 * hills(c, r))
}

/// Sides that must be refused, for a field has at least one cell.
pub const TOO_SMALL: &[(u32, u32)] = &[(0, 0), (1, 1), (1, 9), (9, 1)];

/// Why a field of that size is refused.
pub fn refusal(width: u32, height: u32) -> Option<String> {
    field(width, height, [1.0, 1.0], |_, _| 0.0).err()
}
