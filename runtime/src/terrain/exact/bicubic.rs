//! The oracle's bicubic: the Catmull-Rom spline as a polynomial of its four samples, along rows, then across them.

use super::{Corners, Field, meet_bilinear};

impl Field<'_> {
    /// The bicubic surface's derivative of order (i, j) by x and y; order (0, 0) is the height.
    pub fn bicubic(&self, x: f64, y: f64, order: [u32; 2]) -> f64 {
        let (rows, u, v) = self.neighbours(x, y);
        let value = spline(rows.map(|row| spline(row, u, order[0])), v, order[1]);
        value * self.unit(x, y, order)
    }

    /// The same of the surface that is bicubic at the points of an n x n split of the cell and bilinear between.
    pub fn subdivided(&self, x: f64, y: f64, n: f64, order: [u32; 2]) -> f64 {
        if order[0] > 1 || order[1] > 1 {
            return 0.0;
        }
        let (rows, u, v) = self.neighbours(x, y);
        let at = |u: f64, v: f64| spline(rows.map(|row| spline(row, u, 0)), v, 0);
        let part = |t: f64| (t * n).floor().min(n - 1.0);
        let (i, j) = (part(u), part(v));
        let line =
            |a: f64, b: f64, t: f64, order: u32| if order == 0 { a + t * (b - a) } else { (b - a) * n };
        let row = |j: f64| line(at(i / n, j / n), at((i + 1.0) / n, j / n), u * n - i, order[0]);
        line(row(j), row(j + 1.0), v * n - j, order[1]) * self.unit(x, y, order)
    }

    /// Cells a metre to the powers of the orders; 0 for a derivative along an axis beyond whose rim the position is.
    fn unit(&self, x: f64, y: f64, order: [u32; 2]) -> f64 {
        let inside = self.inside(x, y);
        let along = |axis: usize| match order[axis] {
            0 => 1.0,
            n => inside[axis] / self.spacing[axis].powi(n as i32),
        };
        along(0) * along(1)
    }

    /// The 4 x 4 samples around the cell under a position, and the position in it.
    fn neighbours(&self, x: f64, y: f64) -> ([[f64; 4]; 4], f64, f64) {
        let [nx, ny] = self.cells();
        let (gx, gy) = ((x / self.spacing[0]).max(0.0).min(nx), (y / self.spacing[1]).max(0.0).min(ny));
        let (i, j) = self.cell(gx, gy);
        let (u, v) = (gx - f64::from(i), gy - f64::from(j));
        if self.corners(i, j).is_none() {
            return ([[self.at_rim(gx, gy); 4]; 4], u, v);
        }
        (self.around(i, j), u, v)
    }

    /// The 4 x 4 samples around a cell, rows from south to north. What is missing beyond the rim or in a hole is as the sample before
    /// it, first along columns, then along rows.
    pub(super) fn around(&self, i: u32, j: u32) -> [[f64; 4]; 4] {
        let known = |c: i64, r: i64| {
            let at = u32::try_from(c).ok().zip(u32::try_from(r).ok());
            at.and_then(|(c, r)| self.sample(c, r))
        };
        let inner = |k: i64| k.clamp(0, 1);
        let column = |c: i64, k: i64| {
            let (far, near) = (i64::from(j) + k, i64::from(j) + inner(k));
            known(c, far).or_else(|| known(c, near))
        };
        let cell = |a: i64, k: i64| {
            let (far, near) = (i64::from(i) + a, i64::from(i) + inner(a));
            column(far, k).or_else(|| column(near, k)).unwrap_or(self.low)
        };
        std::array::from_fn(|k| std::array::from_fn(|a| cell(a as i64 - 1, k as i64 - 1)))
    }
}

/// No point of the patch is higher: the spline's weights below 0 add up to at most 1/8 along an axis, so those of both axes to
/// 9/32, halfway. What rounding adds is far less than the thousandth.
pub(super) fn summit(around: &[[f64; 4]; 4]) -> f64 {
    let all = around.as_flattened();
    let (low, high) = all.iter().fold((f64::MAX, f64::MIN), |(low, high), z| (low.min(*z), high.max(*z)));
    high + 0.282 * (high - low)
}

