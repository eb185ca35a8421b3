//! `ghyll lsp`, over its protocol.

use crate::support::Folder;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

/// An editor's side of a session.
struct Editor {
    server: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
    next: i32,
    /// Notifications that came before what was waited for.
    told: Vec<Value>,
}

fn framed(text: &str) -> String {
    format!("Content-Length: {}\r\n\r\n{text}", text.len())
}

impl Editor {
    fn start(folder: &Folder) -> Editor {
        let mut server = Command::new(env!("CARGO_BIN_EXE_ghyll"))
            .arg("lsp")
            .env("XDG_CACHE_HOME", folder.path("cache"))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the binary runs");
        let to = server.stdin.take().expect("it is piped");
        let from = BufReader::new(server.stdout.take().expect("it is piped"));
        Editor { server, to, from, next: 0, told: Vec::new() }
    }

    /// A session in which the editor can show everything.
    fn new(folder: &Folder) -> Editor {
        let mut editor = Editor::start(folder);
        let documents = json!({
            "documentSymbol": { "hierarchicalDocumentSymbolSupport": true },
            "publishDiagnostics": { "relatedInformation": true, "codeDescriptionSupport": true },
        });
        let begun = editor.ask("initialize", json!({ "capabilities": { "textDocument": documents } }));
        assert_eq!(begun["serverInfo"]["name"], "ghyll");
        editor.tell("initialized", json!({}));
        editor
    }

    fn send(&mut self, text: &str) {
        self.to.write_all(framed(text).as_bytes()).expect("the server reads");
    }

    fn tell(&mut self, method: &str, params: Value) {
        self.send(&json!({ "jsonrpc": "2.0", "method": method, "params": params }).to_string());
    }

    fn receive(&mut self) -> Option<Value> {
        let mut length = 0;
        loop {
            let mut line = String::new();
            if self.from.read_line(&mut line).expect("text") == 0 {
                return None;
            }
            match line.trim_end() {
                "" => break,
                header => {
                    length =
                        header.strip_prefix("Content-Length: ").expect("a length").parse().expect("a number")
                }
            }
        }
        let mut body = vec![0; length];
        self.from.read_exact(&mut body).expect("the whole body");
        Some(serde_json::from_slice(&body).expect("JSON"))
    }

    /// The whole response to a request.
    fn response(&mut self, method: &str, params: Value) -> Value {
        self.next += 1;
        let id = self.next;
        self.send(&json!({ "jsonrpc": "2.0", "id": id, "method": method, "params": params }).to_string());
        loop {
            let message = self.receive().expect("a response");
            if message["id"] == id {
                return message;
            }
            self.told.push(message);
        }
    }

    #[track_caller]
    fn ask(&mut self, method: &str, params: Value) -> Value {
        let response = self.response(method, params);
        assert!(response["error"].is_null(), "{response}");
        response["result"].clone()
    }

    fn open(&mut self, uri: &str, text: &str) {
        let item = json!({ "uri": uri, "languageId": "ghyll", "version": 1, "text": text });
        self.tell("textDocument/didOpen", json!({ "textDocument": item }));
    }

    /// The next diagnostics that are told of a document.
    fn diagnostics(&mut self, uri: &str) -> Vec<Value> {
        let is = |m: &Value| m["method"] == "textDocument/publishDiagnostics" && m["params"]["uri"] == uri;
        loop {
            let found = match self.told.iter().position(is) {
                Some(at) => self.told.remove(at),
                None => {
                    let message = self.receive().expect("diagnostics");
                    self.told.push(message);
                    continue;
                }
            };
            return found["params"]["diagnostics"].as_array().expect("a list").clone();
        }
    }

    fn at(&mut self, method: &str, uri: &str, line: u32, character: u32) -> Value {
        self.ask(method, place(uri, line, character))
    }

    fn hover(&mut self, uri: &str, line: u32, character: u32) -> String {
        let hover = self.at("textDocument/hover", uri, line, character);
        hover["contents"]["value"].as_str().unwrap_or_default().to_owned()
    }

    fn words(&mut self, uri: &str, line: u32, character: u32) -> Vec<String> {
        let items = self.at("textDocument/completion", uri, line, character);
        items
            .as_array()
            .expect("a list")
            .iter()
            .map(|i| i["label"].as_str().expect("a word").to_owned())
            .collect()
    }

    /// How the server ends.
    fn end(mut self) -> (Option<i32>, String) {
        drop(self.to);
        let mut err = String::new();
        let _ = self.server.stderr.take().expect("it is piped").read_to_string(&mut err);
        (self.server.wait().expect("it ends").code(), err)
    }

