//! Stage splice: the new tokens of a pair, kept ones and granted outputs, and how they are cut into blocks.

use super::allocate::Grant;
use super::decode::Pair;
use super::execute::Output;
use super::tokens::Tokens;

/// The pair's tokens with its granted redexes replaced.
pub fn splice(pair: &Pair, grants: &[Option<Grant>], outputs: &[Output]) -> Tokens {
    let mut tokens = Tokens::default();
    let mut kept = 0;
    for (redex, grant) in pair.redexes.iter().zip(grants) {
        let Some(grant) = grant else { continue };
        tokens.extend(&pair.tokens, kept, redex.from);
        tokens.extend(&outputs[grant.output].tokens, grant.from, grant.to);
        kept = redex.to;
    }
    tokens.extend(&pair.tokens, kept, pair.tokens.len());
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
