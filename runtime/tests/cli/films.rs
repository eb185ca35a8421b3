//! Cameras, samples and films: what is drawn follows what was asked for.

use crate::support::{Folder, machines};
use image::{AnimationDecoder, codecs::gif::GifDecoder};
use std::fs::File;
use std::io::BufReader;

fn grey(folder: &Folder, name: &str) -> u8 {
    image::open(folder.path(name)).expect("a picture").to_luma8().get_pixel(0, 0)[0]
}

#[test]
fn a_film_is_numbered_pictures_and_t_takes_the_type_of_its_place() {
    let folder = Folder::new("film_numbers");
    folder.write(
        "p.ghyll",
        "param k: f32 = 0.0; param n: i32 = 0; fn pixel(p: vec2) -> f32 = k + 0.1 * f32(n);",
    );
    for on in machines() {
        let line =
            format!("render p.ghyll --on {on} --size 2x2 --frames 1..4 --set k=t/10 --set n=t -o f.png");
        folder.ghyll(&line).printed();
        for t in 1..4u8 {
            let wanted = (f32::from(t) * 0.2 * 255.0).round() as u8;
            assert_eq!(grey(&folder, &format!("f-000{t}.png")), wanted, "{on} {t}");
        }
        assert!(!folder.path("f-0004.png").exists());
    }
}

#[test]
fn a_parameter_t_is_the_frame_and_a_film_is_one_file() {
    let folder = Folder::new("film_gif");
    folder.write("p.ghyll", "param t: f32 = 0.0; fn pixel(p: vec2) -> f32 = t / 2.0;");
    folder.ghyll("render p.ghyll --on cpu --size 2x2 --frames 0..3 --fps 10 -o f.gif").printed();
    let file = BufReader::new(File::open(folder.path("f.gif")).unwrap());
    let frames = GifDecoder::new(file).unwrap().into_frames().collect_frames().unwrap();
    let greys: Vec<u8> = frames.iter().map(|frame| frame.buffer().get_pixel(0, 0)[0]).collect();
    assert_eq!(greys, [0, 128, 255]);
    folder.ghyll("render p.ghyll --on cpu --size 2x2 --frames 0..3 -o f.apng").printed();
    assert!(std::fs::read(folder.path("f.apng")).unwrap().windows(4).any(|w| w == b"acTL"));
    folder.ghyll("render p.ghyll --on cpu --size 2x2 -o f.gif").failed(2, &["--frames"]);
}

#[test]
fn what_a_frame_cannot_be_is_told_before_the_first_is_drawn() {
    let folder = Folder::new("film_errors");
    folder.write("p.ghyll", "param k: f32 = 0.0 in 0.0..1.0; fn pixel(p: vec2) -> f32 = k;");
    let line = "render p.ghyll --on cpu --size 2x2 -o f.png";
    folder.ghyll(&format!("{line} --frames 0..20 --set k=t/10")).failed(2, &["`k`", "0..1"]);
    folder.ghyll(&format!("{line} --frames 5..5")).failed(2, &["--frames", "not drawn"]);
    folder.ghyll(&format!("{line} --frames x")).failed(2, &["A..B"]);
    folder.ghyll(&format!("{line} --eye t,0,9 --look-at 1,1,1")).failed(2, &["--eye", "--frames"]);
    folder.ghyll(&format!("{line} --turntable")).failed(2, &["--frames"]);
    assert!(!folder.path("f-0000.png").exists());
}

#[test]
fn samples_are_averaged_before_encoding() {
    let folder = Folder::new("samples");
    // The left two fifths of every pixel are brighter than white.
    folder.write("p.ghyll", "fn pixel(p: vec2) -> f32 = if fract(p.x) < 0.4 { 2.0 } else { 0.0 };");
    for on in machines() {
        folder.ghyll(&format!("render p.ghyll --on {on} --size 9x3 --samples 5 -o s.png")).printed();
        assert_eq!(grey(&folder, "s.png"), 204, "{on}");
        folder.ghyll(&format!("render p.ghyll --on {on} --size 9x3 -o s.png")).printed();
        assert_eq!(grey(&folder, "s.png"), 0, "{on}");
    }
    folder.ghyll("render p.ghyll --on cpu --samples 0").failed(2, &["--samples"]);
}

const DIRECTION: &str = "use terrain; fn pixel(p: vec2) -> vec3 = 0.5 + 0.5 * camera(p).dir;";

#[test]
fn cameras_move_with_t_and_turn() {
    let folder = Folder::new("film_cameras");
    folder.write("p.ghyll", DIRECTION);
    let colour = |name: &str| image::open(folder.path(name)).unwrap().to_rgb8().get_pixel(1, 1).0;
    let line = "render p.ghyll --on cpu --size 3x3 -o c.png";
    folder.ghyll(&format!("{line} --frames 0..2 --eye 0,0,0 --look-at t,1-t,0")).printed();
    assert_eq!((colour("c-0000.png"), colour("c-0001.png")), ([128, 255, 128], [255, 128, 128]));
    // A quarter turn clockwise of a camera that looks north looks east.
    folder.ghyll(&format!("{line} --frames 0..4 --eye 0,0,0 --look-at 0,1,0 --turntable")).printed();
    assert_eq!((colour("c-0000.png"), colour("c-0001.png")), ([128, 255, 128], [255, 128, 128]));
    folder.ghyll(&format!("{line} --view panorama --eye 1000,1000")).printed();
    assert_eq!(colour("c.png"), [128, 255, 128]);
    folder.ghyll(&format!("{line} --view panorama --eye -5,0")).failed(2, &["no ground"]);
    folder.ghyll(&format!("{line} --view panorama --ortho")).failed(2, &["panorama"]);
    folder.ghyll(&format!("{line} --eye 0,0,0")).failed(2, &["--look-at"]);
}

