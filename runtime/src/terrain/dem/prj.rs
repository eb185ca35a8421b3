//! The reference system of a grid whose format names none: well-known text in a `.prj` file beside it.

use super::DemOptions;
use super::geo::metres_per_degree;
use crate::terrain::field::{Georeference, Terrain};
use std::path::Path;

/// What is read of a reference system.
#[derive(Clone, Debug, PartialEq)]
struct System {
    epsg: Option<u32>,
    geographic: bool,
    /// Metres in a unit of its coordinates; of a projected system only.
    unit: f64,
}

/// Names systems go by where no code is given: ESRI's and those of the EPSG register.
const NAMED: &[(&str, u32)] = &[
    ("GCS_WGS_1984", 4326),
    ("WGS 84", 4326),
    ("GCS_North_American_1983", 4269),
    ("NAD83", 4269),
    ("GCS_ETRS_1989", 4258),
    ("ETRS89", 4258),
    ("WGS_1984_Web_Mercator_Auxiliary_Sphere", 3857),
];
/// Beginnings of the names of UTM zones, with the codes of zone 0 in the north and, if there are any, in the south.
const ZONED: &[(&str, u32, Option<u32>)] = &[
    ("WGS_1984_UTM_Zone_", 32600, Some(32700)),
    ("WGS 84 / UTM zone ", 32600, Some(32700)),
    ("NAD_1983_UTM_Zone_", 26900, None),
    ("NAD83 / UTM zone ", 26900, None),
    ("ETRS_1989_UTM_Zone_", 25800, None),
    ("ETRS89 / UTM zone ", 25800, None),
];

/// Takes what the `.prj` beside a file says into a field whose own file names no system.
pub(super) fn place(terrain: &mut Terrain, path: &Path, options: &DemOptions) {
    let Some(crs) = terrain.crs.as_mut().filter(|crs| crs.epsg.is_none() && crs.keys.is_none()) else {
        return;
    };
    let Some(text) = beside(path) else { return };
    let Some(system) = parsed(&text) else { return };
    (crs.epsg, crs.geographic) = (system.epsg, system.geographic);
    if options.spacing.is_none() {
        terrain.spacing = spacing(crs, terrain.height, system.unit);
    }
}

fn beside(path: &Path) -> Option<String> {
    let packed = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("gz"));
    let plain = if packed { path.with_extension("") } else { path.to_owned() };
    ["prj", "PRJ"].iter().find_map(|ending| std::fs::read_to_string(plain.with_extension(ending)).ok())
}

fn spacing(crs: &Georeference, rows: u32, unit: f64) -> [f64; 2] {
    let [dx, dy] = crs.step;
    let [east, north] = match crs.geographic {
        true => metres_per_degree(crs.north_west[1] - 0.5 * f64::from(rows - 1) * dy),
        false => [unit; 2],
    };
    [dx * east, dy * north]
}

/// Of well-known text, version 1 or 2; none if it is something else.
fn parsed(text: &str) -> Option<System> {
    let (kind, _) = text.trim_start_matches('\u{feff}').trim_start().split_once(['[', '('])?;
    let geographic = match kind.trim().to_ascii_uppercase().as_str() {
        "GEOGCS" | "GEOGCRS" | "GEODCRS" => true,
        "PROJCS" | "PROJCRS" => false,
        _ => return None,
    };
    let parts = parts(text);
    let of = |keyword: &str| parts.iter().rfind(|part| part.keyword.eq_ignore_ascii_case(keyword));
    let stated = ["AUTHORITY", "ID"].iter().find_map(|keyword| of(keyword));
    let code = stated.filter(|part| part.words.first().is_some_and(|name| name.eq_ignore_ascii_case("EPSG")));
    let code = code.and_then(|part| part.words.get(1)?.parse().ok());
    let name = text.split('"').nth(1).unwrap_or_default();
    let unit = ["UNIT", "LENGTHUNIT"].iter().find_map(|keyword| of(keyword)?.words.get(1)?.parse().ok());
    Some(System {
        epsg: code.or_else(|| code_of(name)),
        geographic,
        unit: unit.filter(|unit: &f64| unit.is_finite() && *unit > 0.0).unwrap_or(1.0),
    })
}

