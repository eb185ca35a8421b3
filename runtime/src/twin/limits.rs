//! What all lanes of a run share: the clock, the count of rewrites, the memory in use, the first error.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::time::{Duration, Instant};

use crate::config::Config;
use crate::error::RunError;
use crate::memory::Memory;
use crate::progress::{Progress, Step};

pub struct Limits {
    start: Instant,
    timeout: Duration,
    max_rewrites: Option<u64>,
    max_memory: u64,
    progress: Progress,
    rewrites: AtomicU64,
    memory: AtomicU64,
    peak: AtomicU64,
    stopped: AtomicBool,
    error: Mutex<Option<RunError>>,
}

impl Limits {
    /// `fixed` is held as long as the run lasts.
    pub fn new(config: &Config, fixed: Memory) -> Result<Limits, RunError> {
        let limit = config.max_memory;
        if fixed.total() > limit {
            return Err(RunError::TooLittleMemory { needed: fixed, limit });
        }
        Ok(Limits {
            start: Instant::now(),
            timeout: config.timeout,
            max_rewrites: config.max_rewrites,
            max_memory: config.max_memory,
            progress: config.progress.clone(),
            rewrites: AtomicU64::new(0),
            memory: AtomicU64::new(fixed.total()),
            peak: AtomicU64::new(fixed.total()),
            stopped: AtomicBool::new(false),
            error: Mutex::new(None),
        })
    }

    pub fn elapsed(&self) -> Duration {
        self.start.elapsed()
    }

    pub fn rewrites(&self) -> u64 {
        self.rewrites.load(Relaxed)
    }

    pub fn peak_memory(&self) -> u64 {
        self.peak.load(Relaxed)
    }

    /// Bytes that may still be taken.
    pub fn free_memory(&self) -> u64 {
        self.max_memory.saturating_sub(self.memory.load(Relaxed))
    }

    /// Counts rewrites made in `function`.
    pub fn spend(&self, rewrites: u64, function: &str) -> Result<(), RunError> {
        let total = self.rewrites.fetch_add(rewrites, Relaxed) + rewrites;
        match self.max_rewrites {
            Some(limit) if total > limit => {
                Err(self.fail(RunError::MaxRewrites { function: function.into(), limit }))
            }
            _ => Ok(()),
        }
    }

    pub fn check_clock(&self, function: &str) -> Result<(), RunError> {
        if self.stopped.load(Relaxed) {
            return Err(self.first_error());
        }
        self.progress.tell(Step::Rewrites(self.rewrites()));
        let elapsed = self.start.elapsed();
        if elapsed <= self.timeout {
            return Ok(());
        }
        Err(self.fail(RunError::Timeout {
            function: function.into(),
            seconds: elapsed.as_secs_f64(),
            reached: format!("{} rewrites", self.rewrites()),
        }))
    }

    /// Whether work that is under way may be dropped: the run has ended, or [`Limits::check_clock`] is about to end it.
    pub fn is_over(&self) -> bool {
        self.stopped.load(Relaxed) || self.start.elapsed() > self.timeout
    }

    /// Replaces a holding of `before` bytes by one of `after`.
    pub fn hold(&self, before: u64, after: u64, function: &str) -> Result<(), RunError> {
        if after <= before {
            self.release(before - after);
            return Ok(());
        }
        let wanted = self.memory.fetch_add(after - before, Relaxed) + (after - before);
        if wanted <= self.max_memory {
            self.peak.fetch_max(wanted, Relaxed);
            return Ok(());
        }
        self.memory.fetch_sub(after - before, Relaxed);
        Err(self.out_of_memory(wanted, function))
    }

    /// Counts bytes that are taken whether they are free or not.
    pub fn take(&self, bytes: u64) {
        let taken = self.memory.fetch_add(bytes, Relaxed) + bytes;
        self.peak.fetch_max(taken.min(self.max_memory), Relaxed);
    }

    pub fn release(&self, bytes: u64) {
        self.memory.fetch_sub(bytes, Relaxed);
    }

    pub fn out_of_memory(&self, bytes: u64, function: &str) -> RunError {
        self.fail(RunError::OutOfMemory { function: function.into(), bytes, limit: self.max_memory })
    }

    /// Stops all lanes; the first error is the one that counts.
    pub fn fail(&self, error: RunError) -> RunError {
        self.stopped.store(true, Relaxed);
        let mut first = self.error.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        first.get_or_insert(error).clone()
    }

    fn first_error(&self) -> RunError {
        let first = self.error.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        first.clone().unwrap_or_else(|| RunError::Internal("the run stopped without an error".into()))
    }
}
