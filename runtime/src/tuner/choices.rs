//! What can be chosen, as data.

use ghyll_compiler::argument::parse_arguments;
use ghyll_compiler::compile::Options;
use ghyll_compiler::typed::Module;
use std::fmt;

/// Parameters that choices vary where a program has them, with values from the best picture to the cheapest.
pub const OPERATORS: &[(&str, &[&str])] = &[("detail", &["true", "false"]), ("shadows", &["true", "false"])];

/// Samples of a pixel, from the cheapest to the best picture.
pub const SAMPLES: &[u32] = &[1, 2, 4, 8];

/// One way to draw a program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Choice {
    /// Parameters with their values, as `--set` takes them.
    pub set: Vec<(String, String)>,
    /// Samples of every pixel.
    pub samples: u32,
    /// Whether baked functions are kept in rasters.
    pub bake: bool,
}

impl Choice {
    /// Whether it differs in samples only, so that one program draws both.
    pub fn same_program(&self, other: &Choice) -> bool {
        self.set == other.set && self.bake == other.bake
    }

    /// What the compiler is told of it.
    pub fn apply(&self, options: &Options) -> Options {
        let mut options = options.clone();
        options.set.extend(self.set.iter().cloned());
        options.no_bake |= !self.bake;
        options
    }
}

impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        for (name, value) in &self.set {
            write!(f, "{name}={value}, ")?;
        }
        write!(f, "{} sample{} a pixel", self.samples, if self.samples == 1 { "" } else { "s" })?;
        if self.bake { Ok(()) } else { f.write_str(", no bake") }
    }
}

/// All choices of a program, the best picture first and those of one program together. What `options` has fixed stays;
/// samples vary unless they are given, baking where there is something to bake.
pub fn choices(module: &Module, options: &Options, samples: Option<u32>, bakes: bool) -> Vec<Choice> {
    let free = |name: &str| {
        let fixed = options.set.iter().any(|(set, _)| set == name) || options.live.iter().any(|l| l == name);
        module.params.iter().find(|param| param.name == name).filter(|_| !fixed)
    };
    let mut sets: Vec<Vec<(String, String)>> = vec![Vec::new()];
    for (name, values) in OPERATORS {
        let Some(param) = free(name) else { continue };
        let held: Vec<&str> =
            values.iter().copied().filter(|v| parse_arguments(module, v, &param.ty).is_ok()).collect();
        if held.len() > 1 {
            let with = |set: &Vec<(String, String)>, value: &str| {
                let mut set = set.clone();
                set.push((name.to_string(), value.to_string()));
                set
            };
            sets =
                sets.iter().flat_map(|set| held.iter().map(|v| with(set, v)).collect::<Vec<_>>()).collect();
        }
    }
    let baking: &[bool] = if bakes && !options.no_bake { &[true, false] } else { &[true] };
    let mut counts = samples.map_or(SAMPLES.to_vec(), |count| vec![count]);
    counts.sort_unstable_by(|a, b| b.cmp(a));
    let mut all = Vec::new();
    for bake in baking {
        for set in &sets {
            all.extend(counts.iter().map(|samples| Choice {
                set: set.clone(),
                samples: *samples,
                bake: *bake,
            }));
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use ghyll_compiler::compile::check;
    use ghyll_compiler::source::Source;

    const PROGRAM: &str = "
        param detail: bool = false;
        param shadows: f32 = 1.0;
        fn pixel(p: vec2) -> f32 = if detail { shadows } else { p.x };
    ";

    #[test]
    fn only_what_a_program_can_hold_varies() {
        let module = check(Source::new("p", PROGRAM)).unwrap().module;
        let all = choices(&module, &Options::default(), None, false);
        assert_eq!(all.len(), 2 * SAMPLES.len());
        assert_eq!(all[0].to_string(), "detail=true, 8 samples a pixel");
        assert_eq!(all[all.len() - 1].to_string(), "detail=false, 1 sample a pixel");

        let fixed = Options { set: vec![("detail".into(), "true".into())], ..Options::default() };
        let left = choices(&module, &fixed, Some(3), true);
        let told: Vec<String> = left.iter().map(Choice::to_string).collect();
        assert_eq!(told, ["3 samples a pixel", "3 samples a pixel, no bake"]);
        let live = Options { live: vec!["detail".into()], no_bake: true, ..Options::default() };
        assert_eq!(choices(&module, &live, Some(1), true).len(), 1);
    }
}
