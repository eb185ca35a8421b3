//! Stage execute: lanes draw redexes from the queue, rewrite each up to `depth` times in a window of their own, and
//! publish what is left of it.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use rayon::prelude::*;

use super::decode::{Pair, Redex};
use super::machine::{Machine, Stop};
use super::pool::Pool;
use super::tokens::Tokens;
use crate::error::RunError;

/// A redex of the queue: its pair, and which of the pair's redexes it is.
#[derive(Clone, Copy, Debug)]
pub struct Record {
    pub pair: usize,
    pub redex: Redex,
}

/// What the records of one part of the queue were rewritten to.
#[derive(Default)]
pub struct Output {
    pub tokens: Tokens,
    /// Where each record's tokens end.
    pub ends: Vec<usize>,
    /// Records at the end of the part that were left for later.
    pub left: usize,
    /// Components of a pixel.
    pub components: u32,
    /// Pixels that were taken from the stream: index, components.
    pub stored: Vec<(u32, Vec<u32>)>,
}

/// All redexes that decode found, in stream order.
pub fn queue(pairs: &[Pair]) -> Vec<Record> {
    let of_pair = |(pair, loaded): (usize, &Pair)| {
        loaded.redexes.iter().map(|redex| Record { pair, redex: *redex }).collect::<Vec<_>>()
    };
    pairs.iter().enumerate().flat_map(of_pair).collect()
}

/// Outputs for `part` records each, in the queue's order. One record may use all memory; of several, those that begin
/// when little is left are left for later.
pub fn execute(
    pool: &Pool,
    pairs: &[Pair],
    queue: &[Record],
    (depth, part): (u64, usize),
    components: u32,
) -> Result<Vec<Output>, RunError> {
    let floor = if queue.len() > 1 { pool.limits.free_memory() / 4 } else { 0 };
    let made = AtomicU64::new(0);
    let run = |records: &[Record]| {
        pool.with(|machine| {
            machine.leave_free(floor);
            let mut output = Output { components, ..Output::default() };
            let function = records.first().map_or("", |r| pool.code.function(r.redex.task));
            pool.limits.check_clock(function)?;
            for (index, record) in records.iter().enumerate() {
                if pool.limits.free_memory() < floor {
                    output.left = records.len() - index;
                    break;
                }
                let before = output.tokens.bytes();
                rewrite(machine, &pairs[record.pair].tokens, record.redex, depth, &mut output)?;
                let more = output.tokens.bytes() - before;
                made.fetch_add(more, Relaxed);
                pool.limits.take(more);
            }
            Ok(output)
        })
    };
    let outputs = queue.par_chunks(part).map(run).collect();
    // What is granted of them is charged as the stream's.
    pool.limits.release(made.into_inner());
    outputs
}

fn rewrite(
    machine: &mut Machine,
    tokens: &Tokens,
    redex: Redex,
    depth: u64,
    output: &mut Output,
) -> Result<(), RunError> {
    machine.begin(tokens, redex);
    while machine.run(depth)? == Stop::Store {
        match machine.take_store(output.components) {
            Some(pixel) => output.stored.push(pixel),
            None => break,
        }
    }
    machine.publish(&mut output.tokens);
    output.ends.push(output.tokens.len());
    Ok(())
}
