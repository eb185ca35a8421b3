//! An open document: its text, and positions in it. A position counts UTF-16 units, places in the compiler count bytes.

use ghyll_compiler::source::Span;
use lsp_types::{Position, Range, TextDocumentContentChangeEvent};

#[derive(Clone, Debug, Default)]
pub struct Text {
    pub text: String,
    /// Where lines begin.
    lines: Vec<usize>,
}

impl Text {
    pub fn new(text: impl Into<String>) -> Text {
        let text = text.into();
        let bytes = text.as_bytes();
        let ends = (0..bytes.len()).filter(|&i| match bytes[i] {
            b'\n' => true,
            b'\r' => bytes.get(i + 1) != Some(&b'\n'),
            _ => false,
        });
        let lines = std::iter::once(0).chain(ends.map(|end| end + 1)).collect();
        Text { text, lines }
    }

    /// The position of a byte; of one within a character, that of the character.
    pub fn position(&self, byte: usize) -> Position {
        let mut byte = byte.min(self.text.len());
        while !self.text.is_char_boundary(byte) {
            byte -= 1;
        }
        let line = self.lines.partition_point(|start| *start <= byte) - 1;
        let before = &self.text[self.lines[line]..byte];
        Position::new(line as u32, before.encode_utf16().count() as u32)
    }

    /// The byte of a position; behind the end of a line its end, behind the last line the end of the text.
    pub fn byte(&self, position: Position) -> usize {
        let Some(&start) = self.lines.get(position.line as usize) else { return self.text.len() };
        let end = self.lines.get(position.line as usize + 1).copied().unwrap_or(self.text.len());
        let line = self.text[start..end].trim_end_matches(['\n', '\r']);
        let mut left = position.character as usize;
        for (at, c) in line.char_indices() {
            if left < c.len_utf16() {
                return start + at;
            }
            left -= c.len_utf16();
        }
        start + line.len()
    }

    pub fn range(&self, span: Span) -> Range {
        Range::new(self.position(span.start as usize), self.position(span.end as usize))
    }

    /// The whole text.
    pub fn whole(&self) -> Range {
        Range::new(Position::new(0, 0), self.position(self.text.len()))
    }

    /// The text after a change: of a part, or of everything.
    pub fn changed(self, change: TextDocumentContentChangeEvent) -> Text {
        let Some(range) = change.range else { return Text::new(change.text) };
        let start = self.byte(range.start);
        let end = self.byte(range.end).max(start);
        let mut text = self.text;
        text.replace_range(start..end, &change.text);
        Text::new(text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(line: u32, character: u32) -> Position {
        Position::new(line, character)
    }

    #[test]
    fn positions_count_units_of_utf_16() {
        let text = Text::new("aä\u{1F3D4}b\r\n\rx\n");
        for (byte, position) in [
            (0, at(0, 0)),
            (1, at(0, 1)),
            (3, at(0, 2)),
            (7, at(0, 4)),
            (8, at(0, 5)),
            (10, at(1, 0)),
            (11, at(2, 0)),
            (13, at(3, 0)),
        ] {
            assert_eq!(text.position(byte), position, "{byte}");
            assert_eq!(text.byte(position), byte, "{position:?}");
        }
        // Within the mountain, behind the line, behind the text.
        assert_eq!((text.byte(at(0, 3)), text.byte(at(0, 99)), text.byte(at(99, 0))), (3, 8, 13));
        assert_eq!(text.position(5), at(0, 2));
        assert_eq!(text.position(99), at(3, 0));
    }

    #[test]
    fn changes_are_made_at_positions() {
        let change = |range: Option<(Position, Position)>, text: &str| TextDocumentContentChangeEvent {
            range: range.map(|(a, b)| Range::new(a, b)),
            range_length: None,
            text: text.into(),
        };
        let text = Text::new("fn f() = \u{1F3D4}1;\nend");
        let text = text.changed(change(Some((at(0, 11), at(0, 12))), "größe"));
        assert_eq!(text.text, "fn f() = \u{1F3D4}größe;\nend");
        let text = text.changed(change(Some((at(0, 17), at(9, 0))), ""));
        assert_eq!(text.text, "fn f() = \u{1F3D4}größe;");
        // Ends before it begins: nothing is removed.
        let text = text.changed(change(Some((at(0, 2), at(0, 1))), "!"));
        assert_eq!(text.text, "fn! f() = \u{1F3D4}größe;");
        assert_eq!(text.changed(change(None, "new")).text, "new");
    }
}
