mod accepted;
mod arguments;
mod fuzz;
mod limits;
mod modules;
mod rejected;
mod verify;

use super::*;
use crate::source::NoFiles;

fn check(text: &str) -> Result<Checked, Report> {
    front(Source::new("test.ghyll", text), &NoFiles)
}

fn accepts(text: &str) -> Checked {
    let checked = check(text).unwrap_or_else(|r| panic!("{text}\n{}", crate::report::render(&r, false)));
    let wrong = verify::verify(&checked.module);
    assert!(wrong.is_empty(), "{text}\n{}", wrong.join("\n"));
    checked
}

/// Codes of all diagnostics with the text each one points at.
fn found(text: &str) -> Vec<(codes::Code, String)> {
    let diagnostics = match check(text) {
        Ok(checked) => checked.warnings,
        Err(report) => report.diagnostics,
    };
    let place = |d: &Diagnostic| match d.primary.0.source.0 {
        0 => text[d.primary.0.start as usize..d.primary.0.end as usize].to_owned(),
        _ => "<library>".to_owned(),
    };
    diagnostics.iter().map(|d| (d.code, place(d))).collect()
}

/// Wraps expressions in functions: `body: type` becomes a function of that result.
fn of_type(ty: &str, body: &str) -> String {
    format!("fn f(n: i32, u: u32, x: f32, v: vec3, w: vec2, b: bool, m: mat3, iv: ivec2) -> {ty} = {body};")
}
