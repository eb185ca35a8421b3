//! Stage splice: the new tokens of a pair, kept ones and granted outputs, and how they are cut into blocks.

use super::allocate::Grant;
use super::decode::Pair;
use super::execute::Output;
use super::tokens::Tokens;

/// Tokens and redexes between two looks at the clock.
const LOOK: usize = 1 << 20;
const LOOK_REDEXES: usize = 1 << 12;

/// The pair's tokens with its granted redexes replaced; incomplete if the run is over.
pub fn splice(
    pair: &Pair,
    grants: &[Option<Grant>],
    outputs: &[Output],
    is_over: impl Fn() -> bool,
) -> Tokens {
    let mut tokens = Tokens::default();
    let mut kept = 0;
    let mut append = |other: &Tokens, from: usize, to: usize| {
        for at in (from..to).step_by(LOOK) {
            if at != from && is_over() {
                return;
            }
            tokens.extend(other, at, to.min(at + LOOK));
        }
    };
    for (step, (redex, grant)) in pair.redexes.iter().zip(grants).enumerate() {
        let Some(grant) = grant else { continue };
        if step % LOOK_REDEXES == LOOK_REDEXES - 1 && is_over() {
            return tokens;
        }
        append(&pair.tokens, kept, redex.from);
        append(&outputs[grant.output].tokens, grant.from, grant.to);
        kept = redex.to;
    }
    append(&pair.tokens, kept, pair.tokens.len());
    tokens
}

/// Cuts tokens into as few blocks as they fit, evenly filled.
pub fn blocks(tokens: Tokens, block: usize) -> Vec<Tokens> {
    let length = tokens.len();
    let count = length.div_ceil(block);
    if count == 1 {
        return vec![tokens];
    }
    let cut = |i: usize| {
        let mut piece = Tokens::default();
        piece.extend(&tokens, i * length / count, (i + 1) * length / count);
        piece
    };
    (0..count).map(cut).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_filled_evenly() {
        for (length, expected) in [(0, vec![]), (8, vec![8]), (9, vec![4, 5]), (17, vec![5, 6, 6])] {
            let mut tokens = Tokens::default();
            tokens.push_literals(&vec![0; length]);
            let sizes: Vec<usize> = blocks(tokens, 8).iter().map(Tokens::len).collect();
            assert_eq!(sizes, expected);
        }
    }
}
