//! The oracle's bicubic: the Catmull-Rom spline as a polynomial of its four samples, along rows, then across them.

use super::Field;

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
        // What is missing beyond the rim or in a hole is as the sample before it, first along columns, then along rows.
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
        (std::array::from_fn(|k| std::array::from_fn(|a| cell(a as i64 - 1, k as i64 - 1))), u, v)
    }
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
