//! Source text in the usual layout. Only blanks, line ends and commas behind last elements change: every lexeme and
//! every comment stays, in order, so numbers keep their spelling and parentheses their place.
//!
//! Where lines end is the writer's choice, as far as it is one (see [`layout`]): a list that is opened at the end of a
//! line has its elements on lines of their own, a block with names in it always has. Lines that are too long are broken at
//! their outermost brackets.

mod angles;
mod layout;
mod lines;
mod spaces;
mod tokens;

use crate::diagnostic::Diagnostic;
use crate::front::on_large_stack;
use crate::parse;
use crate::print::same_tree;
use crate::source::SourceId;
use tokens::{comments, tokens};

/// Columns of a line where there is a choice.
pub const WIDTH: usize = 120;

/// The text in the usual layout, with `\n` at line ends and without a byte order mark.
///
/// # Errors
/// What is wrong with a text that is no program.
pub fn format(source: SourceId, text: &str) -> Result<String, Vec<Diagnostic>> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text).replace("\r\n", "\n").replace('\r', "\n");
    let parsed = parse::file(source, &text);
    if !parsed.diagnostics.is_empty() {
        return Err(parsed.diagnostics);
    }
    let angles = on_large_stack(|| angles::angles(&parsed.tree));
    let mut tokens = tokens(source, &text, &angles);
    let formatted = layout::layout(&mut tokens);
    // A layout that changes the program would be a defect of this module: then the text stays as it is.
    let again = parse::file(source, &formatted);
    let same = again.diagnostics.is_empty()
        && same_tree(&again.tree, &parsed.tree)
        && comments(&formatted) == comments(&text);
    debug_assert!(same, "{text}\n-- formatted --\n{formatted}");
    Ok(if same { formatted } else { text })
}

#[cfg(test)]
mod tests;
