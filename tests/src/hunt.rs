//! Looks for inputs that a function does not survive: it panics, takes too long or takes too much memory.
//!
//! A find is reduced while it fails in the same way and is written to `tests/finds/`. An input that takes the whole
//! process down (an overflown stack) is what `tests/finds/NAME.last` holds afterwards.

use ghyll_compiler::random::Random;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, PanicHookInfo, catch_unwind};
use std::path::PathBuf;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// What an input may cost.
const TIME: Duration = Duration::from_secs(2);
/// Code that is not optimised gets more of it.
const PATIENCE: u32 = if cfg!(debug_assertions) { 5 } else { 1 };
/// Bytes in addition to what the process held before.
const MEMORY: u64 = 1 << 30;
/// An input that is not done after this is left behind.
const HANG: Duration = Duration::from_secs(60);
/// The process gives up before the machine does.
const GIVE_UP: u64 = 6 << 30;
/// How long one find is reduced.
const REDUCING: Duration = Duration::from_secs(20);
/// Finds of one kind that are kept.
const KEPT: usize = 3;

/// Two hunts at once would be charged for each other's time and memory, and share the panic hook.
static TURN: Mutex<()> = Mutex::new(());
static PANICKED: Mutex<Option<String>> = Mutex::new(None);

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// One input: bytes, and the name of the file that they would come from.
#[derive(Clone, Debug)]
pub struct Input {
    pub name: String,
    pub bytes: Vec<u8>,
    /// Seed of what the function itself draws.
    pub seed: u64,
}

pub struct Hunt {
    /// Names the saved files.
    pub name: &'static str,
    pub seed: u64,
    pub time: Duration,
}

/// A way to fail, equal for inputs that fail alike.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Failure {
    Panic(String),
    Slow,
    Memory,
    Hang,
}

struct Run {
    failure: Option<Failure>,
    /// What the message says beside the kind.
    cost: String,
}

impl Hunt {
    /// `GHYLL_SEED` and `GHYLL_FUZZ_SECONDS`, or a new seed and five seconds.
    pub fn from_environment(name: &'static str) -> Hunt {
        let number = |key: &str| {
            std::env::var(key).ok().map(|text| match text.parse::<u64>() {
                Ok(n) => n,
                Err(_) => panic!("{key} must be a number, not `{text}`"),
            })
        };
        let new = || {
            SystemTime::now().duration_since(UNIX_EPOCH).map_or(1, |t| t.as_nanos() as u64 % 1_000_000_000)
        };
        let seed = number("GHYLL_SEED").unwrap_or_else(new);
        Hunt { name, seed, time: Duration::from_secs(number("GHYLL_FUZZ_SECONDS").unwrap_or(5)) }
    }

