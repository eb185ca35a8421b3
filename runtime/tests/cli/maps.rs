//! `ghyll map`: a value for each sample, with the place of the elevation data.

use crate::rasters::geotiff;
use crate::support::{Folder, machines};
use ghyll_runtime::terrain::raster::Texels;
use ghyll_runtime::terrain::{DemOptions, Raster, Terrain};

/// Position and height of each sample.
const HERE: &str = "use terrain; fn map(p: vec2) -> vec3 = vec3(p, nearest(p));";

#[test]
fn every_sample_has_its_value_and_its_place() {
    let folder = Folder::new("map_values");
    folder.write("p.ghyll", HERE);
    folder.write("dem.tif", geotiff((4, 3), (1000.0, 2000.0), 32654, |c, r| (10 * c + r) as f32));
    let dem = Terrain::open(folder.path("dem.tif"), &DemOptions::default()).unwrap();
    for machine in machines() {
        folder.ghyll(&format!("map p.ghyll --dem dem.tif --on {machine} -o out.tif")).printed();
        let map = Raster::open(folder.path("out.tif")).unwrap();
        assert_eq!((map.width, map.height, map.components), (4, 3, 3));
        assert_eq!(map.place, dem.crs, "{machine}");
        let Texels::Floats(values) = &map.texels else { panic!("floats") };
        // North-west first: column c, row r lies at (10 c, 10 (2 - r)).
        for (at, value) in values.chunks(3).enumerate() {
            let (c, r) = ((at % 4) as f32, (at / 4) as f32);
            assert_eq!(value, [10.0 * c, 10.0 * (2.0 - r), 10.0 * c + r], "{machine}");
        }
    }
}

#[test]
fn voids_stay_voids() {
    let folder = Folder::new("map_voids");
    folder.write("p.ghyll", "fn map(p: vec2) -> f32 = p.x;");
    let hole = |c, r| if (c, r) == (2, 0) { f32::NAN } else { 1.0 };
    folder.write("dem.tif", geotiff((4, 3), (1000.0, 2000.0), 32654, hole));
    for machine in machines() {
        folder.ghyll(&format!("map p.ghyll --dem dem.tif --on {machine} -o out.tif")).printed();
        let map = Terrain::open(folder.path("out.tif"), &DemOptions::default()).unwrap();
        assert_eq!((map.voids, map.sample(2, 2), map.sample(3, 2)), (1, None, Some(30.0)), "{machine}");
        folder.ghyll(&format!("map p.ghyll --dem dem.tif --on {machine} -o out.npy")).printed();
        let bytes = std::fs::read(folder.path("out.npy")).unwrap();
        let third: [u8; 4] = bytes[bytes.len() - 40..][..4].try_into().unwrap();
        assert!(f32::from_le_bytes(third).is_nan(), "{machine}");
    }
}

#[test]
fn slopes_of_a_plane() {
    let folder = Folder::new("map_slope");
    let example = concat!(env!("CARGO_MANIFEST_DIR"), "/../lang-examples/slope.ghyll");
    folder.write("p.ghyll", std::fs::read(example).unwrap());
    // A metre up for each metre to the east. WGSL allows `atan` an error of 4096 units in the last place.
    folder.write("dem.tif", geotiff((5, 4), (0.0, 0.0), 32654, |c, _| 10.0 * c as f32));
    for machine in machines() {
        folder.ghyll(&format!("map p.ghyll --dem dem.tif --on {machine} -o out.tif")).printed();
        let map = Terrain::open(folder.path("out.tif"), &DemOptions::default()).unwrap();
        assert!((map.sample(2, 1).unwrap() - 45.0).abs() < 0.02, "{machine}");
        // At the rim the field goes on level, so half of the way is level.
        assert!((map.sample(0, 1).unwrap() - 0.5f64.atan().to_degrees()).abs() < 0.02, "{machine}");
    }
}

#[test]
fn a_baked_function_serves_a_map() {
    let folder = Folder::new("map_baked");
    folder.write(
        "p.ghyll",
        "@bake fn square(p: vec2) -> f32 = p.x * p.x; fn map(p: vec2) -> f32 = square(p + vec2(10.0, 0.0)) - square(p);",
    );
    folder.write("dem.tif", geotiff((4, 3), (0.0, 0.0), 32654, |_, _| 0.0));
    for machine in machines() {
        folder.ghyll(&format!("map p.ghyll --dem dem.tif --on {machine} -o out.tif")).printed();
        let map = Terrain::open(folder.path("out.tif"), &DemOptions::default()).unwrap();
        assert_eq!((map.sample(0, 0), map.sample(2, 2)), (Some(100.0), Some(500.0)), "{machine}");
    }
}

#[test]
fn what_is_no_map_is_refused() {
    let folder = Folder::new("map_refusals");
    folder.write("value.ghyll", "fn main() -> i32 = 1; fn map(p: vec2) -> i32 = 1;");
    folder.write("picture.ghyll", "fn pixel(p: vec2) -> f32 = 1.0;");
    folder.ghyll("map value.ghyll --on cpu").failed(1, &["`map` is not a map entry"]);
    folder.ghyll("map picture.ghyll --on cpu").failed(2, &["`fn pixel`", "ghyll render"]);
    folder.ghyll("map picture.ghyll --entry pixel --on cpu -o out.gif").failed(2, &["out.gif", ".tif"]);
    folder.ghyll("map picture.ghyll --entry pixel --on cpu -o out.tif").printed();
    let map = Terrain::open(folder.path("out.tif"), &DemOptions::default()).unwrap();
    assert_eq!(
        (map.width, map.height, map.crs.unwrap().epsg),
        (512, 512, Terrain::builtin().crs.unwrap().epsg)
    );
}

#[test]
fn a_picture_of_a_map_tells_what_it_cannot_hold() {
    let folder = Folder::new("map_clamped");
    folder.write("p.ghyll", "use terrain; fn map(p: vec2) -> f32 = nearest(p) / 10.0;");
    folder.write("dem.tif", geotiff((4, 3), (1000.0, 2000.0), 32654, |c, _| 5.0 * c as f32));
    let said = |file: &str| {
        let ended = folder.ghyll(&format!("map p.ghyll --dem dem.tif --on cpu -o {file}"));
        ended.printed();
        ended.err
    };
    let png = said("m.png");
    assert!(
        png.contains("3 of the map's 12 numbers") && png.contains("m.png") && png.contains(".tif"),
        "{png}"
    );
    assert!(!said("m.tif").contains("outside"));
}
