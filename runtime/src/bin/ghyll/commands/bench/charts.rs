//! Drawings of measurements: sheets of panels, as SVG for pages and as PNG.

pub mod bars;
pub mod lines;

use ghyll_runtime::image::{Format, Image, encode};
use plotters::coord::Shift;
use plotters::drawing::DrawingAreaErrorKind;
use plotters::prelude::*;
use plotters::style::register_font;

pub const FONT: &str = "sans-serif";
pub const COLORS: [RGBColor; 4] = [
    RGBColor(0x1b, 0x6c, 0xa8),
    RGBColor(0xd9, 0x82, 0x1c),
    RGBColor(0x2f, 0x8f, 0x4e),
    RGBColor(0x80, 0x50, 0xa0),
];

pub type Area<B> = DrawingArea<B, Shift>;
pub type Drawn<B> = Result<(), DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>>;

/// One diagram of a sheet.
pub trait Panel {
    /// Pixels across and down.
    const SIZE: (u32, u32);
    /// Most panels in a row.
    const COLUMNS: usize;

    fn draw<B: DrawingBackend>(&self, area: &Area<B>) -> Drawn<B>;
}

fn size<P: Panel>(panels: &[P]) -> (u32, u32) {
    let columns = panels.len().min(P::COLUMNS) as u32;
    (P::SIZE.0 * columns, P::SIZE.1 * panels.len().div_ceil(P::COLUMNS) as u32)
}

pub fn svg<P: Panel>(panels: &[P]) -> Result<String, String> {
    let mut text = String::new();
    sheet(SVGBackend::with_string(&mut text, size(panels)).into_drawing_area(), panels)?;
    Ok(text)
}

pub fn png<P: Panel>(panels: &[P]) -> Result<Vec<u8>, String> {
    let (width, height) = size(panels);
    let mut bytes = vec![0; 3 * (width * height) as usize];
    sheet(BitMapBackend::with_buffer(&mut bytes, (width, height)).into_drawing_area(), panels)?;
    let data = bytes.iter().map(|byte| f32::from(*byte) / 255.0).collect();
    let image = Image::new(width, height, 3, data).map_err(|e| e.to_string())?;
    encode(&image, Format::Png).map_err(|e| e.to_string())
}

fn sheet<B: DrawingBackend, P: Panel>(root: Area<B>, panels: &[P]) -> Result<(), String> {
    register_font(FONT, FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT)
        .map_err(|_| "the plot's font cannot be read".to_string())?;
    root.fill(&WHITE).map_err(|e| e.to_string())?;
    let rows = panels.len().div_ceil(P::COLUMNS);
    let areas = root.split_evenly((rows, panels.len().min(P::COLUMNS)));
    areas.iter().zip(panels).try_for_each(|(area, panel)| panel.draw(area)).map_err(|e| e.to_string())?;
    root.present().map_err(|e| e.to_string())
}
