//! `ghyll repl`: items and expressions, one after the other.

mod input;
mod session;

use crate::arguments::Repl;
use crate::failure::Failure;
use crate::report::line;
use input::{Input, Lines};
use session::{Answer, Session};

const HELP: &str = "\
Type an expression to see its value, or an item (`fn`, `const`, `struct`, `enum`, `type`, `param`, `raster`, `use`) to keep it.
An item replaces an earlier one of the same name. `let x = e` keeps a constant. Text goes on in the next line while a bracket is open.
  :type e       the type of an expression
  :load FILE    the items of a file
  :list         the items kept
  :reset        forgets all items
  :help         this text
  :quit         ends; so does the end of the input";

pub fn repl(arguments: &Repl) -> Result<(), Failure> {
    let mut session = Session::new(arguments)?;
    let mut lines = Lines::open()?;
    if lines.on_terminal() {
        eprintln!("ghyll {}; :help tells what can be typed", env!("CARGO_PKG_VERSION"));
    }
    if let Some(file) = &arguments.file {
        session.load(file)?;
    }
    let mut mistakes = 0;
    while let Some(input) = lines.next()? {
        match answer(&mut session, &input) {
            Ok(Some(text)) => {
                if !text.is_empty() {
                    line!("{text}");
                }
            }
            Ok(None) => break,
            Err(failure) => {
                mistakes += 1;
                failure.tell();
            }
        }
    }
    match mistakes {
        0 => Ok(()),
        // At a terminal mistakes have been seen and mended.
        _ if lines.on_terminal() => Ok(()),
        1 => Err(Failure::Input("one input was wrong".into())),
        n => Err(Failure::Input(format!("{n} inputs were wrong"))),
    }
}

/// What an input gives; none at the end.
fn answer(session: &mut Session, input: &Input) -> Result<Option<String>, Failure> {
    let text = match input {
        Input::Text(text) => match session.enter(text)? {
            Answer::Kept => String::new(),
            Answer::Value(value) => value,
        },
        Input::Command(name, rest) => match (name.as_str(), rest.as_str()) {
            ("type" | "t", "") => return Err(usage(":type takes an expression, such as :type vec2(1)")),
            ("type" | "t", expression) => session.type_of(expression)?,
            ("load" | "l", "") => return Err(usage(":load takes a file")),
            ("load" | "l", file) => {
                session.load(file.as_ref())?;
                String::new()
            }
            ("list", "") => session.text(),
            ("reset", "") => {
                session.reset();
                String::new()
            }
            ("help" | "h" | "?", "") => HELP.into(),
            ("quit" | "q" | "exit", "") => return Ok(None),
            (name, _) => {
                return Err(usage(&format!("there is no command `:{name}` of that form; :help lists them")));
            }
        },
    };
    Ok(Some(text))
}

fn usage(message: &str) -> Failure {
    Failure::Usage(message.into())
}
