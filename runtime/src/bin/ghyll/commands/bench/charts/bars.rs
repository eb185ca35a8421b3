//! Lying bars, each of two parts one behind the other.

use super::lines::plain;
use super::{Area, COLORS, Drawn, FONT, Panel};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

pub struct Bar {
    pub name: String,
    pub parts: [f64; 2],
}

impl Bar {
    fn total(&self) -> f64 {
        self.parts.iter().sum()
    }
}

pub struct Bars {
    pub title: String,
    pub unit: &'static str,
    /// What the parts are.
    pub parts: [&'static str; 2],
    /// From top to bottom.
    pub bars: Vec<Bar>,
}

const TONES: [RGBColor; 2] = [COLORS[0], RGBColor(0xa9, 0xc8, 0xdd)];

impl Panel for Bars {
    const SIZE: (u32, u32) = (560, 420);
    const COLUMNS: usize = 2;

    fn draw<B: DrawingBackend>(&self, area: &Area<B>) -> Drawn<B> {
        let most = self.bars.iter().map(Bar::total).fold(1e-9, f64::max);
        // The legend has a place below the bars.
        let count = 1.16 * self.bars.len() as f64;
        let mut chart = ChartBuilder::on(area)
            .caption(&self.title, (FONT, 16))
            .margin(10)
            .margin_right(20)
            .x_label_area_size(36)
            .y_label_area_size(170)
            .build_cartesian_2d(0.0..1.12 * most, count..0.0)?;
        chart
            .configure_mesh()
            .disable_y_mesh()
            .disable_y_axis()
            .x_desc(self.unit)
            .x_labels(6)
            .label_style((FONT, 12))
            .light_line_style(TRANSPARENT)
            .draw()?;
        for (at, (name, tone)) in self.parts.iter().zip(TONES).enumerate() {
            let bars = self.bars.iter().enumerate().map(|(row, bar)| {
                let from: f64 = bar.parts[..at].iter().sum();
                let row = row as f64;
                Rectangle::new([(from, row + 0.15), (from + bar.parts[at], row + 0.85)], tone.filled())
            });
            chart
                .draw_series(bars)?
                .label(*name)
                .legend(move |(x, y)| Rectangle::new([(x, y - 4), (x + 14, y + 4)], tone.filled()));
        }
        for (row, bar) in self.bars.iter().enumerate() {
            let middle = row as f64 + 0.5;
            let (x, y) = chart.backend_coord(&(0.0, middle));
            let (end, _) = chart.backend_coord(&(bar.total(), middle));
            let origin = area.get_base_pixel();
            let style = |side| TextStyle::from((FONT, 12)).pos(Pos::new(side, VPos::Center));
            let place = |x: i32| (x - origin.0, y - origin.1);
            area.draw_text(&bar.name, &style(HPos::Right), place(x - 6))?;
            area.draw_text(&plain(bar.total()), &style(HPos::Left), place(end + 4))?;
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::LowerRight)
            .background_style(WHITE.mix(0.85))
            .border_style(BLACK.mix(0.3))
            .label_font((FONT, 12))
            .draw()
    }
}
