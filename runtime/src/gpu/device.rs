//! Adapter and device: what is asked for, once.

use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use super::error::GpuError;
use super::pipelines::Kept;
use crate::gpu_terrain::first_inexact;

#[derive(Clone, Debug, Default)]
pub struct GpuOptions {
    /// Part of the adapter's name, in any case.
    pub adapter: Option<String>,
    /// Let wgpu check the sizes of indirect dispatches, which the rewriter's own stages compute.
    pub validate_indirect: bool,
}

/// What is known of an adapter.
#[derive(Clone, Debug)]
pub struct Info {
    pub name: String,
    pub backend: String,
    pub driver: String,
    /// The adapter is a CPU.
    pub software: bool,
    pub timestamps: bool,
    pub limits: wgpu::Limits,
}

/// An open adapter; clones share the device.
#[derive(Clone)]
pub struct Gpu {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    info: Info,
    lost: Arc<Mutex<Option<String>>>,
    kept: Arc<Mutex<Kept>>,
    /// What the proof of exact sums and products has found.
    proof: Arc<OnceLock<Result<bool, String>>>,
}

fn instance(options: &GpuOptions) -> wgpu::Instance {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::PRIMARY;
    descriptor.flags = wgpu::InstanceFlags::empty();
    if options.validate_indirect {
        descriptor.flags |= wgpu::InstanceFlags::VALIDATION_INDIRECT_CALL;
    }
    wgpu::Instance::new(descriptor)
}

/// Real GPUs before software.
fn rank(kind: wgpu::DeviceType) -> u32 {
    match kind {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    }
}

fn choose(mut adapters: Vec<wgpu::Adapter>, wanted: Option<&str>) -> Result<wgpu::Adapter, GpuError> {
    adapters.sort_by_key(|adapter| rank(adapter.get_info().device_type));
    let Some(wanted) = wanted else {
        return adapters.into_iter().next().ok_or(GpuError::NoAdapter);
    };
    let names: Vec<String> = adapters.iter().map(|adapter| adapter.get_info().name).collect();
    if names.is_empty() {
        return Err(GpuError::NoAdapter);
    }
    let lower = wanted.to_lowercase();
    let found = names.iter().position(|name| name.to_lowercase().contains(&lower));
    match found {
        Some(index) => Ok(adapters.swap_remove(index)),
        None => Err(GpuError::NoSuchAdapter { wanted: wanted.to_owned(), found: names.join(", ") }),
    }
}

impl Gpu {
    pub fn new(options: &GpuOptions) -> Result<Gpu, GpuError> {
        let instance = instance(options);
        let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
        Gpu::open(choose(adapters, options.adapter.as_deref())?)
    }

    /// All adapters there are.
    pub fn list() -> Vec<Info> {
        let instance = instance(&GpuOptions::default());
        let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
        adapters.iter().map(describe).collect()
    }

    fn open(adapter: wgpu::Adapter) -> Result<Gpu, GpuError> {
        let info = describe(&adapter);
        if !adapter.get_downlevel_capabilities().flags.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS) {
            return Err(GpuError::NoCompute { adapter: info.name });
        }
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("ghyll"),
            required_features: adapter.features() & wgpu::Features::TIMESTAMP_QUERY,
            required_limits: adapter.limits(),
            memory_hints: wgpu::MemoryHints::Performance,
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|error| GpuError::NoDevice { adapter: info.name.clone(), reason: error.to_string() })?;
        Ok(Gpu::adopt(device, queue, info))
    }

    /// A device that the application has opened.
    pub fn from_device(adapter: &wgpu::Adapter, device: wgpu::Device, queue: wgpu::Queue) -> Gpu {
        let mut info = describe(adapter);
        info.limits = device.limits();
        info.timestamps = device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        Gpu::adopt(device, queue, info)
    }

    fn adopt(device: wgpu::Device, queue: wgpu::Queue, info: Info) -> Gpu {
        let lost = Arc::new(Mutex::new(None));
        let note = |slot: &Arc<Mutex<Option<String>>>, text: String| {
            if let Ok(mut slot) = slot.lock() {
                slot.get_or_insert(text);
            }
        };
        let slot = lost.clone();
        device.set_device_lost_callback(move |reason, text| note(&slot, format!("{reason:?}: {text}")));
        let slot = lost.clone();
        device.on_uncaptured_error(Arc::new(move |error| note(&slot, error.to_string())));
        Gpu { device, queue, info, lost, kept: Arc::default(), proof: Arc::default() }
    }

    pub fn info(&self) -> &Info {
        &self.info
    }

    /// Why the device is of no more use, if so.
    pub fn lost(&self) -> Option<String> {
        self.lost.lock().ok().and_then(|lost| lost.clone())
    }

    /// Whether sums and products are rounded as the walks through terrain rely on; proved once for a device.
    pub fn keeps_rounding(&self) -> Result<bool, String> {
        self.proof.get_or_init(|| first_inexact(self).map(|pair| pair.is_none())).clone()
    }

    /// Takes it that the proof has failed.
    #[cfg(test)]
    pub(crate) fn plant_failed_proof(&self) {
        assert!(self.proof.set(Ok(false)).is_ok(), "nothing was proved yet");
    }

    /// Pipelines made so far for this device, by all engines.
    pub fn pipelines_made(&self) -> u64 {
        self.kept().made
    }

    /// Pipelines for engines to come.
    pub(super) fn kept(&self) -> MutexGuard<'_, Kept> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Loop turns that an invocation may make in all; llvmpipe ends loops silently beyond 65535.
    pub(super) fn loop_turns(&self) -> Option<u32> {
        self.info.name.contains("llvmpipe").then_some(65535)
    }

    /// Workgroups that the adapter runs at once, roughly.
    pub(super) fn parallel_groups(&self) -> u32 {
        if self.info.software {
            std::thread::available_parallelism().map_or(2, |n| n.get() as u32)
        } else {
            256
        }
    }
}

fn describe(adapter: &wgpu::Adapter) -> Info {
    let info = adapter.get_info();
    Info {
        name: info.name,
        backend: info.backend.to_string(),
        driver: format!("{} {}", info.driver, info.driver_info),
        software: info.device_type == wgpu::DeviceType::Cpu,
        timestamps: adapter.features().contains(wgpu::Features::TIMESTAMP_QUERY),
        limits: adapter.limits(),
    }
}
