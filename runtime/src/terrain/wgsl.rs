//! The shader text of the intrinsics that a program reaches, and of nothing else.
//!
//! [`PIECES`] is the table: each piece of `shaders/terrain/` with what must stand before it.

use super::field::{Samples, Terrain};
use super::pyramid::Side;
use ghyll_compiler::intrinsics::Intrinsic;

/// How samples are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    I16,
    F32,
}

impl Format {
    pub fn of(terrain: &Terrain) -> Format {
        match terrain.samples {
            Samples::I16(_) => Format::I16,
            Samples::F32(_) => Format::F32,
        }
    }
}

struct Piece {
    name: &'static str,
    text: &'static str,
    needs: &'static [&'static str],
}

macro_rules! pieces {
    ($($name:literal $file:literal [$($need:literal)*];)*) => {
        &[$(Piece {
            name: $name,
            text: include_str!(concat!("../../../shaders/terrain/", $file, ".wgsl")),
            needs: &[$($need),*],
        }),*]
    };
}

/// Names that end in a format are chosen by the name without it; a file used under several names holds the word
/// `SURFACE`, which the part of the name behind the last underscore replaces.
const PIECES: &[Piece] = pieces! {
    "scene" "scene" [];
    "samples" "samples" [];
    "sample.i16" "samples_i16" ["samples"];
    "sample.f32" "samples_f32" ["samples"];
    "bounds" "bounds" [];
    "bound.i16" "bounds_i16" ["bounds" "sample"];
    "bound.f32" "bounds_f32" ["bounds"];
    "floors" "floors" [];
    "floor.i16" "floors_i16" ["floors" "sample"];
    "floor.f32" "floors_f32" ["floors"];
    "crests" "crests" [];
    "crest_node.i16" "crests_i16" ["crests" "sample"];
    "crest_node.f32" "crests_f32" ["crests"];
    "corners" "corners" ["scene" "sample"];
    "box" "box" ["scene"];
    "rim" "rim" ["scene" "sample"];
    "cell" "cell" ["corners" "rim"];
    "onto" "onto" [];
    "slope" "slope" ["scene"];
    "transforms" "transforms" ["scene"];
    "ray" "ray" ["transforms" "planes"];
    "planes" "planes" [];
    "patch" "patch" ["corners"];
    "height_bilinear" "height_bilinear" ["corners"];
    "height_triangulated" "height_triangulated" ["corners"];
    "patch_bilinear" "patch_bilinear" ["patch"];
    "patch_triangulated" "patch_triangulated" ["patch"];
    "sextic" "sextic" ["patch"];
    "patch_bicubic" "patch_bicubic" ["sextic" "samples_bicubic"];
    "patch_subdivided" "patch_subdivided" ["patch_bilinear" "part"];
    "samples_bilinear" "samples_corners" ["corners" "bound"];
    "samples_triangulated" "samples_corners" ["corners" "bound"];
    "samples_bicubic" "samples_around" ["neighbours" "crest_node"];
    "samples_subdivided" "samples_around" ["neighbours" "crest_node"];
    "hit_bilinear" "hit" ["ray" "samples_bilinear" "patch_bilinear"];
    "walk_bilinear" "walk" ["hit_bilinear"];
    "hit_triangulated" "hit" ["ray" "samples_triangulated" "patch_triangulated"];
    "walk_triangulated" "walk" ["hit_triangulated"];
    "hit_bicubic" "hit" ["ray" "samples_bicubic" "patch_bicubic"];
    "walk_bicubic" "walk" ["hit_bicubic"];
    "hit_subdivided" "hit" ["ray" "samples_subdivided" "patch_subdivided"];
    "walk_subdivided" "walk" ["hit_subdivided"];
    "hit_cell" "hit_cell" ["ray" "patch" "crest_node"];
    "walk_cell" "walk" ["hit_cell"];
    "settle_bilinear" "settle" ["walk_bilinear"];
    "settle_triangulated" "settle" ["walk_triangulated"];
    "settle_bicubic" "settle" ["walk_bicubic"];
    "settle_subdivided" "settle" ["walk_subdivided"];
    "extent" "extent" ["scene"];
    "texel" "texel" ["scene"];
    "relief" "relief" ["scene"];
    "nearest" "nearest" ["scene" "sample"];
    "triangulated" "triangulated" ["cell" "height_triangulated"];
    "bilinear" "bilinear" ["cell" "height_bilinear"];
    "micro_row" "micro_row" [];
    "mean.i16" "means_i16" [];
    "mean.f32" "means_f32" [];
    "means" "means" ["scene" "sample" "mean"];
    "row.i16" "row_i16" ["scene" "sample"];
    "row.f32" "row_f32" ["scene" "sample"];
    "neighbours" "neighbours" ["scene" "row" "rim"];
    "part" "part" ["corners" "neighbours"];
    "fine" "fine" ["part"];
    "bicubic" "bicubic" ["neighbours"];
    "gradient_bicubic" "gradient_bicubic" ["neighbours" "slope"];
    "bend_bicubic" "bend_bicubic" ["neighbours" "slope"];
    "subdivided" "subdivided" ["fine" "height_bilinear"];
    "gradient_subdivided" "gradient_subdivided" ["fine" "slope"];
    "twist_subdivided" "twist_subdivided" ["fine" "slope"];
    "gradient_triangulated" "gradient_triangulated" ["cell" "onto" "slope"];
    "gradient_bilinear" "gradient_bilinear" ["cell" "onto" "slope"];
    "twist_bilinear" "twist_bilinear" ["cell" "onto" "slope"];
    "trace_bicubic" "trace" ["settle_bicubic"];
    "trace_subdivided" "trace_subdivided" ["settle_subdivided"];
    "occluded_bicubic" "occluded" ["walk_bicubic"];
    "occluded_subdivided" "occluded_subdivided" ["walk_subdivided"];
    "trace_triangulated" "trace" ["settle_triangulated"];
    "trace_bilinear" "trace" ["settle_bilinear"];
    "occluded_triangulated" "occluded" ["walk_triangulated"];
    "occluded_bilinear" "occluded" ["walk_bilinear"];
    "next_cell" "next_cell" ["walk_cell"];
    "patch_around" "patch_around" ["neighbours"];
    "side_highest" "side_highest" ["scene" "bound"];
    "side_lowest" "side_lowest" ["scene" "floor"];
    "side_crest" "side_crest" ["scene" "crest_node"];
    "highest" "extreme" ["box" "side_highest"];
    "lowest" "extreme" ["box" "side_lowest"];
    "inclines" "inclines" ["box" "sample"];
    "crest" "extreme" ["box" "side_crest"];
    "inclines_bicubic" "inclines_bicubic" ["neighbours"];
    "holed" "holed" ["box" "sample"];
    "hole" "hole" ["holed"];
    "camera" "camera" ["scene"];
    "beam_start" "beam_start" ["scene"];
    "pixel_width" "pixel_width" ["scene"];
    "picture" "picture" ["scene"];
    "sun_dir" "sun_dir" ["scene"];
    "sun_color" "sun_color" ["scene"];
    "place" "place" ["scene"];
    "rasters" "rasters" [];
    "raster_texel_1" "raster_texel_1" ["rasters"];
    "raster_texel_2" "raster_texel_2" ["rasters"];
    "raster_texel_3" "raster_texel_3" ["rasters"];
    "raster_texel_4" "raster_texel_4" ["rasters"];
    "raster_1" "raster" ["raster_texel_1"];
    "raster_2" "raster" ["raster_texel_2"];
    "raster_3" "raster" ["raster_texel_3"];
    "raster_4" "raster" ["raster_texel_4"];
    "rasters_slope" "rasters_slope" ["rasters"];
    "raster_slope_1" "raster_slope" ["rasters_slope" "raster_texel_1"];
    "raster_slope_2" "raster_slope" ["rasters_slope" "raster_texel_2"];
    "raster_slope_3" "raster_slope" ["rasters_slope" "raster_texel_3"];
    "raster_slope_4" "raster_slope" ["rasters_slope" "raster_texel_4"];
    "gradient_raster_1" "gradient_raster_1" ["raster_slope_1"];
    "gradient_raster_2" "gradient_raster_2" ["raster_slope_2"];
    "gradient_raster_3" "gradient_raster_3" ["raster_slope_3"];
    "gradient_raster_4" "gradient_raster_4" ["raster_slope_4"];
    "twist_raster_1" "twist_raster" ["raster_slope_1"];
    "twist_raster_2" "twist_raster" ["raster_slope_2"];
    "twist_raster_3" "twist_raster" ["raster_slope_3"];
    "twist_raster_4" "twist_raster" ["raster_slope_4"];
};

