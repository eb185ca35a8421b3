//! How far a run has come, for a bar on a terminal.

use std::fmt::{self, Debug, Formatter};
use std::sync::Arc;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Pixels of the picture that are finished.
    Pixels { done: u64, total: u64 },
    /// Rewrites so far, where nobody knows how many there will be.
    Rewrites(u64),
}

/// Who wants to know; nobody by default. The callback is called from any thread, between submissions on the GPU and
/// between tiles on the CPU, so it has to be quick.
#[derive(Clone, Default)]
pub struct Progress(Option<Arc<dyn Fn(Step) + Send + Sync>>);

impl Progress {
    pub fn new(tell: impl Fn(Step) + Send + Sync + 'static) -> Progress {
        Progress(Some(Arc::new(tell)))
    }

    pub fn tell(&self, step: Step) {
        if let Some(tell) = &self.0 {
            tell(step);
        }
    }

    /// Pixels done of a picture that is computed in `parts`.
    pub(crate) fn part(&self, (width, height): (u32, u32), done: u64, parts: u64) {
        let total = u64::from(width) * u64::from(height);
        let done = (u128::from(total) * u128::from(done.min(parts)) / u128::from(parts.max(1))) as u64;
        self.tell(Step::Pixels { done, total });
    }
}

impl Debug for Progress {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        f.write_str(if self.0.is_some() { "Progress(told)" } else { "Progress(none)" })
    }
}

/// The same listener.
impl PartialEq for Progress {
    fn eq(&self, other: &Progress) -> bool {
        match (&self.0, &other.0) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            (a, b) => a.is_none() && b.is_none(),
        }
    }
}

/// For tests: a listener, and what it was told.
#[cfg(test)]
pub(crate) fn recorded() -> (Progress, Arc<std::sync::Mutex<Vec<Step>>>) {
    let steps = Arc::new(std::sync::Mutex::new(Vec::new()));
    let kept = steps.clone();
    (Progress::new(move |step| kept.lock().unwrap().push(step)), steps)
}

/// For tests: the steps tell of all pixels of the picture, the finished ones last, in at least `least` steps.
#[cfg(test)]
pub(crate) fn check(steps: &[Step], pixels: u64, least: usize) -> Result<(), String> {
    let mut told = Vec::new();
    for step in steps {
        if let Step::Pixels { done, total } = step {
            if *total != pixels || *done > *total {
                return Err(format!("{step:?} of {pixels}"));
            }
            told.push(*done);
        }
    }
    if told.iter().max() != Some(&pixels) || told.len() < least {
        return Err(format!("{told:?} of {pixels}"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_end_and_a_wrong_total_are_seen() {
        let pixels = |done, total| Step::Pixels { done, total };
        assert!(check(&[pixels(5, 10), Step::Rewrites(3), pixels(10, 10)], 10, 2).is_ok());
        for wrong in [vec![], vec![pixels(5, 10)], vec![pixels(5, 9), pixels(10, 10)], vec![pixels(10, 10)]] {
            assert!(check(&wrong, 10, 2).is_err(), "{wrong:?}");
        }
    }

    #[test]
    fn parts_are_told_as_pixels() {
        let (progress, steps) = recorded();
        progress.part((10, 3), 1, 4);
        progress.part((10, 3), 9, 4);
        let told = steps.lock().unwrap().clone();
        assert_eq!(told, [Step::Pixels { done: 7, total: 30 }, Step::Pixels { done: 30, total: 30 }]);
        assert_eq!(progress, progress.clone());
        assert_ne!(progress, Progress::default());
    }
}
