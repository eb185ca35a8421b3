//! One value for each sample of a field: what a map entry yields.

use crate::image::{Format, Image, ImageError};
use crate::terrain::Terrain;
use crate::terrain::geotags::GeoTags;
use std::path::Path;

/// Values by sample, rows from north to south, with the place of the field; NaN where the field has a void.
#[derive(Clone, Debug)]
pub struct Map {
    image: Image,
    tags: GeoTags,
}

impl Map {
    /// Takes the values of all samples and leaves out those of voids.
    pub fn new(mut image: Image, terrain: &Terrain) -> Map {
        let row = image.width as usize * image.components as usize;
        let rows = image.data.chunks_exact_mut(row).zip((0..terrain.height).rev());
        for (values, r) in rows {
            for (value, c) in values.chunks_exact_mut(image.components as usize).zip(0..) {
                if terrain.sample(c, r).is_none() {
                    value.fill(f32::NAN);
                }
            }
        }
        Map { image, tags: GeoTags::of(terrain) }
    }

    pub fn image(&self) -> &Image {
        &self.image
    }

    /// Numbers that a picture of bytes cannot hold: those outside 0 to 1.
    pub fn clamped(&self) -> usize {
        self.image.data.iter().filter(|x| **x < 0.0 || **x > 1.0).count()
    }

    /// Writes the map in the format that the name's ending names; a TIFF is georeferenced as the field is.
    pub fn save(&self, file: impl AsRef<Path>) -> Result<(), ImageError> {
        let file = file.as_ref();
        match Format::of(file)? {
            Format::Tiff => self.image.save_with(file, Some(&self.tags)),
            _ => self.image.save(file),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_of_voids_are_left_out() {
        // The southern row comes first in a field, the northern one in a map.
        let terrain = Terrain::from_heights(2, 2, [1.0, 1.0], vec![f32::NAN, 1.0, 1.0, 1.0]).unwrap();
        let map = Map::new(Image::new(2, 2, 2, vec![5.0; 8]).unwrap(), &terrain);
        assert_eq!(map.image().pixel(0, 0), [5.0, 5.0]);
        assert!(map.image().pixel(0, 1).iter().all(|x| x.is_nan()));
        assert_eq!(map.image().pixel(1, 1), [5.0, 5.0]);
    }
}
