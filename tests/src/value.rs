//! Values in Ghyll syntax: reading them, and when two of them agree.
//!
//! The suite compares values as trees rather than as text, so that `1.0` and `1.00`, or a struct by name and by
//! position, are the same, while `1` and `1.0` are not.

use std::fmt;

#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Bool(bool),
    Int(i64),
    Float(f64),
    Tuple(Vec<Value>),
    Array(Vec<Value>),
    /// Vectors, structs, variants and names of functions: `vec2(1.0, 2.0)`, `Ray(near: 0.0)`, `None`.
    Make(String, Vec<(Option<String>, Value)>),
}

/// How far floats may be apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tolerance {
    /// Nothing was said: [`Tolerance::USUAL`] of the expected value.
    Usual,
    /// `~ t`: t times the expected value, or t where that is below 1.
    Given(f64),
}

impl Tolerance {
    /// A few units in the last place of f32, and WGSL's error of the common built-ins.
    pub const USUAL: f64 = 1e-5;

    fn allows(self, expected: f64, actual: f64) -> bool {
        if expected.is_nan() || actual.is_nan() {
            return expected.is_nan() && actual.is_nan();
        }
        let allowed = match self {
            Tolerance::Usual => Tolerance::USUAL * expected.abs(),
            Tolerance::Given(t) => t * expected.abs().max(1.0),
        };
        expected == actual || expected.is_finite() && (expected - actual).abs() <= allowed
    }
}

impl Value {
    pub fn parse(text: &str) -> Result<Value, String> {
        let mut reader = Reader { text, at: 0 };
        let value = reader.value()?;
        match reader.peek() {
            None => Ok(value),
            Some(c) => Err(format!("`{c}` after the value in `{text}`")),
        }
    }

    /// Exact but for floats.
    pub fn agrees(&self, actual: &Value, tolerance: Tolerance) -> bool {
        match (self, actual) {
            (Value::Float(a), Value::Float(b)) => tolerance.allows(*a, *b),
            (Value::Tuple(a), Value::Tuple(b)) | (Value::Array(a), Value::Array(b)) => {
                a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.agrees(b, tolerance))
            }
            (Value::Make(f, a), Value::Make(g, b)) => {
                f == g && a.len() == b.len() && a.iter().zip(b).all(|(a, b)| fields_agree(a, b, tolerance))
            }
            _ => self == actual,
        }
    }
}

fn fields_agree(a: &(Option<String>, Value), b: &(Option<String>, Value), tolerance: Tolerance) -> bool {
    let names = a.0.is_none() || b.0.is_none() || a.0 == b.0;
    names && a.1.agrees(&b.1, tolerance)
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Value::Bool(b) => write!(f, "{b}"),
            Value::Int(i) => write!(f, "{i}"),
            Value::Float(x) => write!(f, "{x:?}"),
            Value::Tuple(items) => write!(f, "({})", list(items)),
            Value::Array(items) => write!(f, "[{}]", list(items)),
            Value::Make(name, fields) if fields.is_empty() => write!(f, "{name}"),
            Value::Make(name, fields) => {
                let field = |(name, value): &(Option<String>, Value)| match name {
                    Some(name) => format!("{name}: {value}"),
                    None => value.to_string(),
                };
                write!(f, "{name}({})", fields.iter().map(field).collect::<Vec<_>>().join(", "))
            }
        }
    }
}

fn list(items: &[Value]) -> String {
    items.iter().map(Value::to_string).collect::<Vec<_>>().join(", ")
}

