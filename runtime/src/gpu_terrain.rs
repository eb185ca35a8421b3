//! The scene on the device: bind group 1 of every program that asks for terrain, and the mipmaps of bounds built there.
//!
//! A pyramid is made level by level by `shaders/terrain/pyramid.wgsl` and equals [`crate::terrain::Pyramid`] bit for bit.

mod proof;

pub(crate) use proof::first_inexact;

use crate::gpu::Gpu;
use crate::terrain::beams::TILE;
use crate::terrain::layout::SceneUniform;
use crate::terrain::pyramid::{Level, Side, levels};
use crate::terrain::raster::Texels;
use crate::terrain::wgsl::{Format, Uses, pyramid_stage};
use crate::terrain::{Layer, Scene, Terrain};
use bytemuck::{Pod, Zeroable};
use std::sync::{Arc, Weak};
use wgpu::util::{BufferInitDescriptor, DeviceExt};

/// Invocations of the pyramid stage in a workgroup.
const WORKGROUP: u32 = 64;
/// Workgroups in a row of the grid; a device allows 65535.
const GROUPS: u32 = 32768;

#[derive(Debug, thiserror::Error)]
pub enum UploadError {
    #[error("{what} take {needed} bytes, but this adapter binds at most {limit}; {mend}")]
    TooLarge { what: &'static str, mend: &'static str, needed: u64, limit: u64 },
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

/// Buffers of one field, of those that a program uses; the scene record changes with camera and sun, the others only
/// with the field.
#[derive(Debug)]
pub struct GpuTerrain {
    /// Kept by name only: its samples need not stay on the host.
    field: Weak<Terrain>,
    scene: wgpu::Buffer,
    samples: Option<wgpu::Buffer>,
    bounds: Option<wgpu::Buffer>,
    rasters: Option<wgpu::Buffer>,
    floors: Option<wgpu::Buffer>,
    micro: Option<wgpu::Buffer>,
    means: Option<wgpu::Buffer>,
    beams: Option<wgpu::Buffer>,
    crests: Option<wgpu::Buffer>,
}

impl GpuTerrain {
    /// Whether each buffer is one that the adapter can bind. The pyramids are smaller than the samples.
    pub fn fits(limits: &wgpu::Limits, scene: &Scene, uses: Uses) -> Result<(), UploadError> {
        let limit = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        let (field, rasters) = ("cut or reduce the field", "reduce them, or use --no-bake");
        let words = |used: bool, words: &dyn Fn() -> u64| if used { words() } else { 0 };
        let is_read = uses.samples || uses.bounds || uses.floors || uses.crests;
        let buffers = [
            ("the field's samples", field, words(is_read, &|| scene.sample_word_count())),
            ("the field's means", field, words(uses.means, &|| scene.mean_words().len() as u64)),
            (
                "the micro-heightfield's texels",
                "reduce it",
                words(uses.micro, &|| scene.micro().words().len() as u64),
            ),
            ("the rasters and bakes", rasters, words(uses.rasters, &|| scene.layers().size())),
        ];
        match buffers.into_iter().find(|(.., words)| 4 * words > limit) {
            Some((what, mend, words)) => Err(UploadError::TooLarge { what, mend, needed: 4 * words, limit }),
            None => Ok(()),
        }
    }

