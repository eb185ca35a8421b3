//! The tuning file: figures of choices that were measured before, by what they were measured for.

use super::choices::Choice;
use super::measure::Measured;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

#[derive(Debug, thiserror::Error)]
pub enum FileError {
    #[error("{} is no tuning file ({what}); delete it, or name another one with --tuning", file.display())]
    Damaged { file: PathBuf, what: String },
    #[error("cannot read {}: {error}", file.display())]
    Read { file: PathBuf, error: std::io::Error },
    #[error("cannot write {}: {error}; name another one with --tuning", file.display())]
    Write { file: PathBuf, error: std::io::Error },
}

/// What figures depend on: program, data, view, machine. Entries of equal texts are of one subject.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Subject {
    /// For who reads the file.
    pub about: String,
    /// Of all that figures depend on.
    pub fingerprint: String,
}

impl Subject {
    pub fn new(about: String, details: &str) -> Subject {
        // FNV-1a: the same in every version of this program, unlike the standard library's.
        let step = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        let hash = details.as_bytes().iter().fold(0xcbf2_9ce4_8422_2325, step);
        Subject { about, fingerprint: format!("{hash:016x}") }
    }
}

/// A file in memory.
pub struct TuningFile {
    path: PathBuf,
    entries: Vec<(Subject, Vec<Measured>)>,
}

impl TuningFile {
    /// A file that is not there is empty.
    pub fn open(path: &Path) -> Result<TuningFile, FileError> {
        let file = path.to_owned();
        let text = match std::fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                return Ok(TuningFile { path: file, entries: Vec::new() });
            }
            Err(error) => return Err(FileError::Read { file, error }),
        };
        let damaged = |what: &str| FileError::Damaged { file: file.clone(), what: what.into() };
        let value: Value = serde_json::from_str(&text).map_err(|e| damaged(&e.to_string()))?;
        let entries = value["tunings"].as_array().ok_or_else(|| damaged("it has no `tunings`"))?;
        let entries = entries
            .iter()
            .enumerate()
            .map(|(at, value)| {
                entry(value).ok_or_else(|| damaged(&format!("number {at} of its `tunings` lacks a figure")))
            })
            .collect::<Result<_, _>>()?;
        Ok(TuningFile { path: file, entries })
    }

    pub fn find(&self, subject: &Subject) -> Option<&[Measured]> {
        let found = self.entries.iter().find(|(known, _)| known.fingerprint == subject.fingerprint);
        found.map(|(_, all)| all.as_slice())
    }

    /// Adds figures and writes the file.
    pub fn keep(&mut self, subject: Subject, measured: &[Measured]) -> Result<(), FileError> {
        self.entries.retain(|(known, _)| known.fingerprint != subject.fingerprint);
        self.entries.push((subject, measured.to_vec()));
        let entries: Vec<Value> =
            self.entries.iter().map(|(subject, all)| entry_json(subject, all)).collect();
        let text = format!("{:#}\n", json!({ "tunings": entries }));
        std::fs::write(&self.path, text).map_err(|error| FileError::Write { file: self.path.clone(), error })
    }
}

fn entry_json(subject: &Subject, all: &[Measured]) -> Value {
    json!({
        "about": subject.about,
        "fingerprint": subject.fingerprint,
        "choices": all.iter().map(measured_json).collect::<Vec<_>>(),
    })
}

/// Figures that are not known, and an error of nothing, are null.
pub fn measured_json(measured: &Measured) -> Value {
    let Choice { set, samples, bake } = &measured.choice;
    let set: serde_json::Map<String, Value> =
        set.iter().map(|(name, value)| (name.clone(), value.as_str().into())).collect();
    json!({
        "set": set,
        "samples": samples,
        "bake": bake,
        "frame_ms": measured.frame_ms.is_finite().then_some(measured.frame_ms),
        "psnr_db": measured.psnr.is_finite().then_some(measured.psnr),
        "memory_bytes": measured.memory,
        "drawn": measured.drawn,
    })
}

fn entry(value: &Value) -> Option<(Subject, Vec<Measured>)> {
    let text = |key: &str| value[key].as_str().map(str::to_owned);
    let subject = Subject { about: text("about")?, fingerprint: text("fingerprint")? };
    let all: Vec<Measured> = value["choices"].as_array()?.iter().map(measured).collect::<Option<_>>()?;
    (!all.is_empty()).then_some((subject, all))
}

fn measured(value: &Value) -> Option<Measured> {
    let set = value["set"].as_object()?.iter();
    let set =
        set.map(|(name, value)| Some((name.clone(), value.as_str()?.to_owned()))).collect::<Option<_>>()?;
    let samples = value["samples"].as_u64().and_then(|n| u32::try_from(n).ok()).filter(|n| *n > 0)?;
    let choice = Choice { set, samples, bake: value["bake"].as_bool()? };
    let drawn = value["drawn"].as_bool()?;
    let number = |key: &str, absent: f64| match &value[key] {
        Value::Null => Some(absent),
        other => other.as_f64(),
    };
    Some(Measured {
        choice,
        frame_ms: number("frame_ms", f64::INFINITY)?,
        psnr: number("psnr_db", if drawn { f64::INFINITY } else { f64::NEG_INFINITY })?,
        memory: value["memory_bytes"].as_u64()?,
        drawn,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_come_back() {
        let set = vec![("detail".to_string(), "true".to_string())];
        let choice = Choice { set, samples: 4, bake: false };
        let drawn = Measured { choice, frame_ms: 12.5, psnr: f64::INFINITY, memory: 1 << 20, drawn: true };
        let lacking =
            Measured { frame_ms: f64::INFINITY, psnr: f64::NEG_INFINITY, drawn: false, ..drawn.clone() };
        for one in [drawn, lacking] {
            assert_eq!(measured(&measured_json(&one)), Some(one));
        }
        let one = Subject::new("a".into(), "details");
        assert_eq!(one.fingerprint, Subject::new("b".into(), "details").fingerprint);
        assert_ne!(one.fingerprint, Subject::new("a".into(), "Details").fingerprint);
    }
}