struct Reader<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Reader<'a> {
    fn peek(&mut self) -> Option<char> {
        let rest = self.text[self.at..].trim_start();
        self.at = self.text.len() - rest.len();
        rest.chars().next()
    }

    fn eat(&mut self, c: char) -> bool {
        let found = self.peek() == Some(c);
        if found {
            self.at += c.len_utf8();
        }
        found
    }

    fn take(&mut self, accept: impl Fn(char) -> bool) -> &'a str {
        let rest = &self.text[self.at..];
        let end = rest.find(|c| !accept(c)).unwrap_or(rest.len());
        self.at += end;
        &rest[..end]
    }

    fn value(&mut self) -> Result<Value, String> {
        match self.peek() {
            Some('(') => {
                self.eat('(');
                let mut items = self.items(')', Reader::value)?;
                Ok(if items.len() == 1 { items.remove(0) } else { Value::Tuple(items) })
            }
            Some('[') => {
                self.eat('[');
                Ok(Value::Array(self.items(']', Reader::value)?))
            }
            Some(c) if c.is_ascii_digit() || "-.".contains(c) => self.number(),
            Some(c) if c.is_ascii_alphabetic() || c == '_' => self.named(),
            Some(c) => Err(format!("`{c}` begins no value in `{}`", self.text)),
            None => Err(format!("a value is missing in `{}`", self.text)),
        }
    }

    fn items<T>(
        &mut self,
        close: char,
        item: impl Fn(&mut Reader<'a>) -> Result<T, String>,
    ) -> Result<Vec<T>, String> {
        let mut items = Vec::new();
        while !self.eat(close) {
            items.push(item(self)?);
            if !self.eat(',') && self.peek() != Some(close) {
                return Err(format!("`,` or `{close}` is missing in `{}`", self.text));
            }
        }
        Ok(items)
    }

    fn number(&mut self) -> Result<Value, String> {
        let negative = self.eat('-');
        let text = self.take(|c| c.is_ascii_alphanumeric() || "._+-".contains(c));
        let value = read_number(text).ok_or(format!("`{text}` is no number"))?;
        Ok(match value {
            Value::Int(i) if negative => Value::Int(-i),
            Value::Float(x) if negative => Value::Float(-x),
            other => other,
        })
    }

    fn named(&mut self) -> Result<Value, String> {
        let name = self.take(|c| c.is_ascii_alphanumeric() || c == '_');
        match name {
            "true" => return Ok(Value::Bool(true)),
            "false" => return Ok(Value::Bool(false)),
            "inf" => return Ok(Value::Float(f64::INFINITY)),
            "NaN" | "nan" => return Ok(Value::Float(f64::NAN)),
            _ => {}
        }
        let fields = if self.eat('(') { self.items(')', Reader::field)? } else { Vec::new() };
        Ok(Value::Make(name.to_string(), fields))
    }

    fn field(&mut self) -> Result<(Option<String>, Value), String> {
        let start = (self.peek(), self.at).1;
        let name = self.take(|c| c.is_ascii_alphanumeric() || c == '_');
        if !name.is_empty() && self.eat(':') {
            return Ok((Some(name.to_string()), self.value()?));
        }
        self.at = start;
        Ok((None, self.value()?))
    }
}

fn read_number(text: &str) -> Option<Value> {
    if text == "inf" {
        return Some(Value::Float(f64::INFINITY));
    }
    if !text.starts_with(|c: char| c.is_ascii_digit() || c == '.') {
        return None;
    }
    let text = text.replace('_', "");
    let whole = text.strip_suffix('u').unwrap_or(&text);
    if let Some(hex) = whole.strip_prefix("0x") {
        return i64::from_str_radix(hex, 16).ok().map(Value::Int);
    }
    if whole.chars().all(|c| c.is_ascii_digit()) {
        return whole.parse().ok().map(Value::Int);
    }
    text.parse().ok().map(Value::Float)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn agree(a: &str, b: &str) -> bool {
        Value::parse(a).unwrap().agrees(&Value::parse(b).unwrap(), Tolerance::Usual)
    }

    #[test]
    fn forms_of_one_value_agree() {
        for (a, b) in [
            ("1.0", "1.00"),
            ("42", "42u"),
            ("0x2a", "42"),
            ("-.5", "-0.5"),
            ("1e3", "1000.0"),
            ("(1, true)", "( 1,true, )"),
            ("(3)", "3"),
            ("Ray(near: 1.0, far: 2.0)", "Ray(1.0, 2.0)"),
            ("Some(None)", "Some( None )"),
            ("[vec2(1.0, 2.0)]", "[vec2(1.0,2.0)]"),
            ("nan", "NaN"),
            ("-inf", "-inf"),
            ("0.333333333", "0.33333334"),
        ] {
            assert!(agree(a, b), "{a} and {b}");
        }
    }

    #[test]
    fn different_values_do_not_agree() {
        for (a, b) in [
            ("1", "1.0"),
            ("1", "2"),
            ("1.0", "1.0001"),
            ("0.0", "0.0001"),
            ("(1, 2)", "(1, 2, 3)"),
            ("[1]", "1"),
            ("Some(1)", "Other(1)"),
            ("Some(1)", "None"),
            ("Ray(near: 1.0)", "Ray(far: 1.0)"),
            ("nan", "1.0"),
            ("inf", "-inf"),
            ("true", "false"),
            ("true", "1"),
        ] {
            assert!(!agree(a, b), "{a} and {b}");
        }
    }

    #[test]
    fn a_given_tolerance_is_absolute_below_one() {
        let near = |e: f64, a: f64, t| Value::Float(e).agrees(&Value::Float(a), Tolerance::Given(t));
        assert!(near(0.0, 0.009, 0.01) && !near(0.0, 0.011, 0.01));
        assert!(near(100.0, 100.9, 0.01) && !near(100.0, 101.1, 0.01));
        assert!(near(2.0, 2.0, 0.0) && !near(2.0, 2.0000001, 0.0));
    }

    #[test]
    fn what_is_no_value_is_refused() {
        for text in ["", "1 2", "(1", "[1,", "1.2.3", "0xg", "?", "a(b", "12ab", "--1", "-true"] {
            assert!(Value::parse(text).is_err(), "{text}");
        }
    }

    #[test]
    fn printing_gives_the_value_back() {
        for text in ["(1, true)", "[1.5, -2.0]", "S(a: 1, b: None)", "Some(vec2(0.0, 1.0))"] {
            assert_eq!(Value::parse(text).unwrap().to_string(), text);
        }
    }
}
