//! What `-o` writes: every figure as CSV, the table and the verdicts as Markdown, the plot as SVG and PNG.

use super::pareto::Verdict;
use super::{Row, plot};
use crate::failure::Failure;
use serde_json::Value;
use std::fmt::Write;
use std::path::Path;

pub fn write(folder: &Path, rows: &[Row], verdicts: &[Verdict]) -> Result<(), Failure> {
    let failed = |e: std::io::Error| Failure::Usage(format!("cannot write into {}: {e}", folder.display()));
    std::fs::create_dir_all(folder).map_err(failed)?;
    let save = |name: &str, content: &[u8]| std::fs::write(folder.join(name), content).map_err(failed);
    save("accuracy.csv", csv(rows).as_bytes())?;
    save("accuracy.md", markdown(rows, verdicts).as_bytes())?;
    let panels = plot::panels(rows);
    if !panels.is_empty() {
        save("accuracy.svg", plot::svg(&panels).map_err(Failure::Run)?.as_bytes())?;
        save("accuracy.png", &plot::png(&panels).map_err(Failure::Run)?)?;
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
