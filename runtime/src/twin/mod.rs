//! The CPU twin: the rounds of the GPU in Rust, under the shaders' names, and the machine where there is no
//! adapter.
//!
//! - [`compile`] turns the function table into the register form ([`code`], [`instruction`]);
//! - [`machine`] is a lane: registers and the window of two stacks;
//! - [`decode`], [`execute`], [`allocate`], [`splice`] are the stages, [`rounds`] their sequence over
//!   the stream's [`order`], [`schedule`] the
//!   depth of each round;
//! - [`lane`] rewrites values and pixels in one window, without rounds;
//! - [`limits`] is what ends a run that does not end by itself.

mod allocate;
mod code;
mod compile;
mod decode;
mod execute;
mod instruction;
mod lane;
mod limits;
mod machine;
mod order;
mod pool;
mod rounds;
mod schedule;
mod splice;
mod tokens;

#[cfg(test)]
mod tests;

use ghyll_compiler::core::Const;
use ghyll_compiler::table::{Table, TaskId, Token};

use self::code::Code;
use self::limits::Limits;
use self::order::Block;
use self::pool::Pool;
use self::rounds::Rounds;
use self::schedule::Schedule;
use self::tokens::Tokens;
use crate::config::{Config, Rewriter, Stats};
use crate::error::RunError;
use crate::memory::Memory;
use crate::world::World;

/// Pixels whose streams are rewritten together in block mode.
const PART: u64 = 1 << 16;

/// Sees a stream.
pub type Observe<'o> = dyn FnMut(&[Token<u32>]) + Send + 'o;

/// A function table, ready to run on the CPU.
pub struct Twin {
    code: Code,
    /// Words of the live parameters, one after the other.
    live: Vec<u32>,
}

impl Twin {
    pub fn new(table: &Table) -> Result<Twin, RunError> {
        Ok(Twin { code: compile::compile(table)?, live: Vec::new() })
    }

    /// Sets the words of the live parameters, one after the other; those that are missing are 0.
    pub fn set_live(&mut self, words: &[u32]) {
        self.live = words.to_vec();
    }

    /// Rewrites `stream` to its normal form; returns the words that are left.
    pub fn run(
        &self,
        stream: &[Token<Const>],
        config: &Config,
        world: Option<&dyn World>,
    ) -> Result<(Vec<u32>, Stats), RunError> {
        self.rewrite(stream, config, world, None)
    }

    /// As [`Twin::run`], calling `observe` with every stream between two rounds, the first one included. In
    /// lane mode there are no rounds and so only the first.
    pub fn run_observed(
        &self,
        stream: &[Token<Const>],
        config: &Config,
        world: Option<&dyn World>,
        observe: &mut Observe,
    ) -> Result<(Vec<u32>, Stats), RunError> {
        self.rewrite(stream, config, world, Some(observe))
    }

    fn rewrite(
        &self,
        stream: &[Token<Const>],
        config: &Config,
        world: Option<&dyn World>,
        mut observe: Option<&mut Observe>,
    ) -> Result<(Vec<u32>, Stats), RunError> {
        let tokens = Tokens::from_stream(stream);
        self.in_pool(config, world, 0, |pool| {
            if config.rewriter == Rewriter::Lane {
                if let Some(observe) = observe {
                    observe(&tokens.to_stream());
                }
                return Ok((lane::value(pool, &tokens)?, Stats::default()));
            }
            // The stream is put together only for who asks: that costs its whole length.
            let mut seen = |blocks: &[Block]| {
                if let Some(observe) = &mut observe {
                    let stream: Vec<_> = blocks.iter().flat_map(|b| b.tokens.to_stream()).collect();
                    observe(&stream);
                }
            };
            let schedule = Schedule::new(config, rayon::current_num_threads());
            let mut rounds = Rounds::new(pool, schedule, config.block, 0);
            let words = rounds.run(tokens, &mut |_, _| {}, &mut seen)?;
            Ok((words, rounds.stats))
        })
    }

    /// Evaluates `entry`, which takes a position and returns `components` floats, at the centre of every pixel. Rows
    /// from the top, a pixel's components side by side.
    pub fn render(
        &self,
        (width, height): (u32, u32),
        components: u32,
        entry: TaskId,
        config: &Config,
        world: Option<&dyn World>,
    ) -> Result<(Vec<f32>, Stats), RunError> {
        let image = u64::from(width) * u64::from(height) * u64::from(components) * 4;
        self.in_pool(config, world, image, |pool| match config.rewriter {
            Rewriter::Block => self.render_blocks(pool, (width, height), components, entry.0, config),
            Rewriter::Auto | Rewriter::Lane => {
                let picture = lane::image(pool, (width, height), components, entry.0, config)?;
                Ok((picture, Stats::default()))
            }
        })
    }

    /// Block mode: the image's stream, `index x y entry store` for each pixel, part by part.
    fn render_blocks(
        &self,
        pool: &Pool,
        (width, height): (u32, u32),
        components: u32,
        entry: u32,
        config: &Config,
    ) -> Result<(Vec<f32>, Stats), RunError> {
        let pixels = u64::from(width) * u64::from(height);
        let mut image = vec![0.0; (pixels * u64::from(components)) as usize];
        let part = (config.max_memory / 256).clamp(1, PART);
        let schedule = Schedule::new(config, rayon::current_num_threads());
        let mut rounds = Rounds::new(pool, schedule, config.block, components);
        for first in (0..pixels).step_by(part as usize) {
            let mut stream = Tokens::default();
            for index in first..(first + part).min(pixels) {
                let at = [(index % u64::from(width)) as u32, (index / u64::from(width)) as u32];
                let [x, y] = lane::within(at, config.point).map(f32::to_bits);
                stream.push_literals(&[index as u32, x, y]);
                stream.push_function(entry);
                stream.push_function(self.code.store());
            }
            let mut store = |index: u32, words: &[u32]| {
                let at = index as usize * components as usize;
                for (to, word) in image[at..at + components as usize].iter_mut().zip(words) {
                    *to = f32::from_bits(*word);
                }
            };
            let rest = rounds.run(stream, &mut store, &mut |_| {})?;
            if !rest.is_empty() {
                return Err(RunError::Internal(format!("an image left {} words in its stream", rest.len())));
            }
            config.progress.part((width, height), first + part, pixels);
        }
        Ok((image, rounds.stats))
    }

    /// Runs `work` on the threads that were asked for, beside an image of so many bytes, and completes its statistics.
    fn in_pool<T: Send>(
        &self,
        config: &Config,
        world: Option<&dyn World>,
        image: u64,
        work: impl FnOnce(&Pool) -> Result<(T, Stats), RunError> + Send,
    ) -> Result<(T, Stats), RunError> {
        let fixed = Memory { image, terrain: world.map_or(0, World::bytes), ..Memory::default() };
        let limits = Limits::new(config, fixed)?;
        let run = || {
            let pool = Pool::new(&self.code, &self.live, &limits, world);
            work(&pool)
        };
        let (value, stats) = match config.threads {
            None => run(),
            Some(count) => rayon::ThreadPoolBuilder::new()
                .num_threads(count.max(1))
                .build()
                .map_err(|e| RunError::Device(format!("no threads: {e}")))?
                .install(run),
        }?;
        let counted = Stats {
            rewrites: limits.rewrites(),
            memory: Memory { stream: limits.peak_memory() - fixed.total(), ..fixed },
            total: limits.elapsed(),
            ..stats
        };
        Ok((value, counted))
    }
}