/// First share in [0, 1] of the way where z is on or under the bicubic patch: between the places where the height over it turns,
/// which are those of its derivative.
pub(super) fn meet_bicubic(rows: [[f64; 4]; 4], u: [f64; 2], v: [f64; 2], z: [f64; 2]) -> Option<f64> {
    let base = rows[1][1];
    let rows = rows.map(|row| row.map(|z| z - base));
    // A ray that falls without end is cut where it is under all of the patch.
    let all = rows.as_flattened();
    let (low, high) = all.iter().fold((f64::MAX, f64::MIN), |(low, high), z| (low.min(*z), high.max(*z)));
    let under = low - (high - low) - 1.0;
    if z[0] - base <= under {
        return Some(0.0);
    }
    if z[1] - base < under {
        let cut = (z[0] - base - under) / (z[0] - z[1]);
        let upto = |ends: [f64; 2]| [ends[0], ends[0] + cut * (ends[1] - ends[0])];
        let shorter = [z[0] - base, under];
        return meet_bicubic(rows, upto(u), upto(v), shorter).map(|share| cut * share);
    }
    let line = |ends: [f64; 2]| vec![ends[0], ends[1] - ends[0]];
    let cubic = |of: [&Vec<f64>; 4], at: &Vec<f64>| {
        let weight = |parts: [f64; 4]| {
            of.iter()
                .zip(parts)
                .fold(vec![0.0], |sum, (p, part)| add(&sum, &p.iter().map(|c| c * part).collect::<Vec<_>>()))
        };
        let powers = [
            weight([0.0, 1.0, 0.0, 0.0]),
            weight([-0.5, 0.0, 0.5, 0.0]),
            weight([1.0, -2.5, 2.0, -0.5]),
            weight([-0.5, 1.5, -1.5, 0.5]),
        ];
        powers.iter().rev().fold(vec![0.0], |sum, p| add(&times(&sum, at), p))
    };
    let along = rows.map(|row| {
        let constant = row.map(|z| vec![z]);
        cubic([&constant[0], &constant[1], &constant[2], &constant[3]], &line(u))
    });
    let surface = cubic([&along[0], &along[1], &along[2], &along[3]], &line(v));
    let over = add(&line(z.map(|z| z - base)), &surface.iter().map(|c| -c).collect::<Vec<_>>());
    if value(&over, 0.0) <= 0.0 {
        return Some(0.0);
    }
    let stops = turns(&over);
    stops.windows(2).find(|pair| value(&over, pair[1]) <= 0.0).map(|pair| bisected(&over, pair[0], pair[1]))
}

/// The same of the surface that is bicubic at the points of an n x n split of the cell and bilinear between.
pub(super) fn meet_subdivided(
    rows: [[f64; 4]; 4],
    n: f64,
    u: [f64; 2],
    v: [f64; 2],
    z: [f64; 2],
) -> Option<f64> {
    let mut cuts = vec![0.0, 1.0];
    for [a, b] in [u, v] {
        let planes = (0..=n as u32).map(|k| (f64::from(k) / n - a) / (b - a));
        cuts.extend(planes.filter(|share| *share > 0.0 && *share < 1.0));
    }
    cuts.sort_by(f64::total_cmp);
    let between = |ends: [f64; 2], share: f64| ends[0] + share * (ends[1] - ends[0]);
    cuts.windows(2).find_map(|pair| {
        let middle = 0.5 * (pair[0] + pair[1]);
        let part = |ends: [f64; 2]| (between(ends, middle) * n).floor().clamp(0.0, n - 1.0);
        let (i, j) = (part(u), part(v));
        let at = |i: f64, j: f64| spline(rows.map(|row| spline(row, i / n, 0)), j / n, 0);
        let corners =
            Corners { sw: at(i, j), se: at(i + 1.0, j), nw: at(i, j + 1.0), ne: at(i + 1.0, j + 1.0) };
        let within = |ends: [f64; 2], k: f64| [0, 1].map(|end: usize| between(ends, pair[end]) * n - k);
        let heights = [0, 1].map(|end: usize| between(z, pair[end]));
        let share = meet_bilinear(&corners, within(u, i), within(v, j), heights)?;
        Some(pair[0] + share * (pair[1] - pair[0]))
    })
}

