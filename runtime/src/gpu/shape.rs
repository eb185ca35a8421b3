//! All sizes of the rewriter, derived from the program and the adapter.

use super::code::Code;
use super::hand::Hand;
use crate::config::{Config, Rewriter};
use crate::error::RunError;

/// Longest block; a pair's function bits must fit into workgroup memory.
const LONGEST_BLOCK: u32 = 1 << 14;
/// Workgroups per row of a dispatch; WebGPU allows 65535.
pub const GRID: u32 = 32768;

/// Invocations and memory of a workgroup that WebGPU promises, less what the stages keep there themselves.
const MOST_LANES: u32 = 256;
const WORKGROUP_BYTES: u32 = (16 << 10) - 512;

/// Where lanes keep their windows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Windows {
    /// Private memory: twice as fast on llvmpipe where lanes stay long, but spills out of a GPU's registers.
    Private,
    /// Workgroup memory, those of a workgroup word by word side by side.
    Workgroup,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Words of a block.
    pub block: u32,
    /// Words of a lane's window.
    pub window: u32,
    /// Lanes of a workgroup.
    pub lanes: u32,
    /// Invocations of a workgroup in the other stages.
    pub group: u32,
    /// Longest emission, the runtime's own tasks included.
    pub emission: u32,
    /// Most literals of a segment of the right stack.
    pub segment: u32,
    /// None if tasks work in the window itself.
    pub hand: Option<Hand>,
    /// The compiler's tasks.
    pub tasks: u32,
    /// Words of live parameters.
    pub live: u32,
    /// Words of a pixel; 0 without an image.
    pub components: u32,
    /// Rewrites of the inner loop between two looks at what is rare.
    pub burst: u32,
    /// Rewrites of a record while redexes are few.
    pub expand: u32,
    /// Literals that a lane takes from the left at a time.
    pub pull: u32,
    pub windows: Windows,
    /// Fused loops can run out of fuel.
    pub can_exhaust: bool,
}

/// What a lane may leave behind: its window, a task, and what is far as one token on each side.
fn output(window: u32) -> u32 {
    window + 3
}

impl Shape {
    pub fn new(code: &Code, config: &Config, components: u32, software: bool) -> Result<Shape, RunError> {
        let store = if components == 0 { 0 } else { components + 1 };
        let arity = code.arities.iter().copied().max().unwrap_or(0).max(store);
        let emission = code.longest_emission.max(store + 1).max(4);
        let least = 4 * (arity + emission);
        let block = config.block.max(least + 3).next_multiple_of(32);
        if block > LONGEST_BLOCK {
            return Err(RunError::ArityTooLong { arity, limit: LONGEST_BLOCK / 8 });
        }
        let wide = config.rewriter == Rewriter::Block || components != 0;
        // In few sizes, so that programs can share kernels.
        let window = if wide { least } else { least.max(64) }.next_multiple_of(32).min(block - 3);
        let windows = if software && config.rewriter != Rewriter::Block {
            Windows::Private
        } else {
            Windows::Workgroup
        };
        let usual = if software { 8 } else { 32 };
        let lanes = config.threads.map_or(usual, |threads| {
            // What every adapter can hold.
            let most = match windows {
                Windows::Private => MOST_LANES,
                Windows::Workgroup => (WORKGROUP_BYTES / (4 * window)).clamp(1, MOST_LANES),
            };
            (threads as u32).clamp(1, most.max(usual))
        });
        Ok(Shape {
            block,
            window,
            lanes,
            group: if software { 8 } else { 32 },
            emission,
            segment: code.widths.segment,
            hand: Hand::new(code, arity),
            tasks: code.arities.len() as u32,
            live: code.live_words,
            components,
            burst: 64,
            expand: 8,
            pull: if config.rewriter == Rewriter::Block { 1 } else { window / 4 },
            windows,
            can_exhaust: code.functions.contains("exhausted") || code.prelude.contains("exhausted"),
        })
    }

    /// Words of a block with its function bits.
    pub fn stride(&self) -> u32 {
        self.block + self.block / 32
    }

    pub fn output(&self) -> u32 {
        output(self.window)
    }

    /// Words of a record with its output.
    pub fn record(&self) -> u32 {
        8 + self.output() + self.output().div_ceil(32)
    }

    /// The constants that the shaders expect. Kernels without the program's code are told nothing of it, so that
    /// most programs can share them.
    pub fn header(&self, runs_code: bool) -> String {
        let mut constants = vec![
            ("BLOCK", self.block),
            ("OUTPUT", self.output()),
            ("LANES", self.lanes),
            ("GROUP", self.group),
            ("EXPAND", self.expand),
            ("GRID", GRID),
        ];
        if runs_code {
            constants.extend([
                ("WINDOW", self.window),
                ("EMISSION", self.emission),
                ("TASKS", self.tasks),
                ("LIVE", self.live),
                ("COMPONENTS", self.components),
                ("BURST", self.burst),
                ("PULL", self.pull),
            ]);
        }
        constants.iter().map(|(name, value)| format!("const {name}: u32 = {value}u;\n")).collect()
    }
}
