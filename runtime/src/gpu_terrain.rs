//! The scene on the device: bind group 1 of every program that asks for terrain, and the maximum mipmap built there.
//!
//! The pyramid is made level by level by `shaders/terrain/pyramid.wgsl` and equals [`crate::terrain::Pyramid`] bit for bit.

use crate::terrain::layout::SceneUniform;
use crate::terrain::pyramid::{Level, levels};
use crate::terrain::wgsl::{Format, pyramid_stage};
use crate::terrain::{Scene, Terrain};
use bytemuck::{Pod, Zeroable};
use std::sync::Arc;
use wgpu::util::{BufferInitDescriptor, DeviceExt};

/// Invocations of the pyramid stage in a workgroup.
const WORKGROUP: u32 = 64;
/// Workgroups in a row of the grid; a device allows 65535.
const GROUPS: u32 = 32768;

#[derive(Debug, thiserror::Error)]
pub enum UploadError {
    #[error(
        "the field's samples take {needed} bytes, but this adapter binds at most {limit}; cut or reduce the field, or \
         use --on cpu"
    )]
    TooLarge { needed: u64, limit: u64 },
}

/// Parameters of the pyramid stage; the layout is the shader's `PyramidStep`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Step {
    row: u32,
    offset: u32,
    width: u32,
    height: u32,
    below_offset: u32,
    below_width: u32,
    below_height: u32,
    first: u32,
}

/// Buffers of one field; the scene record changes with camera and sun, the others only with the field.
#[derive(Debug)]
pub struct GpuTerrain {
    field: Arc<Terrain>,
    scene: wgpu::Buffer,
    samples: wgpu::Buffer,
    bounds: wgpu::Buffer,
}

impl GpuTerrain {
    /// Uploads the field and builds its pyramid.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, scene: &Scene) -> Result<GpuTerrain, UploadError> {
        let words = scene.sample_words();
        let needed = 4 * words.len() as u64;
        let limit = device.limits().max_storage_buffer_binding_size.min(device.limits().max_buffer_size);
        if needed > limit {
            return Err(UploadError::TooLarge { needed, limit });
        }
        let record = device.create_buffer_init(&BufferInitDescriptor {
            label: Some("terrain scene"),
            contents: bytemuck::bytes_of(scene.uniform()),
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        });
        let samples = device.create_buffer_init(&BufferInitDescriptor {
            label: Some("terrain samples"),
            contents: bytemuck::cast_slice(&words),
            usage: wgpu::BufferUsages::STORAGE,
        });
        let bounds = build_pyramid(device, queue, scene.terrain(), &samples);
        Ok(GpuTerrain { field: scene.terrain().clone(), scene: record, samples, bounds })
    }

    /// Takes another camera, sun or exaggeration of the same field; false if it is another field.
    pub fn update(&self, queue: &wgpu::Queue, scene: &Scene) -> bool {
        let same = Arc::ptr_eq(&self.field, scene.terrain());
        if same {
            queue.write_buffer(&self.scene, 0, bytemuck::bytes_of(scene.uniform()));
        }
        same
    }

    /// Bytes on the device: scene record, samples, bounds.
    pub fn bytes(&self) -> [u64; 3] {
        [self.scene.size(), self.samples.size(), self.bounds.size()]
    }

    /// Layout of bind group 1 with all three bindings.
    pub fn layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
        let read = wgpu::BufferBindingType::Storage { read_only: true };
        let record = size_of::<SceneUniform>() as u64;
        let entries =
            [entry(0, wgpu::BufferBindingType::Uniform, record), entry(1, read, 4), entry(2, read, 4)];
        device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("terrain"),
            entries: &entries,
        })
    }

    /// Bind group 1, for a layout made by [`GpuTerrain::layout`].
    pub fn bind_group(&self, device: &wgpu::Device, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
        bind(device, layout, "terrain", &[&self.scene, &self.samples, &self.bounds])
    }
}

fn entry(binding: u32, ty: wgpu::BufferBindingType, size: u64) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty,
            has_dynamic_offset: false,
            min_binding_size: wgpu::BufferSize::new(size),
        },
        count: None,
    }
}

fn bind(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    label: &str,
    buffers: &[&wgpu::Buffer],
) -> wgpu::BindGroup {
    let numbered = buffers.iter().zip(0..);
    let entries: Vec<_> = numbered
        .map(|(buffer, binding)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
        .collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}

/// The stages that build the pyramid: parameters and words to write, lowest level first.
fn plan(levels: &[Level], row: u32, nodes_in_word: u32) -> Vec<(Step, u32)> {
    let steps = levels.windows(2).enumerate().map(|(k, pair)| {
        let [below, level] = [pair[0], pair[1]];
        let step = Step {
            row,
            offset: level.offset,
            width: level.width,
            height: level.height,
            below_offset: below.offset,
            below_width: below.width,
            below_height: below.height,
            first: u32::from(k == 0),
        };
        (step, (level.width * level.height).div_ceil(nodes_in_word))
    });
    steps.collect()
}

fn build_pyramid(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    terrain: &Terrain,
    samples: &wgpu::Buffer,
) -> wgpu::Buffer {
    let format = Format::of(terrain);
    let nodes_in_word = match format {
        Format::I16 => 2,
        Format::F32 => 1,
    };
    let (levels, nodes) = levels(terrain.width, terrain.height);
    let bounds = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("terrain bounds"),
        size: 4 * u64::from((nodes / nodes_in_word).max(1)),
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("pyramid"),
        entries: &[
            entry(0, wgpu::BufferBindingType::Uniform, size_of::<Step>() as u64),
            entry(1, wgpu::BufferBindingType::Storage { read_only: true }, 4),
            entry(2, wgpu::BufferBindingType::Storage { read_only: false }, 4),
        ],
    });
    let pipeline = pyramid_pipeline(device, &layout, format);
    let mut encoder =
        device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("pyramid") });
    for (step, words) in plan(&levels, terrain.width, nodes_in_word) {
        let step = device.create_buffer_init(&BufferInitDescriptor {
            label: Some("pyramid step"),
            contents: bytemuck::bytes_of(&step),
            usage: wgpu::BufferUsages::UNIFORM,
        });
        let group = bind(device, &layout, "pyramid", &[&step, samples, &bounds]);
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        let groups = words.div_ceil(WORKGROUP);
        pass.dispatch_workgroups(groups.min(GROUPS), groups.div_ceil(GROUPS), 1);
    }
    queue.submit([encoder.finish()]);
    bounds
}

fn pyramid_pipeline(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    format: Format,
) -> wgpu::ComputePipeline {
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("pyramid"),
        source: wgpu::ShaderSource::Wgsl(pyramid_stage(format).into()),
    });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("pyramid"),
        bind_group_layouts: &[Some(layout)],
        immediate_size: 0,
    });
    device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("pyramid"),
        layout: Some(&layout),
        module: &module,
        entry_point: Some("pyramid"),
        compilation_options: Default::default(),
        cache: None,
    })
}

#[cfg(test)]
mod tests;
