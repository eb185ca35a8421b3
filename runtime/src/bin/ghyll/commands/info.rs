//! `ghyll info`: adapters, or what an elevation file holds.

use super::scene;
use crate::arguments::Info;
use crate::failure::Failure;
use ghyll_runtime::gpu::Gpu;
use ghyll_runtime::terrain::Terrain;
use serde_json::json;

pub fn info(arguments: &Info) -> Result<(), Failure> {
    let Some(path) = &arguments.dem else {
        return adapters(arguments.json);
    };
    let terrain = scene::open(Some(path), &arguments.reading)?;
    if arguments.json {
        println!("{}", described(&terrain));
        return Ok(());
    }
    let [dx, dy] = terrain.spacing;
    let [east, north] = terrain.extent();
    println!("format   {}", terrain.format);
    println!("samples  {} x {}", terrain.width, terrain.height);
    println!("spacing  {dx:.3} m east-west, {dy:.3} m north-south");
    println!("extent   {:.3} km x {:.3} km", east / 1000.0, north / 1000.0);
    println!("heights  {} m to {} m", terrain.min, terrain.max);
    println!("voids    {}", terrain.voids);
    println!("crs      {}", crs(&terrain).unwrap_or_else(|| "none stated".into()));
    Ok(())
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
                    "workgroup_memory_bytes": a.limits.max_compute_workgroup_storage_size,
                })
            })
            .collect();
        println!("{}", json!({ "version": env!("CARGO_PKG_VERSION"), "adapters": rows }));
        return Ok(());
    }
    println!("ghyll {}", env!("CARGO_PKG_VERSION"));
    if adapters.is_empty() {
        println!(
            "no GPU adapter: programs run on the CPU twin. Install a Vulkan, Metal or Direct3D 12 driver; on Linux"
        );
        println!("Mesa's package (mesa-vulkan-drivers, vulkan-swrast) has a software one");
    }
    for a in adapters {
        let kind = if a.software { ", software" } else { "" };
        println!("adapter  {} ({}{kind}; {})", a.name, a.backend, a.driver);
        println!("         storage bindings up to {} MiB", a.limits.max_storage_buffer_binding_size >> 20);
        println!("         workgroup memory {} KiB", a.limits.max_compute_workgroup_storage_size >> 10);
    }
    Ok(())
}
