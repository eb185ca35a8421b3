//! Whether a device keeps what `shaders/terrain/transforms.wgsl` relies on: sums and products rounded to nearest, neither
//! fused nor reordered where the text rounds.

use super::{bind, entry};
use crate::gpu::{Gpu, trusted_module};
use crate::terrain::layout::SceneUniform;
use crate::terrain::transforms;
use crate::terrain::wgsl;
use bytemuck::Zeroable;
use wgpu::util::{BufferInitDescriptor, DeviceExt};

const KERNEL: &str = "
@group(0) @binding(0) var<storage, read> pairs: array<vec2<f32>>;
@group(0) @binding(1) var<storage, read_write> results: array<vec4<f32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let pair = pairs[id.x];
    results[id.x] = vec4<f32>(terrain_sum(pair.x, pair.y), terrain_product(pair.x, pair.y));
}
";
const PAIRS: usize = 4096;

/// Pairs of all signs and of sizes far apart and near each other.
fn pairs() -> Vec<[f32; 2]> {
    let mut state = 7u32;
    let mut next = || {
        state = state.wrapping_mul(747796405).wrapping_add(2891336453);
        let size = f32::from_bits((127 - 12 + (state >> 27)) << 23);
        size * ((state >> 2) as f32 / (1 << 24) as f32 - 4.0)
    };
    (0..PAIRS).map(|_| [next(), next()]).collect()
}

fn expected(pairs: &[[f32; 2]]) -> Vec<[f32; 4]> {
    let numbers = |[a, b]: [f32; 2]| {
        let ([s, e], [p, f]) = (transforms::sum(a, b), transforms::product(a, b));
        [s, e, p, f]
    };
    pairs.iter().map(|pair| numbers(*pair)).collect()
}

/// The first pair for which the device's sum or product, or what rounding lost of it, is another number than IEEE
/// arithmetic gives; none if all agree. The sign of a zero does not count.
pub(crate) fn first_inexact(gpu: &Gpu) -> Result<Option<[f32; 2]>, String> {
    let pairs = pairs();
    let found = evaluate(gpu, &pairs)?;
    let wrong = expected(&pairs).into_iter().zip(found).position(|(a, b)| a != b);
    Ok(wrong.map(|at| pairs[at]))
}

