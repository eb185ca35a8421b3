//! THE table of modes: the machines and settings that a case runs on.
//!
//! A case that names no modes runs on the oracle, on the CPU and in one mode of the GPU. These take turns, so that each
//! area meets all of them ([`Mode::in_turn`]). `GHYLL_ALL_MODES=1` asks every mode of every case.

use crate::case::{Case, Expectation};

macro_rules! modes {
    ($($id:ident $name:literal $family:literal $always:literal;)*) => {
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Mode { $($id),* }

        impl Mode {
            pub const ALL: &'static [Mode] = &[$(Mode::$id),*];

            pub fn name(self) -> &'static str {
                match self { $(Mode::$id => $name),* }
            }

            /// `oracle`, `single`, `cpu` or `gpu`.
            pub fn family(self) -> &'static str {
                match self { $(Mode::$id => $family),* }
            }

            /// Asked of every case that names no modes.
            pub fn always(self) -> bool {
                match self { $(Mode::$id => $always),* }
            }
        }
    };
}

modes! {
    Oracle "oracle" "oracle" true;
    // The oracle in single precision, for comparisons to the bit.
    OracleSingle "oracle-single" "single" false;
    CpuAuto "cpu-auto" "cpu" true;
    CpuBlock "cpu-block" "cpu" true;
    CpuLane "cpu-lane" "cpu" true;
    GpuAuto "gpu-auto" "gpu" false;
    // Without wgpu's bounds and loop checks.
    GpuTrusted "gpu-trusted" "gpu" false;
    // The paper's algorithm: blocks, depth 1.
    GpuBlock "gpu-block" "gpu" false;
    GpuLane "gpu-lane" "gpu" false;
    // Blocks of 32 words: redexes lie across block borders.
    GpuTinyBlocks "gpu-tiny-blocks" "gpu" false;
    // An arena of a few blocks: breadth must turn into depth.
    GpuTinyArena "gpu-tiny-arena" "gpu" false;
}

impl Mode {
    pub fn is_gpu(self) -> bool {
        self.family() == "gpu"
    }

    /// The modes a word of a case header stands for: `all`, a family or a name.
    pub fn named(word: &str) -> Option<Vec<Mode>> {
        let chosen: Vec<Mode> = Mode::ALL
            .iter()
            .copied()
            .filter(|m| word == "all" || word == m.family() || word == m.name())
            .collect();
        (!chosen.is_empty()).then_some(chosen)
    }

    /// The first mode whose shaders are the same for every program.
    pub fn kernels(self) -> Mode {
        match self {
            Mode::GpuLane | Mode::GpuTinyArena => Mode::GpuAuto,
            _ => self,
        }
    }

    fn on_gpu() -> Vec<Mode> {
        Mode::ALL.iter().copied().filter(|m| m.is_gpu()).collect()
    }

    /// Gives the cases that name no modes the usual ones and one of the GPU each, in turn, or as many as an area needs to
    /// meet all of them. What ends in a failure or is measured depends on the mode, so such a case is run in the usual
    /// one of the GPU unless it names its modes.
    pub fn in_turn(cases: &mut [Case], all: bool) {
        let on_gpu = Mode::on_gpu();
        let measured = |c: &Case| {
            let depends =
                |e: &Expectation| matches!(e, Expectation::Fails { .. } | Expectation::Rounds { .. });
            c.settings.memory.is_some() || c.settings.timeout.is_some() || c.expectations.iter().any(depends)
        };
        for area in cases.chunk_by_mut(|a, b| a.area() == b.area()) {
            let mut unnamed: Vec<&mut Case> = area.iter_mut().filter(|c| c.modes.is_empty()).collect();
            unnamed.iter_mut().for_each(|case| case.modes = Mode::usual());
            let (fixed, mut chosen): (Vec<&mut Case>, Vec<&mut Case>) =
                unnamed.into_iter().filter(|c| crate::judge::runs(c)).partition(|c| measured(c));
            fixed.into_iter().for_each(|case| case.modes.push(Mode::GpuAuto));
            let pictures = |c: &Case| c.expectations.iter().any(|e| matches!(e, Expectation::Render(_)));
            // Pictures have shaders of their own, and turns of their own.
            chosen.sort_by_key(|c| pictures(c));
            let count = chosen.len();
            for turn in 0..on_gpu.len().max(count) {
                if let Some(case) = chosen.get_mut(turn % count.max(1)) {
                    case.modes.push(on_gpu[turn % on_gpu.len()]);
                }
            }
            if all {
                chosen.iter_mut().for_each(|case| case.modes = Mode::ALL.to_vec());
            }
        }
    }

    pub fn usual() -> Vec<Mode> {
        Mode::ALL.iter().copied().filter(|m| m.always()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::parse;

    fn cases(count: usize) -> Vec<Case> {
        let one = |i| format!("//# case c{i}\n//# run main() => 1\nfn main() -> i32 = 1;\n");
        let text: String = (0..count).map(one).collect();
        parse("a/b", &text).expect("sound headers")
    }

    #[test]
    fn every_area_meets_every_mode() {
        for count in [1, 2, 5, 17] {
            let mut cases = cases(count);
            Mode::in_turn(&mut cases, false);
            for mode in Mode::on_gpu() {
                assert!(cases.iter().any(|c| c.modes.contains(&mode)), "{count} cases lack {}", mode.name());
            }
            let least = Mode::usual().len() + 1;
            assert!(cases.iter().all(|c| c.modes.len() >= least && c.modes.starts_with(&Mode::usual())));
        }
    }

    #[test]
    fn named_modes_stay_and_all_is_all() {
        let text = "//# case a\n//# run main() => 1\n//# modes oracle cpu\nfn main() -> i32 = 1;\n";
        let mut named = parse("a/b", text).expect("sound headers");
        Mode::in_turn(&mut named, true);
        assert_eq!(named[0].modes, Mode::usual(), "none of the GPU");
        let text = "//# case a\n//# fails main() => 3 \"x\"\nfn main() -> i32 = 1;\n";
        let mut measured = parse("a/b", text).expect("sound headers");
        Mode::in_turn(&mut measured, true);
        assert_eq!(measured[0].modes, [Mode::usual(), vec![Mode::GpuAuto]].concat());
        let mut usual = cases(2);
        Mode::in_turn(&mut usual, true);
        assert!(usual.iter().all(|c| c.modes == Mode::ALL));
    }
}
