//! Time against error, a panel for each terrain, view and surface: curves of the searches by their halvings, `trace`, and the front.

use super::{Method, Row, Setting};
use ghyll_runtime::image::{Format, Image, encode};
use plotters::coord::Shift;
use plotters::drawing::DrawingAreaErrorKind;
use plotters::prelude::*;
use plotters::style::register_font;

/// What is exact to the last digit still has a place on a logarithmic axis.
const LEAST: f64 = 1e-7;
const COLUMNS: usize = 3;
const PANEL: (u32, u32) = (460, 330);
const COLORS: [RGBColor; 4] = [
    RGBColor(0x1b, 0x6c, 0xa8),
    RGBColor(0xd9, 0x82, 0x1c),
    RGBColor(0x2f, 0x8f, 0x4e),
    RGBColor(0x80, 0x50, 0xa0),
];
const TRACE: RGBColor = RGBColor(0xc0, 0x20, 0x30);
const FONT: &str = "sans-serif";

type Point = (f64, f64);

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

fn size(panels: &[Panel]) -> (u32, u32) {
    let columns = panels.len().min(COLUMNS) as u32;
    (PANEL.0 * columns, PANEL.1 * panels.len().div_ceil(COLUMNS) as u32)
}

pub fn svg(panels: &[Panel]) -> Result<String, String> {
    let mut text = String::new();
    draw(SVGBackend::with_string(&mut text, size(panels)).into_drawing_area(), panels)?;
    Ok(text)
}

pub fn png(panels: &[Panel]) -> Result<Vec<u8>, String> {
    let (width, height) = size(panels);
    let mut bytes = vec![0; 3 * (width * height) as usize];
    draw(BitMapBackend::with_buffer(&mut bytes, (width, height)).into_drawing_area(), panels)?;
    let data = bytes.iter().map(|byte| f32::from(*byte) / 255.0).collect();
    let image = Image::new(width, height, 3, data).map_err(|e| e.to_string())?;
    encode(&image, Format::Png).map_err(|e| e.to_string())
}

fn draw<B: DrawingBackend>(root: DrawingArea<B, Shift>, panels: &[Panel]) -> Result<(), String> {
    register_font(FONT, FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT)
        .map_err(|_| "the plot's font cannot be read".to_string())?;
    root.fill(&WHITE).map_err(|e| e.to_string())?;
    let rows = panels.len().div_ceil(COLUMNS);
    for (area, panel) in root.split_evenly((rows, panels.len().min(COLUMNS))).iter().zip(panels) {
        draw_panel(area, panel).map_err(|e| e.to_string())?;
    }
    root.present().map_err(|e| e.to_string())
}

fn draw_panel<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    panel: &Panel,
) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
    let points = || panel.curves.iter().flat_map(|(_, points)| points).chain([&panel.trace]);
    let range = |pick: fn(&Point) -> f64, room: f64| {
        let (low, high) = points().map(pick).fold((f64::MAX, 0.0f64), |(lo, hi), x| (lo.min(x), hi.max(x)));
        (low.max(1e-9) / room, high.max(2e-9) * room)
    };
    let ((left, right), (low, high)) = (range(|p| p.0, 1.3), range(|p| p.1, 3.0));
    let mut chart = ChartBuilder::on(area)
        .caption(&panel.title, (FONT, 16))
        .margin(10)
        .x_label_area_size(36)
        .y_label_area_size(60)
        .build_cartesian_2d((left..right).log_scale(), (low..high).log_scale())?;
    chart
        .configure_mesh()
        .x_desc("ms a frame")
        .y_desc("error, footprints")
        .label_style((FONT, 12))
        .x_labels(5)
        .y_labels(8)
        .x_label_formatter(&|x: &f64| if *x < 10.0 { format!("{x:.1}") } else { format!("{x:.0}") })
        .y_label_formatter(&|y: &f64| format!("{y:.0e}"))
        .light_line_style(TRANSPARENT)
        .draw()?;
    for ((halvings, points), color) in panel.curves.iter().zip(COLORS.into_iter().cycle()) {
        let line = LineSeries::new(points.iter().copied(), color.stroke_width(2));
        chart
            .draw_series(line)?
            .label(format!("search(n, {halvings})"))
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], color.stroke_width(2)));
        chart.draw_series(points.iter().map(|p| Circle::new(*p, 3, color.filled())))?;
    }
    chart
        .draw_series([TriangleMarker::new(panel.trace, 8, TRACE.filled())])?
        .label("trace")
        .legend(|(x, y)| TriangleMarker::new((x + 8, y), 6, TRACE.filled()));
    // The front as the stairs under which nothing lies, its members ringed.
    let stairs = panel.front.windows(2).flat_map(|pair| [pair[0], (pair[1].0, pair[0].1)]);
    let stairs: Vec<Point> = stairs.chain(panel.front.last().copied()).collect();
    chart
        .draw_series(LineSeries::new(stairs, BLACK.mix(0.35).stroke_width(1)))?
        .label("front")
        .legend(|(x, y)| Circle::new((x + 8, y), 6, BLACK.stroke_width(1)));
    chart.draw_series(panel.front.iter().map(|p| Circle::new(*p, 7, BLACK.stroke_width(1))))?;
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerLeft)
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK.mix(0.3))
        .label_font((FONT, 12))
        .draw()
}
