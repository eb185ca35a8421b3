//! Time against error, a panel for each terrain, view and surface: curves of the searches by their halvings, `trace`, and the front.

use super::super::charts::lines::{Label, Point, axes, curve, legend, plain, powers, range};
use super::super::charts::{self, Area, COLORS, Drawn};
use super::{Method, Row, Setting};
use plotters::prelude::*;

/// What is exact to the last digit still has a place on a logarithmic axis.
const LEAST: f64 = 1e-7;
const TRACE: RGBColor = RGBColor(0xc0, 0x20, 0x30);

pub struct Panel {
    title: String,
    trace: Point,
    /// Halvings, and the points by their pieces.
    curves: Vec<(u32, Vec<Point>)>,
    front: Vec<Point>,
}

/// Settings with a curve at least.
pub fn panels(rows: &[Row]) -> Vec<Panel> {
    let mut settings: Vec<&Setting> = Vec::new();
    for row in rows.iter().filter(|row| row.distances.is_some()) {
        if !settings.contains(&&row.setting) {
            settings.push(&row.setting);
        }
    }
    settings.into_iter().filter_map(|setting| panel(setting, rows)).collect()
}

fn panel(setting: &Setting, rows: &[Row]) -> Option<Panel> {
    let own: Vec<(&Row, Point)> = rows
        .iter()
        .filter(|row| row.setting == *setting)
        .filter_map(|row| Some((row, (row.ms[0], row.distances.as_ref()?.all.max(LEAST)))))
        .collect();
    let trace = own.iter().find(|(row, _)| row.method == Some(Method::Trace))?.1;
    let mut curves: Vec<(u32, Vec<Point>)> = Vec::new();
    for (row, point) in &own {
        let Some(Method::Search(_, halvings)) = row.method else { continue };
        match curves.iter_mut().find(|(m, _)| *m == halvings) {
            Some((_, points)) => points.push(*point),
            None => curves.push((halvings, vec![*point])),
        }
    }
    let mut front: Vec<Point> = own.iter().filter(|(row, _)| row.front).map(|(_, point)| *point).collect();
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    let Setting { terrain, view, surface, backend } = setting;
    let title = format!("{terrain}, {view}, {surface}, {backend}");
    curves.iter().any(|(_, points)| points.len() > 1).then_some(Panel { title, trace, curves, front })
}

impl charts::Panel for Panel {
    const SIZE: (u32, u32) = (460, 330);
    const COLUMNS: usize = 3;

    fn draw<B: DrawingBackend>(&self, area: &Area<B>) -> Drawn<B> {
        let points = || self.curves.iter().flat_map(|(_, points)| points).chain([&self.trace]);
        // On the right there is room for the legend, which would hide points anywhere else.
        let (left, right) = range(points().map(|p| p.0), 1.3);
        let ranges = ((left, 5.0 * right), range(points().map(|p| p.1), 3.0));
        let labels = (
            &Label { text: "ms a frame", number: plain, base: 2.0 },
            &Label { text: "error, footprints", number: powers, base: 10.0 },
        );
        let mut chart = axes(area, &self.title, labels, ranges)?;
        for ((halvings, points), color) in self.curves.iter().zip(COLORS.into_iter().cycle()) {
            curve(&mut chart, &format!("search(n, {halvings})"), points, color)?;
        }
        chart
            .draw_series([TriangleMarker::new(self.trace, 8, TRACE.filled())])?
            .label("trace")
            .legend(|(x, y)| TriangleMarker::new((x + 8, y), 6, TRACE.filled()));
        // The front as the stairs under which nothing lies, its members ringed.
        let stairs = self.front.windows(2).flat_map(|pair| [pair[0], (pair[1].0, pair[0].1)]);
        let stairs: Vec<Point> = stairs.chain(self.front.last().copied()).collect();
        chart
            .draw_series(LineSeries::new(stairs, BLACK.mix(0.35).stroke_width(1)))?
            .label("front")
            .legend(|(x, y)| Circle::new((x + 8, y), 6, BLACK.stroke_width(1)));
        chart.draw_series(self.front.iter().map(|p| Circle::new(*p, 7, BLACK.stroke_width(1))))?;
        legend(&mut chart, SeriesLabelPosition::UpperRight)
    }
}
