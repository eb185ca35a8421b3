//! THE table of modes: the machines and settings that a case runs on.
//!
//! A new pipeline costs a software adapter up to 300 ms, so only one GPU mode is asked of every case; the rest run
//! where a case says `modes all`.

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
    GpuAuto "gpu-auto" "gpu" true;
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

    pub fn usual() -> Vec<Mode> {
        Mode::ALL.iter().copied().filter(|m| m.always()).collect()
    }
}
