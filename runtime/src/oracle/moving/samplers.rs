//! The height field's own surfaces over a piece of a ray. Within one cell a surface is a polynomial, which is found from its values
//! and bounded by its Bézier coefficients; over several cells it is bounded by their samples.

use ghyll_compiler::builtins::Builtin;
use ghyll_compiler::core::Intrinsic;

use super::span::Span;
use super::{Range, Result};
use crate::error::RunError;
use crate::oracle::datum::Datum;
use crate::oracle::evaluator::Evaluator;
use crate::oracle::terrain::ask;

/// Cells of a box that are looked at together.
const MOST_CELLS: u32 = 1024;
/// A Catmull-Rom spline's weights of four samples sum up to this, positive and negative ones together.
const OVERSHOOT: f64 = 1.25;
/// Those of the three steps between them that make its slope.
const STEEPER: f64 = 1.5;

/// Values of a patch at thirds of its cell, rows from the south.
pub type Patch = [[f64; 4]; 4];

/// A surface of the field, with the parts along a cell's side of the approximated bicubic.
#[derive(Clone, Copy, PartialEq)]
pub enum Kind {
    Plain(Builtin),
    Subdivided(f64),
}

pub fn sample<'m>(oracle: &mut Evaluator<'m>, kind: Kind, p: &[Range]) -> Result<Range> {
    let [x, y] = p else { return Err(RunError::Internal("a position has two components".into())) };
    let (size, texel) = (ask(oracle, Intrinsic::Extent, &[])?, ask(oracle, Intrinsic::Texel, &[])?);
    let at = [x.clamp(0.0, size[0]), y.clamp(0.0, size[1])];
    let grid = [0, 1].map(|k| at[k].scale(1.0 / texel[k]));
    let last = [0, 1].map(|k| (size[k] / texel[k]).round().max(1.0) as u32 - 1);
    if kind == Kind::Plain(Builtin::Nearest) {
        for g in grid {
            g.add(Range::still(0.5)).step(f64::floor)?;
        }
        let middle = at.map(|r| 0.5 * (r.value.lo + r.value.hi));
        return Ok(Range::still(ask(oracle, Intrinsic::Nearest, &[Datum::vec(&middle)])?[0]));
    }
    let cell = |g: f64, k: usize| (g.floor().max(0.0) as u32).min(last[k]);
    let first = [0, 1].map(|k| cell(grid[k].value.lo, k));
    let end = [0, 1].map(|k| cell(grid[k].value.hi, k));
    let middle =
        |i: u32, j: u32| Datum::vec(&[(f64::from(i) + 0.5) * texel[0], (f64::from(j) + 0.5) * texel[1]]);
    if first == end {
        let local = [0, 1].map(|k| grid[k].sub(Range::still(f64::from(first[k]))));
        if ask(oracle, Intrinsic::Hole, &[middle(first[0], first[1])])?[0] != 0.0 {
            // A hole is level.
            return Ok(Range::still(ask(oracle, Intrinsic::Bilinear, &[middle(first[0], first[1])])?[0]));
        }
        return within(oracle, kind, (first, texel), local);
    }
    let count = (end[0] - first[0] + 1).saturating_mul(end[1] - first[1] + 1);
    if count > MOST_CELLS {
        return Err(RunError::Undecided);
    }
    for (i, j) in (first[0]..=end[0]).flat_map(|i| (first[1]..=end[1]).map(move |j| (i, j))) {
        // The surface jumps at the rim of a hole.
        if ask(oracle, Intrinsic::Hole, &[middle(i, j)])?[0] != 0.0 {
            return Err(RunError::Undecided);
        }
    }
    let smooth = !matches!(kind, Kind::Plain(Builtin::Bilinear | Builtin::Triangulated));
    let room = if smooth { 1.0 } else { 0.0 };
    let corner = |k: usize, side: f64| (if side < 0.0 { first[k] } else { end[k] }, side);
    let ends = [corner(0, -1.0), corner(1, -1.0), corner(0, 1.0), corner(1, 1.0)];
    let place = |(at, (cell, side)): (usize, &(u32, f64))| {
        let middle = (f64::from(*cell) + 0.5 + side * room) * texel[at % 2];
        Datum::F32(middle.clamp(0.0, size[at % 2]))
    };
    let bounds: Vec<Datum<'m>> = ends.iter().enumerate().map(place).collect();
    let mut value = Span {
        lo: ask(oracle, Intrinsic::Lowest, &bounds)?[0],
        hi: ask(oracle, Intrinsic::Highest, &bounds)?[0],
    };
    let steps = ask(oracle, Intrinsic::Inclines, &bounds)?;
    let mut steep = [Span { lo: steps[0], hi: steps[1] }, Span { lo: steps[2], hi: steps[3] }];
    if smooth {
        value = swollen(value, OVERSHOOT * OVERSHOOT);
        // Beyond the rim and beside holes a sample is repeated: a step of nothing.
        steep = steep.map(|s| swollen(s.hull(Span::point(0.0)), STEEPER * OVERSHOOT));
    }
    let slope = steep[0].mul(at[0].slope).add(steep[1].mul(at[1].slope));
    Ok(Range { value, slope })
}

