//! Inputs: lines until brackets are closed, from a terminal with editing, else from standard input.

use crate::failure::Failure;
use ghyll_compiler::lexer::lex;
use ghyll_compiler::source::SourceId;
use rustyline::Editor;
use rustyline::config::{Builder, ColorMode};
use rustyline::error::ReadlineError;
use rustyline::history::MemHistory;
use std::io::{BufRead, IsTerminal, StdinLock};

pub enum Input {
    Text(String),
    /// `:name rest`
    Command(String, String),
}

pub enum Lines {
    Terminal(Box<Editor<(), MemHistory>>),
    Piped(StdinLock<'static>),
}

impl Lines {
    pub fn open() -> Result<Lines, Failure> {
        let input = std::io::stdin();
        if !input.is_terminal() {
            return Ok(Lines::Piped(input.lock()));
        }
        let config = Builder::new().auto_add_history(true).color_mode(ColorMode::Disabled).build();
        let editor = Editor::with_history(config, MemHistory::new()).map_err(failed)?;
        Ok(Lines::Terminal(Box::new(editor)))
    }

    pub fn on_terminal(&self) -> bool {
        matches!(self, Lines::Terminal(_))
    }

    /// The next input that is not empty; none at the end.
    pub fn next(&mut self) -> Result<Option<Input>, Failure> {
        let mut text = String::new();
        loop {
            let Some(line) = self.line(if text.is_empty() { "> " } else { ". " })? else {
                // What is not finished is told as it is.
                return Ok(Some(text).filter(|text| !text.trim().is_empty()).map(Input::Text));
            };
            if text.is_empty()
                && let Some(command) = line.trim().strip_prefix(':')
            {
                let (name, rest) = command.split_once(char::is_whitespace).unwrap_or((command, ""));
                return Ok(Some(Input::Command(name.into(), rest.trim().into())));
            }
            text.push_str(&line);
            text.push('\n');
            if !text.trim().is_empty() && lex(SourceId(0), &text).unclosed.is_empty() {
                return Ok(Some(Input::Text(text)));
            }
            if text.trim().is_empty() {
                text.clear();
            }
        }
    }

    fn line(&mut self, prompt: &str) -> Result<Option<String>, Failure> {
        match self {
            Lines::Terminal(editor) => match editor.readline(prompt) {
                Ok(line) => Ok(Some(line)),
                Err(ReadlineError::Eof | ReadlineError::Interrupted) => Ok(None),
                Err(error) => Err(failed(error)),
            },
            Lines::Piped(input) => {
                let mut line = String::new();
                let read = input.read_line(&mut line).map_err(failed)?;
                Ok((read > 0).then(|| line.trim_end_matches(['\n', '\r']).to_owned()))
            }
        }
    }
}

fn failed(error: impl std::fmt::Display) -> Failure {
    Failure::Input(format!("cannot read the input: {error}"))
}
