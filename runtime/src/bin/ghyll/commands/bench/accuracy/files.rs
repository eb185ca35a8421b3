//! What `-o` writes: every figure as CSV, the table and the verdicts as Markdown, the plot as SVG and PNG.

use super::super::charts;
use super::super::folder::Folder;
use super::pareto::Verdict;
use super::{Row, plot};
use crate::failure::Failure;
use serde_json::Value;
use std::fmt::Write;

pub fn write(folder: &Folder, rows: &[Row], verdicts: &[Verdict]) -> Result<(), Failure> {
    folder.save("accuracy.csv", csv(rows))?;
    folder.save("accuracy.md", markdown(rows, verdicts))?;
    let panels = plot::panels(rows);
    if !panels.is_empty() {
        folder.save("accuracy.svg", charts::svg(&panels).map_err(Failure::Run)?)?;
        folder.save("accuracy.png", charts::png(&panels).map_err(Failure::Run)?)?;
    }
    Ok(())
}

fn csv(rows: &[Row]) -> String {
    let field = |value: &Value| match value {
        Value::Null => String::new(),
        Value::String(text) if text.contains([',', '"', '\n']) => {
            format!("\"{}\"", text.replace('"', "\"\""))
        }
        Value::String(text) => text.clone(),
        other => other.to_string(),
    };
    let mut lines = Vec::new();
    for row in rows {
        let Value::Object(row) = row.json() else { continue };
        if lines.is_empty() {
            lines.push(row.keys().cloned().collect::<Vec<_>>().join(","));
        }
        lines.push(row.values().map(field).collect::<Vec<_>>().join(","));
    }
    lines.join("\n") + "\n"
}

/// Few digits, so that columns can be compared by eye.
fn short(x: f64) -> String {
    match x.abs() {
        0.0 => "0".into(),
        a if !a.is_finite() => "equal".into(),
        a if a < 1e-2 => format!("{x:.1e}"),
        a if a < 10.0 => format!("{x:.2}"),
        a if a < 1000.0 => format!("{x:.1}"),
        _ => format!("{x:.0}"),
    }
}

pub fn markdown(rows: &[Row], verdicts: &[Verdict]) -> String {
    let mut text = String::from(
        "| configuration | ms | disagreements | metres: max | p99 | rms | footprints: max | p99 | rms | error | PSNR dB | SSIM | FLIP | front |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for row in rows {
        let of = |pick: &dyn Fn(&super::Distances) -> String| row.distances.as_ref().map_or("-".into(), pick);
        let cells = [
            row.name(),
            short(row.ms[0]),
            of(&|d| d.disagreements.to_string()),
            of(&|d| short(d.metres.max)),
            of(&|d| short(d.metres.p99)),
            of(&|d| short(d.metres.rms)),
            of(&|d| short(d.footprints.max)),
            of(&|d| short(d.footprints.p99)),
            of(&|d| short(d.footprints.rms)),
            of(&|d| short(d.all)),
            short(row.apart.psnr),
            format!("{:.4}", row.apart.ssim),
            format!("{:.4}", row.apart.flip),
            of(&|_| if row.front { "yes" } else { "" }.to_string()),
        ];
        let _ = writeln!(text, "| {} |", cells.join(" | "));
    }
    text.push_str(
        "\n| trace against the searches | slower and worse | faster and worse | least error of the faster, to trace's | not slower and not worse | dominates |\n\
         |---|---|---|---|---|---|\n",
    );
    for verdict in verdicts {
        let _ = writeln!(
            text,
            "| {} | {} of {} | {} | {} | {} | {} |",
            verdict.name(),
            verdict.dominated,
            verdict.searches,
            verdict.faster,
            verdict.faster_error.map_or("-".into(), short),
            verdict.better,
            if verdict.dominates() { "yes" } else { "no" },
        );
    }
    text
}