fn evaluate(gpu: &Gpu, pairs: &[[f32; 2]]) -> Result<Vec<[f32; 4]>, String> {
    let device = &gpu.device;
    let storage = |read_only| wgpu::BufferBindingType::Storage { read_only };
    let record = size_of::<SceneUniform>() as u64;
    let values = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("proof"),
        entries: &[entry(0, storage(true), 8), entry(1, storage(false), 16)],
    });
    let scene = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("proof"),
        entries: &[entry(0, wgpu::BufferBindingType::Uniform, record)],
    });
    let text = format!("{}\n{KERNEL}", wgsl::transforms());
    let module = trusted_module(
        device,
        wgpu::ShaderModuleDescriptor { label: Some("proof"), source: wgpu::ShaderSource::Wgsl(text.into()) },
    );
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("proof"),
        layout: Some(&device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("proof"),
            bind_group_layouts: &[Some(&values), Some(&scene)],
            immediate_size: 0,
        })),
        module: &module,
        entry_point: Some("main"),
        compilation_options: Default::default(),
        cache: None,
    });
    let filled = |contents: &[u8], usage| {
        device.create_buffer_init(&BufferInitDescriptor { label: Some("proof"), contents, usage })
    };
    let input = filled(bytemuck::cast_slice(pairs), wgpu::BufferUsages::STORAGE);
    let uniform = filled(bytemuck::bytes_of(&SceneUniform::zeroed()), wgpu::BufferUsages::UNIFORM);
    let size = 16 * pairs.len() as u64;
    let buffer = |usage| {
        let label = Some("proof");
        device.create_buffer(&wgpu::BufferDescriptor { label, size, usage, mapped_at_creation: false })
    };
    let output = buffer(wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
    let readback = buffer(wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ);
    let mut encoder = device.create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &bind(device, &values, "proof", &[(0, &input), (1, &output)]), &[]);
        pass.set_bind_group(1, &bind(device, &scene, "proof", &[(0, &uniform)]), &[]);
        pass.dispatch_workgroups((pairs.len() / 64) as u32, 1, 1);
    }
    encoder.copy_buffer_to_buffer(&output, 0, &readback, 0, size);
    gpu.queue.submit([encoder.finish()]);
    let slice = readback.slice(..);
    slice.map_async(wgpu::MapMode::Read, |_| {});
    device.poll(wgpu::PollType::wait_indefinitely()).map_err(|e| e.to_string())?;
    if let Some(why) = gpu.lost() {
        return Err(why);
    }
    let view = slice.get_mapped_range().map_err(|e| e.to_string())?;
    Ok(bytemuck::pod_collect_to_vec(&view))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Config;
    use crate::gpu::{GpuError, GpuOptions};
    use crate::machine::{Job, Machine};
    use crate::terrain::{Scene, SceneOptions, Terrain};
    use ghyll_compiler::compile::{self, EntryKind, Options};
    use ghyll_compiler::source::Source;

    #[test]
    fn the_adapter_adds_and_multiplies_without_loss() {
        let gpu = match Gpu::new(&GpuOptions::default()) {
            Ok(gpu) => gpu,
            Err(GpuError::NoAdapter) => return eprintln!("no adapter: nothing was checked on a device"),
            Err(error) => panic!("{error}"),
        };
        let pairs = pairs();
        for ((pair, expected), found) in
            pairs.iter().zip(expected(&pairs)).zip(evaluate(&gpu, &pairs).unwrap())
        {
            assert_eq!(found, expected, "{pair:?}");
        }
        assert_eq!(first_inexact(&gpu), Ok(None));
        // A planted difference: other pairs have other results.
        let mut others = pairs.clone();
        others[5][1] += 1.0;
        assert_ne!(expected(&others), evaluate(&gpu, &pairs).unwrap());
    }

    /// Where the proof fails, programs that walk are the twin's, and no others.
    #[test]
    fn a_failed_proof_has_a_stand_in() {
        let gpu = match Gpu::new(&GpuOptions::default()) {
            Ok(gpu) => gpu,
            Err(GpuError::NoAdapter) => return eprintln!("no adapter: nothing was checked on a device"),
            Err(error) => panic!("{error}"),
        };
        let compiled = |text: &str| {
            let checked = compile::check(Source::new("test.ghyll", text)).unwrap();
            let options = Options { want: Some(EntryKind::Image), ..Options::default() };
            let compiled = compile::compile(&checked, &options).unwrap();
            (checked, compiled)
        };
        let walks = compiled(
            "use terrain; fn pixel(p: vec2) -> f32 = match trace(bilinear, camera(p)) { Some(t) => t, None => -1.0 };",
        );
        let reads = compiled("use terrain; fn pixel(p: vec2) -> f32 = bilinear(p);");
        gpu.plant_failed_proof();
        let machine = Machine::Gpu(Box::new(gpu.clone()));
        let scene = Scene::new(std::sync::Arc::new(Terrain::builtin()), &SceneOptions::default()).unwrap();
        let job = Job { checked: &walks.0, compiled: &walks.1, scene: Some(&scene) };
        let stand_in = |machine: &Machine, (checked, compiled): &(_, _)| {
            let job = Job { checked, compiled, scene: Some(&scene) };
            machine.stand_in(&job).unwrap().map(|other| (other.machine.describe(), other.why))
        };
        let (other, why) = stand_in(&machine, &walks).unwrap();
        assert!(other == "CPU twin" && why.contains("exact tracing"), "{other}: {why}");
        assert_eq!(stand_in(&machine, &reads), None);
        let fresh = Machine::Gpu(Box::new(Gpu::new(&GpuOptions::default()).unwrap()));
        assert_eq!(stand_in(&fresh, &walks), None);

        let made = gpu.pipelines_made();
        let drawn = |machine: &Machine| job.render(machine, (16, 16), &Config::default()).unwrap().0;
        assert_eq!(drawn(&machine), drawn(&Machine::Cpu));
        assert_eq!(gpu.pipelines_made(), made);
    }
}