fn code_of(name: &str) -> Option<u32> {
    let zone = |(beginning, north, south): &(&str, u32, Option<u32>)| {
        let zone = name.strip_prefix(beginning)?;
        let (number, base) = match zone.strip_suffix('N') {
            Some(number) => (number, *north),
            None => (zone.strip_suffix('S')?, (*south)?),
        };
        number.parse().ok().filter(|n| (1..=60).contains(n)).map(|n: u32| base + n)
    };
    let named = NAMED.iter().find(|(known, _)| *known == name).map(|(_, code)| *code);
    named.or_else(|| ZONED.iter().find_map(zone))
}

/// A keyword with what it holds that is no keyword itself.
struct Part {
    keyword: String,
    words: Vec<String>,
}

/// The parts of the outermost one, in their order.
fn parts(text: &str) -> Vec<Part> {
    let (mut found, mut depth, mut quoted) = (Vec::new(), 0, false);
    let mut word = String::new();
    for c in text.chars() {
        match c {
            '"' => quoted = !quoted,
            _ if quoted => word.push(c),
            '[' | '(' => {
                depth += 1;
                if depth == 2 {
                    found.push(Part { keyword: std::mem::take(&mut word), words: Vec::new() });
                }
                word.clear();
            }
            ',' | ']' | ')' => {
                if let (2, Some(part)) = (depth, found.last_mut()) {
                    part.words.push(std::mem::take(&mut word));
                }
                word.clear();
                if c != ',' {
                    depth -= 1;
                }
            }
            _ if c.is_whitespace() => {}
            _ => word.push(c),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const DEGREES: &str = r#"GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",SPHEROID["WGS_1984",6378137.0,298.257223563]],
        PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]]"#;
    const FEET: &str = r#"PROJCS["NAD83 / California zone 3 (ftUS)",GEOGCS["NAD83",UNIT["degree",0.0174532925199433],
        AUTHORITY["EPSG","4269"]],PROJECTION["Lambert_Conformal_Conic_2SP"],UNIT["US survey foot",0.3048006096012192],
        AUTHORITY["EPSG","2227"]]"#;

    #[test]
    fn systems_are_known_by_code_or_by_name() {
        let system = |text: &str| parsed(text).map(|s| (s.epsg, s.geographic, s.unit));
        let (degree, foot) = (0.0174532925199433, 0.3048006096012192);
        assert_eq!(system(DEGREES), Some((Some(4326), true, degree)));
        assert_eq!(system(FEET), Some((Some(2227), false, foot)), "not the code of the system below");
        let utm = |name: &str| format!(r#"PROJCS["{name}",UNIT["Meter",1.0]]"#);
        assert_eq!(system(&utm("WGS_1984_UTM_Zone_33S")), Some((Some(32733), false, 1.0)));
        assert_eq!(system(&utm("ETRS89 / UTM zone 32N")), Some((Some(25832), false, 1.0)));
        assert_eq!(
            system(&utm("NAD_1983_UTM_Zone_10S")),
            Some((None, false, 1.0)),
            "there is none in the south"
        );
        assert_eq!(system(&utm("somewhere")), Some((None, false, 1.0)));
        let second = r#"PROJCRS["x",BASEGEOGCRS["WGS 84"],CONVERSION["c",METHOD["m"]],LENGTHUNIT["metre",1],ID["EPSG",32633]]"#;
        assert_eq!(system(second), Some((Some(32633), false, 1.0)));
        for other in ["", "Projection UTM\nZone 10", "LOCAL_CS[\"x\"]", "PROJCS"] {
            assert_eq!(system(other), None, "{other}");
        }
    }

    #[test]
    fn a_grid_takes_its_place_from_the_file_beside_it() {
        let folder = std::env::temp_dir().join(format!("ghyll-prj-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let grid = folder.join("a.asc");
        let text = "ncols 2\nnrows 2\nxllcorner 6000000\nyllcorner 2000000\ncellsize 10\n1 2\n3 4\n";
        std::fs::write(&grid, text).unwrap();
        let read = |options: &DemOptions| Terrain::open(&grid, options).unwrap();
        let plain = read(&DemOptions::default());
        assert_eq!((plain.spacing, plain.crs.unwrap().epsg), ([10.0; 2], None));
        std::fs::write(folder.join("a.prj"), FEET).unwrap();
        let placed = read(&DemOptions::default());
        assert_eq!((placed.spacing, placed.crs.unwrap().epsg), ([10.0 * 0.3048006096012192; 2], Some(2227)));
        let asked = read(&DemOptions { spacing: Some([7.0; 2]), ..DemOptions::default() });
        assert_eq!(asked.spacing, [7.0; 2]);
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
