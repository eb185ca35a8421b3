//! Limits, and the choice that meets them.

use super::measure::Measured;
use crate::memory::{allowance, size};
use std::fmt;

/// What a picture may take, and how good it must be.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// Milliseconds a frame.
    pub frame_ms: Option<f64>,
    /// Decibels against the best choice's picture.
    pub min_psnr: Option<f64>,
    /// Bytes.
    pub max_memory: Option<u64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    FrameMs,
    MinPsnr,
    MaxMemory,
}

const ALL: [Limit; 3] = [Limit::FrameMs, Limit::MinPsnr, Limit::MaxMemory];

impl Limits {
    /// How far a choice goes beyond a limit, in the limit's unit: 0 or less if it does not.
    fn beyond(&self, limit: Limit, measured: &Measured) -> f64 {
        match limit {
            Limit::FrameMs => self.frame_ms.map_or(0.0, |ms| measured.frame_ms - ms),
            Limit::MinPsnr => self.min_psnr.map_or(0.0, |least| least - measured.psnr),
            Limit::MaxMemory => self.max_memory.map_or(0.0, |most| measured.memory as f64 - most as f64),
        }
    }

    fn given(&self, limit: Limit) -> bool {
        match limit {
            Limit::FrameMs => self.frame_ms.is_some(),
            Limit::MinPsnr => self.min_psnr.is_some(),
            Limit::MaxMemory => self.max_memory.is_some(),
        }
    }

    /// Where the frame's time is limited, or nothing but memory is, the best picture; else the least time. Of equals the
    /// faster, then the smaller.
    pub fn pick<'a>(&self, all: &'a [Measured]) -> Result<&'a Measured, Vec<Shortfall>> {
        let quality_first = self.frame_ms.is_some() || self.min_psnr.is_none();
        let better = |a: &&Measured, b: &&Measured| {
            let quality = b.psnr.total_cmp(&a.psnr);
            let time = a.frame_ms.total_cmp(&b.frame_ms);
            let memory = a.memory.cmp(&b.memory);
            if quality_first { quality.then(time).then(memory) } else { time.then(memory).then(quality) }
        };
        let good = all.iter().filter(|m| m.drawn && ALL.iter().all(|limit| self.beyond(*limit, m) <= 0.0));
        good.min_by(better).ok_or_else(|| self.shortfalls(all))
    }

    /// The limits that are in the way, that of the least share first. One is binding by itself if some choice meets all others.
    fn shortfalls(&self, all: &[Measured]) -> Vec<Shortfall> {
        let nearest = |limit: Limit, among: &mut dyn Iterator<Item = &Measured>| {
            let least = among.min_by(|a, b| self.beyond(limit, a).total_cmp(&self.beyond(limit, b)))?;
            Some(Shortfall { limit, limits: *self, nearest: least.clone(), alone: true })
        };
        let drawn = || all.iter().filter(|m| m.drawn);
        // Of what lacks memory nothing else is known.
        if drawn().next().is_none() {
            return nearest(Limit::MaxMemory, &mut all.iter()).into_iter().collect();
        }
        let given: Vec<Limit> = ALL.into_iter().filter(|limit| self.given(*limit)).collect();
        let meets_others = |limit: Limit, m: &Measured| {
            given.iter().all(|other| *other == limit || self.beyond(*other, m) <= 0.0)
        };
        let mut alone: Vec<Shortfall> = given
            .iter()
            .filter_map(|limit| nearest(*limit, &mut drawn().filter(|m| meets_others(*limit, m))))
            .collect();
        alone.sort_by(|a, b| a.share().total_cmp(&b.share()));
        if !alone.is_empty() {
            return alone;
        }
        let each = given.iter().filter_map(|limit| nearest(*limit, &mut drawn()));
        each.filter(|missed| missed.by() > 0.0).map(|missed| Shortfall { alone: false, ..missed }).collect()
    }
}

/// A limit that no choice meets, or none that meets the others.
#[derive(Clone, Debug, PartialEq)]
pub struct Shortfall {
    pub limit: Limit,
    limits: Limits,
    /// The choice that misses it least.
    pub nearest: Measured,
    /// All other limits are met by this choice.
    pub alone: bool,
}

impl Shortfall {
    /// By how much it is missed, in milliseconds, decibels or bytes.
    pub fn by(&self) -> f64 {
        self.limits.beyond(self.limit, &self.nearest)
    }
}