    fn shut_down(mut self) {
        assert!(self.ask("shutdown", Value::Null).is_null());
        self.tell("exit", Value::Null);
        let (status, err) = self.end();
        assert_eq!((status, err.as_str()), (Some(0), ""));
    }
}

fn place(uri: &str, line: u32, character: u32) -> Value {
    json!({ "textDocument": { "uri": uri }, "position": { "line": line, "character": character } })
}

fn range(line: u32, from: u32, to: u32) -> Value {
    json!({ "start": { "line": line, "character": from }, "end": { "line": line, "character": to } })
}

const A: &str = "file:///none/a.ghyll";

#[test]
fn a_session_from_initialize_to_exit() {
    let folder = Folder::new("lsp_session");
    let mut editor = Editor::new(&folder);
    let text = "use terrain;\n\n/// Twice as high.\nfn high(p: vec2) -> f32 = 2.0 * bilinear(p);\nfn pixel(p: vec2) -> f32 {\n    let tall = high(p);\n    tall + /* 🏔 */ tall\n}\n";
    editor.open(A, text);
    assert_eq!(editor.diagnostics(A), [] as [Value; 0]);

    assert_eq!(editor.hover(A, 5, 16), "```ghyll\nfn high(p: vec2) -> f32\n```\n\nTwice as high.\n");
    assert!(
        editor.hover(A, 3, 35).starts_with("```ghyll\nbilinear(p: vec2) -> f32\n```\n\nbilinear between")
    );
    // Behind a mountain of two units.
    let hover = editor.at("textDocument/hover", A, 6, 21);
    assert_eq!(hover["contents"]["value"], "```ghyll\ntall: f32\n```\n");
    assert_eq!(hover["range"], range(6, 20, 24));
    assert_eq!(editor.hover(A, 6, 9), "```ghyll\nf32\n```\n");
    assert_eq!(editor.hover(A, 1, 0), "");

    let definition = editor.at("textDocument/definition", A, 6, 20);
    assert_eq!(definition, json!({ "uri": A, "range": range(5, 8, 12) }));
    let library = editor.at("textDocument/definition", A, 0, 6);
    let uri = library["uri"].as_str().expect("a file").to_owned();
    assert!(uri.ends_with("/terrain.ghyll"), "{uri}");
    let path = uri.strip_prefix("file://").expect("a path").replace("%20", " ");
    assert!(std::fs::read_to_string(path).expect("the module").contains("fn camera(p: vec2) -> Ray"));

    let symbols = editor.ask("textDocument/documentSymbol", json!({ "textDocument": { "uri": A } }));
    let names: Vec<_> = symbols.as_array().expect("a list").iter().map(|s| s["name"].clone()).collect();
    assert_eq!(names, ["high", "pixel"]);
    assert_eq!(symbols[1]["selectionRange"], range(4, 3, 8));

    let edits = editor.ask(
        "textDocument/formatting",
        json!({ "textDocument": { "uri": A }, "options": { "tabSize": 4, "insertSpaces": true } }),
    );
    assert_eq!(edits, json!([]));
    let places = editor.at("textDocument/documentHighlight", A, 5, 9);
    assert_eq!(
        places,
        json!([{ "range": range(5, 8, 12) }, { "range": range(6, 4, 8) }, { "range": range(6, 20, 24) }])
    );
    editor.shut_down();
}

