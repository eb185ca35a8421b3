//! Messages on a pair of streams. Whatever comes in, reading neither panics nor takes memory without bound.

use lsp_server::{ErrorCode, Message};
use serde_json::Value;
use std::io::{self, BufRead, Read, Write};
use std::sync::mpsc::{Receiver, Sender};

pub enum Incoming {
    Message(Message),
    /// No message, but the next one can be found.
    Wrong(ErrorCode, String),
    /// Nothing that follows can be understood.
    Broken(String),
}

pub enum Outgoing {
    Message(Message),
    Raw(Value),
}

/// Longest header line.
const LONGEST_LINE: u64 = 4 << 10;
/// Longest message, in bytes.
const LONGEST_MESSAGE: u64 = 256 << 20;

/// Passes on what is read until the stream ends.
pub fn read_all(mut from: impl BufRead, to: &Sender<Incoming>) {
    loop {
        let incoming = match body(&mut from) {
            Ok(None) => return,
            Ok(Some(body)) => message(&body),
            Err(broken) => Incoming::Broken(broken),
        };
        let last = matches!(incoming, Incoming::Broken(_));
        if to.send(incoming).is_err() || last {
            return;
        }
    }
}

fn message(body: &[u8]) -> Incoming {
    let value: Value = match serde_json::from_slice(body) {
        Ok(value) => value,
        Err(error) => {
            return Incoming::Wrong(ErrorCode::ParseError, format!("the message is no JSON: {error}"));
        }
    };
    // A request whose id is of another kind would pass for a notification, and wait for its answer.
    let answerable = value
        .get("id")
        .is_none_or(|id| id.is_string() || id.as_i64().is_some_and(|id| i32::try_from(id).is_ok()));
    match serde_json::from_value(value) {
        Ok(message) if answerable => Incoming::Message(message),
        _ => {
            let text = "neither a request nor a notification: those have a `method`, and an `id` is an integer or a text";
            Incoming::Wrong(ErrorCode::InvalidRequest, text.into())
        }
    }
}

/// The bytes of the next message; none at the end of the stream.
fn body(from: &mut impl BufRead) -> Result<Option<Vec<u8>>, String> {
    let mut length: Option<u64> = None;
    let mut first = true;
    loop {
        let mut line = Vec::new();
        from.take(LONGEST_LINE).read_until(b'\n', &mut line).map_err(|e| e.to_string())?;
        if line.is_empty() && first {
            return Ok(None);
        }
        first = false;
        if line.last() != Some(&b'\n') {
            return Err("standard input holds no message: a header line does not end".into());
        }
        let text = String::from_utf8_lossy(&line);
        let text = text.trim_end();
        if text.is_empty() {
            break;
        }
        let Some((name, value)) = text.split_once(':') else {
            return Err(format!("standard input holds no message: `{}` is no header", text.escape_debug()));
        };
        if name.trim().eq_ignore_ascii_case("Content-Length") {
            length = value.trim().parse().ok().filter(|length| *length <= LONGEST_MESSAGE);
            if length.is_none() {
                return Err(format!(
                    "Content-Length `{}` is not that of a message",
                    value.trim().escape_debug()
                ));
            }
        }
    }
    let Some(length) = length else { return Err("a message without Content-Length".into()) };
    let mut body = Vec::new();
    from.take(length).read_to_end(&mut body).map_err(|e| e.to_string())?;
    match body.len() as u64 == length {
        true => Ok(Some(body)),
        false => Err("standard input ended within a message".into()),
    }
}

/// Writes what is sent until nobody can send any more.
pub fn write_all(mut to: impl Write, from: &Receiver<Outgoing>) -> io::Result<()> {
    for outgoing in from {
        match outgoing {
            Outgoing::Message(message) => message.write(&mut to)?,
            Outgoing::Raw(value) => {
                let text = value.to_string();
                write!(to, "Content-Length: {}\r\n\r\n{text}", text.len())?;
                to.flush()?;
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;

    fn read(text: &str) -> Vec<String> {
        let (to, from) = channel();
        read_all(text.as_bytes(), &to);
        drop(to);
        from.iter()
            .map(|incoming| match incoming {
                Incoming::Message(Message::Notification(n)) => n.method,
                Incoming::Message(_) => "message".into(),
                Incoming::Wrong(code, _) => format!("{}", code as i32),
                Incoming::Broken(text) => text,
            })
            .collect()
    }

    fn framed(body: &str) -> String {
        format!("Content-Length: {}\r\n\r\n{body}", body.len())
    }

    #[test]
    fn what_is_no_message_does_not_hide_the_next() {
        let good = framed("{\"method\":\"a\"}");
        let deep = framed(&"[".repeat(100_000));
        for bad in [
            framed("{"),
            framed("[]"),
            framed("{\"id\":{},\"method\":1}"),
            framed("\u{7f}ä"),
            framed(""),
            deep,
        ] {
            let found = read(&format!("{bad}{good}"));
            assert_eq!(found.len(), 2, "{bad:.60}");
            assert!(found[0].starts_with("-32") && found[1] == "a", "{found:?}");
        }
        assert_eq!(read(&format!("content-length:14\r\nX: y\r\n\r\n{{\"method\":\"b\"}}{good}")), ["b", "a"]);
    }

    #[test]
    fn nothing_is_read_behind_a_broken_header() {
        for bad in [
            "nonsense\r\n",
            "\r\n",
            "Content-Length: x\r\n\r\n",
            "Content-Length: -1\r\n\r\n",
            "Content-Length: 99999999999999999999\r\n\r\n",
            "Content-Length: 9999999999\r\n\r\n{}",
            "Content-Length: 10\r\n\r\n{}",
            "Content-Length: 2",
        ] {
            let found = read(bad);
            assert!(found.len() == 1 && !found[0].starts_with('-'), "{bad}: {found:?}");
        }
        let endless = "x".repeat(100_000);
        assert_eq!(read(&endless).len(), 1);
        assert!(read("").is_empty());
    }
}
