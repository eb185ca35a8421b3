//! `ghyll lsp`: a language server over standard input and output.

mod answer;
mod document;
mod pages;
mod publish;
mod rename;
mod server;
mod transport;
mod uri;

use crate::failure::Failure;
use lsp_server::{ErrorCode, Message, Request, Response};
use serde_json::json;
use server::Server;
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread;
use transport::{Incoming, Outgoing};

/// Serves one editor until it says `exit`.
pub fn lsp() -> Result<(), Failure> {
    let (to_editor, outgoing) = channel();
    let (incoming, from_editor) = channel();
    let writer = thread::spawn(move || transport::write_all(std::io::stdout(), &outgoing));
    // Ends with the process: it waits for input that need not come.
    thread::spawn(move || transport::read_all(std::io::stdin().lock(), &incoming));
    let ended = serve(&from_editor, &to_editor);
    drop(to_editor);
    // An editor that went away reads nothing.
    let _ = writer.join();
    ended
}

/// Where a session is in the protocol.
enum Phase {
    Before,
    Running(Box<Server>),
    After,
}

fn serve(from_editor: &Receiver<Incoming>, to_editor: &Sender<Outgoing>) -> Result<(), Failure> {
    let mut phase = Phase::Before;
    loop {
        let incoming = match &mut phase {
            Phase::Running(server) if server.has_work() => match from_editor.try_recv() {
                // What is typed meanwhile may make the work needless.
                Err(TryRecvError::Empty) => {
                    server.work();
                    continue;
                }
                incoming => incoming.ok(),
            },
            _ => from_editor.recv().ok(),
        };
        let Some(incoming) = incoming else {
            return Err(Failure::Input("the editor closed standard input without `exit`".into()));
        };
        let message = match incoming {
            Incoming::Message(message) => message,
            Incoming::Wrong(code, text) => {
                let error = json!({ "jsonrpc": "2.0", "id": null, "error": { "code": code as i32, "message": text } });
                // If nobody listens any more, the next read ends the session.
                let _ = to_editor.send(Outgoing::Raw(error));
                continue;
            }
            Incoming::Broken(text) => return Err(Failure::Input(text)),
        };
        match message {
            Message::Request(request) => {
                let (next, response) = answered(phase, request, to_editor);
                phase = next;
                let _ = to_editor.send(Outgoing::Message(response.into()));
            }
            Message::Notification(notification) if notification.method == "exit" => {
                return match phase {
                    Phase::After => Ok(()),
                    _ => Err(Failure::Input("the editor said `exit` before `shutdown`".into())),
                };
            }
            Message::Notification(notification) => {
                if let Phase::Running(server) = &mut phase {
                    server.notified(notification);
                }
            }
            // Nothing is asked of the editor.
            Message::Response(_) => {}
        }
    }
}

fn answered(phase: Phase, request: Request, to_editor: &Sender<Outgoing>) -> (Phase, Response) {
    let refuse =
        |code: ErrorCode, text: &str| Response::new_err(request.id.clone(), code as i32, text.into());
    let method = request.method.clone();
    match (phase, method.as_str()) {
        (Phase::Before, "initialize") => match Server::new(&request.params, to_editor.clone()) {
            Ok(server) => {
                let response = Response::new_ok(request.id, server::capabilities());
                (Phase::Running(Box::new(server)), response)
            }
            Err(wrong) => (Phase::Before, refuse(ErrorCode::InvalidParams, &wrong)),
        },
        (Phase::Before, _) => {
            (Phase::Before, refuse(ErrorCode::ServerNotInitialized, "the first request is `initialize`"))
        }
        (Phase::Running(_), "shutdown") => (Phase::After, Response::new_ok(request.id, ())),
        (Phase::Running(server), "initialize") => {
            (Phase::Running(server), refuse(ErrorCode::InvalidRequest, "`initialize` comes once"))
        }
        (Phase::Running(mut server), _) => {
            let response = server.answer(request);
            (Phase::Running(server), response)
        }
        (Phase::After, _) => {
            (Phase::After, refuse(ErrorCode::InvalidRequest, "after `shutdown` there is only `exit`"))
        }
    }
}