impl fmt::Display for Shortfall {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let (by, choice) = (self.by(), &self.nearest.choice);
        let others = if self.alone && self.nearest.drawn && self.has_others() {
            " of those that meet the other limits"
        } else {
            ""
        };
        match self.limit {
            Limit::FrameMs => write!(
                f,
                "--frame-ms is missed by {by:.1} ms: the fastest choice{others} ({choice}) takes {:.1} ms; \
                 allow --frame-ms {:.0}, or make the picture smaller",
                self.nearest.frame_ms,
                (1.05 * self.nearest.frame_ms).ceil()
            ),
            Limit::MinPsnr => write!(
                f,
                "--min-psnr is missed by {by:.1} dB: the best choice{others} ({choice}) gives {:.1} dB; \
                 ask for --min-psnr {:.0}",
                self.nearest.psnr,
                self.nearest.psnr.floor()
            ),
            Limit::MaxMemory => write!(
                f,
                "--max-memory is missed by {}: the smallest choice{others} ({choice}) needs {}{}; \
                 allow --max-memory {}, or make the picture smaller",
                size(by.max(0.0) as u64),
                if self.nearest.drawn { "" } else { "at least " },
                size(self.nearest.memory),
                allowance(self.nearest.memory)
            ),
        }
    }
}

impl Shortfall {
    /// Whether other limits are given too.
    fn has_others(&self) -> bool {
        ALL.iter().any(|limit| *limit != self.limit && self.limits.given(*limit))
    }

    /// What is missing as a share of the limit.
    fn share(&self) -> f64 {
        let limit = match self.limit {
            Limit::FrameMs => self.limits.frame_ms,
            Limit::MinPsnr => self.limits.min_psnr,
            Limit::MaxMemory => self.limits.max_memory.map(|bytes| bytes as f64),
        };
        self.by() / limit.unwrap_or(1.0).max(1e-9)
    }
}

#[cfg(test)]
mod tests {
    use super::super::choices::Choice;
    use super::*;

    fn measured(samples: u32, frame_ms: f64, psnr: f64, memory: u64, drawn: bool) -> Measured {
        let choice = Choice { set: Vec::new(), samples, bake: true };
        Measured { choice, frame_ms, psnr, memory, drawn }
    }

    fn three() -> [Measured; 3] {
        [
            measured(8, 80.0, f64::INFINITY, 300, true),
            measured(4, 40.0, 35.0, 200, true),
            measured(1, 10.0, 25.0, 100, true),
        ]
    }

    fn picked(limits: Limits) -> u32 {
        limits.pick(&three()).unwrap().choice.samples
    }

    #[test]
    fn what_is_not_limited_is_made_the_best_of() {
        let none = Limits::default();
        assert_eq!(picked(none), 8);
        assert_eq!(picked(Limits { frame_ms: Some(50.0), ..none }), 4);
        assert_eq!(picked(Limits { min_psnr: Some(30.0), ..none }), 4);
        assert_eq!(picked(Limits { min_psnr: Some(20.0), ..none }), 1);
        assert_eq!(picked(Limits { min_psnr: Some(90.0), ..none }), 8);
        // Together: the best picture within the time.
        assert_eq!(picked(Limits { frame_ms: Some(90.0), min_psnr: Some(20.0), ..none }), 8);
        assert_eq!(picked(Limits { max_memory: Some(250), ..none }), 4);
    }

    #[test]
    fn the_binding_limit_is_told_with_how_much_is_missing() {
        let missed = |limits: Limits| limits.pick(&three()).unwrap_err();
        let time = missed(Limits { frame_ms: Some(4.0), ..Limits::default() });
        assert_eq!((time.len(), time[0].limit, time[0].by()), (1, Limit::FrameMs, 6.0));
        // A choice that is good enough takes 40 ms, one that is fast enough has 25 dB: either limit is in the way.
        let both = missed(Limits { frame_ms: Some(20.0), min_psnr: Some(30.0), ..Limits::default() });
        let told: Vec<_> = both.iter().map(|s| (s.limit, s.by(), s.alone)).collect();
        assert_eq!(told, [(Limit::MinPsnr, 5.0, true), (Limit::FrameMs, 20.0, true)]);
        assert!(both[1].to_string().contains("4 samples") && both[1].to_string().contains("--frame-ms 42"));
        // Time is in the way whatever the memory is.
        let limits = Limits { frame_ms: Some(5.0), max_memory: Some(1000), ..Limits::default() };
        assert_eq!(missed(limits)[0].limit, Limit::FrameMs);
    }

    #[test]
    fn what_lacks_memory_is_told_by_the_smallest() {
        let lacking = |memory| measured(1, f64::INFINITY, f64::NEG_INFINITY, memory, false);
        let limits = Limits { frame_ms: Some(5.0), max_memory: Some(1000), ..Limits::default() };
        let missed = limits.pick(&[lacking(5000), lacking(3000)]).unwrap_err();
        assert_eq!((missed[0].limit, missed[0].by()), (Limit::MaxMemory, 2000.0));
        assert!(missed[0].to_string().contains("--max-memory 3K"), "{}", missed[0]);
    }
}
