//! The pages of `docs/errors/`, which explain each diagnostic code with a program that gives it and the mended one.

use crate::resolve;

/// Code and text of every page.
pub const PAGES: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/pages.rs"));

/// The page of a code, in upper or lower case; else the code that was probably meant.
pub fn page(code: &str) -> Result<&'static str, Option<&'static str>> {
    let code = code.to_ascii_uppercase();
    match PAGES.iter().find(|(known, _)| *known == code) {
        Some((_, text)) => Ok(text),
        None => Err(resolve::similar(&code, PAGES.iter().map(|(known, _)| *known))),
    }
}

/// A fenced block of a Markdown text.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// What stands behind the fence: language and words.
    pub tag: String,
    pub text: String,
    /// Line of the fence, from 1.
    pub line: usize,
}

/// The fenced blocks of a Markdown text.
pub fn blocks(markdown: &str) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut open: Option<Block> = None;
    for (i, line) in markdown.lines().enumerate() {
        match (line.strip_prefix("```"), &mut open) {
            (Some(tag), None) => {
                open = Some(Block { tag: tag.trim().to_owned(), text: String::new(), line: i + 1 });
            }
            (Some(_), Some(_)) => blocks.extend(open.take()),
            (None, Some(block)) => {
                block.text.push_str(line);
                block.text.push('\n');
            }
            (None, None) => {}
        }
    }
    blocks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_found_in_any_case() {
        assert_eq!(page("e0106"), page("E0106"));
        assert!(page("E0106").is_ok_and(|text| text.contains("chained")));
        assert!(page("E106").is_err_and(|meant| meant.is_some()));
        assert_eq!(page("something"), Err(None));
    }

    #[test]
    fn blocks_have_tags_and_lines() {
        let found = blocks("text\n```a b\nx\n\ny\n```\n```\nz\n```\n");
        let block = |tag: &str, text: &str, line| Block { tag: tag.to_owned(), text: text.to_owned(), line };
        assert_eq!(found, [block("a b", "x\n\ny\n", 2), block("", "z\n", 7)]);
    }
}
