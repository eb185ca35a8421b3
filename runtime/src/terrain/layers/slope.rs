//! Slopes of data layers: exact derivatives of what is read between the texels, 0 along an axis where the position is
//! beyond the outermost texels' centres. On a column or row of texels the cell to the east and south counts, at the last
//! one that inside.
//!
//! Twin of `shaders/terrain/rasters_slope.wgsl` and `raster_slope.wgsl`.

use super::Layer;

/// Cell and place in it along one axis.
struct Place<T> {
    first: u32,
    within: T,
    inside: bool,
}

impl Layer {
    /// Index of the last column (axis 0) or row (axis 1).
    fn last(&self, axis: usize) -> u32 {
        [self.raster.width, self.raster.height][axis] - 1
    }

    fn place_f32(&self, x: f32, axis: usize) -> Place<f32> {
        let last = self.last(axis);
        let at = self.unbounded_f32(x, axis);
        let grid = at.max(0.0).min(last as f32);
        let first = (grid as u32).min(last.max(1) - 1);
        Place { first, within: grid - first as f32, inside: at >= 0.0 && at <= last as f32 }
    }

    /// Slopes of the components by x, then by y.
    pub(super) fn gradient_f32(&self, x: f32, y: f32, out: &mut [u32]) {
        let (px, py) = (self.place_f32(x, 0), self.place_f32(y, 1));
        let scale = |axis: usize, inside: bool| if inside { self.scale[axis] as f32 } else { 0.0 };
        let (sx, sy) = (scale(0, px.inside), scale(1, py.inside));
        let (u, v, n) = (px.within, py.within, self.raster.components);
        for c in 0..n {
            let [nw, ne, sw, se] = self.raster.around(px.first, py.first, c);
            let east = ((ne - nw) * (1.0 - v) + (se - sw) * v) * sx;
            let north = ((sw - nw) * (1.0 - u) + (se - ne) * u) * sy;
            out[c as usize] = east.to_bits();
            out[(n + c) as usize] = north.to_bits();
        }
    }

    /// Second derivatives of the components by x and y.
    pub(super) fn twist_f32(&self, x: f32, y: f32, out: &mut [u32]) {
        let (px, py) = (self.place_f32(x, 0), self.place_f32(y, 1));
        let scale = |axis: usize, inside: bool| if inside { self.scale[axis] as f32 } else { 0.0 };
        let (sx, sy) = (scale(0, px.inside), scale(1, py.inside));
        for (c, word) in (0..self.raster.components).zip(out) {
            let [nw, ne, sw, se] = self.raster.around(px.first, py.first, c);
            *word = (((se - sw) - (ne - nw)) * sx * sy).to_bits();
        }
    }

    fn place_f64(&self, x: f64, axis: usize) -> Place<f64> {
        let last = self.last(axis);
        let at = x * self.scale[axis] + self.shift[axis];
        let inside = (0.0..=f64::from(last)).contains(&at);
        let first = at.floor().clamp(0.0, f64::from(last.saturating_sub(1)));
        Place { first: first as u32, within: at.clamp(0.0, f64::from(last)) - first, inside }
    }

    /// The same in double precision, as differences of the texels weighted along the other axis.
    pub(super) fn gradient_f64(&self, x: f64, y: f64, out: &mut [f64]) {
        let places = [self.place_f64(x, 0), self.place_f64(y, 1)];
        let n = self.raster.components as usize;
        for c in 0..n {
            let [nw, ne, sw, se] =
                self.raster.around(places[0].first, places[1].first, c as u32).map(f64::from);
            for (axis, [a, b, c0, d]) in [[nw, ne, sw, se], [nw, sw, ne, se]].into_iter().enumerate() {
                let Place { inside, .. } = places[axis];
                let across = places[1 - axis].within;
                let slope = (b - a) + across * ((d - c0) - (b - a));
                out[axis * n + c] = if inside { slope * self.scale[axis] } else { 0.0 };
            }
        }
    }

    pub(super) fn twist_f64(&self, x: f64, y: f64, out: &mut [f64]) {
        let places = [self.place_f64(x, 0), self.place_f64(y, 1)];
        for (c, value) in (0..self.raster.components).zip(out) {
            let [nw, ne, sw, se] = self.raster.around(places[0].first, places[1].first, c).map(f64::from);
            let inside = places.iter().all(|p| p.inside);
            *value = if inside { (nw - ne - sw + se) * self.scale[0] * self.scale[1] } else { 0.0 };
        }
    }
}
