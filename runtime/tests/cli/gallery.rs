//! `docs/gallery.md`: its commands run and draw what the page shows, and its pictures are small.

use crate::support::Folder;
use ghyll_runtime::terrain::Raster;
use ghyll_runtime::terrain::raster::Texels;
use std::path::{Path, PathBuf};

/// Pictures are drawn that much smaller here.
const SHRUNK: u32 = 4;

/// But for those with lines or edges that are so many pixels wide at every size: they would be other pictures.
const LINED: [&str; 6] = ["overview.jpg", "contours.jpg", "steep.jpg", "wind.jpg", "streaks.jpg", "one.png"];

/// Pictures are compared by the means of squares of so many pixels of the page's, in which one sample a pixel is as good as
/// many, and JPEG loses nothing.
const SQUARE: u32 = 20;

/// Mean difference of squares. Those that are drawn in full size differ by 0.002 at most, the small ones by 0.006, at the edges
/// of what is near; another light or palette makes more than this.
const SAME: f32 = 0.01;

fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}

fn page() -> String {
    std::fs::read_to_string(repository("docs/gallery.md")).unwrap()
}

/// The commands that the page shows.
fn commands(page: &str) -> Vec<&str> {
    page.lines().filter_map(|line| line.strip_prefix("ghyll ")).collect()
}

fn after<'a>(command: &'a str, option: &str) -> Option<&'a str> {
    command.split_whitespace().skip_while(|word| *word != option).nth(1)
}

/// How much smaller a command's picture is drawn.
fn shrunk(command: &str) -> u32 {
    if after(command, "-o").is_some_and(|name| LINED.contains(&name)) { 1 } else { SHRUNK }
}

/// The command as it is run here: programs by their path, small, one sample, on the machine that needs no compiler.
fn small(command: &str) -> String {
    let mut words: Vec<String> = Vec::new();
    let mut rest = command.split_whitespace();
    while let Some(word) = rest.next() {
        match word {
            "--samples" => drop(rest.next()),
            "--size" => {
                let (w, h) = rest.next().and_then(|size| size.split_once('x')).expect("a size");
                let part = |n: &str| n.parse::<u32>().unwrap() / shrunk(command);
                words.push(format!("--size {}x{}", part(w), part(h)));
            }
            _ if word.starts_with("lang-examples/") => words.push(repository(word).display().to_string()),
            _ => words.push(word.to_owned()),
        }
    }
    // A small picture asks for fewer values than a bake makes; a map asks for all of them.
    let bake = if words[0] == "map" { "" } else { " --no-bake" };
    format!("{} --on cpu{bake}", words.join(" "))
}

/// Colours of a picture shrunk by a whole number: means of squares, three components each.
fn colors(path: &Path, shrink: u32) -> (u32, u32, Vec<f32>) {
    let raster = Raster::open(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let (width, height, n) = (raster.width / shrink, raster.height / shrink, raster.components);
    let texel = |x: u32, y: u32, c: u32| {
        let at = ((y * raster.width + x) * n + c.min(n - 1)) as usize;
        match &raster.texels {
            Texels::Bytes(bytes) => f32::from(bytes[at]) / 255.0,
            Texels::Floats(floats) => floats[at],
            Texels::Reserved => unreachable!("it is read from a file"),
        }
    };
    let mean = |x: u32, y: u32, c: u32| {
        let all = (0..shrink * shrink).map(|k| texel(x * shrink + k % shrink, y * shrink + k / shrink, c));
        all.sum::<f32>() / (shrink * shrink) as f32
    };
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    (width, height, places.flat_map(|(x, y)| [0, 1, 2].map(|c| mean(x, y, c))).collect())
}

/// Mean difference of the colours; infinite if the sizes differ.
fn difference(a: &(u32, u32, Vec<f32>), b: &(u32, u32, Vec<f32>)) -> f32 {
    if (a.0, a.1) != (b.0, b.1) {
        return f32::INFINITY;
    }
    a.2.iter().zip(&b.2).map(|(x, y)| (x - y).abs()).sum::<f32>() / a.2.len() as f32
}

#[test]
fn each_command_draws_what_the_page_shows() {
    let folder = Folder::new("gallery");
    let page = page();
    let mut drawn = Vec::new();
    for command in commands(&page) {
        folder.ghyll(&small(command)).printed();
        let name = after(command, "-o").expect("an output");
        if command.starts_with("render") {
            let kept = colors(&repository(&format!("docs/gallery/{name}")), SQUARE);
            let made = colors(&folder.path(name), SQUARE / shrunk(command));
            assert_eq!((made.0, made.1), (kept.0, kept.1), "{name}");
            let off = difference(&made, &kept);
            assert!(off < SAME, "{name} is off by {off}");
            drawn.push((name, made, kept));
        }
    }
    assert!(drawn.len() >= 10, "{} pictures", drawn.len());
    // Every other picture of the page is told apart, but for the one that is the same with more rays.
    for (name, made, _) in &drawn {
        for (other, _, kept) in drawn.iter().filter(|(other, ..)| other != name) {
            let off = difference(made, kept);
            let alike = [name, other].iter().all(|name| name.ends_with(".png"));
            assert!(alike || off > SAME, "{name} is off {other} by {off} only");
        }
    }
}

#[test]
fn each_picture_has_a_command_and_is_small() {
    let page = page();
    let shown: Vec<&str> =
        page.split("](gallery/").skip(1).map(|rest| rest.split(')').next().unwrap()).collect();
    let mut made: Vec<&str> =
        commands(&page).iter().filter(|c| c.starts_with("render")).filter_map(|c| after(c, "-o")).collect();
    let mut kept: Vec<String> = std::fs::read_dir(repository("docs/gallery"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    let mut listed = shown.clone();
    listed.sort_unstable();
    made.sort_unstable();
    kept.sort_unstable();
    assert_eq!(listed, made);
    assert_eq!(listed, kept);
    let sizes = shown.iter().map(|name| {
        let size = std::fs::metadata(repository(&format!("docs/gallery/{name}"))).unwrap().len();
        assert!(size < 150_000, "{name} takes {size} bytes");
        size
    });
    assert!(sizes.sum::<u64>() < 2_000_000);
}
