//! The library modules, in Ghyll, as part of the compiler.

/// Names that are always in scope.
pub const PRELUDE: &str = "prelude";

/// Modules that `use` can name, with their texts.
pub const MODULES: &[(&str, &str)] = &[
    (PRELUDE, include_str!("../std/prelude.ghyll")),
    ("terrain", include_str!("../std/terrain.ghyll")),
    ("antialias", include_str!("../std/antialias.ghyll")),
    ("chart", include_str!("../std/chart.ghyll")),
    ("data", include_str!("../std/data.ghyll")),
    ("light", include_str!("../std/light.ghyll")),
    ("shade", concat!(include_str!("../std/shade.ghyll"), "\n", include_str!("../std/colormaps.ghyll"))),
    ("sky", include_str!("../std/sky.ghyll")),
    ("water", include_str!("../std/water.ghyll")),
];

pub fn text(name: &str) -> Option<&'static str> {
    MODULES.iter().find(|(module, _)| *module == name).map(|(_, text)| *text)
}

/// Name of a library text in diagnostics.
pub fn file_name(name: &str) -> String {
    format!("<library>/{name}.ghyll")
}
