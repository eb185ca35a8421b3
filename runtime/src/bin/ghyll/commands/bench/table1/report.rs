//! What `-o` writes: the table with the paper's figures beside it, and bars.

use super::super::charts;
use super::super::charts::bars::{Bar, Bars};
use super::super::folder::Folder;
use super::{Cell, Ratio, WAYS, Way, paper};
use crate::failure::Failure;
use std::fmt::Write;

pub fn write(folder: &Folder, cells: &[Cell], ratios: &[Ratio], size: (u32, u32)) -> Result<(), Failure> {
    folder.save("table1.md", markdown(cells, ratios, size))?;
    let panels = panels(cells);
    folder.save("table1.svg", charts::svg(&panels).map_err(Failure::Run)?)?;
    folder.save("table1.png", charts::png(&panels).map_err(Failure::Run)?)
}

fn of(way: Way, cells: &[Cell]) -> Vec<&Cell> {
    cells.iter().filter(|cell| cell.way == way).collect()
}

pub fn markdown(cells: &[Cell], ratios: &[Ratio], (width, height): (u32, u32)) -> String {
    let mut text = format!(
        "Milliseconds a frame of {width}x{height} pixels; rewriting is the same network without its work; net is what is left. \
         The paper's figures are of its own machine, terrains and pictures: compare ratios.\n"
    );
    for way in WAYS {
        let own = of(*way, cells);
        if own.is_empty() {
            continue;
        }
        let _ = write!(
            text,
            "\n**{}**\n\n\
             | terrain | geometry | lighting | average | least | greatest | rewriting | net | paper: average | paper: net |\n\
             |---|---|---|---|---|---|---|---|---|---|\n",
            way.name
        );
        for cell in own {
            let [average, least, greatest] = cell.ms;
            let paper = cell.paper_average();
            let ms = [average, least, greatest, cell.overhead, cell.net(), paper, paper - paper::OVERHEAD];
            let ms: Vec<String> = ms.iter().map(|x| format!("{x:.1}")).collect();
            let Cell { terrain_name, form, .. } = cell;
            let _ = writeln!(
                text,
                "| {terrain_name} | {} | {} | {} |",
                form.geometry(),
                form.lighting(),
                ms.join(" | ")
            );
        }
    }
    text.push_str("\n| ratio | of | net | average | paper: net | wanted |\n|---|---|---|---|---|---|\n");
    for ratio in ratios {
        let reached = if ratio.reached() { "reached" } else { "not reached" };
        let _ = writeln!(
            text,
            "| {} | {} | {:.2} | {:.2} | {:.2} | at most {:.0}: {reached} |",
            ratio.what, ratio.of, ratio.net, ratio.average, ratio.paper_net, ratio.wanted
        );
    }
    text.push_str(
        "\n| terrain | geometry | way | pixels hit by one only | largest error in m | error in footprints (rms) |\n|---|---|---|---|---|---|\n",
    );
    for cell in cells.iter().filter(|cell| !cell.form.dynamic) {
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {:.1e} | {:.1e} |",
            cell.terrain_name,
            cell.form.geometry(),
            cell.way.name,
            cell.distances.disagreements,
            cell.distances.metres.max,
            cell.distances.all
        );
    }
    text
}

fn panels(cells: &[Cell]) -> Vec<Bars> {
    let bars = |title: &str, own: &[&Cell], bar: &dyn Fn(&Cell) -> (String, [f64; 2])| {
        let bar = |cell: &&Cell| {
            let (terrain, parts) = bar(cell);
            let name = format!("{terrain}, {}, {}", cell.form.geometry(), cell.form.lighting());
            Bar { name, parts }
        };
        let bars = own.iter().map(bar).collect();
        Bars { title: title.into(), unit: "ms a frame", parts: ["stages", "rewriting"], bars }
    };
    let mut panels = Vec::new();
    for way in WAYS {
        let own = of(*way, cells);
        if !own.is_empty() {
            let bar = |cell: &Cell| (cell.terrain_name.clone(), [cell.net().max(0.0), cell.overhead]);
            panels.push(bars(way.name, &own, &bar));
        }
    }
    let all = of(WAYS[0], cells);
    if !all.is_empty() {
        let bar = |cell: &Cell| {
            let parts = [cell.paper_average() - paper::OVERHEAD, paper::OVERHEAD];
            (paper::TERRAINS[cell.terrain].to_string(), parts)
        };
        panels.push(bars("the paper, GTX TITAN", &all, &bar));
    }
    panels
}
