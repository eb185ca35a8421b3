//! Lines as they are written, with the comments at their ends in a column.

use super::tokens::trimmed;

pub const INDENT: usize = 4;
/// Blanks before a comment at the end of a line, at least.
const APART: usize = 4;

#[derive(Clone, Debug, Default)]
pub struct Line {
    pub indent: usize,
    pub code: String,
    /// `//` comment at its end.
    pub comment: Option<String>,
    /// An empty line stands before it.
    pub apart: bool,
    /// The lexemes on it, from and to.
    pub tokens: (usize, usize),
}

impl Line {
    fn is_empty(&self) -> bool {
        self.code.is_empty() && self.comment.is_none()
    }

    /// Columns without the comment.
    pub fn width(&self) -> usize {
        INDENT * self.indent + self.code.lines().last().map_or(0, |line| line.chars().count())
    }
}

#[derive(Debug, Default)]
pub struct Lines {
    done: Vec<Line>,
    pub current: Line,
}

impl Lines {
    /// Ends the line, if it has anything, and begins another.
    pub fn begin(&mut self, indent: usize, apart: bool, token: usize) {
        let apart = apart && !(self.done.is_empty() && self.current.is_empty());
        let line = Line { indent, apart, tokens: (token, token), ..Line::default() };
        let ended = std::mem::replace(&mut self.current, line);
        if !ended.is_empty() {
            self.done.push(ended);
        } else {
            self.current.apart |= ended.apart;
        }
    }

    /// Adds a comment's lines to the code.
    pub fn comment(&mut self, text: &str) {
        let blanks = " ".repeat(INDENT * self.current.indent + 1);
        for (i, line) in trimmed(text).into_iter().enumerate() {
            if i > 0 {
                self.current.code.push('\n');
                if !line.is_empty() {
                    self.current.code.push_str(&blanks);
                }
            }
            self.current.code.push_str(line);
        }
    }

    pub fn finish(mut self) -> Vec<Line> {
        self.begin(0, false, 0);
        self.done
    }
}

/// The text of all lines.
pub fn text(lines: &[Line]) -> String {
    let mut out = String::new();
    let mut at = 0;
    while at < lines.len() {
        // Comments of neighbouring lines stand in one column.
        let count = lines[at..]
            .iter()
            .enumerate()
            .take_while(|(i, line)| {
                line.comment.is_some() && !line.code.is_empty() && (*i == 0 || !line.apart)
            })
            .count();
        let column = lines[at..at + count].iter().map(|line| line.width() + APART).max().unwrap_or(0);
        for line in &lines[at..at + count.max(1)] {
            if line.apart {
                out.push('\n');
            }
            out.push_str(&" ".repeat(INDENT * line.indent));
            out.push_str(&line.code);
            if let Some(comment) = &line.comment {
                let blanks = if line.code.is_empty() { 0 } else { column.saturating_sub(line.width()) };
                out.push_str(&" ".repeat(blanks));
                out.push_str(comment);
            }
            out.push('\n');
        }
        at += count.max(1);
    }
    out
}
