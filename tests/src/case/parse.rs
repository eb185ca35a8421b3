//! Reader of case files. A word it does not know, a name given twice or an expectation that misses a part is an
//! error: a misspelt expectation must never be skipped.

use super::{
    Call, Case, Dem, Diagnostic, Expectation, PictureTolerance, Pixel, Program, Raster, Render, Settings,
    Severity,
};
use crate::mode::Mode;
use crate::pages::repeated;
use crate::value::{Tolerance, Value};
use std::collections::HashSet;

type Read<T> = Result<T, String>;

/// The cases of one file, or the line and reason of the first mistake.
pub fn parse(topic: &str, text: &str) -> Result<Vec<Case>, (u32, String)> {
    let mut reader =
        Reader { topic, cases: Vec::new(), names: HashSet::new(), into: Into::Nothing, repeat: None };
    let mut last = 0;
    for (index, line) in text.lines().enumerate() {
        last = index as u32 + 1;
        reader.line(last, line).map_err(|reason| (last, reason))?;
    }
    reader.finish_case().map_err(|reason| (last, reason))?;
    if reader.cases.is_empty() {
        return Err((last, "the file holds no case".into()));
    }
    Ok(reader.cases)
}

/// Where the next line that is no header line belongs.
enum Into {
    Nothing,
    Program,
    File,
    /// The program is a file of the repository; no line may follow the header.
    Elsewhere,
}

struct Reader<'a> {
    topic: &'a str,
    cases: Vec<Case>,
    names: HashSet<String>,
    into: Into,
    /// Copies of the program's lines that hold `#`.
    repeat: Option<usize>,
}

impl Reader<'_> {
    fn line(&mut self, number: u32, line: &str) -> Read<()> {
        let Some(header) = line.strip_prefix("//#") else {
            return self.program_line(line);
        };
        let (word, rest) = split_word(header);
        if word == "case" {
            self.finish_case()?;
            return self.begin_case(number, rest);
        }
        let case = self.cases.last_mut().ok_or("the file must begin with `//# case NAME`")?;
        if word == "file" {
            if rest.is_empty() {
                return Err("`file` needs a name".into());
            }
            case.program.files.push((rest.to_string(), String::new()));
            self.into = Into::File;
            return Ok(());
        }
        if word == "repeat" {
            self.repeat = Some(rest.parse().map_err(|_| format!("`{rest}` is no number of copies"))?);
            return Ok(());
        }
        if word == "program" {
            case.program.text = from_file(&mut case.program.name, rest)?;
            self.into = Into::Elsewhere;
            return Ok(());
        }
        let begun = !case.program.text.is_empty() && !matches!(self.into, Into::Elsewhere);
        if begun || matches!(self.into, Into::File) {
            return Err("expectations stand above the program".into());
        }
        header_line(case, word, rest)
    }

    fn program_line(&mut self, line: &str) -> Read<()> {
        if matches!(self.into, Into::Nothing | Into::Elsewhere) {
            let skipped = line.trim().is_empty() || line.starts_with("//");
            return if skipped { Ok(()) } else { Err("a program stands below its own header".into()) };
        }
        let Some(case) = self.cases.last_mut() else { return Ok(()) };
        let text = match (&self.into, case.program.files.last_mut()) {
            (Into::File, Some((_, text))) => text,
            _ => &mut case.program.text,
        };
        text.push_str(line);
        text.push('\n');
        Ok(())
    }

    fn begin_case(&mut self, line: u32, name: &str) -> Read<()> {
        let plain = |c: char| c.is_ascii_alphanumeric() || "-_/".contains(c);
        if name.is_empty() || !name.chars().all(plain) {
            return Err(format!("`{name}` is no case name: letters, digits, `-`, `_` and `/`"));
        }
        if !self.names.insert(name.to_string()) {
            return Err(format!("a second case is named `{name}`"));
        }
        self.into = Into::Program;
        self.cases.push(Case {
            topic: self.topic.to_string(),
            name: name.to_string(),
            line,
            program: Program { name: format!("{name}.ghyll"), ..Program::default() },
            settings: Settings::default(),
            expectations: Vec::new(),
            modes: Vec::new(),
            broken: None,
        });
        Ok(())
    }

    fn finish_case(&mut self) -> Read<()> {
        let Some(case) = self.cases.last_mut() else { return Ok(()) };
        if let Some(times) = self.repeat.take() {
            case.program.text = repeated(&case.program.text, times);
        }
        if case.expectations.is_empty() {
            return Err(format!("case `{}` expects nothing", case.name));
        }
        if case.program.text.trim().is_empty() {
            return Err(format!("case `{}` has no program", case.name));
        }
        let errors = case
            .expectations
            .iter()
            .any(|e| matches!(e, Expectation::Diagnostic(d) if d.severity == Severity::Error));
        let others = case.expectations.iter().any(|e| !matches!(e, Expectation::Diagnostic(_)));
        if errors && others {
            return Err(format!("case `{}` expects an error and a run", case.name));
        }
        Ok(())
    }
}

