//! Stage execute: lanes draw redexes from the queue, rewrite each up to `depth` times in a window of their own, and
//! publish what is left of it.

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

/// Outputs for `part` records each, in the queue's order.
pub fn execute(
    pool: &Pool,
    pairs: &[Pair],
    queue: &[Record],
    (depth, part): (u64, usize),
    components: u32,
) -> Result<Vec<Output>, RunError> {
    let run = |records: &[Record]| {
        pool.with(|machine| {
            let mut output = Output { components, ..Output::default() };
            let function = records.first().map_or("", |r| pool.code.function(r.redex.task));
            pool.limits.check_clock(function)?;
            for record in records {
                rewrite(machine, &pairs[record.pair].tokens, record.redex, depth, &mut output)?;
            }
            Ok(output)
        })
    };
    queue.par_chunks(part).map(run).collect()
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