/// The same middle, so many times as wide.
fn swollen(s: Span, by: f64) -> Span {
    let (middle, half) = (0.5 * (s.lo + s.hi), 0.5 * (s.hi - s.lo));
    Span { lo: middle - by * half, hi: middle + by * half }.add(Span { lo: -1e-300, hi: 1e-300 })
}

/// Within one cell, at local positions.
fn within<'m>(
    oracle: &mut Evaluator<'m>,
    kind: Kind,
    (cell, texel): ([u32; 2], Vec<f64>),
    local: [Range; 2],
) -> Result<Range> {
    let [u, v] = local.map(|r| Span { lo: r.value.lo.clamp(0.0, 1.0), hi: r.value.hi.clamp(0.0, 1.0) });
    // Sides are looked at from within: on the line itself the next cell counts, and that may be a hole.
    let inside = |k: usize, t: f64| {
        let shift = if t >= 1.0 { -1e-14 } else { 1e-14 };
        (f64::from(cell[k]) + t) * (1.0 + shift) * texel[k]
    };
    let at = |a: f64, b: f64| [inside(0, a), inside(1, b)];
    let moved = |[east, north]: [Span; 2]| east.mul(local[0].slope).add(north.mul(local[1].slope));
    match kind {
        Kind::Plain(Builtin::Triangulated) => {
            let corner = |oracle: &Evaluator<'m>, a, b| height(oracle, kind, at(a, b));
            let (sw, se) = (corner(oracle, 0.0, 0.0)?, corner(oracle, 1.0, 0.0)?);
            let (nw, ne) = (corner(oracle, 0.0, 1.0)?, corner(oracle, 1.0, 1.0)?);
            let plane = |east: f64, north: f64| {
                let value = Span::point(sw).add(u.mul(Span::point(east))).add(v.mul(Span::point(north)));
                Range { value, slope: moved([Span::point(east), Span::point(north)]) }
            };
            let (south_east, north_west) = (plane(se - sw, ne - se), plane(ne - nw, nw - sw));
            Ok(if u.lo >= v.hi {
                south_east
            } else if u.hi <= v.lo {
                north_west
            } else {
                let slope = south_east.slope.hull(north_west.slope);
                Range { value: south_east.value.hull(north_west.value), slope }
            })
        }
        Kind::Plain(Builtin::Bilinear) => bilinear_parts(oracle, kind, 1.0, (u, v), &at, &moved),
        Kind::Subdivided(n) => bilinear_parts(oracle, kind, n, (u, v), &at, &moved),
        Kind::Plain(Builtin::Bicubic) => {
            let key = (cell[0], cell[1]);
            let patch = match oracle.patches.get(&key) {
                Some(patch) => *patch,
                None => {
                    let mut values = [[0.0; 4]; 4];
                    for (r, row) in values.iter_mut().enumerate() {
                        for (c, z) in row.iter_mut().enumerate() {
                            *z = height(oracle, kind, at(c as f64 / 3.0, r as f64 / 3.0))?;
                        }
                    }
                    let patch = transposed(transposed(values.map(bezier)).map(bezier));
                    oracle.patches.insert(key, patch);
                    patch
                }
            };
            let largest = patch.iter().flatten().fold(0.0f64, |m, z| m.max(z.abs()));
            let slack = Span { lo: -1e-13 * largest, hi: 1e-13 * largest };
            let hull = |rows: &[Vec<f64>]| {
                let all =
                    rows.iter().flatten().fold((f64::MAX, f64::MIN), |(lo, hi), z| (lo.min(*z), hi.max(*z)));
                Span { lo: all.0, hi: all.1 }.add(slack)
            };
            let along = |rows: Vec<Vec<f64>>, part: Span| {
                rows.iter().map(|row| parted(row, part)).collect::<Vec<_>>()
            };
            let columns = |rows: &[Vec<f64>]| {
                (0..rows[0].len()).map(|c| rows.iter().map(|row| row[c]).collect()).collect::<Vec<Vec<f64>>>()
            };
            let rows: Vec<Vec<f64>> = patch.iter().map(|row| row.to_vec()).collect();
            let steps = |rows: &[Vec<f64>]| rows.iter().map(|row| slopes(row)).collect::<Vec<_>>();
            let value = hull(&along(columns(&along(rows.clone(), u)), v));
            let east = hull(&along(columns(&along(steps(&rows), u)), v));
            let north = hull(&along(columns(&along(steps(&columns(&rows)), v)), u));
            Ok(Range { value, slope: moved([east, north]) })
        }
        Kind::Plain(other) => Err(RunError::Unsupported(format!("ranges of `{}`", other.name()))),
    }
}