/// Shader text with what it needs of bind group 1.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Module {
    pub text: String,
    pub uses: Uses,
}

/// Bindings of group 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Uses {
    /// Binding 0, a uniform buffer: [`super::layout::SceneUniform`].
    pub scene: bool,
    /// Binding 1, read-only storage: [`super::Scene::sample_words`].
    pub samples: bool,
    /// Binding 2, read-only storage: [`super::Scene::pyramid`].
    pub bounds: bool,
    /// Binding 3, read-only storage: [`super::Layers`].
    pub rasters: bool,
    /// Binding 4, read-only storage: the minimum mipmap, as `bounds`.
    pub floors: bool,
    /// Binding 5, read-only storage: [`super::Micro::words`].
    pub micro: bool,
    /// Binding 6, read-only storage: [`super::Scene::mean_words`].
    pub means: bool,
    /// Binding 7, read-only storage: the starts of [`super::Scene::beams`].
    pub beams: bool,
    /// Binding 8, read-only storage: [`super::Scene::crests`], as `bounds`.
    pub crests: bool,
}

/// Declarations of the given intrinsics and of all that they need, each once.
pub fn wgsl(intrinsics: &[Intrinsic], format: Format) -> Module {
    let mut placed: Vec<&'static str> = Vec::new();
    let mut text = String::new();
    for intrinsic in intrinsics {
        place(intrinsic.name(), format, &mut placed, &mut text);
    }
    let uses = |name: &str| placed.contains(&name);
    let (scene, samples, bounds) = (uses("scene"), uses("samples"), uses("bounds"));
    let uses = Uses {
        scene,
        samples,
        bounds,
        rasters: uses("rasters"),
        floors: uses("floors"),
        micro: uses("micro_row"),
        means: uses("means"),
        beams: uses("beam_start"),
        crests: uses("crests"),
    };
    Module { uses, text }
}

