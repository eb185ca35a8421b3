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

    /// What the tokens take.
    pub fn bytes(&self) -> u64 {
        (4 * self.words.capacity() + 8 * self.functions.capacity()) as u64
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
        let masks = self.words.len().div_ceil(64);
        if masks > self.functions.len() {
            self.functions.resize(masks, 0);
        }
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
        // 64 bits at a time, which come to lie in one word or two.
        for at in (from..to).step_by(64) {
            let bits = other.bits(at, to);
            if bits != 0 {
                let (word, shift) = ((base + at - from) / 64, (base + at - from) % 64);
                self.functions[word] |= bits << shift;
                if let Some(rest) = bits.checked_shr(64 - shift as u32).filter(|rest| *rest != 0) {
                    self.functions[word + 1] |= rest;
                }
            }
        }
    }

    /// The function bits of up to 64 tokens from `at` on, none of `end` or later.
    fn bits(&self, at: usize, end: usize) -> u64 {
        let (word, shift) = (at / 64, at % 64);
        let low = self.functions.get(word).map_or(0, |bits| bits >> shift);
        let high = self.functions.get(word + 1).and_then(|bits| bits.checked_shl(64 - shift as u32));
        (low | high.unwrap_or(0)) & below((end - at).min(64))
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

    /// The last function token in `from..to`.
    pub fn last_function(&self, from: usize, to: usize) -> Option<usize> {
        (from / 64..to.div_ceil(64).min(self.functions.len())).rev().find_map(|i| {
            let bits = self.functions[i] & mask(i, from, to);
            (bits != 0).then(|| i * 64 + 63 - bits.leading_zeros() as usize)
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
    below(high) & !below(low)
}

/// The lowest `n` bits.
fn below(n: usize) -> u64 {
    if n == 64 { u64::MAX } else { (1 << n) - 1 }
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
        let ranges = [(0, 300), (5, 5), (3, 64), (60, 70), (63, 129), (64, 192), (299, 300)];
        for (before, (from, to)) in [0, 13, 51, 64].into_iter().flat_map(|n| ranges.map(|range| (n, range))) {
            let mut piece = sample(before);
            piece.extend(&all, from, to);
            assert_eq!(piece.len(), before + to - from);
            assert!((0..before).all(|i| piece.is_function(i) == all.is_function(i)));
            assert_eq!(all.last_function(from, to), (from..to).rev().find(|i| all.is_function(*i)));
            for i in from..to {
                assert_eq!(piece.is_function(before + i - from), all.is_function(i), "{from}..{to} at {i}");
            }
            let expected: Vec<_> = (from..to).filter(|i| all.is_function(*i)).collect();
            assert_eq!(all.functions_in(from, to).collect::<Vec<_>>(), expected);
            assert_eq!(all.all_literals(from, to), expected.is_empty());
        }
    }
}
