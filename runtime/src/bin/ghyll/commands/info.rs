//! `ghyll info`: adapters, or what an elevation file holds.

use super::scene;
use crate::arguments::Info;
use crate::failure::Failure;
use ghyll_runtime::gpu::{Gpu, GpuOptions, Info as Adapter};
use ghyll_runtime::terrain::Terrain;
use serde_json::json;

pub fn info(arguments: &Info) -> Result<(), Failure> {
    let Some(path) = &arguments.dem else {
        return adapters(arguments.json);
    };
    let terrain = scene::open(Some(path), &arguments.reading)?;
    if arguments.json {
        crate::report::line!("{}", described(&terrain));
        return Ok(());
    }
    let [dx, dy] = terrain.spacing;
    let [east, north] = terrain.extent();
    crate::report::line!("format   {}", terrain.format);
    crate::report::line!("samples  {} x {}", terrain.width, terrain.height);
    crate::report::line!("spacing  {dx:.3} m east-west, {dy:.3} m north-south");
    crate::report::line!("extent   {:.3} km x {:.3} km", east / 1000.0, north / 1000.0);
    match terrain.voids < terrain.samples.len() {
        true => {
            crate::report::line!("heights  {} m to {} m", millimetres(terrain.min), millimetres(terrain.max))
        }
        false => crate::report::line!("heights  none: every sample is missing"),
    }
    crate::report::line!("voids    {}", terrain.voids);
    crate::report::line!("crs      {}", crs(&terrain).unwrap_or_else(|| "none stated".into()));
    Ok(())
}

fn millimetres(z: f64) -> f64 {
    (z * 1000.0).round() / 1000.0
}

fn crs(terrain: &Terrain) -> Option<String> {
    let reference = terrain.crs.as_ref()?;
    Some(match reference.epsg {
        Some(code) => format!("EPSG:{code}"),
        None if reference.geographic => "geographic".into(),
        None => "projected".into(),
    })
}

fn described(terrain: &Terrain) -> serde_json::Value {
    json!({
        "width": terrain.width,
        "height": terrain.height,
        "spacing": terrain.spacing,
        "min": terrain.min,
        "max": terrain.max,
        "voids": terrain.voids,
        "crs": crs(terrain),
        "format": terrain.format,
    })
}

/// Whether the adapter's arithmetic is what tracing relies on; none if it cannot be opened.
fn exact(adapter: &Adapter) -> Option<bool> {
    let options = GpuOptions { adapter: Some(adapter.name.clone()), ..GpuOptions::default() };
    let gpu = Gpu::new(&options).ok()?;
    gpu.keeps_rounding().ok()
}

fn adapters(as_json: bool) -> Result<(), Failure> {
    let adapters = Gpu::list();
    if as_json {
        let rows: Vec<_> = adapters
            .iter()
            .map(|a| {
                json!({
                    "name": a.name,
                    "backend": a.backend,
                    "driver": a.driver,
                    "software": a.software,
                    "max_storage_buffer_binding_bytes": a.limits.max_storage_buffer_binding_size,
                    "exact_sums_and_products": exact(a),
                    "workgroup_memory_bytes": a.limits.max_compute_workgroup_storage_size,
                })
            })
            .collect();
        crate::report::line!("{}", json!({ "version": env!("CARGO_PKG_VERSION"), "adapters": rows }));
        return Ok(());
    }
    crate::report::line!("ghyll {}", env!("CARGO_PKG_VERSION"));
    if adapters.is_empty() {
        crate::report::line!(
            "no GPU adapter: programs run on the CPU twin. Install a Vulkan, Metal or Direct3D 12 driver; on Linux"
        );
        crate::report::line!("Mesa's package (mesa-vulkan-drivers, vulkan-swrast) has a software one");
    }
    for a in adapters {
        let kind = if a.software { ", software" } else { "" };
        crate::report::line!("adapter  {} ({}{kind}; {})", a.name, a.backend, a.driver);
        crate::report::line!(
            "         storage bindings up to {} MiB",
            a.limits.max_storage_buffer_binding_size >> 20
        );
        crate::report::line!(
            "         workgroup memory {} KiB",
            a.limits.max_compute_workgroup_storage_size >> 10
        );
        let verdict = match exact(&a) {
            Some(true) => "proved",
            Some(false) => "not kept: distances are less exact; see docs/accuracy.md",
            None => "not tested: the adapter cannot be opened",
        };
        crate::report::line!("         error-free sums and products {verdict}");
    }
    Ok(())
}