fn value(p: &[f64], x: f64) -> f64 {
    p.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

fn add(a: &[f64], b: &[f64]) -> Vec<f64> {
    let at = |p: &[f64], k: usize| p.get(k).copied().unwrap_or(0.0);
    (0..a.len().max(b.len())).map(|k| at(a, k) + at(b, k)).collect()
}

fn times(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            product[i + j] += x * y;
        }
    }
    product
}

/// 0, 1 and the places between where the polynomial turns: it is monotone from one to the next.
fn turns(p: &[f64]) -> Vec<f64> {
    if p.len() <= 2 {
        return vec![0.0, 1.0];
    }
    let slope: Vec<f64> = p.iter().enumerate().skip(1).map(|(k, c)| k as f64 * c).collect();
    let inner = turns(&slope);
    let crossings =
        inner.windows(2).filter(|pair| (value(&slope, pair[0]) > 0.0) != (value(&slope, pair[1]) > 0.0));
    let mut stops = vec![0.0];
    stops.extend(crossings.map(|pair| bisected(&slope, pair[0], pair[1])));
    stops.push(1.0);
    stops
}

/// Where the sign changes between two places.
fn bisected(p: &[f64], a: f64, b: f64) -> f64 {
    let positive = value(p, a) > 0.0;
    let (mut a, mut b) = (a, b);
    for _ in 0..60 {
        let middle = 0.5 * (a + b);
        if (value(p, middle) > 0.0) == positive { a = middle } else { b = middle }
    }
    b
}

/// The spline through samples at -1, 0, 1 and 2, or its derivative of an order, at t.
fn spline([a, b, c, d]: [f64; 4], t: f64, order: u32) -> f64 {
    let cubic = [b, 0.5 * (c - a), a - 2.5 * b + 2.0 * c - 0.5 * d, 0.5 * (d - a) + 1.5 * (b - c)];
    match order {
        0 => ((cubic[3] * t + cubic[2]) * t + cubic[1]) * t + cubic[0],
        1 => (3.0 * cubic[3] * t + 2.0 * cubic[2]) * t + cubic[1],
        2 => 6.0 * cubic[3] * t + 2.0 * cubic[2],
        3 => 6.0 * cubic[3],
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn height(rows: &[[f64; 4]; 4], u: f64, v: f64) -> f64 {
        spline(rows.map(|row| spline(row, u, 0)), v, 0)
    }

    #[test]
    fn the_summit_is_above_the_patch_and_no_higher_than_it_must_be() {
        // High where halfway along both axes the weight is above 0.
        let inner = |k: usize| k == 1 || k == 2;
        let worst =
            std::array::from_fn(|j| std::array::from_fn(|i| f64::from(u8::from(inner(i) == inner(j)))));
        assert_eq!(height(&worst, 0.5, 0.5), 1.28125);
        assert_eq!(summit(&worst), 1.282);
        let mut state = 7u64;
        for _ in 0..2000 {
            let rows = std::array::from_fn(|_| {
                std::array::from_fn(|_| {
                    state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                    f64::from((state >> 33) as u32 & 7)
                })
            });
            let top = summit(&rows);
            let grid =
                (0..=16).flat_map(|i| (0..=16).map(move |j| (f64::from(i) / 16.0, f64::from(j) / 16.0)));
            for (u, v) in grid {
                assert!(height(&rows, u, v) <= top, "{rows:?} at {u}, {v}");
            }
        }
    }
}
