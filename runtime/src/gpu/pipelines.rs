//! Bind group layouts, and pipelines compiled when first used.

use std::borrow::Cow;
use std::collections::{BTreeMap, VecDeque};
use std::time::{Duration, Instant};

use super::buffers::Buffers;
use super::code::Code;
use super::device::Gpu;
use super::shader::{Kernel, source};
use super::shape::Shape;
use crate::error::RunError;

/// Layout of group 1, and the bindings that it has.
#[derive(Clone)]
pub struct SceneLayout {
    pub layout: wgpu::BindGroupLayout,
    pub bindings: Vec<u32>,
}

pub struct Pipelines {
    stream: wgpu::BindGroupLayout,
    /// Group 2 of decode, and of allocate: where they write the sizes of later dispatches.
    decode_sizes: wgpu::BindGroupLayout,
    allocate_sizes: wgpu::BindGroupLayout,
    empty: wgpu::BindGroupLayout,
    scene: Option<SceneLayout>,
    trusted: bool,
    ready: BTreeMap<Kernel, wgpu::ComputePipeline>,
    /// Time spent compiling.
    pub compiling: Duration,
}

/// The pipelines a device has used last. Most kernels do not depend on the program, and the same program is often
/// run again under another configuration, so engines share them.
#[derive(Default)]
pub struct Kept {
    latest: VecDeque<(Identity, wgpu::ComputePipeline)>,
    /// Pipelines made so far.
    pub made: u64,
}

/// What makes two pipelines the same.
#[derive(PartialEq)]
struct Identity {
    kernel: Kernel,
    trusted: bool,
    /// Bindings of group 1: a text need not use all that its program has.
    bindings: Vec<u32>,
    text: String,
}

/// How many pipelines are kept for engines to come.
const KEPT: usize = 64;

impl Kept {
    fn find(&mut self, wanted: &Identity) -> Option<wgpu::ComputePipeline> {
        let index = self.latest.iter().position(|(known, _)| known == wanted)?;
        let found = self.latest.remove(index)?;
        let pipeline = found.1.clone();
        self.latest.push_front(found);
        Some(pipeline)
    }

    fn keep(&mut self, identity: Identity, pipeline: wgpu::ComputePipeline) {
        self.latest.push_front((identity, pipeline));
        self.latest.truncate(KEPT);
        self.made += 1;
    }
}

/// Bind groups of the rewriter; made anew when buffers grow.
pub struct Groups {
    pub stream: wgpu::BindGroup,
    pub decode_sizes: wgpu::BindGroup,
    pub allocate_sizes: wgpu::BindGroup,
    pub empty: wgpu::BindGroup,
}

fn entry(binding: u32, kind: wgpu::BufferBindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer { ty: kind, has_dynamic_offset: false, min_binding_size: None },
        count: None,
    }
}