    /// Uploads what is used of the scene and builds the field's pyramid.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        scene: &Scene,
        uses: Uses,
    ) -> Result<GpuTerrain, UploadError> {
        GpuTerrain::fits(&device.limits(), scene, uses)?;
        let record = device.create_buffer_init(&BufferInitDescriptor {
            label: Some("terrain scene"),
            contents: bytemuck::bytes_of(scene.uniform()),
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        });
        let (mut samples, mut bounds, mut rasters, mut floors) = (None, None, None, None);
        let read_only = |label, words: &[u32]| {
            device.create_buffer_init(&BufferInitDescriptor {
                label: Some(label),
                contents: bytemuck::cast_slice(words),
                usage: wgpu::BufferUsages::STORAGE,
            })
        };
        let mut micro = None;
        if uses.micro {
            let words = scene.micro().words();
            micro = Some(read_only("terrain micro", &words));
        }
        let mut means = None;
        if uses.means {
            means = Some(read_only("terrain means", scene.mean_words()));
        }
        let mut crests = None;
        if uses.crests {
            crests = Some(read_only("terrain crests", &scene.crests().words()));
        }
        let mut beams = None;
        if uses.beams {
            let starts = &scene.beams().starts;
            beams = Some(device.create_buffer_init(&BufferInitDescriptor {
                label: Some("terrain beams"),
                contents: bytemuck::cast_slice(starts),
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
            }));
        }
        if uses.samples || uses.bounds || uses.floors {
            let buffer = read_only("terrain samples", &scene.sample_words());
            let pyramid = |side| build_pyramid(device, queue, (scene.terrain(), side), &buffer);
            bounds = uses.bounds.then(|| pyramid(Side::Above));
            floors = uses.floors.then(|| pyramid(Side::Below));
            samples = uses.samples.then_some(buffer);
        }
        if uses.rasters {
            rasters = Some(device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("terrain rasters"),
                size: (4 * scene.layers().size()).max(4),
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }));
        }
        let field = Arc::downgrade(scene.terrain());
        let terrain = GpuTerrain {
            field,
            scene: record,
            samples,
            bounds,
            rasters,
            floors,
            micro,
            means,
            beams,
            crests,
        };
        if let Some(rasters) = &terrain.rasters {
            queue.write_buffer(rasters, 0, bytemuck::cast_slice(&scene.layers().records()));
            for (slot, layer) in scene.layers().iter() {
                upload(queue, rasters, 4 * scene.layers().first(slot), layer);
            }
        }
        Ok(terrain)
    }

    /// Whether it is this field that the buffers hold, and as many beams as the scene has.
    pub fn serves(&self, scene: &Scene) -> bool {
        let size = scene.options().size;
        let tiles = u64::from(size.0.div_ceil(TILE)) * u64::from(size.1.div_ceil(TILE));
        let same_tiles = self.beams.as_ref().is_none_or(|beams| beams.size() == 4 * tiles);
        same_tiles && std::ptr::eq(self.field.as_ptr(), Arc::as_ptr(scene.terrain()))
    }

    /// Takes another camera, sun or exaggeration of the same field; false if it is another field.
    pub fn update(&self, queue: &wgpu::Queue, scene: &Scene) -> bool {
        let same = self.serves(scene);
        if same {
            queue.write_buffer(&self.scene, 0, bytemuck::bytes_of(scene.uniform()));
            if let Some(beams) = &self.beams {
                queue.write_buffer(beams, 0, bytemuck::cast_slice(&scene.beams().starts));
            }
        }
        same
    }

    /// Fills a layer's texels from another buffer.
    pub fn copy_layer(&self, gpu: &Gpu, from: &wgpu::Buffer, offset: u64, bytes: u64) {
        let Some(rasters) = &self.rasters else { return };
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(from, 0, rasters, offset, bytes);
        gpu.queue.submit([encoder.finish()]);
    }

    /// Bytes on the device: scene record, samples, bounds of both sides, rasters, means, the micro-heightfield and beams together.
    pub fn bytes(&self) -> [u64; 5] {
        let size = |buffer: &Option<wgpu::Buffer>| buffer.as_ref().map_or(0, wgpu::Buffer::size);
        let bounds = size(&self.bounds) + size(&self.floors) + size(&self.crests);
        let further = size(&self.means) + size(&self.micro) + size(&self.beams);
        [self.scene.size(), size(&self.samples), bounds, size(&self.rasters), further]
    }

    /// Numbers of the bindings that there are buffers for.
    pub fn bindings(&self) -> Vec<u32> {
        self.buffers().iter().map(|(binding, _)| *binding).collect()
    }

    /// Layout of bind group 1 with the bindings that there are buffers for.
    pub fn layout(&self, device: &wgpu::Device) -> wgpu::BindGroupLayout {
        let read = wgpu::BufferBindingType::Storage { read_only: true };
        let kind = |binding| match binding {
            0 => entry(0, wgpu::BufferBindingType::Uniform, size_of::<SceneUniform>() as u64),
            _ => entry(binding, read, 4),
        };
        let entries: Vec<_> = self.buffers().iter().map(|(binding, _)| kind(*binding)).collect();
        device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("terrain"),
            entries: &entries,
        })
    }

    /// Bind group 1, for the layout of [`GpuTerrain::layout`].
    pub fn bind_group(&self, device: &wgpu::Device, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
        bind(device, layout, "terrain", &self.buffers())
    }

    /// Every buffer with its binding.
    fn buffers(&self) -> Vec<(u32, &wgpu::Buffer)> {
        let GpuTerrain { samples, bounds, rasters, floors, micro, means, beams, crests, .. } = self;
        let read = [samples, bounds, rasters, floors, micro, means, beams, crests];
        let read = read.map(Option::as_ref);
        let all = std::iter::once(Some(&self.scene)).chain(read);
        (0..).zip(all).filter_map(|(binding, buffer)| Some((binding, buffer?))).collect()
    }
}

/// Writes a layer's texels, bytes four to a word.
fn upload(queue: &wgpu::Queue, rasters: &wgpu::Buffer, offset: u64, layer: &Layer) {
    match &layer.raster().texels {
        Texels::Floats(data) => queue.write_buffer(rasters, offset, bytemuck::cast_slice(data)),
        Texels::Bytes(data) => {
            let whole = data.len() / 4 * 4;
            queue.write_buffer(rasters, offset, &data[..whole]);
            if whole < data.len() {
                let mut last = [0; 4];
                last[..data.len() - whole].copy_from_slice(&data[whole..]);
                queue.write_buffer(rasters, offset + whole as u64, &last);
            }
        }
        Texels::Reserved => {}
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
    buffers: &[(u32, &wgpu::Buffer)],
) -> wgpu::BindGroup {
    let entries: Vec<_> = buffers
        .iter()
        .map(|(binding, buffer)| wgpu::BindGroupEntry {
            binding: *binding,
            resource: buffer.as_entire_binding(),
        })
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
    (terrain, side): (&Terrain, Side),
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
    let pipeline = pyramid_pipeline(device, &layout, pyramid_stage(format, side));
    let mut encoder =
        device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("pyramid") });
    for (step, words) in plan(&levels, terrain.width, nodes_in_word) {
        let step = device.create_buffer_init(&BufferInitDescriptor {
            label: Some("pyramid step"),
            contents: bytemuck::bytes_of(&step),
            usage: wgpu::BufferUsages::UNIFORM,
        });
        let group = bind(device, &layout, "pyramid", &[(0, &step), (1, samples), (2, &bounds)]);
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
    text: String,
) -> wgpu::ComputePipeline {
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("pyramid"),
        source: wgpu::ShaderSource::Wgsl(text.into()),
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
