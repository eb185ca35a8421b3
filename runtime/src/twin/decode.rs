//! Stage decode: loads a pair of neighbouring blocks and finds its redexes by mask tests.

use super::code::Code;
use super::tokens::Tokens;

/// A function token with its operands, all of them literals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Redex {
    /// First operand.
    pub start: usize,
    /// The function token.
    pub end: usize,
    pub task: u32,
}

/// Two neighbouring blocks, loaded together.
#[derive(Debug, Default)]
pub struct Pair {
    pub tokens: Tokens,
    pub redexes: Vec<Redex>,
}

/// Arity of a function token; `store` takes a pixel's index and components.
pub fn arity(code: &Code, task: u32, components: u32) -> usize {
    code.tasks.get(task as usize).map_or(1 + components as usize, |t| t.arity as usize)
}

pub fn decode(code: &Code, components: u32, first: Tokens, second: Option<Tokens>) -> Pair {
    let mut tokens = first;
    if let Some(second) = second {
        tokens.extend(&second, 0, second.len());
    }
    let mut redexes = Vec::new();
    for end in tokens.functions_in(0, tokens.len()) {
        let task = tokens.words()[end];
        let Some(start) = end.checked_sub(arity(code, task, components)) else { continue };
        if tokens.all_literals(start, end) {
            redexes.push(Redex { start, end, task });
        }
    }
    Pair { tokens, redexes }
}
