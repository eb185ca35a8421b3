//! Presets (paper, section 4): rows of parameter values for time, quality or memory, for any program that has
//! parameters of these names.

/// One row. What a program has no parameter for, or cannot hold, is passed over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    pub name: &'static str,
    /// Parameters with their values, as `--set` takes them.
    pub set: &'static [(&'static str, &'static str)],
    /// Samples of every pixel.
    pub samples: u32,
    /// Whether baked functions are kept in rasters.
    pub bake: bool,
}

pub const PRESETS: &[Preset] = &[
    Preset { name: "time", set: &[("shadows", "false"), ("detail", "false")], samples: 1, bake: true },
    Preset { name: "quality", set: &[("shadows", "true"), ("detail", "true")], samples: 8, bake: true },
    Preset { name: "memory", set: &[("detail", "false"), ("lighting", "sunlit")], samples: 1, bake: false },
];

impl Preset {
    pub fn named(name: &str) -> Option<&'static Preset> {
        PRESETS.iter().find(|preset| preset.name == name)
    }
}
