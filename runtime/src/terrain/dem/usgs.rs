//! USGS ASCII DEM (.dem): a record of type A that describes the grid, then one record of type B for each column, from
//! west to east, with heights from south to north. Columns may begin and end anywhere: quadrangles are skew in UTM.
//! Source: USGS, Standards for Digital Elevation Models, part 2.

use super::geo::metres_per_degree;
use super::grid::{Grid, Values};
use super::{DemError, DemOptions, check_claim};
use crate::terrain::field::{Georeference, Terrain};

/// Length of the A record and of every block of a B record.
const BLOCK: usize = 1024;
/// What stands for a missing sample where the file has none.
const MISSING: f32 = -32767.0;
const FEET: f64 = 0.3048;

/// Numbers of the A record, by their place in it (from 0).
struct Header {
    /// 0 geographic, 1 UTM.
    system: u16,
    zone: u16,
    feet_on_ground: bool,
    arc_seconds: bool,
    feet_of_height: bool,
    /// Of the quadrangle's corners: least x, y and greatest x, y.
    hull: [f64; 4],
    resolution: [f64; 3],
    columns: usize,
}

pub(super) fn read(file: &str, bytes: &[u8], options: &DemOptions) -> Result<Terrain, DemError> {
    let text = |range: std::ops::Range<usize>| {
        let part = bytes.get(range).and_then(|b| std::str::from_utf8(b).ok());
        part.map(str::trim).ok_or_else(|| DemError::truncated(file, "its header is cut off or not text"))
    };
    let number = |range: std::ops::Range<usize>, what: &str| {
        let word = text(range)?.replace(['D', 'd'], "E");
        word.parse::<f64>().ok().filter(|x| x.is_finite()).ok_or_else(|| {
            let mend = "it is no USGS DEM, or a damaged one; get the file again";
            DemError::unsupported(file, format!("its {what} is `{word}`"), mend)
        })
    };
    let whole = |range, what| number(range, what).map(|x| x.clamp(0.0, 1e6) as usize);

    // The A record.
    let corner = |i: usize| number(546 + 24 * i..570 + 24 * i, "quadrangle");
    let mut hull = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
    for i in 0..8 {
        let axis = i % 2;
        hull[axis] = hull[axis].min(corner(i)?);
        hull[axis + 2] = hull[axis + 2].max(corner(i)?);
    }
    let ground = whole(528..534, "unit of the ground")?;
    let header = Header {
        system: whole(156..162, "reference system")? as u16,
        zone: whole(162..168, "zone")? as u16,
        feet_on_ground: ground == 1,
        arc_seconds: ground == 3,
        feet_of_height: whole(534..540, "unit of height")? == 1,
        hull,
        resolution: [
            number(816..828, "resolution")?,
            number(828..840, "resolution")?,
            number(840..852, "resolution")?,
        ],
        columns: whole(858..864, "number of columns")?,
    };
    let [dx, dy, dz] = header.resolution;
    if !(dx > 0.0 && dy > 0.0 && dz > 0.0) {
        return Err(DemError::lying(file, format!("its resolution is {dx} x {dy} x {dz}")));
    }
    // Samples lie at multiples of the resolution; the grid holds the whole quadrangle, as GDAL's does.
    let south = (header.hull[1] / dy).floor() * dy;
    let rows = ((header.hull[3] / dy).ceil() - south / dy).max(0.0) as u64 + 1;
    let (width, height) = (header.columns as u64, rows);
    check_claim(file, (width, height), 6, bytes.len() as u64, true)?;

    let mut heights = vec![MISSING; (width * height) as usize];
    let mut west = None;
    let mut at = BLOCK;
    for column in 0..header.columns {
        let short = || DemError::truncated(file, format!("it has {column} of {width} columns"));
        let head = bytes.get(at..at + 144).ok_or_else(short)?;
        let word = |range: std::ops::Range<usize>| {
            let word = std::str::from_utf8(&head[range]).unwrap_or_default().trim().replace(['D', 'd'], "E");
            word.parse::<f64>().ok().filter(|x| x.is_finite()).ok_or_else(short)
        };
        let count = word(12..18)?.clamp(0.0, 1e6) as usize;
        let (x, y, datum) = (word(24..48)?, word(48..72)?, word(72..96)?);
        west.get_or_insert(x);
        let first = ((y - south) / dy).round();
        // The first block has room for 146 heights of six characters behind its head, the others for 170.
        let mut place = at + 144;
        let mut room = 146;
        for i in 0..count {
            if room == 0 {
                at += BLOCK;
                (place, room) = (at, 170);
            }
            let cell = bytes.get(place..place + 6).ok_or_else(short)?;
            let value = std::str::from_utf8(cell).ok().and_then(|w| w.trim().parse::<f64>().ok());
            let value = value.ok_or_else(short)?;
            let row = first + i as f64;
            if value > -32767.0 && (0.0..height as f64).contains(&row) {
                heights[row as usize * width as usize + column] = (value * dz + datum) as f32;
            }
            place += 6;
            room -= 1;
        }
        at += BLOCK;
    }
    let whole = heights.iter().all(|z| z.fract() == 0.0);
    let place = georeference(&header, west.unwrap_or(header.hull[0]), south + (height - 1) as f64 * dy);
    let spacing = options.spacing.unwrap_or_else(|| spacing(&header, &place, height));
    Grid {
        width: width as u32,
        height: height as u32,
        values: if whole {
            Values::I32(heights.into_iter().map(|z| z as i32).collect())
        } else {
            Values::F32(heights)
        },
        nodata: options.nodata.or(Some(f64::from(MISSING))),
        scale: if header.feet_of_height { FEET } else { 1.0 },
        offset: 0.0,
        spacing,
        crs: Some(place),
        format: "USGS DEM".to_owned(),
        south_first: true,
    }
    .terrain(file)
}

