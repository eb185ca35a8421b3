//! Curves over two logarithmic axes.

use super::{Area, COLORS, Drawn, FONT, Panel};
use plotters::coord::combinators::LogCoord;
use plotters::prelude::*;

pub type Point = (f64, f64);
pub type Axis = LogCoord<f64>;
pub type Chart<'a, B> = ChartContext<'a, B, Cartesian2d<Axis, Axis>>;

/// What stands at an axis, and how its numbers are written.
pub struct Label {
    pub text: &'static str,
    pub number: fn(f64) -> String,
    /// Of the logarithm: numbers are written at its powers.
    pub base: f64,
}

pub fn plain(x: f64) -> String {
    if x < 10.0 { format!("{x:.1}") } else { format!("{x:.0}") }
}

pub fn whole(x: f64) -> String {
    format!("{x:.0}")
}

pub fn powers(x: f64) -> String {
    format!("{x:.0e}")
}

/// Least and greatest with room around them, in powers.
pub fn range(values: impl Iterator<Item = f64>, room: f64) -> (f64, f64) {
    let (low, high) = values.fold((f64::MAX, 0.0f64), |(lo, hi), x| (lo.min(x), hi.max(x)));
    (low.max(1e-9) / room, high.max(2e-9) * room)
}

/// An empty diagram.
pub fn axes<'a, B: DrawingBackend>(
    area: &Area<B>,
    title: &str,
    (x, y): (&Label, &Label),
    ((left, right), (low, high)): (Point, Point),
) -> Result<Chart<'a, B>, DrawingAreaErrorKind<B::ErrorType>> {
    let mut chart = ChartBuilder::on(area)
        .caption(title, (FONT, 16))
        .margin(10)
        .x_label_area_size(36)
        .y_label_area_size(60)
        .build_cartesian_2d((left..right).log_scale().base(x.base), (low..high).log_scale().base(y.base))?;
    chart
        .configure_mesh()
        .x_desc(x.text)
        .y_desc(y.text)
        .label_style((FONT, 12))
        .x_labels(5)
        .y_labels(8)
        .x_label_formatter(&|v: &f64| (x.number)(*v))
        .y_label_formatter(&|v: &f64| (y.number)(*v))
        .light_line_style(TRANSPARENT)
        .draw()?;
    Ok(chart)
}

/// A curve through marked points, named in the legend.
pub fn curve<B: DrawingBackend>(
    chart: &mut Chart<B>,
    name: &str,
    points: &[Point],
    color: RGBColor,
) -> Drawn<B> {
    chart
        .draw_series(LineSeries::new(points.iter().copied(), color.stroke_width(2)))?
        .label(name)
        .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], color.stroke_width(2)));
    chart.draw_series(points.iter().map(|p| Circle::new(*p, 3, color.filled())))?;
    Ok(())
}

pub fn legend<'a, B: DrawingBackend + 'a>(
    chart: &mut Chart<'a, B>,
    position: SeriesLabelPosition,
) -> Drawn<B> {
    chart
        .configure_series_labels()
        .position(position)
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK.mix(0.3))
        .label_font((FONT, 12))
        .draw()
}

/// Curves alone.
pub struct Lines {
    pub title: String,
    pub x: Label,
    pub y: Label,
    pub curves: Vec<(String, Vec<Point>)>,
}

impl Panel for Lines {
    const SIZE: (u32, u32) = (460, 330);
    const COLUMNS: usize = 2;

    fn draw<B: DrawingBackend>(&self, area: &Area<B>) -> Drawn<B> {
        let points = || self.curves.iter().flat_map(|(_, points)| points);
        let ranges = (range(points().map(|p| p.0), 1.2), range(points().map(|p| p.1), 1.5));
        let mut chart = axes(area, &self.title, (&self.x, &self.y), ranges)?;
        for ((name, points), color) in self.curves.iter().zip(COLORS.into_iter().cycle()) {
            curve(&mut chart, name, points, color)?;
        }
        legend(&mut chart, SeriesLabelPosition::UpperRight)
    }
}
