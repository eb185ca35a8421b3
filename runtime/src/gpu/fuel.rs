//! How much one submission may do, from measured times.
//!
//! A driver ends a submission that runs for seconds, so every lane has fuel per dispatch. Fuel is raised only where
//! it was used up, from the time that a dispatch with lanes out of fuel took at most.

use std::time::Duration;

/// What a dispatch of lanes may take.
const DISPATCH: f64 = 0.06;
const LEAST: i32 = 64;
const MOST: i32 = 1 << 26;
/// Rounds recorded into one submission.
const ROUNDS: u32 = 16;

#[derive(Clone, Copy, Debug)]
pub struct Fuel {
    /// Steps of a lane in one dispatch.
    pub steps: i32,
    pub rounds: u32,
    /// The last extension took too long, which may have been the load of the machine.
    slow: bool,
}

impl Default for Fuel {
    fn default() -> Fuel {
        Fuel { steps: 1024, rounds: 4, slow: false }
    }
}

impl Fuel {
    /// Learns from a submission: its time, and in how many of its rounds a lane ran out of fuel.
    pub fn learn(&mut self, time: Duration, full: u32) {
        let seconds = time.as_secs_f64();
        if full > 0 {
            let factor = DISPATCH * f64::from(full) / seconds.max(1e-6);
            self.scale(factor.clamp(1.0 / 16.0, 8.0));
        }
        if seconds < 0.25 {
            self.rounds = (self.rounds * 2).min(ROUNDS);
        } else if seconds > 0.8 {
            self.rounds = (self.rounds / 2).max(1);
        }
    }

    fn scale(&mut self, factor: f64) {
        self.steps = ((f64::from(self.steps) * factor) as i32).clamp(LEAST, MOST);
    }

    /// Gives a fused loop more steps, `cap` at most; false if it would take longer than a submission may, which is
    /// measured twice.
    pub fn extend(&mut self, time: Duration, cap: i32) -> bool {
        self.rounds = 1;
        if self.steps >= cap.min(MOST) {
            return false;
        }
        if time.as_secs_f64() > 0.4 {
            let again = !self.slow;
            self.slow = true;
            return again;
        }
        self.slow = false;
        self.scale((1.2 / time.as_secs_f64().max(1e-6)).clamp(2.0, 8.0));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fuel_follows_the_time_of_full_rounds() {
        let mut fuel = Fuel::default();
        fuel.learn(Duration::from_millis(1), 1);
        assert_eq!(fuel.steps, 8 * 1024);
        fuel.learn(Duration::from_millis(600), 1);
        assert!(fuel.steps < 1024);
    }

    #[test]
    fn fuel_stays_where_it_was_not_used_up() {
        let mut fuel = Fuel::default();
        fuel.learn(Duration::from_millis(1), 0);
        assert_eq!(fuel.steps, 1024);
    }

    #[test]
    fn loops_get_more_until_a_submission_takes_too_long() {
        let mut fuel = Fuel::default();
        assert!(fuel.extend(Duration::from_millis(10), i32::MAX));
        assert!(fuel.steps > 1024);
        let steps = fuel.steps;
        assert!(fuel.extend(Duration::from_secs(1), i32::MAX), "once may be the machine's load");
        assert_eq!(fuel.steps, steps);
        assert!(!fuel.extend(Duration::from_secs(1), i32::MAX));
        assert!(!fuel.extend(Duration::from_millis(10), 1000));
    }
}