fn header_line(case: &mut Case, word: &str, rest: &str) -> Read<()> {
    let settings = &mut case.settings;
    match word {
        "run" => case.expectations.push(run(rest)?),
        "fails" => case.expectations.push(fails(rest)?),
        "error" => case.expectations.push(diagnostic(Severity::Error, rest)?),
        "warning" => case.expectations.push(diagnostic(Severity::Warning, rest)?),
        "tasks" => case.expectations.push(tasks(rest)?),
        "rounds" => case.expectations.push(rounds(rest)?),
        "trace" => {
            case.expectations.push(Expectation::Trace { call: call(rest)?, streams: Vec::new() });
        }
        "stream" => match case.expectations.last_mut() {
            Some(Expectation::Trace { streams, .. }) => streams.push(rest.to_string()),
            _ => return Err("`stream` stands below `trace`".into()),
        },
        "render" => case.expectations.push(render(rest)?),
        "pixel" => last_render(case)?.pixels.push(pixel(rest)?),
        "tolerance" => last_render(case)?.tolerance = Some(picture_tolerance(rest)?),
        "set" => settings.set.push(pair(rest, '=')?),
        "live" => settings.live.push(required("a parameter's name", rest)?),
        "memory" => settings.memory = Some(bytes(rest)?),
        "timeout" => settings.timeout = Some(number(rest)?),
        "dem" => settings.dem = Some(dem(rest)?),
        "no-bake" => settings.no_bake = true,
        "raster" => settings.rasters.push(raster(rest)?),
        "broken" => case.broken = Some(quoted(rest)?),
        "modes" => {
            for word in rest.split_whitespace() {
                let modes = Mode::named(word).ok_or(format!("`{word}` is no mode"))?;
                case.modes.extend(modes.iter().filter(|m| !case.modes.contains(m)).collect::<Vec<_>>());
            }
        }
        _ => return Err(format!("`{word}` is no word of a case header")),
    }
    Ok(())
}

// ---- expectations ----

fn run(rest: &str) -> Read<Expectation> {
    let (call_text, expected) = pair(rest, "=>")?;
    let (value, tolerance) = value_and_tolerance(&expected)?;
    Ok(Expectation::Run { call: call(&call_text)?, value, tolerance })
}

fn fails(rest: &str) -> Read<Expectation> {
    let (call_text, expected) = pair(rest, "=>")?;
    let (status, part) = split_word(&expected);
    let status = status.parse().map_err(|_| format!("`{status}` is no exit status"))?;
    Ok(Expectation::Fails { call: call(&call_text)?, status, part: quoted(part)? })
}

