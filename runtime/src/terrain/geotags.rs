//! What a GeoTIFF says about the place of its samples: taken from the field's file where it was one, else written anew.

use super::field::{Georeference, Terrain};

/// The keys of a reference system as a file holds them.
#[derive(Clone, Debug, PartialEq)]
pub struct GeoKeys {
    pub directory: Vec<u16>,
    pub doubles: Vec<f64>,
    pub text: String,
}

pub(super) const MODEL_TYPE: u16 = 1024;
pub(super) const RASTER_TYPE: u16 = 1025;
pub(super) const GEOGRAPHIC_CRS: u16 = 2048;
pub(super) const PROJECTED_CRS: u16 = 3072;
/// Value of `RASTER_TYPE`: coordinates are those of samples, not of the corners of their areas.
pub(super) const PIXEL_IS_POINT: u16 = 2;

impl GeoKeys {
    /// Value of a key that lies in the directory itself.
    pub fn get(&self, key: u16) -> Option<u16> {
        let mut rows = self.directory.chunks_exact(4).skip(1);
        rows.find(|row| row[0] == key && row[1] == 0).map(|row| row[3])
    }

    /// Keys for a reference system that is known by its code, or only as one of degrees or of lengths.
    fn of(place: &Georeference) -> GeoKeys {
        let (model, key) = if place.geographic { (2, GEOGRAPHIC_CRS) } else { (1, PROJECTED_CRS) };
        let mut rows = vec![[MODEL_TYPE, 0, 1, model], [RASTER_TYPE, 0, 1, 1]];
        rows.extend(place.epsg.and_then(|code| u16::try_from(code).ok()).map(|code| [key, 0, 1, code]));
        rows.insert(0, [1, 1, 0, rows.len() as u16]);
        GeoKeys { directory: rows.concat(), doubles: Vec::new(), text: String::new() }
    }
}

/// Tags of a raster with one texel for each sample of a field, rows from north to south.
#[derive(Clone, Debug, PartialEq)]
pub struct GeoTags {
    /// Distance of texels, eastwards and southwards.
    pub scale: [f64; 2],
    /// Where texel coordinates (0, 0) lie.
    pub corner: [f64; 2],
    pub keys: Option<GeoKeys>,
    /// The number that stands for a missing one.
    pub nodata: Option<f64>,
}

impl GeoTags {
    /// A field without a place on the Earth lies in world metres.
    pub fn of(terrain: &Terrain) -> GeoTags {
        let (scale, centre, keys) = match &terrain.crs {
            Some(place) => {
                (place.step, place.north_west, Some(place.keys.clone().unwrap_or_else(|| GeoKeys::of(place))))
            }
            None => (terrain.spacing, [0.0, terrain.extent()[1]], None),
        };
        let point = keys.as_ref().and_then(|keys| keys.get(RASTER_TYPE)) == Some(PIXEL_IS_POINT);
        let half = if point { 0.0 } else { 0.5 };
        let corner = [centre[0] - half * scale[0], centre[1] + half * scale[1]];
        GeoTags { scale, corner, keys, nodata: terrain.nodata }
    }
}
