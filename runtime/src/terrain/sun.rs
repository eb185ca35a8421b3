//! The sun: a direction, or where it stands over a place on the Earth at a time.

use super::field::Terrain;
use solar_positioning::{Location, RefractionCorrection, SolarPositions, delta_t, time::JulianDate};
use std::time::{SystemTime, UNIX_EPOCH};

/// Directions in degrees: azimuth clockwise from north, elevation above the horizon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    pub azimuth: f64,
    pub elevation: f64,
}

impl Default for Sun {
    /// From the north-west, as on maps.
    fn default() -> Sun {
        Sun { azimuth: 310.0, elevation: 34.0 }
    }
}

#[derive(Debug, thiserror::Error)]
pub enum SunError {
    #[error("the elevation data does not say where on the Earth it lies")]
    NoPlace,
    #[error("the elevation data lies in {0}, whose latitudes and longitudes are not known here")]
    Projected(String),
    #[error("latitude {0}, longitude {1} is no place on the Earth")]
    Place(f64, f64),
    #[error("the sun's place is not known for that time: {0}")]
    Time(String),
}

impl Sun {
    /// The sun over a place at a time, bent by the air as an observer at sea level sees it, within 0.001 degrees (Reda,
    /// Andreas 2004).
    pub fn at(time: SystemTime, [latitude, longitude]: [f64; 2]) -> Result<Sun, SunError> {
        if !(latitude.abs() <= 90.0 && longitude.abs() <= 180.0) {
            return Err(SunError::Place(latitude, longitude));
        }
        let wrong = |e: solar_positioning::Error| SunError::Time(e.to_string());
        let since = match time.duration_since(UNIX_EPOCH) {
            Ok(after) => after.as_secs_f64(),
            Err(before) => -before.duration().as_secs_f64(),
        };
        // Days from noon of the first day of the Julian period.
        let julian = since / 86_400.0 + 2_440_587.5;
        let year = 1970.0 + since / (365.2425 * 86_400.0);
        let behind = delta_t::estimate(year).map_err(wrong)?;
        let date = JulianDate::new(julian, behind).map_err(wrong)?;
        let air = RefractionCorrection::standard();
        let place = Location { latitude, longitude };
        let seen = SolarPositions::new().at_from_julian(date, place, 0.0, Some(air)).map_err(wrong)?;
        Ok(Sun { azimuth: seen.azimuth(), elevation: seen.elevation_angle() })
    }

    /// Unit vector towards the sun.
    pub fn dir(&self) -> [f64; 3] {
        let (sin_a, cos_a) = self.azimuth.to_radians().sin_cos();
        let (sin_e, cos_e) = self.elevation.to_radians().sin_cos();
        [sin_a * cos_e, cos_a * cos_e, sin_e]
    }

    /// White when high, red when low, as the air colours it.
    pub fn color(&self) -> [f64; 3] {
        let high = (self.elevation / 40.0).clamp(0.0, 1.0).sqrt();
        [1.0, 0.62 + 0.35 * high, 0.36 + 0.54 * high]
    }
}

/// Latitude and longitude of the field's middle, in degrees.
pub fn place(terrain: &Terrain) -> Result<[f64; 2], SunError> {
    let crs = terrain.crs.as_ref().ok_or(SunError::NoPlace)?;
    if !crs.geographic {
        return Err(SunError::Projected(crs.to_string()));
    }
    let half = |count: u32, step: f64| f64::from(count - 1) * step / 2.0;
    let longitude = crs.north_west[0] + half(terrain.width, crs.step[0]);
    let latitude = crs.north_west[1] - half(terrain.height, crs.step[1]);
    Ok([latitude, (longitude + 180.0).rem_euclid(360.0) - 180.0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn the_sun_of_a_map_stands_in_the_north_west() {
        let [x, y, z] = Sun { azimuth: 315.0, elevation: 45.0 }.dir();
        assert!(x < 0.0 && y > 0.0 && (z - 0.5f64.sqrt()).abs() < 1e-12);
    }

    /// The example of the algorithm's report: 2003-10-17 12:30:30 at UTC-7, Golden, Colorado: azimuth 194.34024, zenith angle
    /// 50.11162 at 820 hPa and 1830 m. At sea level the air bends a little more.
    #[test]
    fn the_published_example() {
        let time = UNIX_EPOCH + Duration::from_secs(1_066_419_030);
        let sun = Sun::at(time, [39.742476, -105.1786]).unwrap();
        assert!((sun.azimuth - 194.34024).abs() < 1e-3, "{sun:?}");
        assert!((sun.elevation - (90.0 - 50.11162)).abs() < 5e-3, "{sun:?}");
        let later = Sun::at(time + Duration::from_secs(60), [39.742476, -105.1786]).unwrap();
        assert!((later.azimuth - sun.azimuth).abs() > 0.1);
    }

    #[test]
    fn a_place_needs_degrees() {
        let [latitude, longitude] = place(&Terrain::builtin()).unwrap();
        assert!((latitude - 35.4).abs() < 0.2 && (longitude - 138.7).abs() < 0.2, "{latitude} {longitude}");
        let nowhere = Terrain::from_heights(2, 2, [1.0, 1.0], vec![0.0; 4]).unwrap();
        assert!(matches!(place(&nowhere), Err(SunError::NoPlace)));
        let mut projected = Terrain::builtin();
        projected.crs.as_mut().unwrap().geographic = false;
        assert!(matches!(place(&projected), Err(SunError::Projected(_))));
        assert!(matches!(Sun::at(UNIX_EPOCH, [91.0, 0.0]), Err(SunError::Place(..))));
    }
}
