//! The operator network as a picture. `layout` places boxes and arrows.

mod svg;

use ghyll_compiler::table::network::{Network, with_fused};
use layout::core::base::Orientation;
use layout::core::color::Color;
use layout::core::geometry::Point;
use layout::core::style::{LineStyleKind, StyleAttr};
use layout::std_shapes::shapes::{Arrow, Element, ShapeKind};
use layout::topo::layout::VisualGraph;
use svg::Svg;
use thiserror::Error;

/// The most tasks that are drawn: placing them takes ever longer, and nobody could follow the arrows.
pub const MOST_DRAWN: usize = 400;

#[derive(Clone, Debug, PartialEq, Error)]
pub enum DrawError {
    #[error("{0} tasks are too many for a drawing (at most {MOST_DRAWN}); `--emit dot` is for Graphviz")]
    TooMany(usize),
}

/// SVG of networks, one below the other: that of the entry, then those of its bakes with their names.
pub fn drawing(networks: &[(&str, Network)]) -> Result<String, DrawError> {
    let tasks = networks.iter().map(|(_, network)| network.tasks.len()).sum();
    if tasks > MOST_DRAWN {
        return Err(DrawError::TooMany(tasks));
    }
    let mut picture = Svg::default();
    for (at, (name, network)) in networks.iter().enumerate() {
        let title = if at == 0 { (*name).to_owned() } else { format!("bake {name}") };
        picture.title(&with_fused(&title, network));
        let mut graph = VisualGraph::new(Orientation::TopToBottom);
        let nodes: Vec<_> = network
            .tasks
            .iter()
            .map(|task| graph.add_node(element(&Network::label(task), task.entry)))
            .collect();
        for link in &network.links {
            let line_style = if link.tokens == 0 { LineStyleKind::Dashed } else { LineStyleKind::Normal };
            let arrow = Arrow { line_style, look: look(false), ..Arrow::simple(&link.label()) };
            graph.add_edge(arrow, nodes[link.from], nodes[link.to]);
        }
        graph.do_it(false, false, false, &mut picture);
        picture.below();
    }
    Ok(picture.finish())
}

fn look(entry: bool) -> StyleAttr {
    let width = if entry { 3 } else { 1 };
    StyleAttr::new(Color::fast("black"), width, Some(Color::fast("white")), 6, svg::FONT)
}

fn element(text: &str, entry: bool) -> Element {
    let size = svg::extent(text);
    let size = Point::new(size.x + 24.0, size.y + 14.0);
    Element::create(ShapeKind::new_box(text), look(entry), Orientation::TopToBottom, size)
}