    /// Tries inputs until the time is over; what was found, as text.
    pub fn run(
        &self,
        mut make: impl FnMut(&mut Random) -> Input,
        survive: impl Fn(&Input) + Send + Sync + 'static,
    ) -> Result<String, String> {
        let _turn = lock(&TURN);
        let survive: Arc<dyn Fn(&Input) + Send + Sync> = Arc::new(survive);
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(remember));
        let mut random = Random::new(self.seed);
        let mut found: BTreeMap<Failure, usize> = BTreeMap::new();
        let mut told = Vec::new();
        let (start, mut tried) = (Instant::now(), 0);
        while start.elapsed() < self.time {
            let input = make(&mut random);
            tried += 1;
            let run = self.attempt(&survive, &input);
            let Some(failure) = run.failure else { continue };
            let known = found.entry(failure.clone()).or_default();
            *known += 1;
            let most = if matches!(failure, Failure::Panic(_)) { 1 } else { KEPT };
            if *known > most {
                continue;
            }
            let hung = failure == Failure::Hang;
            let small = if hung { input } else { self.reduce(&survive, input, &failure) };
            let path = self.save(&format!("{}-{}", self.seed, tried), &small);
            let line = format!("input {tried}: {failure:?}{}; saved as {}", run.cost, path.display());
            eprintln!("{line}");
            told.push(line);
            if hung {
                break;
            }
        }
        std::panic::set_hook(before);
        let _ = std::fs::remove_file(self.last());
        let title =
            format!("GHYLL_SEED={}: {tried} inputs of {} in {:?}", self.seed, self.name, start.elapsed());
        match told.is_empty() {
            true => Ok(title),
            false => Err(format!("{title}\n{}", told.join("\n"))),
        }
    }

    fn attempt(&self, survive: &Arc<dyn Fn(&Input) + Send + Sync>, input: &Input) -> Run {
        // What would take the process down is on disk by then.
        let _ = std::fs::create_dir_all(folder());
        let _ = std::fs::write(self.last(), &input.bytes);
        *lock(&PANICKED) = None;
        let (held, spent, start) = (forget_peak(), processor(), Instant::now());
        let (done, answer) = channel();
        let (work, taken) = (survive.clone(), input.clone());
        std::thread::spawn(move || {
            let survived = catch_unwind(AssertUnwindSafe(|| work(&taken))).is_ok();
            let _ = done.send(survived);
        });
        let survived = loop {
            match answer.recv_timeout(Duration::from_millis(200)) {
                Ok(survived) => break survived,
                Err(RecvTimeoutError::Disconnected) => break false,
                Err(RecvTimeoutError::Timeout) => {}
            }
            if memory("VmRSS:").is_some_and(|now| now > GIVE_UP) {
                eprintln!("GHYLL_SEED={}: out of bounds; {} is the input", self.seed, self.last().display());
                std::process::exit(1);
            }
            if start.elapsed() > HANG {
                return Run { failure: Some(Failure::Hang), cost: format!(" after {HANG:?}") };
            }
        };
        if !survived {
            let place = lock(&PANICKED).take().unwrap_or_default();
            let (place, message) = place.split_once('\n').unwrap_or((&place, ""));
            return Run { failure: Some(Failure::Panic(place.to_owned())), cost: format!(": {message}") };
        }
        let time = match (spent, processor()) {
            (Some(before), Some(after)) => after.saturating_sub(before),
            _ => start.elapsed(),
        };
        let more = memory("VmHWM:").unwrap_or(0).saturating_sub(held);
        let failure = match () {
            () if time > TIME * PATIENCE => Some(Failure::Slow),
            () if more > MEMORY => Some(Failure::Memory),
            () => None,
        };
        Run { failure, cost: format!(" ({time:?}, {} MiB)", more >> 20) }
    }

    /// Removes pieces, ever smaller ones, as long as the rest fails alike.
    fn reduce(&self, survive: &Arc<dyn Fn(&Input) + Send + Sync>, input: Input, failure: &Failure) -> Input {
        let start = Instant::now();
        let mut best = input;
        let mut piece = best.bytes.len() / 2;
        while piece > 0 {
            let (mut at, length) = (0, best.bytes.len());
            while at < best.bytes.len() {
                if start.elapsed() > REDUCING {
                    return best;
                }
                let mut rest = best.clone();
                rest.bytes.drain(at..(at + piece).min(rest.bytes.len()));
                match self.attempt(survive, &rest).failure.as_ref() == Some(failure) {
                    true => best = rest,
                    false => at += piece,
                }
            }
            if best.bytes.len() == length || piece > best.bytes.len() {
                piece /= 2;
            }
        }
        best
    }

    fn last(&self) -> PathBuf {
        folder().join(format!("{}.last", self.name))
    }

    fn save(&self, number: &str, input: &Input) -> PathBuf {
        let path = folder().join(format!("{}-{number}-{}", self.name, input.name));
        if let Err(why) = std::fs::write(&path, &input.bytes) {
            eprintln!("cannot write {}: {why}", path.display());
        }
        path
    }
}

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("finds")
}

/// The panic hook: place and message, and nothing on the terminal.
fn remember(info: &PanicHookInfo) {
    let place = info.location().map_or_else(String::new, |at| format!("{}:{}", at.file(), at.line()));
    let payload = info.payload();
    let message = payload
        .downcast_ref::<&str>()
        .map(|text| (*text).to_owned())
        .or_else(|| payload.downcast_ref::<String>().cloned())
        .unwrap_or_default();
    let mut panicked = lock(&PANICKED);
    if panicked.is_none() {
        *panicked = Some(format!("{place}\n{message}"));
    }
}

/// Bytes in a line of `/proc/self/status`, where there is one.
fn memory(key: &str) -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(key))?;
    Some(line.split_whitespace().next()?.parse::<u64>().ok()? << 10)
}

/// Starts the peak anew; what is held now.
fn forget_peak() -> u64 {
    let _ = std::fs::write("/proc/self/clear_refs", "5");
    memory("VmHWM:").unwrap_or(0)
}

/// Processor time of all threads, which other processes do not lengthen.
fn processor() -> Option<Duration> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    let mut fields = stat.rsplit_once(')')?.1.split_whitespace().skip(11);
    let mut next = || fields.next()?.parse::<u64>().ok();
    // Linux counts in hundredths of a second.
    Some(Duration::from_millis(10 * (next()? + next()?)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_planted_panic_is_found_and_reduced() {
        let hunt = Hunt { name: "planted", seed: 7, time: Duration::from_millis(300) };
        let make = |random: &mut Random| {
            let bytes = (0..40).map(|_| b'a' + random.below(26) as u8).collect();
            Input { name: "text".into(), bytes, seed: 0 }
        };
        assert!(hunt.run(make, |_| ()).is_ok());
        let told = hunt.run(make, |input| assert!(!input.bytes.contains(&b'q'), "there is a q")).unwrap_err();
        assert!(told.contains("there is a q"), "{told}");
        let path = told.split("saved as ").nth(1).unwrap().trim();
        assert_eq!(std::fs::read(path).unwrap(), b"q");
        std::fs::remove_file(path).unwrap();
    }
}
