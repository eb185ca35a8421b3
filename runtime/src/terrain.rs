//! The height field and everything that is asked of it: reading elevation data, the scene with camera and sun,
//! surfaces, exact intersection. The maximum mipmap is that of the paper's section 3.1 (Tevs, Ihrke, Seidel 2008).
//!
//! A sample is stored as a raw number; its height is `raw * scale + offset`. Integer data stays 16 bits wide, and
//! rays are carried into raw units instead of heights out of them.

pub mod beams;
mod bicubic;
pub mod dem;
mod exact;
mod field;
mod framing;
pub mod geotags;
mod intrinsics;
pub mod layers;
pub mod layout;
mod means;
mod micro;
mod orbit;
mod patch;
pub mod pyramid;
mod range;
pub mod raster;
mod ray;
pub mod scene;
pub mod steps;
pub mod sun;
mod surface;
#[cfg(test)]
mod tests;
pub(crate) mod transforms;
mod view;
mod walk;
pub mod wgsl;

pub use dem::{DemError, DemOptions, Encoding, Voids};
pub use field::{Georeference, Samples, Terrain, VOID_F32, VOID_I16};
pub use layers::{Layer, Layers};
pub use micro::Micro;
pub use orbit::Orbit;
pub use pyramid::Pyramid;
pub use raster::Raster;
pub use scene::{Scene, SceneError, SceneOptions};
pub use sun::{Sun, SunError};
pub use view::{Camera, NAMED_FOV, NamedView, Projection, STANDING, Stand, View};
