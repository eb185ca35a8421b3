//! What a program sees of the world: one field, its pyramid, a camera and the sun.

use super::beams::Beams;
use super::field::{Samples, Terrain};
use super::layers::Layers;
use super::layout::SceneUniform;
use super::means::Means;
use super::micro::Micro;
use super::pyramid::{self, MAX_LEVELS, Pyramid, Side};
use super::sun::Sun;
use super::view::{Camera, View};
use std::sync::{Arc, OnceLock};

#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    #[error("there is no view named `{0}`; the views are overview, topdown, north, south, east and west")]
    UnknownView(String),
    #[error("the picture has no pixels; give a size of at least 1x1")]
    EmptyPicture,
    #[error("the camera's position, target and up direction must be finite numbers")]
    NotFinite,
    #[error(
        "the field of view is {0} degrees; it must be more than 0 and less than 180, in a panorama 180 at most"
    )]
    FieldOfView(f64),
    #[error("there is no ground at {0}, {1}: it is outside the field or in a hole")]
    NoGround(f64, f64),
    #[error("the camera stands where it looks at; move --eye or --look-at")]
    SamePlace,
    #[error("the sun's azimuth and elevation must be finite numbers")]
    Sun,
    #[error("heights are exaggerated by {0}; the factor must be positive and finite")]
    Exaggeration(f64),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneOptions {
    pub view: View,
    /// Pixels across and down.
    pub size: (u32, u32),
    pub sun: Sun,
    /// Factor on all heights.
    pub exaggerate: f64,
}

impl Default for SceneOptions {
    fn default() -> SceneOptions {
        SceneOptions { view: View::default(), size: (1024, 1024), sun: Sun::default(), exaggerate: 1.0 }
    }
}

#[derive(Clone, Debug)]
pub struct Scene {
    terrain: Arc<Terrain>,
    derived: Arc<Derived>,
    micro: Option<Arc<Micro>>,
    options: SceneOptions,
    camera: Camera,
    uniform: SceneUniform,
    layers: Arc<Layers>,
    /// Of this camera, when a program asks for them.
    beams: Arc<OnceLock<Beams>>,
}

/// What is made of the samples when it is first asked for: a program on the GPU asks for none of it on the host.
#[derive(Debug, Default)]
struct Derived {
    above: OnceLock<Pyramid>,
    below: OnceLock<Pyramid>,
    crests: OnceLock<Pyramid>,
    /// The average mipmap as it is stored.
    means: OnceLock<Vec<u32>>,
    /// The same before it was rounded.
    exact_means: OnceLock<Means>,
}

impl Scene {
    pub fn new(terrain: Arc<Terrain>, options: &SceneOptions) -> Result<Scene, SceneError> {
        let (camera, uniform) = seen(&terrain, options)?;
        let derived = Arc::default();
        Ok(Scene {
            terrain,
            derived,
            micro: None,
            options: *options,
            camera,
            uniform,
            layers: Arc::default(),
            beams: Arc::default(),
        })
    }

    /// The same field seen otherwise; what was made of it is shared.
    pub fn with_options(&self, options: &SceneOptions) -> Result<Scene, SceneError> {
        let (camera, uniform) = seen(&self.terrain, options)?;
        Ok(Scene { options: *options, camera, uniform, beams: Arc::default(), ..self.clone() })
    }

    /// The same scene with these data layers.
    pub fn with_layers(&self, layers: Layers) -> Scene {
        Scene { layers: Arc::new(layers), ..self.clone() }
    }

    pub fn terrain(&self) -> &Arc<Terrain> {
        &self.terrain
    }

    /// The maximum mipmap.
    pub fn pyramid(&self) -> &Pyramid {
        self.derived.above.get_or_init(|| Pyramid::new(&self.terrain, Side::Above))
    }

    /// Where the rays of the picture's tiles may start.
    pub fn beams(&self) -> &Beams {
        self.beams.get_or_init(|| Beams::new(self))
    }

    /// The minimum mipmap.
    pub fn floors(&self) -> &Pyramid {
        self.derived.below.get_or_init(|| Pyramid::new(&self.terrain, Side::Below))
    }

    /// Upper bounds of the bicubic surface.
    pub fn crests(&self) -> &Pyramid {
        self.derived.crests.get_or_init(|| Pyramid::crests(&self.terrain))
    }

    /// Bytes of what has been made of the samples on the host.
    pub fn derived_bytes(&self) -> u64 {
        let Derived { above, below, crests, means, .. } = &*self.derived;
        let pyramids = [above, below, crests].map(|p| p.get().map_or(0, Pyramid::bytes));
        (pyramids.iter().sum::<usize>() + 4 * means.get().map_or(0, Vec::len)) as u64
    }

    /// The average mipmap as the shaders read it.
    pub fn mean_words(&self) -> &[u32] {
        self.derived.means.get_or_init(|| Means::new(&self.terrain).words(&self.terrain))
    }