#[test]
fn the_sun_stands_where_time_and_place_put_it() {
    let folder = Folder::new("sun_at");
    folder.write("p.ghyll", "use terrain; fn pixel(p: vec2) -> vec3 = 0.5 + 0.5 * sun_dir();");
    let colour = || image::open(folder.path("s.png")).unwrap().to_rgb8().get_pixel(0, 0).0;
    let line = "render p.ghyll --on cpu --size 1x1 -o s.png --sun-at";
    // Noon at Mount Fuji is before three in the morning of UTC: the sun stands in the south, 78 degrees high.
    folder.ghyll(&format!("{line} 2026-06-21T02:47Z")).printed();
    let [x, y, z] = colour();
    assert!(x.abs_diff(128) < 3 && (96..106).contains(&y) && z > 250, "{x} {y} {z}");
    folder.ghyll(&format!("{line} 2026-12-21T12:00:00Z@51.48,0")).printed();
    let [_, y, z] = colour();
    assert!(y < 10 && (155..164).contains(&z), "{y} {z}");
    folder.write("d.asc", "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 500000\n1 2\n3 4\n");
    folder.ghyll(&format!("{line} 2026-06-21T12:00Z --dem d.asc")).failed(2, &["--sun-at", "--sun"]);
    folder.ghyll(&format!("{line} yesterday")).failed(2, &["2026-06-21T15:00Z"]);
    folder.ghyll(&format!("{line} 2026-06-21T12:00Z@95,0")).failed(2, &["latitude 95"]);
}

#[test]
fn far_heights_fall_with_the_curvature() {
    let folder = Folder::new("curvature");
    folder.write("p.ghyll", "use terrain; fn pixel(p: vec2) -> f32 = relief().x;");
    folder.write("d.asc", "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 50000\n0 0 0\n0 0 0\n");
    let camera = "--dem d.asc --spacing 50000 --eye 0,0,100 --look-at 1,0,100 --size 1x1 --on cpu -o h.npy";
    let lowest = |more: &str| {
        folder.ghyll(&format!("render p.ghyll {camera} {more}")).printed();
        let bytes = std::fs::read(folder.path("h.npy")).unwrap();
        f32::from_le_bytes(bytes[bytes.len() - 4..].try_into().unwrap())
    };
    assert_eq!(lowest(""), 0.0);
    // 112 km away.
    assert!((lowest("--curvature=0") + 981.0).abs() < 1.0);
    assert!((lowest("--curvature") + 0.87 * 981.0).abs() < 1.0);
    let line = "render p.ghyll --dem d.asc --spacing 50000 --on cpu --size 1x1 --curvature --view topdown";
    folder.ghyll(line).failed(2, &["--curvature", "topdown"]);
}

#[test]
fn a_preset_sets_what_the_program_has() {
    let folder = Folder::new("presets");
    folder.write(
        "p.ghyll",
        "param detail: bool = false; param lighting: f32 = 0.2;
         fn pixel(p: vec2) -> f32 = if detail { fract(p.x) } else { lighting };",
    );
    let line = "render p.ghyll --on cpu --size 2x2 -o p.png";
    let said = |more: &str| {
        let ended = folder.ghyll(&format!("{line} {more}"));
        assert_eq!(ended.status, Some(0), "{}", ended.err);
        (grey(&folder, "p.png"), ended.err)
    };
    let (shade, told) = said("--preset quality");
    assert!(shade == 128 && told.contains("quality: detail=true, 8 samples"), "{shade} {told}");
    assert_eq!(said("--preset quality --set detail=false").0, 51);
    let (_, told) = said("--preset quality --samples 1");
    assert!(!told.contains("samples a pixel"), "{told}");
    // The parameter `lighting` of this program is no function.
    let (shade, told) = said("--preset memory");
    assert!(shade == 51 && told.contains("memory: detail=false, no bake"), "{told}");
    folder.ghyll(&format!("{line} --preset best")).failed(2, &["quality"]);
}

#[test]
fn a_gif_has_its_limit() {
    let folder = Folder::new("gif_rate");
    folder.write("p.ghyll", "fn pixel(p: vec2) -> f32 = 0.5;");
    let line = "render p.ghyll --on cpu --size 2x2 --frames 0..2 --fps";
    folder.ghyll(&format!("{line} 51 -o a.gif")).failed(2, &["--fps 51", "at most 50", ".apng"]);
    assert!(!folder.path("a.gif").exists());
    folder.ghyll(&format!("{line} 50 -o a.gif")).printed();
    folder.ghyll(&format!("{line} 1000 -o a.apng")).printed();
}