#[test]
fn diagnostics_have_the_words_of_check_and_links() {
    let folder = Folder::new("lsp_diagnostics");
    let text = "fn f(x: i32) -> i32 = x;\nfn main() -> i32 = f(/* 🏔 */ 1.5) + q;\n";
    folder.write("a.ghyll", text);
    let checked: Value = serde_json::from_str(&folder.ghyll("check a.ghyll --json").out).expect("JSON");
    let mut editor = Editor::new(&folder);
    editor.open(A, text);
    let found = editor.diagnostics(A);
    assert_eq!(found.len(), 2, "{found:?}");
    for (diagnostic, checked) in found.iter().zip(checked.as_array().expect("a list")) {
        let message = diagnostic["message"].as_str().expect("a text");
        assert!(message.starts_with(checked["title"].as_str().expect("a text")), "{message}");
        assert_eq!(diagnostic["code"], checked["code"]);
        let link = diagnostic["codeDescription"]["href"].as_str().expect("a link");
        assert!(link.ends_with(&format!("{}.md", checked["code"].as_str().expect("a code"))), "{link}");
    }
    assert_eq!(found[0]["range"], range(1, 30, 33));
    assert_eq!(found[0]["severity"], 1);
    assert!(found[0]["message"].as_str().expect("a text").ends_with("help: convert it with `i32(..)`"));
    let related = &found[0]["relatedInformation"][0];
    assert_eq!(related["message"], "the parameter has this type");
    assert_eq!(related["location"], json!({ "uri": A, "range": range(0, 8, 11) }));

    // A change mends one of them; a warning is none of the errors.
    let change = json!({ "range": range(1, 30, 33), "text": "1" });
    let document = json!({ "uri": A, "version": 2 });
    editor.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": [change] }));
    assert_eq!(editor.diagnostics(A).len(), 1);
    let whole = json!({ "text": "fn main() -> i32 { let x = 1; 2 }" });
    editor.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": [whole] }));
    let warned = editor.diagnostics(A);
    assert_eq!(
        (&warned[0]["severity"], &warned[0]["code"], &warned[0]["tags"]),
        (&json!(2), &json!("W0603"), &json!([1]))
    );
    editor.tell("textDocument/didClose", json!({ "textDocument": { "uri": A } }));
    assert!(editor.diagnostics(A).is_empty());
    editor.shut_down();
}

#[test]
fn broken_programs_are_understood_around_the_break() {
    let folder = Folder::new("lsp_broken");
    let mut editor = Editor::new(&folder);
    let text = "use terrain;\nfn good(h: Hit) -> f32 = h.distance;\nfn bad(h: Hit) -> f32 {\n    let d = good(h)\n    h.\n}\nfn other(x: f32) -> f32 = x * ;\nfn last(y: f32) -> vec2 = vec2(y);\n";
    editor.open(A, text);
    assert!(!editor.diagnostics(A).is_empty());
    assert!(editor.hover(A, 1, 27).starts_with("```ghyll\ndistance: f32 // of struct Hit\n```"));
    assert_eq!(editor.hover(A, 7, 31), "```ghyll\ny: f32\n```\n");
    assert_eq!(editor.words(A, 4, 6), ["at", "normal", "distance"]);
    let values = editor.words(A, 6, 30);
    assert_eq!(values[0], "x");
    for word in ["good", "bilinear", "sin", "fold", "if", "FAR", "Some"] {
        assert!(values.iter().any(|v| v == word), "{word} is not in {values:?}");
    }
    assert!(!values.iter().any(|v| v.starts_with('_') || v == "h"), "{values:?}");
    let types = editor.words(A, 7, 12);
    assert!(["Hit", "vec3", "Option", "Surface"].iter().all(|t| types.iter().any(|v| v == t)), "{types:?}");
    assert!(!types.iter().any(|t| t == "good"));
    editor.shut_down();
}

#[test]
fn files_that_are_open_hide_those_on_disk() {
    let folder = Folder::new("lsp_modules");
    folder.write("m.ghyll", "/// From disk.\nfn half(x: f32) -> f32 = x / 2.0;\nfn other() -> i32 = 1;");
    folder.write("main.ghyll", "");
    let uri = |name: &str| format!("file://{}", folder.path(name).display());
    let (main, module) = (uri("main.ghyll"), uri("m.ghyll"));
    let mut editor = Editor::new(&folder);
    let text = "use \"m.ghyll\";\nfn main(x: f32) -> f32 = half(x) + half(1.0);\n";
    editor.open(&main, text);
    assert!(editor.diagnostics(&main).is_empty());
    assert!(editor.hover(&main, 1, 26).contains("From disk."));
    let definition = editor.at("textDocument/definition", &main, 1, 26);
    assert_eq!(definition, json!({ "uri": module, "range": range(1, 3, 7) }));
    // In the editor the module has another text.
    editor.open(&module, "fn half(x: f32, y: f32) -> f32 = x / y;");
    let found = loop {
        let found = editor.diagnostics(&main);
        if !found.is_empty() {
            break found;
        }
    };
    assert_eq!(found[0]["code"], "E0305");
    assert_eq!(found[0]["relatedInformation"][0]["location"]["uri"], module);
    editor.shut_down();
}

