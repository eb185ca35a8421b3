//! The rounds: decode, execute, allocate, splice over pairs of neighbouring blocks, (2k, 2k+1) and
//! (2k+1, 2k+2) in turn, so that every redex comes to lie in one pair.

use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::allocate::{self, Allocation, Grant, TOKEN_BYTES, allocate};
use super::decode::{Pair, Redex, decode};
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

/// Most redexes of a round, and the pairs that are decoded before they are counted.
const MOST_REDEXES: u64 = 1 << 20;
const BATCH: usize = 1024;

/// What a redex takes beside its tokens.
const REDEX_BYTES: usize = size_of::<Redex>() + size_of::<Record>() + size_of::<Option<Grant>>();

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
    /// Tokens in a block of the last round.
    cut: usize,
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
        let cut = block;
        Rounds {
            pool,
            schedule,
            block,
            components,
            order,
            odd: false,
            cut,
            idle: 0,
            held: 0,
            function,
            stats,
        }
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
        let most = self.most_redexes();
        let (parts, mut pairs) = self.load(most);
        let mut records = queue(&pairs);
        let mut limited = records.len() >= most;
        keep_first(most, &mut pairs, &mut records);
        lap(clock, &mut self.stats.decode);
        // Where the stream doubles, a single round takes as long as all before it.
        if let Some(first) = records.first() {
            self.function = self.pool.code.function(first.redex.task);
        }
        let function = self.function;
        self.pool.limits.check_clock(function)?;

        let mut depth = self.schedule.depth(records.len(), length);
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
            limited = true;
        };
        self.charge(length, function)?;

        let clock = Instant::now();
        // Few redexes tell nothing of the stream if they are not all.
        if !limited {
            self.cut = self.schedule.block(self.block, length as usize, records.len());
        }
        let moved = self.write(parts, pairs, (&grants, &outputs), self.cut);
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
        // What was dropped because the time is over must not pass for the end of the stream.
        self.pool.limits.check_clock(function)?;
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
        Ok(true)
    }

    /// Decodes the pairs that may have redexes, up to about `most`; those that have some.
    fn load(&mut self, most: usize) -> (Vec<Part>, Vec<Pair>) {
        let mut parts = pair_up(std::mem::take(&mut self.order), self.odd);
        let (code, components, regions) = (self.pool.code, self.components, self.schedule.regions());
        let mut open: Vec<&mut Part> = parts.iter_mut().filter(|part| !part.is_quiet()).collect();
        let mut pairs: Vec<Pair> = Vec::with_capacity(open.len());
        let mut found = 0;
        for batch in open.chunks_mut(BATCH) {
            if found >= most {
                break;
            }
            let each = (most - found).div_ceil(batch.len());
            let limits = self.pool.limits;
            let decode = |part: &mut &mut Part| match limits.is_over() {
                true => Pair::default(),
                false => decode(code, components, regions, each, part.take_tokens(), || limits.is_over()),
            };
            let decoded: Vec<Pair> = match batch.len() {
                0..FEW => batch.iter_mut().map(decode).collect(),
                _ => batch.par_iter_mut().with_min_len(4).map(decode).collect(),
            };
            for (part, pair) in batch.iter_mut().zip(decoded) {
                if pair.redexes.is_empty() {
                    part.give_back(pair.tokens);
                    part.set_quiet();
                } else {
                    found += pair.redexes.len();
                    part.open = true;
                    pairs.push(pair);
                }
            }
        }
        (parts, pairs)
    }

    /// Splices the pairs in which something was granted; how many tokens that wrote.
    fn write(
        &mut self,
        parts: Vec<Part>,
        pairs: Vec<Pair>,
        (grants, outputs): (&[Option<Grant>], &[Output]),
        block: usize,
    ) -> u64 {
        let few = pairs.len() < FEW;
        let mut pairs = pairs.into_iter();
        let mut grants = grants;
        let granted = parts.into_iter().map(|part| {
            let pair = if part.open { pairs.next() } else { None };
            let count = pair.as_ref().map_or(0, |pair| pair.redexes.len());
            let (own, rest) = grants.split_at(count);
            grants = rest;
            (part, pair, own)
        });
        let granted: Vec<_> = granted.collect();
        let limits = self.pool.limits;
        let write = |(mut part, pair, grants): (Part, Option<Pair>, &[Option<Grant>])| {
            if limits.is_over() {
                return Vec::new();
            }
            match pair {
                Some(pair) if grants.iter().any(Option::is_some) => {
                    fresh(splice(&pair, grants, outputs, || limits.is_over()), block)
                }
                pair => {
                    if let Some(pair) = pair {
                        part.give_back(pair.tokens);
                    }
                    part.keep(block)
                }
            }
        };
        let written: Vec<Vec<Block>> = match few {
            true => granted.into_iter().map(write).collect(),
            false => granted.into_par_iter().with_min_len(4).map(write).collect(),
        };
        self.order = join(written.into_iter());
        self.order.iter().filter(|b| b.fresh).map(|b| b.tokens.len() as u64).sum()
    }

    /// As many redexes as the free memory holds in the worst case of one rewrite each, at least one: breadth turns into
    /// depth when memory runs low.
    fn most_redexes(&self) -> usize {
        let emission = u64::from(self.pool.code.longest_emission.max(1)) * TOKEN_BYTES;
        (self.pool.limits.free_memory() / (emission + REDEX_BYTES as u64)).clamp(1, MOST_REDEXES) as usize
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
    if records.len() <= count {
        return;
    }
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
