//! Runs the case files below `suite/`: one named trial for each case and mode.

use ghyll_tests::case;
use libtest_mimic::{Arguments, Trial};
use std::path::Path;

fn main() {
    let (cases, errors) = case::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("suite"));
    let count = cases.len();
    let headers = Trial::test("suite::headers", move || {
        let lines: Vec<String> = errors.iter().map(ToString::to_string).collect();
        if lines.is_empty() && count > 0 { Ok(()) } else { Err(lines.join("\n").into()) }
    });
    libtest_mimic::run(&Arguments::from_args(), vec![headers]).exit();
}
