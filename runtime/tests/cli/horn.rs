//! Hill shading, slope and aspect equal `gdaldem`'s (GDAL 3.6.2). `tests/data/horn` holds what these wrote for a piece of the
//! built-in field, placed in UTM with oblong texels:
//!
//!     gdaldem hillshade -compute_edges dem.tif hillshade.tif
//!     gdaldem hillshade -compute_edges -az 200 -alt 30 -z 2 dem.tif hillshade_200_30_2.tif
//!     gdaldem slope -compute_edges dem.tif slope.tif
//!     gdaldem aspect -compute_edges -zero_for_flat dem.tif aspect.tif

use crate::support::{Folder, machines};
use ghyll_runtime::terrain::{DemOptions, Terrain};
use std::path::{Path, PathBuf};

fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}

fn values(path: PathBuf) -> Vec<f64> {
    let map = Terrain::open(path, &DemOptions::default()).unwrap();
    let rows = (0..map.height).flat_map(|r| (0..map.width).map(move |c| (c, r)));
    rows.map(|(c, r)| map.sample(c, r).unwrap()).collect()
}

/// The greatest difference between a map and the golden file of that name.
fn difference(machine: &str, options: &str, golden: &str) -> f64 {
    let folder = Folder::new(&format!("horn_{golden}_{machine}"));
    let (program, dem) = (repository("lang-examples/horn.ghyll"), repository("tests/data/horn/dem.tif"));
    let (program, dem) = (program.display(), dem.display());
    folder.ghyll(&format!("map {program} --dem {dem} --on {machine} {options} -o out.tif")).printed();
    let made = values(folder.path("out.tif"));
    let kept = values(repository(&format!("tests/data/horn/{golden}.tif")));
    assert_eq!((made.len(), kept.len()), (1280, 1280));
    made.iter().zip(kept).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn hillshades_are_those_of_gdaldem() {
    for machine in machines() {
        assert!(difference(machine, "", "hillshade") <= 1.0, "{machine}");
        let other = "--set azimuth=200.0 --set altitude=30.0 --set z=2.0";
        assert!(difference(machine, other, "hillshade_200_30_2") <= 1.0, "{machine}");
    }
}

#[test]
fn slopes_and_aspects_are_those_of_gdaldem() {
    for machine in machines() {
        assert!(difference(machine, "--entry slope", "slope") < 0.02, "{machine}");
        // Its aspects leave out that texels are oblong.
        assert!(difference(machine, "--entry aspect --spacing 50", "aspect") < 0.1, "{machine}");
    }
}

#[test]
fn a_light_turned_by_two_degrees_is_noticed() {
    assert!(difference("cpu", "--set azimuth=317.0", "hillshade") > 2.0);
    assert!(difference("cpu", "--entry slope --spacing 51,61.6", "slope") > 0.1);
}
