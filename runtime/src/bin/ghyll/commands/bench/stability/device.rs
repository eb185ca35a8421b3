//! Rays through the intrinsics on a device: one invocation a ray.

use super::judge::{Answer, Surface};
use super::rays::Ray;
use ghyll_runtime::gpu::Gpu;
use ghyll_runtime::gpu_terrain::{GpuTerrain, UploadError};
use ghyll_runtime::terrain::{Scene, wgsl};
use wgpu::util::{BufferInitDescriptor, DeviceExt};

const KERNEL: &str = "
@group(0) @binding(0) var<storage, read> rays: array<f32>;
@group(0) @binding(1) var<storage, read_write> answers: array<vec4<u32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&answers) {
        return;
    }
    let at = 8u * id.x;
    let found = TRACE(rays[at], rays[at + 1u], rays[at + 2u], rays[at + 3u], rays[at + 4u], rays[at + 5u], rays[at + 6u],
        rays[at + 7u]PARTS);
    let dark = OCCLUDED(rays[at], rays[at + 1u], rays[at + 2u], rays[at + 3u], rays[at + 4u], rays[at + 5u],
        rays[at + 6u], rays[at + 7u]PARTS);
    answers[id.x] = vec4<u32>(u32(found.r0), bitcast<u32>(found.r1), u32(dark), 0u);
}
";

/// Rays in a dispatch.
pub const BATCH: usize = 1 << 16;

pub struct Tracer<'a> {
    gpu: &'a Gpu,
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
    terrain: wgpu::BindGroup,
}

impl<'a> Tracer<'a> {
    pub fn new(gpu: &'a Gpu, scene: &Scene, surface: Surface) -> Result<Tracer<'a>, UploadError> {
        let device = &gpu.device;
        let prelude = wgsl::wgsl(&[surface.trace, surface.occluded], wgsl::Format::of(scene.terrain()));
        let terrain = GpuTerrain::new(device, &gpu.queue, scene, prelude.uses)?;
        let terrain_layout = terrain.layout(device);
        let parts = surface.parts.map(|parts| format!(", {parts:?}")).unwrap_or_default();
        let text = KERNEL.replace("TRACE", surface.trace.name()).replace("OCCLUDED", surface.occluded.name());
        let text = text.replace("PARTS", &parts);
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("stability"),
            source: wgpu::ShaderSource::Wgsl(format!("{}\n{text}", prelude.text).into()),
        });
        let storage = |read_only| wgpu::BufferBindingType::Storage { read_only };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("stability"),
            entries: &[entry(0, storage(true)), entry(1, storage(false))],
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("stability"),
            layout: Some(&device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("stability"),
                bind_group_layouts: &[Some(&layout), Some(&terrain_layout)],
                immediate_size: 0,
            })),
            module: &module,
            entry_point: Some("main"),
            compilation_options: Default::default(),
            cache: None,
        });
        let terrain = terrain.bind_group(device, &terrain_layout);
        Ok(Tracer { gpu, pipeline, layout, terrain })
    }

    /// Answers to at most [`BATCH`] rays.
    pub fn trace(&self, rays: &[Ray]) -> Result<Vec<Answer>, String> {
        let device = &self.gpu.device;
        let size = 16 * rays.len() as u64;
        let input = device.create_buffer_init(&BufferInitDescriptor {
            label: Some("rays"),
            contents: bytemuck::cast_slice(rays),
            usage: wgpu::BufferUsages::STORAGE,
        });
        let buffer = |usage| {
            let descriptor =
                wgpu::BufferDescriptor { label: Some("answers"), size, usage, mapped_at_creation: false };
            device.create_buffer(&descriptor)
        };
        let output = buffer(wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
        let readback = buffer(wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ);
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("stability"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: input.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: output.as_entire_binding() },
            ],
        });
        let mut encoder = device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.set_bind_group(1, &self.terrain, &[]);
            pass.dispatch_workgroups(rays.len().div_ceil(64) as u32, 1, 1);
        }
        encoder.copy_buffer_to_buffer(&output, 0, &readback, 0, size);
        self.gpu.queue.submit([encoder.finish()]);
        let slice = readback.slice(..);
        slice.map_async(wgpu::MapMode::Read, |_| {});
        device.poll(wgpu::PollType::wait_indefinitely()).map_err(|e| e.to_string())?;
        let view = slice.get_mapped_range().map_err(|e| e.to_string())?;
        let words: Vec<[u32; 4]> = bytemuck::pod_collect_to_vec(&view);
        let answer = |[hit, distance, occluded, _]: [u32; 4]| Answer { hit, distance, occluded };
        Ok(words.into_iter().map(answer).collect())
    }
}

fn entry(binding: u32, ty: wgpu::BufferBindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
        count: None,
    }
}
