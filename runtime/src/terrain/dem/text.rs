//! ESRI ASCII grid (.asc): a header of keys and values, then rows of numbers from north to south.

use super::geo::metres_per_degree;
use super::grid::{Grid, Values};
use super::{DemError, DemOptions, check_claim};
use crate::terrain::field::{Georeference, Terrain};

const KEYS: &[&str] = &[
    "ncols",
    "nrows",
    "cellsize",
    "dx",
    "dy",
    "xllcorner",
    "xllcenter",
    "yllcorner",
    "yllcenter",
    "nodata_value",
];

pub(super) fn read(file: &str, bytes: &[u8], options: &DemOptions) -> Result<Terrain, DemError> {
    let text = std::str::from_utf8(bytes).map_err(|_| DemError::truncated(file, "it is not text"))?;
    let mut words = text.split_ascii_whitespace().peekable();
    let mut header = [None::<f64>; KEYS.len()];
    while let Some(word) = words.peek() {
        let Some(at) = KEYS.iter().position(|k| k.eq_ignore_ascii_case(word)) else { break };
        words.next();
        let value = words.next().and_then(|w| w.parse().ok());
        header[at] =
            Some(value.ok_or_else(|| DemError::lying(file, format!("`{}` has no number", KEYS[at])))?);
    }
    let get = |key: &str| KEYS.iter().position(|k| *k == key).and_then(|at| header[at]);
    let need =
        |key: &str| get(key).ok_or_else(|| DemError::lying(file, format!("its header has no `{key}`")));
    let side = |key: &str| {
        let n = need(key)?;
        let whole = n >= 0.0 && n.fract() == 0.0 && n < 1e9;
        if whole { Ok(n as u64) } else { Err(DemError::lying(file, format!("`{key}` is {n}"))) }
    };
    let (width, height) = (side("ncols")?, side("nrows")?);
    // A number and the space behind it take two bytes.
    check_claim(file, (width, height), 2, bytes.len() as u64 + 1, false)?;

    let step = match (get("cellsize"), get("dx"), get("dy")) {
        (Some(size), ..) => [size, size],
        (None, Some(dx), Some(dy)) => [dx, dy],
        _ => return Err(DemError::lying(file, "its header has no `cellsize`")),
    };
    if let Some(size) = step.into_iter().find(|size| !(size.is_finite() && *size > 0.0)) {
        let what = format!("its header says that samples are {size} apart");
        return Err(DemError::unsupported(
            file,
            what,
            "correct `cellsize` (or `dx` and `dy`) in it: it is a distance above 0",
        ));
    }
    let place = georeference(&get, step, height);
    let spacing = options.spacing.unwrap_or_else(|| match &place {
        Some(place) if place.geographic => {
            let middle = place.north_west[1] - 0.5 * (height - 1) as f64 * step[1];
            let [east, north] = metres_per_degree(middle);
            [step[0] * east, step[1] * north]
        }
        _ => step,
    });
    let mut values = Vec::with_capacity((width * height) as usize);
    for word in words.by_ref().take((width * height) as usize) {
        let value = word.parse::<f64>();
        values.push(value.map_err(|_| DemError::lying(file, format!("`{word}` is not a number")))?);
    }
    if (values.len() as u64) < width * height {
        return Err(DemError::truncated(
            file,
            format!("it has {} of {} samples", values.len(), width * height),
        ));
    }
    let more = words.count();
    if more > 0 {
        let held = values.len() + more;
        return Err(DemError::too_many(file, held as u64, &[width, height]));
    }
    let whole = values.iter().all(|v| v.fract() == 0.0 && v.abs() < 1e9);
    Grid {
        width: width as u32,
        height: height as u32,
        values: if whole {
            Values::I32(values.into_iter().map(|v| v as i32).collect())
        } else {
            Values::F64(values)
        },
        nodata: options.nodata.or(get("nodata_value")),
        scale: 1.0,
        offset: 0.0,
        spacing,
        crs: place,
        format: "ESRI ASCII grid".to_owned(),
        south_first: false,
    }
    .terrain(file)
}

/// The format names no reference system: a cell of less than 0.1 between longitudes and latitudes counts as degrees.
fn georeference(get: &dyn Fn(&str) -> Option<f64>, step: [f64; 2], height: u64) -> Option<Georeference> {
    let centre =
        |corner: &str, center: &str, step: f64| get(center).or_else(|| get(corner).map(|at| at + 0.5 * step));
    let west = centre("xllcorner", "xllcenter", step[0])?;
    let south = centre("yllcorner", "yllcenter", step[1])?;
    Some(Georeference {
        epsg: None,
        geographic: step[0] < 0.1 && west.abs() <= 360.0 && south.abs() <= 90.0,
        north_west: [west, south + (height - 1) as f64 * step[1]],
        step,
        keys: None,
    })
}
