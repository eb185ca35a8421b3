//! The hand-written kernel that `ghyll bench overhead` compares with (`benches/overhead/kernel.wgsl`).

use ghyll_compiler::intrinsics::Intrinsic;
use ghyll_runtime::gpu::{Gpu, trusted_module};
use ghyll_runtime::gpu_terrain::GpuTerrain;
use ghyll_runtime::terrain::{Scene, wgsl};
use wgpu::util::{BufferInitDescriptor, DeviceExt};

const TEXT: &str = include_str!("../../../../../../benches/overhead/kernel.wgsl");
/// What the kernel calls.
const INTRINSICS: &[Intrinsic] = &[
    Intrinsic::Extent,
    Intrinsic::Texel,
    Intrinsic::Relief,
    Intrinsic::Bilinear,
    Intrinsic::GradientBilinear,
    Intrinsic::TraceBilinear,
    Intrinsic::OccludedBilinear,
    Intrinsic::Camera,
    Intrinsic::SunDir,
];

pub struct Kernel {
    pipeline: wgpu::ComputePipeline,
    groups: [wgpu::BindGroup; 2],
    picture: wgpu::Buffer,
    readback: wgpu::Buffer,
    /// Tiles in a row and in a column.
    tiles: u32,
}

impl Kernel {
    pub fn new(gpu: &Gpu, scene: &Scene, size: u32) -> Result<Kernel, String> {
        let device = &gpu.device;
        let prelude = wgsl::wgsl(INTRINSICS, wgsl::Format::of(scene.terrain()));
        let terrain = GpuTerrain::new(device, &gpu.queue, scene, prelude.uses).map_err(|e| e.to_string())?;
        let terrain_layout = terrain.layout(device);
        let prelude = prelude.text;
        let source = wgpu::ShaderModuleDescriptor {
            label: Some("overhead kernel"),
            source: wgpu::ShaderSource::Wgsl(format!("{prelude}\n{TEXT}").into()),
        };
        let module = trusted_module(device, source);
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("overhead kernel"),
            entries: &[
                entry(0, wgpu::BufferBindingType::Storage { read_only: false }),
                entry(1, wgpu::BufferBindingType::Uniform),
            ],
        });
        let layouts = [Some(&layout), Some(&terrain_layout)];
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("overhead kernel"),
            layout: Some(&device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("overhead kernel"),
                bind_group_layouts: &layouts,
                immediate_size: 0,
            })),
            module: &module,
            entry_point: Some("kernel"),
            compilation_options: wgpu::PipelineCompilationOptions {
                zero_initialize_workgroup_memory: false,
                ..Default::default()
            },
            cache: None,
        });
        let buffer = |size: u64, usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("overhead kernel"),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        let bytes = u64::from(size) * u64::from(size) * 16;
        let storage = wgpu::BufferUsages::STORAGE;
        let picture = buffer(bytes, storage | wgpu::BufferUsages::COPY_SRC);
        let readback = buffer(bytes, wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ);
        let frame = device.create_buffer_init(&BufferInitDescriptor {
            label: Some("overhead kernel"),
            contents: bytemuck::bytes_of(&[size, size, 0, 0]),
            usage: wgpu::BufferUsages::UNIFORM,
        });
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("overhead kernel"),
            layout: &layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: picture.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: frame.as_entire_binding() },
            ],
        });
        let tiles = size.div_ceil(8);
        let groups = [group, terrain.bind_group(device, &terrain_layout)];
        Ok(Kernel { pipeline, groups, picture, readback, tiles })
    }

    /// Draws the picture and waits for it.
    pub fn draw(&self, gpu: &Gpu) -> Result<(), String> {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &self.groups[0], &[]);
            pass.set_bind_group(1, &self.groups[1], &[]);
            pass.dispatch_workgroups(self.tiles, self.tiles, 1);
        }
        gpu.queue.submit([encoder.finish()]);
        wait(gpu)
    }

    /// The picture, three floats a pixel.
    pub fn picture(&self, gpu: &Gpu) -> Result<Vec<f32>, String> {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(&self.picture, 0, &self.readback, 0, self.picture.size());
        gpu.queue.submit([encoder.finish()]);
        let slice = self.readback.slice(..);
        slice.map_async(wgpu::MapMode::Read, |_| {});
        wait(gpu)?;
        let floats: Vec<f32> = {
            let view = slice.get_mapped_range().map_err(|e| e.to_string())?;
            let all: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&view);
            all.iter().flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect()
        };
        self.readback.unmap();
        Ok(floats)
    }
}

fn wait(gpu: &Gpu) -> Result<(), String> {
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).map(|_| ()).map_err(|e| e.to_string())
}

fn entry(binding: u32, ty: wgpu::BufferBindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
        count: None,
    }
}