fn place(name: &str, format: Format, placed: &mut Vec<&'static str>, text: &mut String) {
    let suffix = match format {
        Format::I16 => ".i16",
        Format::F32 => ".f32",
    };
    let fits = |p: &&Piece| p.name == name || p.name.strip_suffix(suffix) == Some(name);
    let piece = PIECES.iter().find(fits).expect("a test places every intrinsic");
    if placed.contains(&piece.name) {
        return;
    }
    for need in piece.needs {
        place(need, format, placed, text);
    }
    placed.push(piece.name);
    let surface = piece.name.rsplit('_').next().unwrap_or_default();
    text.push_str(&piece.text.replace("SURFACE", surface));
    text.push('\n');
}

/// The error-free transforms with what they need, for their proof on a device.
pub(crate) fn transforms() -> String {
    let mut text = String::new();
    place("transforms", Format::F32, &mut Vec::new(), &mut text);
    text
}

/// The stage that builds one level of a mipmap of bounds.
pub fn pyramid_stage(format: Format, side: Side) -> String {
    let keys = match format {
        Format::I16 => include_str!("../../../shaders/terrain/pyramid_i16.wgsl"),
        Format::F32 => include_str!("../../../shaders/terrain/pyramid_f32.wgsl"),
    };
    let outer = match side {
        Side::Above => "max",
        Side::Below => "min",
    };
    format!("{keys}\n{}", include_str!("../../../shaders/terrain/pyramid.wgsl").replace("OUTER", outer))
}

#[cfg(test)]
mod tests {
    use super::*;
    use wgpu::naga;

    fn validate(text: &str) -> naga::Module {
        let module =
            naga::front::wgsl::parse_str(text).unwrap_or_else(|e| panic!("{}", e.emit_to_string(text)));
        let mut validator = naga::valid::Validator::new(
            naga::valid::ValidationFlags::all(),
            naga::valid::Capabilities::empty(),
        );
        validator.validate(&module).unwrap_or_else(|e| panic!("{}", e.emit_to_string(text)));
        module
    }

    #[test]
    fn every_intrinsic_is_a_valid_function_of_its_type() {
        for format in [Format::I16, Format::F32] {
            for intrinsic in Intrinsic::ALL {
                let module = validate(&wgsl(&[*intrinsic], format).text);
                let found =
                    module.functions.iter().find(|(_, f)| f.name.as_deref() == Some(intrinsic.name()));
                let function = found.unwrap_or_else(|| panic!("no function {}", intrinsic.name())).1;
                assert_eq!(function.arguments.len(), intrinsic.params().len(), "{}", intrinsic.name());
                let result = function.result.as_ref().expect("an intrinsic has a result");
                let of = &module.types[result.ty];
                let is_struct = matches!(of.inner, naga::TypeInner::Struct { .. });
                let name = of.name.clone().filter(|_| is_struct);
                let expected = ghyll_compiler::intrinsics::returns_struct(*intrinsic);
                assert_eq!(name, expected.then(|| format!("{}_result", intrinsic.name())));
            }
        }
    }

    #[test]
    fn all_together_stand_once() {
        let twice: Vec<_> = Intrinsic::ALL.iter().chain(Intrinsic::ALL).copied().collect();
        for format in [Format::I16, Format::F32] {
            let module = wgsl(&twice, format);
            validate(&module.text);
            assert_eq!(
                module.uses,
                Uses {
                    scene: true,
                    samples: true,
                    bounds: true,
                    rasters: true,
                    floors: true,
                    micro: true,
                    means: true,
                    beams: true,
                    crests: true
                }
            );
            assert!(!module.text.contains("SURFACE"));
        }
    }

    #[test]
    fn what_is_not_reached_is_not_there() {
        let module = wgsl(&[Intrinsic::Camera], Format::I16);
        assert_eq!(module.uses, Uses { scene: true, ..Uses::default() });
        assert!(!module.text.contains("terrain_walk"));
        assert_eq!(wgsl(&[], Format::F32), Module::default());
    }

    #[test]
    fn the_pyramid_stage_is_valid() {
        for side in [Side::Above, Side::Below] {
            validate(&pyramid_stage(Format::I16, side));
            validate(&pyramid_stage(Format::F32, side));
        }
    }
}
