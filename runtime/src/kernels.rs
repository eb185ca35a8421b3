//! A program on a device with the scene it looks at and the engines of its bakes.

use crate::bake::{self, Inputs};
use crate::config::Config;
use crate::error::RunError;
use crate::gpu::{self, Engine, Gpu};
use crate::gpu_terrain::{GpuTerrain, UploadError};
use crate::machine::Job;
use crate::terrain::Scene;
use crate::terrain::wgsl::{self, Format, Uses};
use ghyll_compiler::back::Back;
use ghyll_compiler::core::Intrinsic;
use ghyll_compiler::typed::FunctionId;

/// The scene with room for the bakes, and what the program and its bakes use of it; none if they do not look at it.
fn looked_at(job: &Job) -> Option<(Scene, Uses)> {
    let compiled = job.compiled;
    let backs = compiled.bakes.iter().map(|bake| &bake.back).chain([&compiled.back]);
    let intrinsics: Vec<Intrinsic> = backs.flat_map(|back| back.wgsl.intrinsics.clone()).collect();
    let scene = job.scene.filter(|_| !intrinsics.is_empty())?;
    let scene = scene.with_layers(bake::reserved(compiled, scene));
    let uses = wgsl::wgsl(&intrinsics, Format::of(scene.terrain())).uses;
    Some((scene, uses))
}

/// Why the scene cannot be bound on the device, if it cannot.
pub fn too_large(job: &Job, gpu: &Gpu) -> Option<UploadError> {
    let (scene, uses) = looked_at(job)?;
    GpuTerrain::fits(&gpu.device.limits(), &scene, uses).err()
}

pub struct Kernels {
    pub engine: Engine,
    terrain: Option<GpuTerrain>,
    bakes: Vec<BakeEngine>,
}

struct BakeEngine {
    engine: Engine,
    /// Where its values begin in the buffer of rasters, in bytes, and how many bytes they are.
    place: (u64, u64),
    /// What the values were computed from; none if they were not yet.
    inputs: Option<Inputs>,
}

impl Kernels {
    /// Uploads what the program and its bakes use of the scene, and bakes.
    pub fn new(job: &Job, gpu: &Gpu, config: &Config, components: u32) -> Result<Kernels, RunError> {
        let compiled = job.compiled;
        let looked_at = looked_at(job);
        let format = looked_at.as_ref().map(|(scene, _)| Format::of(scene.terrain()));
        let (mut terrain, mut bound) = (None, None);
        if let Some((scene, uses)) = &looked_at {
            let uploaded = GpuTerrain::new(&gpu.device, &gpu.queue, scene, *uses)
                .map_err(|e| RunError::Device(e.to_string()))?;
            let layout = uploaded.layout(&gpu.device);
            let group = uploaded.bind_group(&gpu.device, &layout);
            let bytes = uploaded.bytes().iter().sum();
            let layout = gpu::SceneLayout { layout, bindings: uploaded.bindings() };
            (terrain, bound) = (Some(uploaded), Some(gpu::Scene { layout, group, bytes }));
        }
        let engine = |function: FunctionId, back: &Back, components: u32| {
            let prelude = format.map(|format| wgsl::wgsl(&back.wgsl.intrinsics, format).text);
            let scene = bound.clone();
            let code = job.code(function, back, prelude.unwrap_or_default());
            Engine::with_components(gpu, code, config.clone(), scene, components)
        };
        let mut bakes = Vec::new();
        for bake in &compiled.bakes {
            let (scene, _) =
                looked_at.as_ref().ok_or_else(|| RunError::Internal("a bake without a scene".into()))?;
            let words = scene.layers().get(bake.slot).map_or(0, |layer| layer.raster().words());
            bakes.push(BakeEngine {
                engine: engine(bake.function, &bake.back, bake.components)?,
                place: (4 * scene.layers().first(bake.slot), 4 * words),
                inputs: None,
            });
        }
        let engine = engine(compiled.entry, &compiled.back, components)?;
        let mut kernels = Kernels { engine, terrain, bakes };
        kernels.update(job, gpu, config)?;
        Ok(kernels)
    }

    /// Whether the buffers are those of the scene's field.
    pub fn serves(&self, scene: &Scene) -> bool {
        self.terrain.as_ref().is_none_or(|terrain| terrain.serves(scene))
    }

    /// Takes the job's camera, sun, exaggeration and live parameters, and bakes anew what depends on them.
    pub fn update(&mut self, job: &Job, gpu: &Gpu, config: &Config) -> Result<(), RunError> {
        let live = job.live_words(config)?;
        self.engine.set_live(&live);
        let (Some(terrain), Some(scene)) = (&self.terrain, job.scene) else { return Ok(()) };
        if !terrain.update(&gpu.queue, scene) {
            return Err(RunError::Internal("kernels serve one field".into()));
        }
        let inputs = bake::inputs(job.compiled, scene.uniform(), &live);
        let [width, height] = scene.uniform().size;
        for ((kept, bake), inputs) in self.bakes.iter_mut().zip(&job.compiled.bakes).zip(inputs) {
            if kept.inputs.as_ref() == Some(&inputs) {
                continue;
            }
            kept.engine.set_live(&live);
            kept.engine.draw(width, height, bake.back.entry.0)?;
            let (offset, size) = kept.place;
            terrain.copy_layer(gpu, kept.engine.image(), offset, size);
            kept.inputs = Some(inputs);
        }
        Ok(())
    }
}
