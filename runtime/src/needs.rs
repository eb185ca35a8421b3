//! What a picture with bakes needs at least. Bakes and picture are drawn one after the other, and each only knows what it asks
//! for itself: advice from one of them would lead to the refusal of the next.

use crate::error::RunError;
use crate::gpu;
use crate::machine::Job;
use crate::memory::Memory;
use crate::terrain::layers::RECORD;
use crate::world::World;

/// Bytes.
pub struct Needs {
    /// Each bake's values, as long as the program runs.
    bakes: Vec<u64>,
    picture: u64,
    /// What the field takes on the twin; a device tells it with the bakes.
    field: Option<u64>,
}

impl Needs {
    pub fn on_device(job: &Job, size: (u32, u32)) -> Needs {
        Needs::new(job, size, None)
    }

    pub fn on_twin(job: &Job, size: (u32, u32)) -> Needs {
        Needs::new(job, size, job.scene.map(World::bytes))
    }

    fn new(job: &Job, (width, height): (u32, u32), field: Option<u64>) -> Needs {
        let bytes =
            |[w, h]: [u32; 2], components: u32| 4 * u64::from(w) * u64::from(h) * u64::from(components);
        let bakes = job.scene.map_or(Vec::new(), |scene| {
            let size = scene.uniform().size;
            job.compiled.bakes.iter().map(|bake| bytes(size, bake.components)).collect()
        });
        let picture = bytes([width, height], job.compiled.result_words(&job.checked.module));
        Needs { bakes, picture, field }
    }

    /// The error with all that is needed, if it is one of memory.
    pub fn whole(&self, error: RunError) -> RunError {
        let RunError::TooLittleMemory { needed, limit } = error else { return error };
        let kept: u64 = self.bakes.iter().sum();
        let largest = self.bakes.iter().copied().max().unwrap_or(0);
        let needed = match self.field {
            _ if self.bakes.is_empty() => needed,
            Some(terrain) => {
                let bakes = kept + self.bakes.len() as u64 * 4 * RECORD as u64;
                Memory { image: self.picture, bakes, terrain, ..needed }
            }
            // On a device a bake is drawn as a picture and copied to where it is kept.
            None => {
                let (image, drawn) = if largest > self.picture { (0, largest) } else { (self.picture, 0) };
                let readback = needed.readback.max(gpu::readback_of_picture(image + drawn));
                let terrain = needed.terrain.saturating_sub(kept);
                Memory { image, bakes: kept + drawn, terrain, readback, ..needed }
            }
        };
        RunError::TooLittleMemory { needed, limit }
    }
}