fn layout(device: &wgpu::Device, label: &str, kinds: &[wgpu::BufferBindingType]) -> wgpu::BindGroupLayout {
    let entries: Vec<_> = kinds.iter().enumerate().map(|(i, kind)| entry(i as u32, *kind)).collect();
    device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

fn group(
    device: &wgpu::Device,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    buffers: &[&wgpu::Buffer],
) -> wgpu::BindGroup {
    let entries: Vec<_> = buffers
        .iter()
        .enumerate()
        .map(|(i, buffer)| wgpu::BindGroupEntry { binding: i as u32, resource: buffer.as_entire_binding() })
        .collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}

impl Pipelines {
    pub fn new(device: &wgpu::Device, scene: Option<SceneLayout>, trusted: bool) -> Pipelines {
        let written = wgpu::BufferBindingType::Storage { read_only: false };
        let read = wgpu::BufferBindingType::Storage { read_only: true };
        let uniform = wgpu::BufferBindingType::Uniform;
        let stream = [uniform, written, written, written, written, written, written, read];
        Pipelines {
            stream: layout(device, "stream", &stream),
            decode_sizes: layout(device, "decode sizes", &[written]),
            allocate_sizes: layout(device, "allocate sizes", &[written, written]),
            empty: layout(device, "empty", &[]),
            scene,
            trusted,
            ready: BTreeMap::new(),
            compiling: Duration::ZERO,
        }
    }

    pub fn groups(&self, device: &wgpu::Device, buffers: &Buffers) -> Groups {
        let stream = [
            &buffers.params,
            &buffers.state,
            &buffers.arena,
            &buffers.lists,
            &buffers.pairs,
            &buffers.records,
            &buffers.image,
            &buffers.tables,
        ];
        Groups {
            stream: group(device, "stream", &self.stream, &stream),
            decode_sizes: group(device, "decode sizes", &self.decode_sizes, &[&buffers.lane_groups]),
            allocate_sizes: group(
                device,
                "allocate sizes",
                &self.allocate_sizes,
                &[&buffers.lane_groups, &buffers.pair_groups],
            ),
            empty: group(device, "empty", &self.empty, &[]),
        }
    }

    fn bindings(&self, kernel: Kernel) -> Vec<Option<&wgpu::BindGroupLayout>> {
        let scene = self.scene_of(kernel).map_or(&self.empty, |scene| &scene.layout);
        let mut layouts = vec![Some(&self.stream), Some(scene)];
        match kernel {
            Kernel::Decode => layouts.push(Some(&self.decode_sizes)),
            Kernel::Allocate => layouts.push(Some(&self.allocate_sizes)),
            _ => {}
        }
        layouts
    }

    fn scene_of(&self, kernel: Kernel) -> Option<&SceneLayout> {
        self.scene.as_ref().filter(|_| kernel.runs_code())
    }

    /// Compiles the kernel; false if that had been done, by this engine or another.
    pub fn prepare(
        &mut self,
        gpu: &Gpu,
        kernel: Kernel,
        shape: &Shape,
        code: &Code,
    ) -> Result<bool, RunError> {
        if self.ready.contains_key(&kernel) {
            return Ok(false);
        }
        let start = Instant::now();
        let bindings = self.scene_of(kernel).map_or_else(Vec::new, |scene| scene.bindings.clone());
        let text = source(kernel, shape, code)?;
        let identity = Identity { kernel, trusted: self.trusted, bindings, text };
        let (pipeline, made) = match gpu.kept().find(&identity) {
            Some(pipeline) => (pipeline, false),
            None => (self.compile(gpu, &identity)?, true),
        };
        if made {
            gpu.kept().keep(identity, pipeline.clone());
        }
        self.ready.insert(kernel, pipeline);
        self.compiling += start.elapsed();
        Ok(made)
    }

    fn compile(&self, gpu: &Gpu, wanted: &Identity) -> Result<wgpu::ComputePipeline, RunError> {
        let kernel = wanted.kernel;
        let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let module = self.module(&gpu.device, kernel, &wanted.text);
        let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(kernel.name()),
            bind_group_layouts: &self.bindings(kernel),
            immediate_size: 0,
        });
        let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(kernel.name()),
            layout: Some(&layout),
            module: &module,
            entry_point: Some(kernel.name()),
            compilation_options: wgpu::PipelineCompilationOptions {
                // No stage reads workgroup memory that it has not written.
                zero_initialize_workgroup_memory: false,
                ..Default::default()
            },
            cache: None,
        });
        match pollster::block_on(scope.pop()) {
            Some(error) => Err(RunError::Shader(format!("{}: {error}", kernel.name()))),
            None => Ok(pipeline),
        }
    }

    fn module(&self, device: &wgpu::Device, kernel: Kernel, text: &str) -> wgpu::ShaderModule {
        let descriptor = wgpu::ShaderModuleDescriptor {
            label: Some(kernel.name()),
            source: wgpu::ShaderSource::Wgsl(Cow::Borrowed(text)),
        };
        match self.trusted {
            true => trusted_module(device, descriptor),
            false => device.create_shader_module(descriptor),
        }
    }

    /// Layout of group 1.
    pub fn scene(&self) -> Option<&SceneLayout> {
        self.scene.as_ref()
    }

    /// A kernel that `prepare` has compiled.
    pub fn get(&self, kernel: Kernel) -> Option<&wgpu::ComputePipeline> {
        self.ready.get(&kernel)
    }
}

/// A shader without the bounds checks that wgpu adds.
pub fn trusted_module(device: &wgpu::Device, descriptor: wgpu::ShaderModuleDescriptor) -> wgpu::ShaderModule {
    let mut checks = wgpu::ShaderRuntimeChecks::checked();
    checks.bounds_checks = false;
    checks.force_loop_bounding = false;
    // SAFETY: the kernels index only within the sizes that the engine passes them, array indices of the language
    // are clamped by the compiler, and every loop has fuel. Integer division stays checked: the language
    // defines it. The tests run both modes.
    #[allow(unsafe_code)]
    unsafe {
        device.create_shader_module_trusted(descriptor, checks)
    }
}