/// `CODE? at FILE:?LINE:COLUMN "part of the title"?`
fn diagnostic(severity: Severity, rest: &str) -> Read<Expectation> {
    let (code, place) = match split_word(rest) {
        ("at", _) => ("", rest),
        (code, place) => (code, place),
    };
    let is_code = |c: &str| c.len() == 5 && c.starts_with(['E', 'W']) && c[1..].parse::<u16>().is_ok();
    if !code.is_empty() && !is_code(code) {
        return Err(format!("`{code}` is no code such as E0301"));
    }
    let (at, place) = split_word(place);
    if at != "at" {
        return Err("`at LINE:COLUMN` is missing".into());
    }
    let (place, part) = split_word(place);
    let (file, within) = match place.split_once(':') {
        Some((file, within)) if within.contains(':') => (file, within),
        _ => ("", place),
    };
    let (line, column) = pair(within, ':')?;
    let count = |text: &str| match text.parse() {
        Ok(0) | Err(_) => Err(format!("`{place}` is no place")),
        Ok(n) => Ok(n),
    };
    let part = if part.is_empty() { String::new() } else { quoted(part)? };
    let (line, column) = (count(&line)?, count(&column)?);
    Ok(Expectation::Diagnostic(Diagnostic {
        severity,
        file: file.into(),
        code: code.into(),
        line,
        column,
        part,
    }))
}

fn tasks(rest: &str) -> Read<Expectation> {
    let (entry, functions) = pair(rest, "=>")?;
    let mut functions: Vec<String> = functions.split_whitespace().map(String::from).collect();
    functions.sort();
    Ok(Expectation::Tasks { entry, functions })
}

fn rounds(rest: &str) -> Read<Expectation> {
    let (call_text, most) = pair(rest, "<=")?;
    let most = most.parse().map_err(|_| format!("`{most}` is no number of rounds"))?;
    Ok(Expectation::Rounds { call: call(&call_text)?, most })
}

fn render(rest: &str) -> Read<Expectation> {
    let (entry, size) = split_word(rest);
    let (width, height) = size_of(size)?;
    Ok(Expectation::Render(Render {
        entry: required("an entry", entry)?,
        width,
        height,
        pixels: Vec::new(),
        tolerance: None,
    }))
}

fn last_render(case: &mut Case) -> Read<&mut Render> {
    match case.expectations.last_mut() {
        Some(Expectation::Render(render)) => Ok(render),
        _ => Err("this word stands below `render`".into()),
    }
}

fn pixel(rest: &str) -> Read<Pixel> {
    let (place, expected) = pair(rest, "=>")?;
    let (x, y) = pair(&place, ',')?;
    let count = |text: &str| text.parse().map_err(|_| format!("`{place}` is no pixel"));
    let (value, tolerance) = value_and_tolerance(&expected)?;
    Ok(Pixel { x: count(&x)?, y: count(&y)?, value, tolerance })
}

/// `VALUE but SHARE because "reason"`, the middle part optional.
fn picture_tolerance(rest: &str) -> Read<PictureTolerance> {
    let (amount, reason) = pair(rest, "because")?;
    let (value, share) = match amount.split_once("but") {
        Some((value, share)) => (number(value)?, number(share)?),
        None => (number(&amount)?, 0.0),
    };
    Ok(PictureTolerance { value, share, reason: quoted(&reason)? })
}

// ---- settings ----

/// `WxH spacing DX,DY : heights`, rows from north to south.
fn dem(rest: &str) -> Read<Dem> {
    let (shape, heights) = pair(rest, ':')?;
    let (size, spacing) = pair(&shape, "spacing")?;
    let (width, height) = size_of(&size)?;
    let (dx, dy) = match spacing.split_once(',') {
        Some((dx, dy)) => (number(dx)?, number(dy)?),
        None => (number(&spacing)?, number(&spacing)?),
    };
    let heights = numbers(&heights, u64::from(width) * u64::from(height))?;
    Ok(Dem { width, height, spacing: (dx, dy), heights })
}

/// `NAME WxHxN : numbers`, rows from north to south, N numbers for each texel.
fn raster(rest: &str) -> Read<Raster> {
    let (head, values) = pair(rest, ':')?;
    let (name, shape) = split_word(&head);
    let (size, components) = shape.rsplit_once('x').ok_or(format!("`{shape}` is no WxHxN"))?;
    let (width, height) = size_of(size)?;
    let components: u32 = components.parse().map_err(|_| format!("`{shape}` is no WxHxN"))?;
    let numbers = numbers(&values, u64::from(width) * u64::from(height) * u64::from(components))?;
    Ok(Raster { name: required("a name", name)?, width, height, components, numbers })
}

