//! Evaluates baked functions for every sample of the field, by the machine that reads them afterwards.

use crate::config::Config;
use crate::error::RunError;
use crate::machine::Job;
use crate::terrain::layout::SceneUniform;
use crate::terrain::raster::Texels;
use crate::terrain::{Layer, Layers, Raster, Scene};
use crate::twin::Twin;
use ghyll_compiler::bake::Bake;
use ghyll_compiler::compile::Compiled;
use ghyll_compiler::core::Intrinsic;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Everything beside the field and the rasters that a bake's values depend on. While it stays the same, so do they.
pub type Inputs = Vec<u32>;

/// Inputs of every bake, those of the bakes that it reads included.
pub fn inputs(compiled: &Compiled, uniform: &SceneUniform, live: &[u32]) -> Vec<Inputs> {
    let mut of_slot: BTreeMap<u32, Inputs> = BTreeMap::new();
    let mut all = Vec::new();
    for bake in &compiled.bakes {
        let mut inputs = own_inputs(bake, uniform, live);
        for read in bake.reads.iter().filter_map(|slot| of_slot.get(slot)) {
            inputs.extend(read);
        }
        of_slot.insert(bake.slot, inputs.clone());
        all.push(inputs);
    }
    all
}

fn own_inputs(bake: &Bake, uniform: &SceneUniform, live: &[u32]) -> Inputs {
    let uses = |asked: &[Intrinsic]| asked.iter().any(|i| bake.back.wgsl.intrinsics.contains(i));
    let mut inputs = vec![uniform.z_scale.to_bits(), uniform.z_offset.to_bits()];
    if uses(&[Intrinsic::SunDir, Intrinsic::SunColor]) {
        inputs.extend(uniform.sun_dir.iter().chain(&uniform.sun_color).map(|x| x.to_bits()));
    }
    if uses(&[Intrinsic::Camera, Intrinsic::BeamStart, Intrinsic::PixelWidth, Intrinsic::Picture]) {
        inputs.extend(bytemuck::cast_slice::<_, u32>(std::slice::from_ref(uniform)));
    }
    if bake.back.wgsl.uses_live {
        inputs.extend(live);
    }
    inputs
}

/// The layer that a bake's values make, one for each sample.
fn layer(bake: &Bake, scene: &Scene, texels: Texels) -> Layer {
    let [width, height] = scene.uniform().size;
    Layer::of_samples(Arc::new(Raster::computed(width, height, bake.components, texels)), scene.uniform())
}

/// The layers with room for every bake, to be filled on the device.
pub fn reserved(compiled: &Compiled, scene: &Scene) -> Layers {
    let mut layers = scene.layers().clone();
    for bake in &compiled.bakes {
        layers.set(bake.slot, layer(bake, scene, Texels::Reserved));
    }
    layers
}

/// The twin's scene with what it has baked.
pub struct BakedScene {
    scene: Scene,
    inputs: Vec<Inputs>,
}

impl BakedScene {
    /// Bakes what is not in `kept` with the same inputs.
    pub fn new(
        job: &Job,
        scene: &Scene,
        config: &Config,
        kept: Option<BakedScene>,
    ) -> Result<BakedScene, RunError> {
        let live = job.live_words(config)?;
        let inputs = inputs(job.compiled, scene.uniform(), &live);
        let size = (scene.uniform().size[0], scene.uniform().size[1]);
        let mut scene = scene.clone();
        for (at, bake) in job.compiled.bakes.iter().enumerate() {
            let same = |kept: &BakedScene| kept.inputs[at] == inputs[at];
            let old =
                kept.as_ref().filter(|kept| same(kept)).and_then(|kept| kept.scene.layers().get(bake.slot));
            let layer = match old {
                Some(layer) => layer.clone(),
                None => {
                    let mut twin = Twin::new(&bake.back.table)?;
                    twin.set_live(&live);
                    let (data, _) =
                        twin.render(size, bake.components, bake.back.entry, config, Some(&scene))?;
                    layer(bake, &scene, Texels::Floats(data))
                }
            };
            let mut layers = scene.layers().clone();
            layers.set(bake.slot, layer);
            scene = scene.with_layers(layers);
        }
        Ok(BakedScene { scene, inputs })
    }

    pub fn scene(&self) -> &Scene {
        &self.scene
    }
}
