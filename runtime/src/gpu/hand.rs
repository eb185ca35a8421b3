//! The hand of a lane: a task's operands and its emission in registers. They are read from the window and written to
//! it once, whatever task it is: llvmpipe runs all tasks in every turn, and an access to the window is dear there, as
//! lanes have different places in it.

use super::code::Code;
use super::shape::Shape;
use super::template::fill;
use crate::error::RunError;

/// Most registers of a hand; programs whose rewrites are longer work in the window itself.
const MOST: u32 = 24;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hand {
    pub operands: u32,
    /// Literals that go to the left stack.
    pub literals: u32,
    /// Words that go to the right stack.
    pub laters: u32,
}

impl Hand {
    /// `arity` is the longest one, the runtime's own task included.
    pub fn new(code: &Code, arity: u32) -> Option<Hand> {
        let hand = Hand { operands: arity, literals: code.widths.first, laters: code.widths.later };
        (hand.operands + hand.literals + hand.laters <= MOST).then_some(hand)
    }

    /// WGSL with the functions of `hand_window.wgsl`.
    fn wgsl(&self) -> String {
        let Hand { operands, literals, laters } = *self;
        let registers = |name: &str, count: u32| -> String {
            (0..count).map(|i| format!("var<private> {name}_{i}: u32;\n")).collect()
        };
        // The count is known wherever a task is put in place of its call, so of all these one is left.
        let keep = |name: &str, count: u32| -> String {
            let one = |i| format!("    {name}_{i} = select({name}_{i}, word, {name}s == {i}u);\n");
            format!(
                "fn {name}(word: u32) {{\n{}    {name}s += 1u;\n}}\n\n",
                (0..count).map(one).collect::<String>()
            )
        };
        let each = |count: u32, line: &dyn Fn(u32) -> String| (0..count).map(line).collect::<String>();
        [
            registers("operand", operands),
            registers("literal", literals),
            registers("later", laters),
            "var<private> literals: u32;\nvar<private> laters: u32;\n\n".to_owned(),
            "fn take_hand(count: u32) {\n    left -= count;\n    literals = 0u;\n    laters = 0u;\n"
                .to_owned(),
            each(operands, &|i| {
                format!("    if (count > {i}u) {{ operand_{i} = window[slot(left + {i}u)]; }}\n")
            }),
            "}\n\nfn lay_hand() {\n".to_owned(),
            each(literals, &|i| {
                format!("    if (literals > {i}u) {{ window[slot(left + {i}u)] = literal_{i}; }}\n")
            }),
            each(laters, &|i| {
                let place = format!("window[slot(WINDOW - {}u - right)]", i + 1);
                format!("    if (laters > {i}u) {{ {place} = later_{i}; }}\n")
            }),
            "    left += literals;\n    right += laters;\n}\n\nfn consume(count: u32) {}\n\n".to_owned(),
            "fn operand(index: u32) -> u32 {\n    var word = 0u;\n".to_owned(),
            each(operands, &|i| format!("    word = select(word, operand_{i}, index == {i}u);\n")),
            "    return word;\n}\n\n".to_owned(),
            keep("literal", literals),
            keep("later", laters),
        ]
        .concat()
    }
}

const IN_WINDOW: &str = include_str!("../../../shaders/hand_window.wgsl");

/// The functions by which tasks see the stream.
pub fn functions(shape: &Shape) -> Result<String, RunError> {
    match shape.hand {
        Some(hand) => Ok(hand.wgsl()),
        None => {
            let guard = if shape.can_exhaust { "if (exhausted) {\n        return;\n    }" } else { "" };
            fill(IN_WINDOW, "GUARD", guard)
        }
    }
}
