//! The beam pre-pass: `beam`, `--show beams`, and what `explain` tells of it.

use crate::support::{Folder, machines};
use serde_json::Value;

/// Distance and height of what a pixel shows.
fn program(ray: &str) -> String {
    format!(
        "use terrain;
         fn pixel(p: vec2) -> vec2 = match cast(bilinear, {ray}(p)) {{ Some(h) => vec2(h.distance, h.at.z), None => vec2(-1.0) }};"
    )
}

/// Numbers of a .npy file behind its header.
fn floats(folder: &Folder, name: &str) -> Vec<f32> {
    let bytes = std::fs::read(folder.path(name)).expect("a picture");
    let start = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    bytes[start..].chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
}

#[test]
fn rays_with_beams_have_the_same_hits() {
    let folder = Folder::new("rays_with_beams_have_the_same_hits");
    folder.write("plain.ghyll", program("camera")).write("started.ghyll", program("beam"));
    for machine in machines().iter().filter(|machine| **machine != "oracle") {
        for view in ["--view overview", "--view north --ortho", "--view panorama"] {
            let line = |name: &str| {
                let size = if view.ends_with("panorama") { "96x48" } else { "90x75" };
                folder
                    .ghyll(&format!("render {name}.ghyll --on {machine} --size {size} {view} -o {name}.npy"))
                    .printed();
                floats(&folder, &format!("{name}.npy"))
            };
            let (plain, started) = (line("plain"), line("started"));
            assert!(plain.iter().any(|x| *x > 0.0));
            for (a, b) in plain.iter().zip(&started) {
                assert!((a - b).abs() <= 2e-6 * a.abs(), "{machine}, {view}: {a} and {b}");
            }
        }
    }
}

#[test]
fn show_beams_writes_where_rays_start() {
    let folder = Folder::new("show_beams_writes_where_rays_start");
    folder.write("plain.ghyll", program("camera"));
    folder.ghyll("render plain.ghyll --on cpu --size 90x75 -o plain.npy").printed();
    folder.ghyll("render --show beams --on cpu --size 90x75 -o beams.npy").printed();
    let (hits, starts) = (floats(&folder, "plain.npy"), floats(&folder, "beams.npy"));
    assert_eq!((hits.len(), starts.len()), (2 * 90 * 75, 90 * 75));
    let mut near = 0;
    for (hit, start) in hits.chunks_exact(2).zip(&starts) {
        assert!(hit[0] < 0.0 || *start <= hit[0], "{start} behind {}", hit[0]);
        near += usize::from(hit[0] > 0.0 && *start > 0.7 * hit[0]);
    }
    // A tile's rays start together, some see only sky, most start near to what they meet.
    assert!((0..8).all(|x| starts[x] == starts[0]) && starts.contains(&2e9));
    assert!(near > hits.len() / 8, "{near}");
    folder.ghyll("render --show beams --on cpu --size 90x75 -o beams.png").printed();
    folder.ghyll("render plain.ghyll --show beams").failed(2, &["--show"]);
}

#[test]
fn explain_counts_steps() {
    let folder = Folder::new("explain_counts_steps");
    folder.write("plain.ghyll", program("camera")).write("started.ghyll", program("beam"));
    let rays = |name: &str| -> Value {
        let report: Value =
            serde_json::from_str(folder.ghyll(&format!("explain {name}.ghyll --json")).printed())
                .expect("JSON");
        report["primary_rays"].clone()
    };
    let (plain, started) = (rays("plain"), rays("started"));
    assert_eq!((&plain["uses_beams"], &started["uses_beams"]), (&false.into(), &true.into()));
    assert_eq!(plain["rays"], 1024 * 1024);
    assert_eq!(plain["steps"], started["steps"]);
    let n = |key: &str| plain[key].as_f64().expect("a number");
    assert!(n("steps_with_beams") + n("steps_of_beams") < 0.7 * n("steps"), "{plain}");
    let told = folder.ghyll("explain started.ghyll");
    assert!(told.printed().contains("steps per ray"), "{}", told.out);
    folder.write("none.ghyll", "fn pixel(p: vec2) -> f32 = p.x;");
    assert!(rays("none").is_null());
}
