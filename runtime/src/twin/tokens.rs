//! A piece of the stream: words, and one bit a word that says whether it is a function token.

use ghyll_compiler::core::Const;
use ghyll_compiler::table::{TaskId, Token};

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tokens {
    words: Vec<u32>,
    /// Bit i of word i / 64: token i is a function token. Bits past the end are 0.
    functions: Vec<u64>,
}

impl Tokens {
    pub fn from_stream(stream: &[Token<Const>]) -> Tokens {
        let mut tokens = Tokens::default();
        for token in stream {
            match token {
                Token::Literal(c) => tokens.push_literals(&[c.word()]),
                Token::Function(task) => tokens.push_function(task.0),
            }
        }
        tokens
    }

    pub fn len(&self) -> usize {
        self.words.len()
    }

    pub fn words(&self) -> &[u32] {
        &self.words
    }

    pub fn into_words(self) -> Vec<u32> {
        self.words
    }

    pub fn is_function(&self, at: usize) -> bool {
        self.functions.get(at / 64).is_some_and(|bits| bits >> (at % 64) & 1 != 0)
    }

    pub fn push_literals(&mut self, words: &[u32]) {
        self.words.extend_from_slice(words);
        self.functions.resize(self.words.len().div_ceil(64), 0);
    }

    pub fn push_function(&mut self, task: u32) {
        let at = self.words.len();
        self.push_literals(&[task]);
        self.functions[at / 64] |= 1 << (at % 64);
    }

    /// Appends tokens `from..to` of another piece.
    pub fn extend(&mut self, other: &Tokens, from: usize, to: usize) {
        let base = self.words.len();
        self.push_literals(&other.words[from..to]);
        // Function tokens are few: their bits are set one by one.
        for at in other.functions_in(from, to) {
            let at = base + at - from;
            self.functions[at / 64] |= 1 << (at % 64);
        }
    }

    /// Places of the function tokens in `from..to`, ascending.
    pub fn functions_in(&self, from: usize, to: usize) -> impl Iterator<Item = usize> + '_ {
        let first = from / 64;
        let last = to.div_ceil(64).min(self.functions.len());
        (first..last.max(first)).flat_map(move |i| {
            let mut bits = self.functions[i] & mask(i, from, to);
            std::iter::from_fn(move || {
                let bit = bits.trailing_zeros();
                bits &= bits.wrapping_sub(1);
                (bit < 64).then_some(i * 64 + bit as usize)
            })
        })
    }

    /// The mask test: are all tokens in `from..to` literals?
    pub fn all_literals(&self, from: usize, to: usize) -> bool {
        let last = to.div_ceil(64).min(self.functions.len());
        (from / 64..last).all(|i| self.functions[i] & mask(i, from, to) == 0)
    }

    /// As the compiler's stream form, with untyped words.
    pub fn to_stream(&self) -> Vec<Token<u32>> {
        let token = |(i, word): (usize, &u32)| match self.is_function(i) {
            true => Token::Function(TaskId(*word)),
            false => Token::Literal(*word),
        };
        self.words.iter().enumerate().map(token).collect()
    }
}

/// Bits of word `i` that belong to tokens `from..to`.
fn mask(i: usize, from: usize, to: usize) -> u64 {
    let base = i * 64;
    let low = from.saturating_sub(base).min(64);
    let high = to.saturating_sub(base).min(64);
    let below = |n: usize| if n == 64 { u64::MAX } else { (1 << n) - 1 };
    below(high) & !below(low)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(n: usize) -> Tokens {
        let mut tokens = Tokens::default();
        for i in 0..n as u32 {
            if i % 7 == 3 || i % 64 == 63 {
                tokens.push_function(i);
            } else {
                tokens.push_literals(&[i]);
            }
        }
        tokens
    }

    #[test]
    fn pieces_keep_their_bits() {
        let all = sample(300);
        for (from, to) in [(0, 300), (5, 5), (3, 64), (60, 70), (63, 129), (64, 192), (299, 300)] {
            let mut piece = sample(13);
            piece.extend(&all, from, to);
            assert_eq!(piece.len(), 13 + to - from);
            for i in from..to {
                assert_eq!(piece.is_function(13 + i - from), all.is_function(i), "{from}..{to} at {i}");
            }
            let expected: Vec<_> = (from..to).filter(|i| all.is_function(*i)).collect();
            assert_eq!(all.functions_in(from, to).collect::<Vec<_>>(), expected);
            assert_eq!(all.all_literals(from, to), expected.is_empty());
        }
    }
}
