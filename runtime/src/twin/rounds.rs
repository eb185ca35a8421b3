//! The rounds: decode, execute, allocate, splice over pairs of neighbouring blocks, (2k, 2k+1) and
//! (2k+1, 2k+2) in turn, so that every redex comes to lie in one pair.

use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::allocate::{self, Allocation, Grant, TOKEN_BYTES, allocate};
use super::decode::{Pair, decode};
use super::execute::{Output, Record, execute, queue};
use super::order::{Block, Part, fresh, join, pair_up};
use super::pool::Pool;
use super::schedule::Schedule;
use super::splice::splice;
use super::tokens::Tokens;
use crate::config::Stats;
use crate::error::RunError;

/// Depth at which a redex that still needs more memory than there is ends the run.
const LAST_RESORT: u64 = 1 << 24;

/// Pairs that are done sooner by one thread than shared out.
const FEW: usize = 8;

pub struct Rounds<'p, 'r> {
    pool: &'p Pool<'r>,
    schedule: Schedule,
    /// Tokens in a block.
    block: usize,
    /// Components of a pixel, for `store`.
    components: u32,
    order: Vec<Block>,
    /// Whether the first block stays alone in the next round.
    odd: bool,
    /// Rounds since the last one that found a redex.
    idle: u32,
    /// Bytes charged for the stream.
    held: u64,
    /// Function of the first redex of the last round that had one.
    function: &'r str,
    pub stats: Stats,
}

/// Takes a pixel: index and components.
pub type Store<'s> = dyn FnMut(u32, &[u32]) + 's;

impl<'p, 'r> Rounds<'p, 'r> {
    /// `block` is raised until a redex fits two neighbouring blocks.
    pub fn new(pool: &'p Pool<'r>, schedule: Schedule, block: u32, components: u32) -> Rounds<'p, 'r> {
        let arities = pool.code.tasks.iter().map(|t| t.arity);
        let longest = arities.chain([1 + components]).max().unwrap_or(0);
        let block = block.max(2 * (longest + 1)) as usize;
        let stats = Stats::default();
        let (order, function) = (Vec::new(), "");
        Rounds { pool, schedule, block, components, order, odd: false, idle: 0, held: 0, function, stats }
    }

    /// Rewrites `stream` to its normal form and calls `observe` with every stream on the way.
    pub fn run(
        &mut self,
        stream: Tokens,
        store: &mut Store,
        observe: &mut dyn FnMut(&[Block]),
    ) -> Result<Vec<u32>, RunError> {
        self.function = self.first_function(&stream);
        self.charge(stream.len() as u64, self.function)?;
        self.order = fresh(stream, self.block);
        self.odd = false;
        self.idle = 0;
        observe(&self.order);
        while self.order.iter().any(|b| !b.tokens.all_literals(0, b.tokens.len())) {
            if self.round(store)? {
                observe(&self.order);
            }
        }
        self.pool.limits.release(std::mem::take(&mut self.held));
        Ok(std::mem::take(&mut self.order).into_iter().flat_map(|b| b.tokens.into_words()).collect())
    }

    /// One round; tells whether there was anything to rewrite.
    fn round(&mut self, store: &mut Store) -> Result<bool, RunError> {
        let clock = Instant::now();
        let length: u64 = self.order.iter().map(|b| b.tokens.len() as u64).sum();
        let (parts, mut pairs) = self.load();
        let mut records = queue(&pairs);
        self.limit_queue(&mut pairs, &mut records);
        lap(clock, &mut self.stats.decode);
        // Where the stream doubles, a single round takes as long as all before it.
        if let Some(first) = records.first() {
            self.function = self.pool.code.function(first.redex.task);
        }
        let function = self.function;
        self.pool.limits.check_clock(function)?;

        let mut depth = self.schedule.depth(records.len());
        let (outputs, Allocation { grants, length }) = loop {
            let (mut outputs, allocation) = self.rewrite(&pairs, &records, length, depth)?;
            if records.is_empty() || allocation.grants.iter().any(Option::is_some) {
                for (index, components) in outputs.iter_mut().flat_map(|o| o.stored.drain(..)) {
                    store(index, &components);
                }
                break (outputs, allocation);
            }
            // Not one redex may become longer: the first has to become shorter, in a window of its own.
            if depth >= LAST_RESORT {
                let bytes = (length + outputs[0].tokens.len() as u64) * TOKEN_BYTES;
                return Err(self.pool.limits.out_of_memory(bytes, function));
            }
            depth = depth.saturating_mul(16).min(LAST_RESORT);
            keep_first(1, &mut pairs, &mut records);
        };
        self.charge(length, function)?;

        let clock = Instant::now();
        let block = self.schedule.block(self.block, length as usize, records.len());
        let moved = self.write(parts, &pairs, (&grants, &outputs), block);
        lap(clock, &mut self.stats.splice);

        self.odd = !self.odd;
        self.finish(&records, length, moved, function)
    }