fn height<'m>(oracle: &Evaluator<'m>, kind: Kind, p: [f64; 2]) -> Result<f64> {
    let p = Datum::vec(&p);
    let found = match kind {
        Kind::Plain(Builtin::Triangulated) => ask(oracle, Intrinsic::Triangulated, &[p])?,
        Kind::Plain(Builtin::Bilinear) => ask(oracle, Intrinsic::Bilinear, &[p])?,
        Kind::Plain(_) => ask(oracle, Intrinsic::Bicubic, &[p])?,
        Kind::Subdivided(n) => ask(oracle, Intrinsic::Subdivided, &[p, Datum::F32(n)])?,
    };
    Ok(found[0])
}

/// Bilinear between the points of a split into n x n parts: every part that is touched.
fn bilinear_parts<'m>(
    oracle: &Evaluator<'m>,
    kind: Kind,
    n: f64,
    (u, v): (Span, Span),
    at: &dyn Fn(f64, f64) -> [f64; 2],
    moved: &dyn Fn([Span; 2]) -> Span,
) -> Result<Range> {
    let part = |x: f64| (x * n).floor().clamp(0.0, n - 1.0) as u32;
    let mut all: Option<Range> = None;
    for (i, j) in (part(u.lo)..=part(u.hi)).flat_map(|i| (part(v.lo)..=part(v.hi)).map(move |j| (i, j))) {
        let (i, j) = (f64::from(i), f64::from(j));
        let corner = |a: f64, b: f64| height(oracle, kind, at((i + a) / n, (j + b) / n));
        let (sw, se, nw, ne) = (corner(0.0, 0.0)?, corner(1.0, 0.0)?, corner(0.0, 1.0)?, corner(1.0, 1.0)?);
        let inner = |s: Span, first: f64| Span {
            lo: (s.lo * n - first).clamp(0.0, 1.0),
            hi: (s.hi * n - first).clamp(0.0, 1.0),
        };
        let (a, b) = (inner(u, i), inner(v, j));
        // A bilinear patch has its extremes at corners, its slopes theirs at ends.
        let z = |a: f64, b: f64| (1.0 - b) * ((1.0 - a) * sw + a * se) + b * ((1.0 - a) * nw + a * ne);
        let ends = [z(a.lo, b.lo), z(a.hi, b.lo), z(a.lo, b.hi), z(a.hi, b.hi)];
        let slack = 4.0 * f64::EPSILON * ends.iter().fold(0.0f64, |m, z| m.max(z.abs()));
        let value = Span {
            lo: ends.into_iter().fold(f64::MAX, f64::min) - slack,
            hi: ends.into_iter().fold(f64::MIN, f64::max) + slack,
        };
        let between = |x: f64, y: f64, s: Span| {
            let at = |t: f64| n * ((1.0 - t) * x + t * y);
            Span::between(at(s.lo), at(s.hi)).add(Span { lo: -n * slack, hi: n * slack })
        };
        let slope = moved([between(se - sw, ne - nw, b), between(nw - sw, ne - se, a)]);
        all = Some(match all {
            None => Range { value, slope },
            Some(all) => Range { value: all.value.hull(value), slope: all.slope.hull(slope) },
        });
    }
    all.ok_or_else(|| RunError::Internal("a range touches no cell".into()))
}

/// Coefficients of the cubic with these values at 0, 1/3, 2/3 and 1.
fn bezier([a, b, c, d]: [f64; 4]) -> [f64; 4] {
    [a, (-5.0 * a + 18.0 * b - 9.0 * c + 2.0 * d) / 6.0, (2.0 * a - 9.0 * b + 18.0 * c - 5.0 * d) / 6.0, d]
}

fn transposed(m: Patch) -> Patch {
    std::array::from_fn(|r| std::array::from_fn(|c| m[c][r]))
}

/// Coefficients of the derivative.
fn slopes(row: &[f64]) -> Vec<f64> {
    row.windows(2).map(|w| 3.0 * (w[1] - w[0])).collect()
}

/// Coefficients of the same polynomial over a part of [0, 1], by its blossom.
fn parted(row: &[f64], part: Span) -> Vec<f64> {
    let degree = row.len() - 1;
    let blossom = |ends: usize| {
        let mut points = row.to_vec();
        for level in 0..degree {
            let t = if level < ends { part.hi } else { part.lo };
            for k in 0..degree - level {
                points[k] = (1.0 - t) * points[k] + t * points[k + 1];
            }
        }
        points[0]
    };
    (0..=degree).map(blossom).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_lies_within_its_coefficients() {
        let f = |t: f64| 2.0 - 3.0 * t + 7.0 * t * t - 5.0 * t * t * t;
        let row = bezier([f(0.0), f(1.0 / 3.0), f(2.0 / 3.0), f(1.0)]);
        let part = Span { lo: 0.25, hi: 0.4 };
        let coefficients = parted(&row, part);
        assert!((coefficients[0] - f(0.25)).abs() < 1e-12 && (coefficients[3] - f(0.4)).abs() < 1e-12);
        let steep = parted(&slopes(&row), part);
        let d = |t: f64| -3.0 + 14.0 * t - 15.0 * t * t;
        assert!((steep[0] - d(0.25)).abs() < 1e-12 && (steep[2] - d(0.4)).abs() < 1e-12);
    }
}
