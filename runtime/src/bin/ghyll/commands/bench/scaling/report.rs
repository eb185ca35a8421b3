//! What `-o` writes: a table, and curves like the paper's Figs. 10 and 11.

use super::super::charts;
use super::super::charts::lines::{Label, Lines, Point, plain, whole};
use super::super::folder::Folder;
use super::{Axis, INVOCATIONS, Series, WORKGROUPS};
use crate::failure::Failure;
use std::fmt::Write;

pub fn write(folder: &Folder, all: &[Series], size: (u32, u32)) -> Result<(), Failure> {
    folder.save("scaling.md", markdown(all, size))?;
    let panels = panels(all);
    folder.save("scaling.svg", charts::svg(&panels).map_err(Failure::Run)?)?;
    folder.save("scaling.png", charts::png(&panels).map_err(Failure::Run)?)
}

fn fixed(axis: Axis) -> String {
    match axis {
        Axis::Workgroups => format!(", {INVOCATIONS} invocations in each"),
        Axis::Invocations => format!(", {WORKGROUPS} workgroups"),
        Axis::Threads => String::new(),
    }
}

pub fn markdown(all: &[Series], (width, height): (u32, u32)) -> String {
    let mut text = format!(
        "Median milliseconds a frame of {width}x{height} pixels; in parentheses the gain of the last doubling.\n"
    );
    for axis in [Axis::Workgroups, Axis::Invocations, Axis::Threads] {
        let own: Vec<&Series> = all.iter().filter(|series| series.axis == axis).collect();
        let Some(first) = own.first() else { continue };
        let counts: Vec<String> = first.points.iter().map(|(count, _)| count.to_string()).collect();
        let _ = write!(
            text,
            "\n| {}{} | {} |\n|---|{}\n",
            axis.name(),
            fixed(axis),
            counts.join(" | "),
            "---|".repeat(counts.len())
        );
        for series in own {
            let cell = |(at, (_, ms)): (usize, &(u32, [f64; 3]))| match series.gain(at) {
                Some(gain) => format!("{:.1} ({gain:.2})", ms[0]),
                None => format!("{:.1}", ms[0]),
            };
            let cells: Vec<String> = series.points.iter().enumerate().map(cell).collect();
            let Series { geometry, way, backend, .. } = series;
            let _ = writeln!(text, "| {geometry}, {way}, {backend} | {} |", cells.join(" | "));
        }
    }
    text
}

fn panels(all: &[Series]) -> Vec<Lines> {
    let mut panels = Vec::new();
    for axis in [Axis::Workgroups, Axis::Invocations, Axis::Threads] {
        let own: Vec<&Series> = all.iter().filter(|series| series.axis == axis).collect();
        if own.is_empty() {
            continue;
        }
        let curves = |y: &dyn Fn(&Series, usize) -> Option<f64>| {
            let points = |series: &Series| -> Vec<Point> {
                let at = series.points.iter().enumerate();
                at.filter_map(|(at, (count, _))| Some((f64::from(*count), y(series, at)?))).collect()
            };
            let name = |series: &Series| format!("{}, {}", series.geometry, series.way);
            own.iter().map(|series| (name(series), points(series))).collect()
        };
        let backend = own[0].backend;
        let panel = |title: &str, y: &'static str, number: fn(f64) -> String, curves| Lines {
            title: format!("{title}, {backend}{}", fixed(axis)),
            x: Label { text: axis.name(), number: whole, base: 2.0 },
            y: Label { text: y, number, base: 2.0 },
            curves,
        };
        let times = curves(&|series, at| Some(series.points[at].1[0]));
        panels.push(panel("frame time", "ms a frame", plain, times));
        panels.push(panel("gain of doubling", "times as fast", hundredths, curves(&Series::gain)));
    }
    panels
}

fn hundredths(x: f64) -> String {
    format!("{x:.2}")
}
