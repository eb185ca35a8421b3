//! How deep the lanes of a round go: few redexes are expanded breadth first, plenty are finished depth first.

use crate::config::{Config, Rewriter};

/// Rewrites of a lane in a deep round, few enough to share out again what is left of unequal work.
const DEEP: u64 = 1 << 20;
/// The first depth of a stream whose redexes do not become more.
const PATIENT: u64 = 64;
/// Redexes for each thread that are plenty.
const PLENTY: usize = 32;
/// The greatest depth on a stream whose redexes do not become more, and for each token of the stream.
const NARROW: u64 = 1 << 24;
const NARROW_TOKEN: u64 = 4;
/// Depth of block rounds on a stream that is not narrow.
const BLOCK_DEPTH: u64 = 16;

pub enum Schedule {
    Fixed(u64),
    Adaptive(Adaptive),
}

pub struct Adaptive {
    /// Redexes that are plenty, and the depth then.
    plenty: (usize, u64),
    /// Depth while redexes become more.
    growing: u64,
    /// Depth while they do not, doubled every time.
    narrow: u64,
    /// Redexes of the last round.
    before: usize,
    /// Blocks may become longer on a wide stream too.
    auto: bool,
}

impl Schedule {
    pub fn new(config: &Config, threads: usize) -> Schedule {
        let (deep, growing) = match (config.depth, config.rewriter) {
            (Some(depth), _) => return Schedule::Fixed(u64::from(depth.max(1))),
            (None, Rewriter::Block) => (BLOCK_DEPTH, BLOCK_DEPTH),
            (None, _) => (DEEP, 1),
        };
        let auto = config.rewriter != Rewriter::Block;
        let plenty = (PLENTY * threads, deep);
        Schedule::Adaptive(Adaptive { plenty, growing, narrow: PATIENT, before: 0, auto })
    }

    /// Whether a redex takes the tokens around it along.
    pub fn regions(&self) -> bool {
        matches!(self, Schedule::Adaptive(_))
    }

    /// Tokens in a block, at least `least`, of a stream of `length` tokens with so many redexes: a narrow stream needs
    /// no blocks, and `auto` makes no more than keep all threads busy.
    pub fn block(&self, least: usize, length: usize, redexes: usize) -> usize {
        match self {
            Schedule::Fixed(_) => least,
            Schedule::Adaptive(adaptive) if 4 * redexes <= adaptive.plenty.0 => least.max(length),
            Schedule::Adaptive(adaptive) if adaptive.auto => least.max(length.div_ceil(adaptive.plenty.0)),
            Schedule::Adaptive(_) => least,
        }
    }

    /// The depth for a round with so many redexes in a stream of `length` tokens.
    pub fn depth(&mut self, redexes: usize, length: u64) -> u64 {
        match self {
            Schedule::Fixed(depth) => *depth,
            Schedule::Adaptive(adaptive) => adaptive.depth(redexes, length),
        }
    }
}

impl Adaptive {
    fn depth(&mut self, redexes: usize, length: u64) -> u64 {
        let grows = redexes > std::mem::replace(&mut self.before, redexes);
        if redexes >= self.plenty.0 {
            self.plenty.1
        } else if grows {
            self.growing
        } else {
            // A narrow stream: every round costs its whole length, so there are ever fewer rounds.
            self.narrow = (self.narrow * 2).min(NARROW);
            self.narrow.max(NARROW_TOKEN * length)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn narrow_streams_go_deep_and_growing_ones_do_not() {
        let mut schedule = Schedule::new(&Config::default(), 2);
        assert_eq!([1, 2, 4, 8].map(|n| schedule.depth(n, 1)), [1; 4]);
        assert_eq!(schedule.depth(64, 1), DEEP);
        let narrow: Vec<u64> = (0..20).map(|_| schedule.depth(1, 1)).collect();
        assert!(narrow.windows(2).all(|w| w[0] <= w[1]) && narrow[19] == NARROW, "{narrow:?}");
    }
}