fn numbers(text: &str, needed: u64) -> Read<Vec<f32>> {
    let found: Vec<f32> =
        text.split_whitespace().map(|n| number(n).map(|n| n as f32)).collect::<Read<_>>()?;
    match found.len() as u64 == needed {
        true => Ok(found),
        false => Err(format!("{needed} numbers are needed, {} are given", found.len())),
    }
}

/// `64K`, `2M`.
fn bytes(text: &str) -> Read<u64> {
    let (digits, unit) = match text.strip_suffix(['K', 'M']) {
        Some(digits) => (digits, if text.ends_with('K') { 1 << 10 } else { 1 << 20 }),
        None => (text, 1),
    };
    digits.parse::<u64>().map(|n| n * unit).map_err(|_| format!("`{text}` is no size such as 64K"))
}

fn from_file(name: &mut String, path: &str) -> Read<String> {
    *name = required("a path", path)?;
    std::fs::read_to_string(super::root().join(path)).map_err(|error| format!("{path}: {error}"))
}

// ---- parts ----

fn split_word(text: &str) -> (&str, &str) {
    let text = text.trim();
    match text.split_once(char::is_whitespace) {
        Some((word, rest)) => (word, rest.trim()),
        None => (text, ""),
    }
}

/// Both sides of a separator, neither of them empty.
fn pair<S: Separator>(text: &str, separator: S) -> Read<(String, String)> {
    let (left, right) = separator.split(text).ok_or(format!("`{separator}` is missing"))?;
    let (left, right) = (left.trim(), right.trim());
    if left.is_empty() || right.is_empty() {
        return Err(format!("a side of `{separator}` is empty"));
    }
    Ok((left.into(), right.into()))
}

trait Separator: std::fmt::Display {
    fn split<'a>(&self, text: &'a str) -> Option<(&'a str, &'a str)>;
}

impl Separator for char {
    fn split<'a>(&self, text: &'a str) -> Option<(&'a str, &'a str)> {
        text.split_once(*self)
    }
}

impl Separator for &str {
    fn split<'a>(&self, text: &'a str) -> Option<(&'a str, &'a str)> {
        text.split_once(*self)
    }
}

fn required(what: &str, text: &str) -> Read<String> {
    if text.is_empty() { Err(format!("{what} is missing")) } else { Ok(text.into()) }
}

fn number(text: &str) -> Read<f64> {
    text.trim().parse().map_err(|_| format!("`{}` is no number", text.trim()))
}

fn size_of(text: &str) -> Read<(u32, u32)> {
    let (width, height) = pair(text, 'x')?;
    match (width.parse(), height.parse()) {
        (Ok(w), Ok(h)) if w > 0 && h > 0 => Ok((w, h)),
        _ => Err(format!("`{text}` is no size")),
    }
}

fn quoted(text: &str) -> Read<String> {
    let inner = text.trim().strip_prefix('"').and_then(|t| t.strip_suffix('"'));
    inner.map(String::from).ok_or(format!("`{text}` is no text in quotes"))
}

fn value_and_tolerance(text: &str) -> Read<(Value, Tolerance)> {
    match text.split_once('~') {
        Some((value, tolerance)) => Ok((Value::parse(value)?, Tolerance::Given(number(tolerance)?))),
        None => Ok((Value::parse(text)?, Tolerance::Usual)),
    }
}

fn call(text: &str) -> Read<Call> {
    let open = text.find('(').ok_or(format!("`{text}` is no call"))?;
    let inner = text[open + 1..].strip_suffix(')').ok_or(format!("`)` is missing in `{text}`"))?;
    let entry = required("an entry", text[..open].trim())?;
    let mut args = Vec::new();
    let (mut depth, mut start) = (0, 0);
    for (at, c) in inner.char_indices() {
        match c {
            '(' | '[' => depth += 1,
            ')' | ']' => depth -= 1,
            ',' if depth == 0 => {
                args.push(inner[start..at].trim().to_string());
                start = at + 1;
            }
            _ => {}
        }
    }
    if !inner.trim().is_empty() {
        args.push(inner[start..].trim().to_string());
    }
    Ok(Call { entry, args })
}

#[cfg(test)]
mod tests;