    /// Stages execute and allocate.
    fn rewrite(
        &mut self,
        pairs: &[Pair],
        records: &[Record],
        length: u64,
        depth: u64,
    ) -> Result<(Vec<Output>, Allocation), RunError> {
        let clock = Instant::now();
        let part = (records.len() / (8 * rayon::current_num_threads())).clamp(1, 256);
        let outputs = execute(self.pool, pairs, records, (depth, part), self.components)?;
        lap(clock, &mut self.stats.execute);

        let clock = Instant::now();
        let room = allocate::room(self.pool.limits.free_memory() + self.held);
        let allocation = allocate(records, &outputs, length, room);
        lap(clock, &mut self.stats.allocate);
        Ok((outputs, allocation))
    }

    fn finish(
        &mut self,
        records: &[Record],
        length: u64,
        moved: u64,
        function: &str,
    ) -> Result<bool, RunError> {
        if records.is_empty() {
            self.idle = if moved == 0 { self.idle + 1 } else { 0 };
            return match self.idle {
                // Both ways of pairing were tried since the blocks last changed.
                4.. => Err(self.pool.limits.fail(RunError::Internal("function tokens lack operands".into()))),
                _ => Ok(false),
            };
        }
        self.idle = 0;
        self.stats.rounds += 1;
        self.stats.tokens_moved += moved;
        self.stats.longest_stream = self.stats.longest_stream.max(length);
        self.pool.limits.check_clock(function)?;
        Ok(true)
    }

    /// Decodes the pairs that may have redexes; those that have some.
    fn load(&mut self) -> (Vec<Part>, Vec<Pair>) {
        let mut parts = pair_up(std::mem::take(&mut self.order), self.odd);
        let (code, components, regions) = (self.pool.code, self.components, self.schedule.regions());
        let decode = |part: &mut &mut Part| match self.pool.limits.is_over() {
            true => Pair::default(),
            false => decode(code, components, regions, part.tokens()),
        };
        let mut open: Vec<&mut Part> = parts.iter_mut().filter(|part| !part.is_quiet()).collect();
        let decoded: Vec<Pair> = match open.len() {
            0..FEW => open.iter_mut().map(decode).collect(),
            _ => open.par_iter_mut().with_min_len(4).map(decode).collect(),
        };
        let mut pairs = Vec::with_capacity(decoded.len());
        for (part, pair) in open.into_iter().zip(decoded) {
            if pair.redexes.is_empty() {
                part.set_quiet();
            } else {
                part.pair = Some(pairs.len());
                pairs.push(pair);
            }
        }
        (parts, pairs)
    }

    /// Splices the pairs in which something was granted; how many tokens that wrote.
    fn write(
        &mut self,
        parts: Vec<Part>,
        pairs: &[Pair],
        (grants, outputs): (&[Option<Grant>], &[Output]),
        block: usize,
    ) -> u64 {
        let mut firsts = Vec::with_capacity(pairs.len());
        let mut next = 0;
        for pair in pairs {
            firsts.push(next);
            next += pair.redexes.len();
        }
        let write = |part: Part| {
            if self.pool.limits.is_over() {
                return Vec::new();
            }
            let at =
                part.pair.map(|at| (&pairs[at], &grants[firsts[at]..firsts[at] + pairs[at].redexes.len()]));
            match at {
                Some((pair, grants)) if grants.iter().any(Option::is_some) => {
                    fresh(splice(pair, grants, outputs), block)
                }
                _ => part.keep(block),
            }
        };
        let written: Vec<Vec<Block>> = match pairs.len() {
            0..FEW => parts.into_iter().map(write).collect(),
            _ => parts.into_par_iter().with_min_len(4).map(write).collect(),
        };
        self.order = join(written.into_iter());
        self.order.iter().filter(|b| b.fresh).map(|b| b.tokens.len() as u64).sum()
    }

    /// Leaves as many redexes in the queue as the free memory holds in the worst case of one rewrite each, at
    /// least one: breadth turns into depth when memory runs low.
    fn limit_queue(&self, pairs: &mut [Pair], records: &mut Vec<Record>) {
        let each = u64::from(self.pool.code.longest_emission.max(1)) * TOKEN_BYTES;
        let most = (self.pool.limits.free_memory() / each).max(1);
        if records.len() as u64 > most {
            keep_first(most as usize, pairs, records);
        }
    }

    fn charge(&mut self, length: u64, function: &str) -> Result<(), RunError> {
        self.pool.limits.hold(self.held, length * TOKEN_BYTES, function)?;
        self.held = length * TOKEN_BYTES;
        Ok(())
    }

    fn first_function(&self, stream: &Tokens) -> &'r str {
        let first = stream.functions_in(0, stream.len()).next();
        first.map_or("", |at| self.pool.code.function(stream.words()[at]))
    }
}

/// Forgets all redexes but the first ones.
fn keep_first(count: usize, pairs: &mut [Pair], records: &mut Vec<Record>) {
    records.truncate(count);
    for (at, pair) in pairs.iter_mut().enumerate() {
        let first = records.partition_point(|r| r.pair < at);
        let last = records.partition_point(|r| r.pair <= at);
        pair.redexes.truncate(last - first);
    }
}

fn lap(since: Instant, total: &mut Duration) {
    *total += since.elapsed();
}
