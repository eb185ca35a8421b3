//! Options that may change from frame to frame: numbers, or expressions of the frame's number `t`.

use crate::failure::Failure;
use ghyll_compiler::compile;
use ghyll_compiler::source::Source;
use ghyll_compiler::typed::FunctionId;
use ghyll_runtime::oracle::{self, OracleOptions};
use ghyll_runtime::value::Value;

/// Numbers with commas between, or as many expressions of `t`.
#[derive(Clone, Debug, PartialEq)]
pub enum Moving {
    Fixed(Vec<f64>),
    Formula(Vec<String>),
}

impl Moving {
    /// `fixed` reads plain numbers; what it refuses may still be a formula of as many parts as `counts` allows.
    pub fn parse(
        text: &str,
        counts: &[usize],
        fixed: impl Fn(&str) -> Result<Vec<f64>, String>,
    ) -> Result<Moving, String> {
        let refused = match fixed(text) {
            Ok(numbers) => return Ok(Moving::Fixed(numbers)),
            Err(refused) => refused,
        };
        let parts = parts(text);
        if mentions_t(text) && counts.contains(&parts.len()) {
            return Ok(Moving::Formula(parts));
        }
        Err(refused)
    }

    /// The numbers at a frame.
    pub fn at(&self, option: &str, frame: Option<i64>) -> Result<Vec<f64>, Failure> {
        let parts = match self {
            Moving::Fixed(numbers) => return Ok(numbers.clone()),
            Moving::Formula(parts) => parts,
        };
        let frame = frame.ok_or_else(|| {
            Failure::Usage(format!("{option} speaks of `t`, the number of a frame; give --frames A..B"))
        })?;
        parts.iter().map(|part| number(option, part, frame)).collect()
    }
}

/// Value of one expression in double precision.
fn number(option: &str, text: &str, frame: i64) -> Result<f64, Failure> {
    let wrong = |what: String| Failure::Usage(format!("{option} {text}: {what}"));
    let program = format!("fn main() -> f32 = {};", with_t(text, frame));
    let checked = compile::check(Source::new(option, &program)).map_err(|report| {
        wrong(report.diagnostics.first().map_or_else(String::new, |diagnostic| diagnostic.title.clone()))
    })?;
    let main = checked.module.functions.iter().position(|f| f.name == "main" && !f.library);
    let main = FunctionId(main.unwrap_or_default() as u32);
    let value = oracle::evaluate(&checked.module, main, &[], &OracleOptions::default(), None);
    match value.map_err(|e| wrong(e.to_string()))? {
        Value::F32(x) if x.is_finite() => Ok(x),
        other => Err(wrong(format!("at frame {frame} it is {other}; it must be finite"))),
    }
}

/// The text between commas outside brackets.
fn parts(text: &str) -> Vec<String> {
    let mut parts = vec![String::new()];
    let mut depth = 0i32;
    for c in text.chars() {
        match c {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth -= 1,
            _ => {}
        }
        match parts.last_mut() {
            Some(part) if c != ',' || depth > 0 => part.push(c),
            _ => parts.push(String::new()),
        }
    }
    parts
}

/// Whether an expression speaks of `t`.
pub fn mentions_t(text: &str) -> bool {
    with_t(text, 0) != text
}

/// The expression with the frame's number in place of the name `t`: a literal, which takes the type of its place.
pub fn with_t(text: &str, frame: i64) -> String {
    let number = if frame < 0 { format!("({frame})") } else { frame.to_string() };
    let mut out = String::new();
    let mut word = String::new();
    for c in text.chars().chain(std::iter::once(' ')) {
        if c.is_ascii_alphanumeric() || c == '_' {
            word.push(c);
            continue;
        }
        // A field `.t` is no name; the end of a range `..t` is one.
        let field = out.ends_with('.') && !out.ends_with("..");
        out.push_str(if word == "t" && !field { &number } else { &word });
        word.clear();
        out.push(c);
    }
    out.pop();
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn t_is_a_name_of_its_own() {
        assert_eq!(with_t("t*2+st-t_1+a.t+t", 7), "7*2+st-t_1+a.t+7");
        assert_eq!(with_t("sum(0..t, |i| f32(i))", -3), "sum(0..(-3), |i| f32(i))");
        assert!(!mentions_t("detail") && mentions_t("sin(t)"));
    }

    #[test]
    fn formulas_are_evaluated_in_double_precision() {
        let none = |_: &str| Err("no".to_string());
        let moving = Moving::parse("1000.0001 + t / 4, max(t, 2.5), 3", &[3], none).unwrap();
        let Ok(at) = moving.at("--eye", Some(1)) else { panic!("it has a value") };
        assert_eq!(at, [1000.2501, 2.5, 3.0]);
        assert!(Moving::parse("t, 2", &[3], none).is_err());
        assert!(moving.at("--eye", None).is_err());
        assert!(Moving::parse("1, 2, x + t", &[3], none).unwrap().at("--eye", Some(1)).is_err());
    }
}
