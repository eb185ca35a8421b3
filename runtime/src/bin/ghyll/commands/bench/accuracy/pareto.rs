//! Which configurations are worth their time: those that no other beats in time and in error.

use super::{Method, Row, Setting};
use serde_json::{Value, json};

/// Milliseconds and error.
type Point = [f64; 2];

/// Not slower and not worse, and not the same.
fn beats(a: Point, b: Point) -> bool {
    a[0] <= b[0] && a[1] <= b[1] && a != b
}

fn point(row: &Row) -> Option<Point> {
    Some([row.ms[0], row.distances.as_ref()?.all])
}

/// Marks the front of every curve.
pub fn mark(rows: &mut [Row]) {
    let points: Vec<_> = rows.iter().map(|row| (row.setting.clone(), point(row))).collect();
    for row in rows {
        let Some(own) = point(row) else { continue };
        let others = points.iter().filter(|(setting, _)| *setting == row.setting).filter_map(|(_, p)| *p);
        row.front = !others.into_iter().any(|other| beats(other, own));
    }
}

/// Trace against all searches of one setting.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    pub setting: Setting,
    pub trace: Point,
    pub searches: usize,
    /// Slower and worse than trace.
    pub dominated: usize,
    /// Not slower and not worse than trace: at equal time or equal error they would be the choice.
    pub better: usize,
    /// Faster, but worse; the least error of these in units of trace's.
    pub faster: usize,
    pub faster_error: Option<f64>,
    /// The least time in units of trace's for an error that is not above trace's.
    pub equal_error_time: Option<f64>,
}

impl Verdict {
    /// Less error than any search in the same time, less time than any search of the same error.
    pub fn dominates(&self) -> bool {
        self.better == 0
    }

    pub fn name(&self) -> String {
        let Setting { terrain, view, surface, backend } = &self.setting;
        format!("{terrain}, {view}, {surface}, trace against search, {backend}")
    }

    pub fn json(&self) -> Value {
        json!({
            "name": self.name(),
            "trace_ms": self.trace[0],
            "trace_error_footprints": self.trace[1],
            "searches": self.searches,
            "slower_and_worse": self.dominated,
            "better": self.better,
            "faster_and_worse": self.faster,
            "least_error_of_faster_ratio": self.faster_error,
            "least_time_at_equal_error_ratio": self.equal_error_time,
            "dominates": self.dominates(),
        })
    }
}

pub fn verdicts(rows: &[Row]) -> Vec<Verdict> {
    let traces = rows.iter().filter(|row| row.method == Some(Method::Trace));
    traces.filter_map(|row| Some(verdict(row, point(row)?, rows))).collect()
}

fn verdict(own: &Row, trace: Point, rows: &[Row]) -> Verdict {
    let same = rows.iter().filter(|row| row.setting == own.setting && row.method != Some(Method::Trace));
    let searches: Vec<Point> = same.filter_map(point).collect();
    let least = |values: &mut dyn Iterator<Item = f64>| values.min_by(f64::total_cmp);
    let faster: Vec<Point> =
        searches.iter().copied().filter(|p| p[0] < trace[0] && p[1] > trace[1]).collect();
    let count = |test: &dyn Fn(Point) -> bool| searches.iter().filter(|p| test(**p)).count();
    Verdict {
        setting: own.setting.clone(),
        trace,
        searches: searches.len(),
        dominated: count(&|p| beats(trace, p)),
        better: count(&|p| p[0] <= trace[0] && p[1] <= trace[1]),
        faster: faster.len(),
        faster_error: least(&mut faster.iter().map(|p| p[1] / trace[1])),
        equal_error_time: least(&mut searches.iter().filter(|p| p[1] <= trace[1]).map(|p| p[0] / trace[0])),
    }
}

#[cfg(test)]
mod tests {
    use super::super::errors::{Apart, Distances, Spread};
    use super::*;

    fn row(method: Method, ms: f64, error: f64) -> Row {
        Row {
            setting: Setting { terrain: "t".into(), view: "v", surface: "s".into(), backend: "cpu" },
            method: Some(method),
            program: "terrain",
            lighting: "facing",
            preset: None,
            rewriter: "auto",
            samples: 1,
            ms: [ms; 3],
            distances: Some(Distances {
                disagreements: 0,
                metres: Spread::default(),
                footprints: Spread::default(),
                all: error,
            }),
            apart: Apart { psnr: 0.0, ssim: 0.0, flip: 0.0 },
            front: false,
        }
    }

    #[test]
    fn a_front_has_what_nothing_beats() {
        let mut rows = vec![
            row(Method::Trace, 10.0, 1e-5),
            row(Method::Search(8, 0), 5.0, 1.0),
            row(Method::Search(64, 0), 11.0, 0.5),
            row(Method::Search(64, 8), 6.0, 2.0),
        ];
        mark(&mut rows);
        assert_eq!(rows.iter().map(|row| row.front).collect::<Vec<_>>(), [true, true, false, false]);
        let verdict = &verdicts(&rows)[0];
        assert_eq!((verdict.searches, verdict.dominated, verdict.faster), (3, 1, 2));
        assert!(verdict.dominates() && verdict.equal_error_time.is_none());
    }

    #[test]
    fn a_planted_better_search_is_found() {
        let rows = vec![row(Method::Trace, 10.0, 1e-3), row(Method::Search(8, 8), 9.0, 5e-4)];
        let verdict = &verdicts(&rows)[0];
        assert!(!verdict.dominates());
        assert_eq!((verdict.better, verdict.equal_error_time), (1, Some(0.9)));
    }
}