#[test]
fn names_are_changed_everywhere_or_not_at_all() {
    let folder = Folder::new("lsp_rename");
    folder.write("m.ghyll", "fn half(x: f32) -> f32 = x / 2.0;\nfn quarter(x: f32) -> f32 = half(half(x));");
    folder.write("main.ghyll", "");
    let uri = |name: &str| format!("file://{}", folder.path(name).display());
    let (main, module) = (uri("main.ghyll"), uri("m.ghyll"));
    let mut editor = Editor::new(&folder);
    let text = "use \"m.ghyll\";\nfn main(x: f32) -> f32 {\n    let y = half(x);\n    let f = |x: f32| x + y;\n    f(y) + max(x, 1.0)\n}\n";
    editor.open(&main, text);
    let mut rename = |line: u32, character: u32, name: &str| {
        let mut params = place(&main, line, character);
        params["newName"] = name.into();
        editor.response("textDocument/rename", params)
    };
    let edit = |line, from, to, name: &str| json!({ "range": range(line, from, to), "newText": name });
    let local = rename(2, 8, "z");
    let expected = json!({ main.clone(): [edit(2, 8, 9, "z"), edit(3, 25, 26, "z"), edit(4, 6, 7, "z")] });
    assert_eq!(local["result"]["changes"], expected);
    // A name that would mean something else somewhere.
    for (line, character, name) in [(2, 8, "x"), (2, 8, "f")] {
        let response = rename(line, character, name);
        assert!(
            response["error"]["message"].as_str().is_some_and(|m| m.contains(name)),
            "{name}: {response}"
        );
    }
    for wrong in ["", "1a", "a b", "fn", "ä"] {
        assert!(rename(2, 8, wrong)["error"].is_object(), "{wrong}");
    }
    // The library keeps its names.
    assert!(rename(4, 12, "most")["error"].is_object());
    let everywhere = rename(2, 14, "halved");
    assert_eq!(everywhere["result"]["changes"][&main], json!([edit(2, 12, 16, "halved")]));
    let in_module = json!([edit(0, 3, 7, "halved"), edit(1, 28, 32, "halved"), edit(1, 33, 37, "halved")]);
    assert_eq!(everywhere["result"]["changes"][&module], in_module);
    let asked = json!({ "textDocument": { "uri": main }, "position": { "line": 2, "character": 14 }, "context": { "includeDeclaration": false } });
    assert_eq!(editor.ask("textDocument/references", asked).as_array().map(Vec::len), Some(3));
    editor.shut_down();
}

#[test]
fn a_text_is_formatted_as_by_fmt() {
    let folder = Folder::new("lsp_format");
    let text = "fn  main( )->i32=1+ 2 ;";
    folder.write("a.ghyll", text);
    folder.ghyll("fmt a.ghyll").printed();
    let expected = std::fs::read_to_string(folder.path("a.ghyll")).expect("a file");
    let mut editor = Editor::new(&folder);
    editor.open(A, text);
    let asked = json!({ "textDocument": { "uri": A }, "options": { "tabSize": 4, "insertSpaces": true } });
    let edits = editor.ask("textDocument/formatting", asked.clone());
    assert_eq!(edits, json!([{ "range": range(0, 0, 23), "newText": expected }]));
    let change = json!({ "text": "fn main( -> i32 = 1;" });
    let document = json!({ "uri": A, "version": 2 });
    editor.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": [change] }));
    assert!(editor.ask("textDocument/formatting", asked).is_null());
    editor.shut_down();
}

#[test]
fn malformed_messages_have_answers() {
    let folder = Folder::new("lsp_malformed");
    let mut editor = Editor::start(&folder);
    let early = editor.response("textDocument/hover", place(A, 0, 0));
    assert_eq!(early["error"]["code"], -32002);
    assert_eq!(editor.response("initialize", json!({ "capabilities": 1 }))["error"]["code"], -32602);
    editor.ask("initialize", json!({ "capabilities": {} }));
    assert_eq!(editor.response("initialize", json!({ "capabilities": {} }))["error"]["code"], -32600);
    for (text, code) in
        [("{", -32700), ("[]", -32600), ("{\"id\":[],\"method\":\"x\"}", -32600), ("ä", -32700)]
    {
        editor.send(text);
        let answer = editor.receive().expect("an answer");
        assert_eq!((&answer["id"], &answer["error"]["code"]), (&Value::Null, &json!(code)), "{text}");
    }
    assert_eq!(editor.response("no/such", Value::Null)["error"]["code"], -32601);
    assert_eq!(editor.response("textDocument/hover", json!({ "position": -1 }))["error"]["code"], -32602);
    assert_eq!(
        editor.response("textDocument/hover", place("file:///not/open", 0, 0))["error"]["code"],
        -32602
    );
    // Notifications have no answer; the next request has.
    editor.tell("textDocument/didOpen", json!({ "textDocument": 1 }));
    editor.tell(
        "textDocument/didChange",
        json!({ "textDocument": { "uri": A, "version": 1 }, "contentChanges": [] }),
    );
    editor.tell("no/such", json!([1]));
    editor.send(&json!({ "jsonrpc": "2.0", "id": 99, "result": null }).to_string());
    editor.open("untitled:1", "fn main() -> i32 = 1;");
    let far = place("untitled:1", u32::MAX, u32::MAX);
    assert!(editor.ask("textDocument/hover", far.clone()).is_null());
    assert!(editor.ask("textDocument/completion", far).is_array());
    editor.shut_down();
}

