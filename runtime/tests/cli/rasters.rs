//! `--raster`: files of every kind, placed, refused.

use crate::support::{Folder, machines};
use ghyll_runtime::image::{Format, Image, encode};
use std::io::Cursor;
use tiff::encoder::{TiffEncoder, colortype};
use tiff::tags::Tag;

const FLAT: &str = "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\n0 0 0\n0 0 0\n";
const AT: &str = "raster layer: vec3; fn main(x: f32, y: f32) -> vec3 = layer(vec2(x, y));";

fn picture(components: u32, format: Format) -> Vec<u8> {
    let data = [1.0, 0.0, 0.2, 0.4].iter().flat_map(|v| vec![*v; components as usize]).collect();
    encode(&Image::new(2, 2, components, data).unwrap(), format).unwrap()
}

/// A field or a layer of W x H float texels whose north-west corner is at (x, y), 10 m apart.
pub fn geotiff(size: (u32, u32), corner: (f64, f64), epsg: u16, value: impl Fn(u32, u32) -> f32) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    let mut image = encoder.new_image::<colortype::Gray32Float>(size.0, size.1).unwrap();
    let tags = image.encoder();
    tags.write_tag(Tag::ModelPixelScaleTag, &[10.0, 10.0, 0.0][..]).unwrap();
    tags.write_tag(Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, corner.0, corner.1, 0.0][..]).unwrap();
    tags.write_tag(Tag::GeoKeyDirectoryTag, &[1u16, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, epsg][..]).unwrap();
    let data: Vec<f32> =
        (0..size.1).flat_map(|r| (0..size.0).map(move |c| (c, r))).map(|(c, r)| value(c, r)).collect();
    image.write_data(&data).unwrap();
    bytes.into_inner()
}

#[test]
fn pictures_and_arrays_are_layers() {
    let folder = Folder::new("raster_files");
    folder.write("p.ghyll", AT).write("flat.asc", FLAT);
    for (name, format) in [("a.png", Format::Png), ("a.exr", Format::Exr), ("a.npy", Format::Npy)] {
        folder.write(name, picture(3, format));
        for machine in machines() {
            let run = |at: &str| {
                let line = format!("run p.ghyll --on {machine} --dem flat.asc --raster layer={name} -- {at}");
                folder.ghyll(&line).printed().to_owned()
            };
            assert_eq!(run("0 10"), "vec3(1.0, 1.0, 1.0)", "{name} on {machine}");
            assert_eq!(run("20 0"), "vec3(0.4, 0.4, 0.4)", "{name} on {machine}");
            assert_eq!(run("10 10"), "vec3(0.5, 0.5, 0.5)", "{name} on {machine}");
        }
    }
}

#[test]
fn a_georeferenced_layer_lies_where_it_says() {
    let folder = Folder::new("raster_place");
    folder.write("p.ghyll", "raster layer: f32; fn main(x: f32, y: f32) -> f32 = layer(vec2(x, y));");
    folder.write("dem.tif", geotiff((4, 3), (1000.0, 2000.0), 32654, |_, _| 0.0));
    // One column further west, one row further north, and wider: texel (c, r) is the field's sample (c - 1, r - 1).
    folder.write("layer.tif", geotiff((6, 5), (990.0, 2010.0), 32654, |c, r| (10 * c + r) as f32));
    for machine in machines() {
        let run = |dem: &str, at: &str| {
            let line = format!("run p.ghyll --on {machine} --dem {dem} --raster layer=layer.tif -- {at}");
            folder.ghyll(&line).printed().to_owned()
        };
        // The north-western sample, the south-eastern one, and between columns.
        assert_eq!(run("dem.tif", "0 20"), "11.0", "{machine}");
        assert_eq!(run("dem.tif", "30 0"), "43.0", "{machine}");
        assert_eq!(run("dem.tif", "15 20"), "26.0", "{machine}");
        // Without a georeference of its own the field is covered by all of the layer.
        folder.write("flat.asc", FLAT);
        folder.write("flat.npy", encode(&Image::new(4, 3, 1, vec![0.0; 12]).unwrap(), Format::Npy).unwrap());
        assert_eq!(run("flat.npy", "0 2"), "0.0", "{machine}");
        assert_eq!(run("flat.npy", "3 0"), "54.0", "{machine}");
    }
    let line = "run p.ghyll --on cpu --dem dem.tif --raster layer=other.tif -- 0 0";
    folder.write("other.tif", geotiff((4, 3), (1000.0, 2000.0), 32655, |_, _| 0.0));
    folder.ghyll(line).failed(1, &["`layer`", "EPSG:32654", "EPSG:32655"]);
    folder.write("other.tif", geotiff((4, 3), (5000.0, 2000.0), 32654, |_, _| 0.0));
    folder.ghyll(line).failed(1, &["`layer`", "elsewhere"]);
}

#[test]
fn what_cannot_be_bound_is_explained() {
    let folder = Folder::new("raster_refusals");
    folder.write("p.ghyll", AT).write("flat.asc", FLAT).write("a.png", picture(4, Format::Png));
    let run = |more: &str| folder.ghyll(&format!("run p.ghyll --on cpu --dem flat.asc {more} -- 0 0"));
    run("").failed(1, &["`layer`", "--raster layer=FILE"]);
    run("--raster layre=a.png").failed(2, &["`layre`", "did you mean `layer`"]);
    run("--raster layer=a.png").failed(1, &["`layer`", "4 channels", "vec4"]);
    run("--raster layer").failed(2, &["NAME=FILE"]);
    run("--raster layer=a.png --raster layer=a.png").failed(2, &["twice"]);
    run("--raster layer=none.png").failed(1, &["none.png", "`layer`"]);
    folder.write("cut.png", &picture(3, Format::Png)[..60]);
    run("--raster layer=cut.png").failed(1, &["cut.png"]);
}

#[test]
fn what_is_not_read_is_not_loaded() {
    let folder = Folder::new("raster_unread");
    folder.write("flat.asc", FLAT);
    folder.write(
        "p.ghyll",
        "param on: bool = false; raster layer: f32; fn main() -> f32 = if on { layer(vec2(0.0)) } else { 2.5 };",
    );
    for machine in machines() {
        let line = format!("run p.ghyll --on {machine} --dem flat.asc --raster layer=none.png");
        assert_eq!(folder.ghyll(&line).printed(), "2.5", "{machine}");
    }
    folder.ghyll("run p.ghyll --on cpu --set on=true --raster layer=none.png").failed(1, &["none.png"]);
}
