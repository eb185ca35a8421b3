//! Binds a program's rasters to data: by name, only those that are read, placed over the scene's field.

use crate::terrain::layers::PlaceError;
use crate::terrain::{DemError, Layer, Raster, Scene};
use ghyll_compiler::compile::Compiled;
use ghyll_compiler::layout;
use ghyll_compiler::similar;
use ghyll_compiler::typed::Module;
use std::sync::Arc;

#[derive(Debug, thiserror::Error)]
pub enum BindError {
    #[error("{}", unknown(name, have))]
    Unknown { name: String, have: Vec<String> },
    #[error("the raster `{0}` is bound twice; bind one file to it")]
    Twice(String),
    #[error("the program reads the raster `{0}`, but nothing is bound to it; give --raster {0}=FILE")]
    Unbound(String),
    #[error(
        "the raster `{name}` is declared to hold {}, but what is bound to it has {}; declare it `raster {name}: {};` or \
         bind other data",
        channels(*wanted), channels(*found), type_of(*found)
    )]
    Channels { name: String, wanted: u32, found: u32 },
    #[error("the raster `{name}`: {source}")]
    Place { name: String, source: PlaceError },
    #[error("the raster `{name}`: {source}")]
    Read { name: String, source: DemError },
}

impl BindError {
    /// The host named something that the program does not have, rather than data being wrong.
    pub fn is_usage(&self) -> bool {
        matches!(self, BindError::Unknown { .. } | BindError::Twice(_))
    }
}

fn unknown(name: &str, have: &[String]) -> String {
    let start = format!("there is no raster `{name}`");
    match (similar(name, have.iter().map(String::as_str)), have) {
        (Some(meant), _) => format!("{start}; did you mean `{meant}`?"),
        (None, []) => format!("{start}: the program has none"),
        (None, have) => format!("{start} (the program has: {})", have.join(", ")),
    }
}

fn channels(n: u32) -> String {
    if n == 1 { "1 channel".into() } else { format!("{n} channels") }
}

fn type_of(components: u32) -> String {
    if components == 1 { "f32".into() } else { format!("vec{components}") }
}

/// Refuses names that the program does not have, and names given twice.
pub fn check_names<'n>(module: &Module, names: impl Iterator<Item = &'n str>) -> Result<(), BindError> {
    let mut seen = Vec::new();
    for name in names {
        if !module.rasters.iter().any(|raster| raster.name == name) {
            let have = module.rasters.iter().map(|raster| raster.name.clone()).collect();
            return Err(BindError::Unknown { name: name.into(), have });
        }
        if seen.contains(&name) {
            return Err(BindError::Twice(name.into()));
        }
        seen.push(name);
    }
    Ok(())
}

/// The scene with every raster that the program reads. `open` gives the data of a name, none if nothing is bound to it;
/// it is asked only for what is read.
pub fn bind(
    module: &Module,
    compiled: &Compiled,
    scene: &Scene,
    mut open: impl FnMut(&str) -> Option<Result<Arc<Raster>, DemError>>,
) -> Result<Scene, BindError> {
    let mut layers = scene.layers().clone();
    for id in &compiled.rasters {
        let definition = &module.rasters[id.0 as usize];
        let name = &definition.name;
        let raster = open(name).ok_or_else(|| BindError::Unbound(name.clone()))?;
        let raster = raster.map_err(|source| BindError::Read { name: name.clone(), source })?;
        let wanted = layout::scalars(module, &definition.ty).map_or(0, |scalars| scalars.len() as u32);
        if raster.components != wanted {
            return Err(BindError::Channels { name: name.clone(), wanted, found: raster.components });
        }
        let layer = Layer::placed(raster, scene.terrain());
        layers.set(id.0, layer.map_err(|source| BindError::Place { name: name.clone(), source })?);
    }
    Ok(scene.with_layers(layers))
}