    /// The same before it was rounded.
    pub(super) fn means(&self) -> &Means {
        self.derived.exact_means.get_or_init(|| Means::new(&self.terrain))
    }

    /// The micro-heightfield: the shipped one unless the host has bound another.
    pub fn micro(&self) -> &Arc<Micro> {
        self.micro.as_ref().unwrap_or_else(|| Micro::shipped())
    }

    /// The same scene with another micro-heightfield.
    pub fn with_micro(&self, micro: Arc<Micro>) -> Scene {
        Scene { micro: Some(micro), ..self.clone() }
    }

    pub fn options(&self) -> &SceneOptions {
        &self.options
    }

    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    pub fn layers(&self) -> &Layers {
        &self.layers
    }

    /// The record that the shaders read.
    pub fn uniform(&self) -> &SceneUniform {
        &self.uniform
    }

    /// Samples as the shaders read them: 16-bit ones two to a word, the first in the low half.
    pub fn sample_words(&self) -> Vec<u32> {
        match &self.terrain.samples {
            Samples::I16(data) => pack(data),
            Samples::F32(data) => data.iter().map(|v| v.to_bits()).collect(),
        }
    }

    /// Words that the samples take there.
    pub fn sample_word_count(&self) -> u64 {
        match &self.terrain.samples {
            Samples::I16(data) => data.len().div_ceil(2) as u64,
            Samples::F32(data) => data.len() as u64,
        }
    }
}

pub(super) fn pack(data: &[i16]) -> Vec<u32> {
    let word = |pair: &[i16]| {
        let low = u32::from(pair[0] as u16);
        low | u32::from(pair.get(1).copied().unwrap_or(0) as u16) << 16
    };
    data.chunks(2).map(word).collect()
}

fn seen(terrain: &Terrain, options: &SceneOptions) -> Result<(Camera, SceneUniform), SceneError> {
    if !(options.exaggerate > 0.0 && options.exaggerate.is_finite()) {
        return Err(SceneError::Exaggeration(options.exaggerate));
    }
    if !(options.sun.azimuth.is_finite() && options.sun.elevation.is_finite()) {
        return Err(SceneError::Sun);
    }
    let camera = Camera::new(&options.view, terrain, options.exaggerate, options.size)?;
    let uniform = uniform(terrain, &camera, options);
    Ok((camera, uniform))
}

fn uniform(terrain: &Terrain, camera: &Camera, options: &SceneOptions) -> SceneUniform {
    let single = |v: [f64; 3]| v.map(|x| x as f32);
    let spacing = terrain.spacing.map(|d| d as f32);
    let scale = terrain.scale * options.exaggerate;
    let offset = terrain.offset * options.exaggerate;
    let raw = |z: f64| ((z - terrain.offset) / terrain.scale) as f32;
    let mut levels = [[0; 4]; MAX_LEVELS];
    let (shapes, _) = pyramid::levels(terrain.width, terrain.height);
    for (row, level) in levels.iter_mut().zip(&shapes) {
        *row = [level.offset, level.width, level.height, 0];
    }
    SceneUniform {
        spacing,
        inverse_spacing: spacing.map(|d| 1.0 / d),
        relief: [(terrain.min * options.exaggerate) as f32, (terrain.max * options.exaggerate) as f32],
        raw_relief: [raw(terrain.min), raw(terrain.max)],
        z_scale: scale as f32,
        z_offset: offset as f32,
        z_inverse_scale: (1.0 / scale) as f32,
        top: shapes.len() as u32 - 1,
        size: [terrain.width, terrain.height],
        fuel: 5 * (terrain.width + terrain.height) + 64,
        projection: camera.projection as u32,
        eye: single(camera.eye.to_array()),
        near: 0.0,
        forward: single(camera.forward.to_array()),
        far: 1e9,
        across: single(camera.across.to_array()),
        zero: 0,
        down: single(camera.down.to_array()),
        voids: u32::from(terrain.voids > 0),
        sun_dir: single(options.sun.dir()),
        padding2: 0,
        sun_color: single(options.sun.color()),
        padding3: 0,
        middle: camera.middle.map(|x| x as f32),
        pixel_width: camera.pixel_width().map(|x| x as f32),
        levels,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_options_have_their_own_errors() {
        let terrain = Arc::new(Terrain::from_heights(2, 2, [1.0, 1.0], vec![0.0; 4]).unwrap());
        let with = |change: fn(&mut SceneOptions)| {
            let mut options = SceneOptions::default();
            change(&mut options);
            Scene::new(terrain.clone(), &options).unwrap_err()
        };
        assert!(matches!(with(|o| o.exaggerate = 0.0), SceneError::Exaggeration(_)));
        assert!(matches!(with(|o| o.sun.azimuth = f64::NAN), SceneError::Sun));
        assert!(matches!(with(|o| o.size = (0, 5)), SceneError::EmptyPicture));
        assert!(matches!("up".parse::<super::super::NamedView>(), Err(SceneError::UnknownView(_))));
    }
}