#[test]
fn a_session_that_breaks_off_is_a_failure() {
    let folder = Folder::new("lsp_break");
    let mut editor = Editor::new(&folder);
    editor.tell("exit", Value::Null);
    assert_eq!(editor.end().0, Some(1));
    let (status, err) = Editor::new(&folder).end();
    assert_eq!(status, Some(1));
    assert!(err.contains("without `exit`"), "{err}");
    for garbage in ["GET / HTTP/1.1\r\n\r\n", "Content-Length: 18446744073709551615\r\n\r\n", "\u{0}\u{0}\n"]
    {
        let mut editor = Editor::start(&folder);
        editor.to.write_all(garbage.as_bytes()).expect("the server reads");
        let (status, err) = editor.end();
        assert_eq!(status, Some(1), "{garbage}");
        assert!(err.starts_with("ghyll: ") && !err.contains("panicked"), "{err}");
    }
}

/// Functions that call each other, in 10,000 lines.
fn long_program() -> String {
    let mut text = String::from("use terrain;\n");
    for i in 0..2500 {
        let before = if i == 0 { "sin".to_owned() } else { format!("f{}", i - 1) };
        text += &format!(
            "/// Number {i}.\nfn f{i}(x: f32) -> f32 =\n    {before}(x) * cos(x + {i}.0)\n    + max(x, 1.5) / (2.0 + abs(x));\n"
        );
    }
    text + "fn pixel(p: vec2) -> f32 = f2(p.x);\n"
}

#[test]
fn ten_thousand_lines_are_answered_at_once() {
    let folder = Folder::new("lsp_long");
    let mut editor = Editor::new(&folder);
    let text = long_program();
    assert!(text.lines().count() > 10_000);
    editor.open(A, &text);
    editor.diagnostics(A);
    // A debug build is slower by far; the figure that counts is that of a release build.
    let limit = Duration::from_millis(if cfg!(debug_assertions) { 10_000 } else { 500 });
    let document = json!({ "uri": A, "version": 2 });
    let change = json!({ "range": range(5003, 4, 4), "text": " " });
    let begun = Instant::now();
    editor.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": [change] }));
    assert!(editor.hover(A, 5004, 7).contains("max(N, N) -> N"));
    let hover = begun.elapsed();
    let begun = Instant::now();
    assert!(editor.words(A, 5003, 8).len() > 2500);
    let completion = begun.elapsed();
    eprintln!("hover after a change {hover:?}, completion {completion:?}");
    assert!(hover < limit && completion < limit, "hover {hover:?}, completion {completion:?}");
    editor.shut_down();
}

#[test]
fn edits_in_parts_are_those_of_the_whole() {
    let folder = Folder::new("lsp_edits");
    let mut editor = Editor::new(&folder);
    editor.open(A, "fn main() -> i32 = 1;\n");
    let behind = json!({ "line": 9, "character": 9 });
    let edits = [
        (range(0, 19, 20), "two() /* größe 🏔 */ + 1"),
        (range(0, 3, 7), "other"),
        (json!({ "start": behind, "end": behind }), "fn two()->i32=2;\r\n"),
        (range(0, 35, 37), "1 *"),
    ];
    for (version, (range, text)) in edits.iter().enumerate() {
        let document = json!({ "uri": A, "version": version + 2 });
        let changes = json!([{ "range": range, "text": text }]);
        editor.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": changes }));
    }
    folder.write("a.ghyll", "fn other() -> i32 = two() /* größe 1 * */ + 1;\nfn two()->i32=2;\r\n");
    folder.ghyll("fmt a.ghyll").printed();
    let expected = std::fs::read_to_string(folder.path("a.ghyll")).expect("a file");
    let asked = json!({ "textDocument": { "uri": A }, "options": { "tabSize": 4, "insertSpaces": true } });
    assert_eq!(editor.ask("textDocument/formatting", asked)[0]["newText"], expected);
    editor.shut_down();
}
