//! Stage decode: finds the redexes of a pair of neighbouring blocks by mask tests.

use super::code::Code;
use super::tokens::Tokens;

/// Function tokens between two looks at the clock.
const LOOK: usize = 1 << 16;

/// A function token with its operands, all of them literals, and the region of the stream that goes with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Redex {
    /// First token of the region, at or before the operands.
    pub from: usize,
    /// The function token.
    pub at: usize,
    pub task: u32,
    /// End of the region, after the function token.
    pub to: usize,
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

/// With `regions`, a redex takes along the literals before it and the tokens up to the next redex's: what waits for
/// its result is then in the same window. Without, it is the call alone, as in the paper. Those beyond the first `most`
/// are left for later.
pub fn decode(
    code: &Code,
    components: u32,
    regions: bool,
    most: usize,
    tokens: Tokens,
    is_over: impl Fn() -> bool,
) -> Pair {
    let mut redexes: Vec<Redex> = Vec::new();
    // Literals since the last function token.
    let mut run = 0;
    for (step, at) in tokens.functions_in(0, tokens.len()).enumerate() {
        if step % LOOK == LOOK - 1 && is_over() {
            break;
        }
        let task = tokens.words()[at];
        if let Some(first) = at.checked_sub(arity(code, task, components))
            && tokens.all_literals(first, at)
        {
            match redexes.last_mut() {
                Some(before) if regions => before.to = run,
                _ => {}
            }
            if redexes.len() >= most {
                break;
            }
            let (from, to) = if regions { (run, tokens.len()) } else { (first, at + 1) };
            redexes.push(Redex { from, at, task, to });
        }
        run = at + 1;
    }
    Pair { tokens, redexes }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::twin::code::TaskCode;

    #[test]
    fn regions_share_out_the_stream() {
        let task = |arity| TaskCode { start: 0, arity, function: String::new() };
        let code = Code { tasks: vec![task(1), task(2)], ..Code::default() };
        // 7 | 1 f0 | f1 | 2 3 f0 f1 4: the first f1 takes 7 and f0's result.
        let mut tokens = Tokens::default();
        tokens.push_literals(&[7, 1]);
        tokens.push_function(0);
        tokens.push_function(1);
        tokens.push_literals(&[2, 3]);
        tokens.push_function(0);
        tokens.push_function(1);
        tokens.push_literals(&[4]);
        let alone = decode(&code, 0, false, 9, tokens.clone(), || false).redexes;
        assert_eq!(alone.iter().map(|r| (r.from, r.at, r.to)).collect::<Vec<_>>(), [(1, 2, 3), (5, 6, 7)]);
        let shared = |most| {
            let found = decode(&code, 0, true, most, tokens.clone(), || false).redexes;
            found.iter().map(|r| (r.from, r.at, r.to)).collect::<Vec<_>>()
        };
        assert_eq!(shared(9), [(0, 2, 4), (4, 6, 9)]);
        assert_eq!(shared(1), [(0, 2, 4)], "what is the next one's stays its own");
    }
}
