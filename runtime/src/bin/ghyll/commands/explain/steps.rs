//! What primary rays cost, and what beams save of it.

use crate::failure::Failure;
use ghyll_compiler::compile::{Compiled, EntryKind};
use ghyll_compiler::intrinsics::Intrinsic;
use ghyll_runtime::terrain::steps::Steps;
use ghyll_runtime::terrain::{Scene, SceneOptions, Terrain};
use serde_json::{Value, json};
use std::sync::Arc;

/// Counts for a picture whose primary rays are walked over the maximum mipmap; none for other programs.
pub fn steps(compiled: &Compiled, terrain: &Arc<Terrain>) -> Result<Option<Steps>, Failure> {
    let uses = |wanted: &[Intrinsic]| wanted.iter().any(|i| compiled.back.wgsl.intrinsics.contains(i));
    let walks = uses(&[Intrinsic::TraceBilinear, Intrinsic::TraceTriangulated]);
    if compiled.kind != EntryKind::Image || !walks || !uses(&[Intrinsic::Camera]) {
        return Ok(None);
    }
    let scene = Scene::new(terrain.clone(), &SceneOptions::default());
    Ok(Some(Steps::of(&scene.map_err(|e| Failure::Usage(e.to_string()))?)))
}

pub fn text(steps: &Steps, beams: bool) -> Vec<String> {
    let per_ray = |n: u64| n as f64 / steps.rays as f64;
    let [width, height] = [SceneOptions::default().size.0, SceneOptions::default().size.1];
    let unused =
        if beams { "" } else { "; this program's rays start at the camera: `beam(p)` for `camera(p)`" };
    vec![
        format!("steps per ray from the camera on, at {width}x{height}: {:.1}", per_ray(steps.plain)),
        format!(
            "with beams: {:.1} and {:.2} of the pre-pass, {:.0} % less{unused}",
            per_ray(steps.started),
            per_ray(steps.beams),
            100.0 * steps.saved()
        ),
        format!(
            "tiles of 8x8 pixels that see only sky, so that no ray is walked: {} of {}",
            steps.empty, steps.tiles
        ),
    ]
}

pub fn json(steps: &Steps, beams: bool) -> Value {
    json!({
        "rays": steps.rays,
        "steps": steps.plain,
        "steps_with_beams": steps.started,
        "steps_of_beams": steps.beams,
        "saved": steps.saved(),
        "tiles": steps.tiles,
        "tiles_of_sky": steps.empty,
        "uses_beams": beams,
    })
}