fn georeference(header: &Header, west: f64, north: f64) -> Georeference {
    // Old ones are on NAD27, and say so nowhere that is reliable.
    let utm = header.system == 1 && (1..=60).contains(&header.zone);
    let unit = if header.arc_seconds { 1.0 / 3600.0 } else { 1.0 };
    Georeference {
        epsg: utm.then(|| 26700 + u32::from(header.zone)),
        geographic: header.system == 0,
        north_west: [west * unit, north * unit],
        step: [header.resolution[0] * unit, header.resolution[1] * unit],
        keys: None,
    }
}

fn spacing(header: &Header, place: &Georeference, height: u64) -> [f64; 2] {
    if place.geographic {
        let middle = place.north_west[1] - 0.5 * (height - 1) as f64 * place.step[1];
        let [east, north] = metres_per_degree(middle.clamp(-89.9, 89.9));
        return [place.step[0] * east, place.step[1] * north];
    }
    place.step.map(|d| if header.feet_on_ground { d * FEET } else { d })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two columns, of three and two samples; the second begins a row further north.
    fn small() -> Vec<u8> {
        let mut a = vec![b' '; BLOCK];
        let mut put = |at: usize, text: String| a[at..at + text.len()].copy_from_slice(text.as_bytes());
        for (at, n) in [(156, 1), (162, 10), (528, 2), (534, 2), (540, 4), (852, 1), (858, 2)] {
            put(at, format!("{n:6}"));
        }
        for (i, x) in [600.0, 0.0, 600.0, 60.0, 630.0, 60.0, 630.0, 0.0].into_iter().enumerate() {
            put(546 + 24 * i, format!("{x:20.3}D+00"));
        }
        put(816, "0.300000E+02".into());
        put(828, "0.300000E+02".into());
        put(840, "0.100000E+01".into());
        for (column, first, heights) in [(0, 0, vec![5, 6, 7]), (1, 1, vec![8, -32767])] {
            let mut b = vec![b' '; BLOCK];
            let mut put = |at: usize, text: String| b[at..at + text.len()].copy_from_slice(text.as_bytes());
            put(12, format!("{:6}", heights.len()));
            put(24, format!("{:20.3}D+00", 600.0 + 30.0 * f64::from(column)));
            put(48, format!("{:20.3}D+00", 30.0 * f64::from(first)));
            put(72, format!("{:20.3}D+00", 100.0));
            for (i, z) in heights.iter().enumerate() {
                put(144 + 6 * i, format!("{z:6}"));
            }
            a.extend(b);
        }
        a
    }

    #[test]
    fn columns_run_from_south_to_north() {
        let terrain = read("a.dem", &small(), &DemOptions::default()).unwrap();
        assert_eq!((terrain.width, terrain.height, terrain.voids), (2, 3, 2));
        assert_eq!(
            (0..3).map(|r| terrain.sample(0, r)).collect::<Vec<_>>(),
            [Some(105.0), Some(106.0), Some(107.0)]
        );
        assert_eq!((0..3).map(|r| terrain.sample(1, r)).collect::<Vec<_>>(), [None, Some(108.0), None]);
        assert_eq!(terrain.spacing, [30.0, 30.0]);
        assert_eq!(terrain.crs.unwrap().to_string(), "EPSG:26710");
    }

    /// As where a quadrangle is skew in UTM: its corners lie between samples.
    #[test]
    fn a_quadrangle_between_samples_is_held_whole() {
        let mut bytes = small();
        for i in [0, 3] {
            bytes[546 + 48 * i + 24..546 + 48 * i + 44].copy_from_slice(format!("{:20.3}", -3.0).as_bytes());
        }
        let terrain = read("a.dem", &bytes, &DemOptions::default()).unwrap();
        assert_eq!((terrain.height, terrain.voids), (4, 4));
        assert_eq!(terrain.sample(0, 1), Some(105.0));
        assert_eq!(terrain.sample(0, 0), None);
    }

    #[test]
    fn a_cut_file_is_refused() {
        let bytes = small();
        for end in [10, 900, BLOCK, BLOCK + 150, 2 * BLOCK + 100] {
            assert!(read("a.dem", &bytes[..end], &DemOptions::default()).is_err(), "{end}");
        }
    }
}
