//! The stream between two rounds: blocks in order, and where no redex can be. A pair in which nothing was found is
//! not looked at again until one of its blocks changes, so a round costs what its redexes do and not what the
//! whole stream does.

use super::splice::blocks;
use super::tokens::Tokens;

#[derive(Default)]
pub struct Block {
    pub tokens: Tokens,
    /// Written in the last round.
    pub fresh: bool,
    /// No redex within it.
    quiet: bool,
    /// None over the border to its neighbour either.
    quiet_left: bool,
    quiet_right: bool,
}

impl Block {
    fn new(tokens: Tokens) -> Block {
        Block { tokens, fresh: true, ..Block::default() }
    }
}

/// Cuts tokens into fresh blocks.
pub fn fresh(tokens: Tokens, block: usize) -> Vec<Block> {
    blocks(tokens, block).into_iter().map(Block::new).collect()
}

/// Two neighbouring blocks, or one that has no partner in this round.
pub struct Part {
    pub first: Block,
    pub second: Option<Block>,
    /// Whether it is one of the pairs that have redexes.
    pub open: bool,
}

impl Part {
    /// Whether it is known to hold no redex.
    pub fn is_quiet(&self) -> bool {
        self.first.quiet
            && self
                .second
                .as_ref()
                .is_none_or(|second| second.quiet && self.first.quiet_right && second.quiet_left)
    }

    /// Notes that it holds no redex.
    pub fn set_quiet(&mut self) {
        self.first.quiet = true;
        if let Some(second) = &mut self.second {
            second.quiet = true;
            second.quiet_left = true;
            self.first.quiet_right = true;
        }
    }

    /// All its tokens, which are not copied where there is one block: [`Part::give_back`] returns them.
    pub fn take_tokens(&mut self) -> Tokens {
        match &self.second {
            None => std::mem::take(&mut self.first.tokens),
            Some(_) => self.joined(),
        }
    }

    /// Returns what [`Part::take_tokens`] took.
    pub fn give_back(&mut self, tokens: Tokens) {
        if self.second.is_none() {
            self.first.tokens = tokens;
        }
    }

    fn joined(&self) -> Tokens {
        let mut tokens = self.first.tokens.clone();
        if let Some(second) = &self.second {
            tokens.extend(&second.tokens, 0, second.tokens.len());
        }
        tokens
    }

    /// Whether cutting it anew would make no fewer blocks and none that is less than half full, as a redex must not
    /// lie in more than two.
    fn is_even(&self, block: usize) -> bool {
        let first = self.first.tokens.len();
        match &self.second {
            None => first <= block,
            Some(second) => {
                let second = second.tokens.len();
                (first + second).div_ceil(block) == 2 && 2 * first.min(second) >= block
            }
        }
    }

    /// Its blocks as they are, or evened out.
    pub fn keep(self, block: usize) -> Vec<Block> {
        if !self.is_even(block) {
            let tokens = if self.second.is_none() { self.first.tokens } else { self.joined() };
            return fresh(tokens, block);
        }
        std::iter::once(self.first).chain(self.second).collect()
    }
}

/// Pairs of neighbours; if `odd`, the first block has no partner.
pub fn pair_up(order: Vec<Block>, odd: bool) -> Vec<Part> {
    let mut parts = Vec::with_capacity(order.len() / 2 + 1);
    let mut order = order.into_iter().map(|block| Block { fresh: false, ..block });
    if odd && let Some(first) = order.next() {
        parts.push(Part { first, second: None, open: false });
    }
    while let Some(first) = order.next() {
        parts.push(Part { first, second: order.next(), open: false });
    }
    parts
}

/// The next order. Where a part has vanished, others become neighbours.
pub fn join(written: impl Iterator<Item = Vec<Block>>) -> Vec<Block> {
    let mut order = Vec::new();
    let mut gap = false;
    for mut part in written {
        match part.first_mut() {
            Some(first) => first.quiet_left &= !std::mem::take(&mut gap),
            None => gap = true,
        }
        order.append(&mut part);
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    fn order(sizes: &[usize]) -> Vec<Block> {
        let block = |size: &usize| {
            let mut tokens = Tokens::default();
            tokens.push_literals(&vec![0; *size]);
            Block::new(tokens)
        };
        sizes.iter().map(block).collect()
    }

    fn quiet(order: Vec<Block>, odd: bool) -> Vec<Block> {
        let mut parts = pair_up(order, odd);
        parts.iter_mut().for_each(Part::set_quiet);
        join(parts.into_iter().map(|p| p.keep(8)))
    }

    fn which(order: Vec<Block>, odd: bool) -> Vec<bool> {
        pair_up(order, odd).iter().map(Part::is_quiet).collect()
    }

    #[test]
    fn both_ways_of_pairing_are_looked_at() {
        let once = || quiet(order(&[8, 8, 8, 8]), false);
        assert_eq!(which(once(), false), [true, true]);
        assert_eq!(which(once(), true), [true, false, true]);
        assert_eq!(which(quiet(once(), true), true), [true, true, true]);
    }

    #[test]
    fn a_changed_block_and_a_vanished_pair_are_looked_at_again() {
        let all = || quiet(quiet(order(&[8; 6]), false), true);
        let mut changed = all();
        changed[2] = order(&[8]).remove(0);
        assert_eq!(which(changed, false), [true, false, true]);
        let mut parts = pair_up(all(), false);
        parts.remove(1);
        let vanished =
            |at: usize, p: Part| if at == 1 { vec![Vec::new(), p.keep(8)] } else { vec![p.keep(8)] };
        let written = parts.into_iter().enumerate().flat_map(|(at, p)| vanished(at, p));
        assert_eq!(which(join(written), true), [true, false, true]);
    }

    #[test]
    fn uneven_pairs_are_cut_anew() {
        let sizes = |of: &[usize]| -> Vec<usize> {
            let parts = pair_up(order(of), false).into_iter().map(|p| p.keep(8));
            join(parts).iter().map(|b| b.tokens.len()).collect()
        };
        assert_eq!(sizes(&[4, 5]), [4, 5]);
        assert_eq!(sizes(&[3, 7]), [5, 5]);
        assert_eq!(sizes(&[3, 4]), [7]);
        assert_eq!(sizes(&[9]), [4, 5]);
    }
}
