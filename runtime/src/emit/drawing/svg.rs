//! SVG of boxes, arrows and text.

use layout::core::format::{ClipHandle, RenderBackend};
use layout::core::geometry::Point;
use layout::core::style::StyleAttr;
use std::fmt::Write;

/// Height of letters.
pub const FONT: usize = 14;
const LINE: f64 = 18.0;
const MARGIN: f64 = 12.0;

/// Room that a text needs, in the widest of the usual fonts.
pub fn extent(text: &str) -> Point {
    let longest = text.lines().map(|line| line.chars().count()).max().unwrap_or(0);
    Point::new(longest as f64 * FONT as f64 * 0.62, text.lines().count() as f64 * LINE)
}

/// A picture that grows downwards.
#[derive(Default)]
pub struct Svg {
    body: String,
    width: f64,
    height: f64,
    /// Where the part begins that is drawn now.
    top: f64,
}

impl Svg {
    /// A text above what is drawn next.
    pub fn title(&mut self, text: &str) {
        for line in text.lines() {
            self.top += LINE;
            let _ = writeln!(
                self.body,
                r#"<text x="{MARGIN}" y="{:.1}" text-anchor="start">{}</text>"#,
                self.top,
                escaped(line)
            );
        }
        let size = extent(text);
        self.reach(size.x + MARGIN, 0.0);
    }

    /// Goes on below what has been drawn.
    pub fn below(&mut self) {
        self.top = self.height + MARGIN;
    }

    pub fn finish(&self) -> String {
        let (width, height) = (self.width + MARGIN, self.height + MARGIN);
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
             viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"sans-serif\" font-size=\"{FONT}\" \
             text-anchor=\"middle\">\n<defs><marker id=\"head\" markerWidth=\"10\" markerHeight=\"8\" refX=\"9\" \
             refY=\"4\" orient=\"auto-start-reverse\"><path d=\"M0 0 L10 4 L0 8 z\"/></marker></defs>\n\
             <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n{}</svg>\n",
            self.body
        )
    }

    /// The picture reaches to here, measured in the part that is drawn now.
    fn reach(&mut self, x: f64, y: f64) {
        self.width = self.width.max(x);
        self.height = self.height.max(y + self.top);
    }
}

impl RenderBackend for Svg {
    fn draw_rect(
        &mut self,
        xy: Point,
        size: Point,
        look: &StyleAttr,
        _: Option<String>,
        _: Option<ClipHandle>,
    ) {
        let _ = writeln!(
            self.body,
            r#"<rect x="{:.1}" y="{:.1}" width="{:.1}" height="{:.1}" rx="{}" fill="white" stroke="black" stroke-width="{}"/>"#,
            xy.x,
            xy.y + self.top,
            size.x,
            size.y,
            look.rounded,
            look.line_width
        );
        self.reach(xy.x + size.x, xy.y + size.y);
    }

    fn draw_line(&mut self, start: Point, stop: Point, look: &StyleAttr, properties: Option<String>) {
        self.draw_arrow(&[(start, start), (stop, stop)], false, (false, false), look, properties, "");
    }

    fn draw_circle(&mut self, xy: Point, size: Point, look: &StyleAttr, properties: Option<String>) {
        self.draw_rect(xy.sub(size.scale(0.5)), size, look, properties, None);
    }

    fn draw_text(&mut self, xy: Point, text: &str, _: &StyleAttr) {
        let lines: Vec<&str> = text.lines().collect();
        let first = xy.y + self.top - LINE * (lines.len() as f64 - 1.0) / 2.0 + FONT as f64 * 0.35;
        for (i, line) in lines.iter().enumerate() {
            let y = first + LINE * i as f64;
            let _ = writeln!(self.body, r#"<text x="{:.1}" y="{y:.1}">{}</text>"#, xy.x, escaped(line));
        }
        let size = extent(text);
        self.reach(xy.x + size.x / 2.0, xy.y + size.y / 2.0);
    }

    fn draw_arrow(
        &mut self,
        path: &[(Point, Point)],
        dashed: bool,
        head: (bool, bool),
        _: &StyleAttr,
        _: Option<String>,
        text: &str,
    ) {
        let mut line = String::new();
        for (i, (at, control)) in path.iter().enumerate() {
            let [(ax, ay), (cx, cy)] = [at, control].map(|p| (p.x, p.y + self.top));
            let _ = match i {
                // The first pair is start and control, later ones control and end.
                0 => write!(line, "M{ax:.1} {ay:.1} C{cx:.1} {cy:.1}"),
                1 => write!(line, ", {ax:.1} {ay:.1}, {cx:.1} {cy:.1}"),
                _ => write!(line, " S{ax:.1} {ay:.1}, {cx:.1} {cy:.1}"),
            };
            self.reach(at.x, at.y);
            self.reach(control.x, control.y);
        }
        let marker = |there: bool, end: &str| match there {
            true => format!(r##" marker-{end}="url(#head)""##),
            false => String::new(),
        };
        let dashes = if dashed { r#" stroke-dasharray="5,4""# } else { "" };
        let _ = writeln!(
            self.body,
            r#"<path d="{line}" fill="none" stroke="black"{dashes}{}{}/>"#,
            marker(head.0, "start"),
            marker(head.1, "end")
        );
        if let (false, Some((at, _))) = (text.is_empty(), path.get(path.len() / 2)) {
            let _ = writeln!(
                self.body,
                r#"<text x="{:.1}" y="{:.1}" stroke="white" stroke-width="3" paint-order="stroke">{}</text>"#,
                at.x,
                at.y + self.top,
                escaped(text)
            );
        }
    }

    fn create_clip(&mut self, _: Point, _: Point, _: usize) -> ClipHandle {
        0
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
