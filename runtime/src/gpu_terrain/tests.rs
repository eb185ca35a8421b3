//! The device against the twin: the pyramid bit for bit, the intrinsics within rounding. Where no adapter exists the
//! tests say so and check nothing.

use super::*;
use crate::terrain::wgsl::wgsl;
use crate::terrain::{Layers, Raster, SceneOptions, View};
use ghyll_compiler::core::Scalar;
use ghyll_compiler::intrinsics::Intrinsic;

fn device() -> Option<(wgpu::Device, wgpu::Queue)> {
    let instance = wgpu::Instance::default();
    let options = wgpu::RequestAdapterOptions::default();
    let Ok(adapter) = pollster::block_on(instance.request_adapter(&options)) else {
        eprintln!("no adapter: nothing was checked on a device");
        return None;
    };
    let limits = wgpu::DeviceDescriptor { required_limits: adapter.limits(), ..Default::default() };
    pollster::block_on(adapter.request_device(&limits)).ok()
}

fn read(device: &wgpu::Device, queue: &wgpu::Queue, buffer: &wgpu::Buffer) -> Vec<u32> {
    let copy = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: buffer.size(),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(buffer, 0, &copy, 0, buffer.size());
    queue.submit([encoder.finish()]);
    copy.slice(..).map_async(wgpu::MapMode::Read, |result| result.unwrap());
    device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    let mapped = copy.slice(..).get_mapped_range().unwrap();
    bytemuck::cast_slice(&mapped).to_vec()
}

const PYRAMID: Uses = Uses {
    scene: true,
    samples: false,
    bounds: true,
    rasters: false,
    floors: true,
    micro: false,
    means: false,
    beams: false,
    crests: false,
};

fn scene(terrain: Terrain) -> Scene {
    Scene::new(Arc::new(terrain), &SceneOptions::default()).unwrap()
}

/// Layers of 1 to 4 components, floats and bytes, other sizes than the field's; slot 2 is empty.
fn layered(scene: &Scene) -> Scene {
    let number = |i: usize| ((i * 7919) % 1001) as f32 / 100.0 - 5.0;
    let mut layers = Layers::default();
    for (slot, components, width, height) in [(0, 1, 7, 5), (1, 2, 1, 9), (3, 3, 12, 4), (4, 4, 33, 21)] {
        let count = (width * height * components) as usize;
        let texels = match slot % 2 {
            0 => Texels::Floats((0..count).map(number).collect()),
            _ => Texels::Bytes((0..count).map(|i| (i * 37) as u8).collect()),
        };
        let raster = Raster::computed(width, height, components, texels);
        layers.set(slot, Layer::placed(Arc::new(raster), scene.terrain()).unwrap());
    }
    scene.with_layers(layers)
}

#[test]
fn only_what_is_used_is_uploaded() {
    let Some((device, queue)) = device() else { return };
    let scene = layered(&scene(random_field(9, 9)));
    let bytes = |uses| GpuTerrain::new(&device, &queue, &scene, uses).unwrap().bytes();
    let none = bytes(Uses { scene: true, ..Uses::default() });
    assert_eq!(none[1..], [0; 4]);
    let all = bytes(Uses {
        scene: true,
        samples: true,
        bounds: true,
        rasters: true,
        floors: true,
        micro: true,
        means: true,
        beams: true,
        crests: true,
    });
    assert_eq!((all[1], all[3]), (9 * 9 * 4, 4 * scene.layers().size()));
    let (means, tiles) = (scene.mean_words().len() as u64, 128 * 128);
    assert!(all[2] > 0 && all[4] == 4 * (2 + 256 * 128) + 4 * means + 4 * tiles);
}

fn random_field(width: u32, height: u32) -> Terrain {
    let mut state = width * 31 + height;
    let mut random = || {
        state = state.wrapping_mul(747796405).wrapping_add(2891336453);
        if state >> 28 == 0 { f32::NAN } else { (state >> 8) as f32 * 1e-5 - 60.0 }
    };
    let heights = (0..width * height).map(|_| random()).collect();
    Terrain::from_heights(width, height, [10.0, 10.0], heights).unwrap()
}

#[test]
fn the_pyramid_equals_its_twin() {
    let Some((device, queue)) = device() else { return };
    let mut fields = vec![Terrain::builtin()];
    fields.extend([(2, 2), (3, 2), (2, 70), (65, 33), (100, 101)].map(|(w, h)| random_field(w, h)));
    for terrain in fields {
        let scene = scene(terrain);
        let gpu = GpuTerrain::new(&device, &queue, &scene, PYRAMID).unwrap();
        for (side, buffer) in [(Side::Above, &gpu.bounds), (Side::Below, &gpu.floors)] {
            let pyramid = if side == Side::Above { scene.pyramid() } else { scene.floors() };
            let expected = pyramid.words();
            let found = read(&device, &queue, buffer.as_ref().unwrap());
            if scene.pyramid().top() > 0 {
                // Padding nodes are not written.
                let differ = same_bounds(&scene, &expected, &found);
                assert!(differ.is_empty(), "{side:?} {differ:?}");
                let mut planted = found.clone();
                planted[0] ^= 1;
                assert_eq!(same_bounds(&scene, &expected, &planted), [0]);
            }
        }
    }
}

/// Nodes whose bounds differ.
fn same_bounds(scene: &Scene, expected: &[u32], found: &[u32]) -> Vec<u32> {
    let half = Format::of(scene.terrain()) == Format::I16;
    let node = |words: &[u32], i: u32| {
        if half { words[i as usize / 2] >> (16 * (i & 1)) & 0xffff } else { words[i as usize] }
    };
    let nodes = scene.pyramid().levels[1..].iter().flat_map(|l| l.offset..l.offset + l.width * l.height);
    nodes.filter(|i| node(expected, *i) != node(found, *i)).collect()
}

/// A kernel that evaluates one intrinsic for many arguments.
fn kernel(intrinsic: Intrinsic, format: Format) -> String {
    let params = intrinsic.params().len();
    let results = intrinsic.results();
    let arg = |(i, scalar): (usize, &Scalar)| match scalar {
        Scalar::F32 => format!("bitcast<f32>(args[at * {params}u + {i}u])"),
        _ => format!("args[at * {params}u + {i}u]"),
    };
    let args: Vec<String> = intrinsic.params().iter().enumerate().map(arg).collect();
    let field = |i: usize| match results.len() {
        1 => String::new(),
        _ if ghyll_compiler::intrinsics::returns_struct(intrinsic) => format!(".r{i}"),
        _ => format!("[{i}]"),
    };
    let store = |(i, scalar): (usize, &Scalar)| {
        let value = match scalar {
            Scalar::Bool => format!("u32(result{})", field(i)),
            _ => format!("bitcast<u32>(result{})", field(i)),
        };
        format!("    results[at * {}u + {i}u] = {value};\n", results.len())
    };
    let stores: String = results.iter().enumerate().map(store).collect();
    let text = wgsl(&[intrinsic], format).text;
    format!(
        "{text}\n@group(0) @binding(0) var<storage, read> args: array<u32>;\n\
         @group(0) @binding(1) var<storage, read_write> results: array<u32>;\n\
         @compute @workgroup_size(64)\nfn main(@builtin(global_invocation_id) id: vec3<u32>) {{\n    \
         let at = id.x;\n    let result = {}({});\n{stores}}}\n",
        intrinsic.name(),
        args.join(", ")
    )
}

fn evaluate(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    scene: &Scene,
    intrinsic: Intrinsic,
    args: &[u32],
    count: u32,
) -> Vec<u32> {
    let uses = wgsl(&[intrinsic], Format::of(scene.terrain())).uses;
    let gpu = GpuTerrain::new(device, queue, scene, uses).unwrap();
    let storage = |read_only| wgpu::BufferBindingType::Storage { read_only };
    let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: None,
        entries: &[entry(0, storage(true), 4), entry(1, storage(false), 4)],
    });
    let terrain = gpu.layout(device);
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(intrinsic.name()),
        source: wgpu::ShaderSource::Wgsl(kernel(intrinsic, Format::of(scene.terrain())).into()),
    });
    let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(&layout), Some(&terrain)],
        immediate_size: 0,
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: Some(&pipeline_layout),
        module: &module,
        entry_point: Some("main"),
        compilation_options: Default::default(),
        cache: None,
    });
    let args = device.create_buffer_init(&BufferInitDescriptor {
        label: None,
        contents: bytemuck::cast_slice(if args.is_empty() { &[0] } else { args }),
        usage: wgpu::BufferUsages::STORAGE,
    });
    let results = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 4 * u64::from(count) * intrinsic.results().len() as u64,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &bind(device, &layout, "values", &[(0, &args), (1, &results)]), &[]);
    pass.set_bind_group(1, &gpu.bind_group(device, &terrain), &[]);
    pass.dispatch_workgroups(count / 64, 1, 1);
    drop(pass);
    queue.submit([encoder.finish()]);
    read(device, queue, &results)
}

/// Arguments that make sense for the intrinsic: pixels, ground positions or rays through the field.
fn arguments(scene: &Scene, intrinsic: Intrinsic, count: u32) -> Vec<u32> {
    let mut state = 99u32;
    let mut unit = move || {
        state = state.wrapping_mul(747796405).wrapping_add(2891336453);
        (state >> 8) as f32 / 16777216.0
    };
    let [w, h] = scene.terrain().extent().map(|e| e as f32);
    let (lo, hi) = (scene.terrain().min as f32, scene.terrain().max as f32);
    let components = intrinsic.reading().map_or(0, |(_, components)| components as u32);
    let mut args = Vec::new();
    for _ in 0..count {
        match intrinsic.params().len() {
            2 if intrinsic == Intrinsic::MicroRow => {
                args.extend([unit(), unit()].map(|x| (1000.0 * x).floor() - 500.0));
            }
            3 if intrinsic == Intrinsic::Means => {
                let level = (unit() * 9.0).floor();
                let place = [unit(), unit()].map(|x| (x * w / level.exp2()).floor());
                args.extend([level, place[0], place[1]]);
            }
            3 if intrinsic.reading().is_none() => {
                args.extend([unit() * w, unit() * h, 1.0 + (unit() * 8.0).floor()]);
            }
            3 => {
                let slot = scene.layers().iter().find(|(_, l)| l.raster().components == components);
                let around = |unit: f32, size: f32| (unit * 1.2 - 0.1) * size;
                let slot = f32::from_bits(slot.unwrap().0);
                args.extend([slot, around(unit(), w), around(unit(), h)]);
            }
            2 => args.extend([unit() * w, unit() * h]),
            // Boxes of every size, also beyond the rim.
            4 => {
                let size = unit() * unit() * unit();
                let [x, y] = [unit() * 1.2 - 0.1, unit() * 1.2 - 0.1];
                args.extend([x * w, y * h, (x + size * unit()) * w, (y + size * unit()) * h]);
            }
            8 | 9 => {
                let from =
                    [(unit() * 2.0 - 0.5) * w, (unit() * 2.0 - 0.5) * h, lo + 2.0 * unit() * (hi - lo)];
                let to = [unit() * w, unit() * h, lo + unit() * (hi - lo)];
                let d = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
                let length = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
                args.extend(from);
                args.extend(d.map(|d| d / length));
                args.extend([0.0, 1e9]);
                args.extend((intrinsic.params().len() == 9).then(|| 1.0 + (unit() * 8.0).floor()));
            }
            _ => {}
        }
    }
    args.into_iter().map(f32::to_bits).collect()
}

#[test]
fn intrinsics_agree_with_their_twins() {
    let Some((device, queue)) = device() else { return };
    const COUNT: u32 = 4096;
    for scene in [scene(Terrain::builtin()), scene(random_field(60, 45))].map(|s| layered(&s)) {
        for &intrinsic in Intrinsic::ALL {
            let args = arguments(&scene, intrinsic, COUNT);
            let found = evaluate(&device, &queue, &scene, intrinsic, &args, COUNT);
            let (n, m) = (intrinsic.params().len(), intrinsic.results().len());
            let mut expected = vec![0; m];
            let mut apart = 0;
            for at in 0..COUNT as usize {
                scene.eval_f32(intrinsic, &args[at * n..(at + 1) * n], &mut expected);
                apart += usize::from(!close(intrinsic, &expected, &found[at * m..(at + 1) * m]));
            }
            // A driver's division may put a ray that grazes an edge on its other side.
            assert!(apart <= 2, "{}: {apart} of {COUNT} differ", intrinsic.name());
            let wrong: Vec<u32> = expected.iter().map(|w| w ^ 0x4000_0000).collect();
            assert!(!close(intrinsic, &expected, &wrong));
        }
    }
}

/// Every projection's rays, within rounding of the twin's and of the oracle's; turned a little they are other rays.
#[test]
fn cameras_agree_with_their_twins() {
    let Some((device, queue)) = device() else { return };
    const COUNT: u32 = 1024;
    let views = [
        View::overview(),
        View::topdown(),
        View::panorama().turned(77.0),
        View::LookAt {
            eye: [3.0, 5.0, 900.0],
            target: [100.0, 50.0, 0.0],
            up: [0.0, 0.0, 1.0],
            fov: 60.0,
            ortho: false,
        },
    ];
    for view in views {
        let options = SceneOptions { view, size: (512, 300), ..SceneOptions::default() };
        let scene = Scene::new(Arc::new(random_field(40, 30)), &options).unwrap();
        let position = |i: u32| [(i * 37 % 512) as f32 + 0.5, (i * 91 % 300) as f32 + 0.5];
        let args: Vec<u32> = (0..COUNT).flat_map(position).map(f32::to_bits).collect();
        let found = evaluate(&device, &queue, &scene, Intrinsic::Camera, &args, COUNT);
        for at in 0..COUNT as usize {
            let (args, found) = (&args[2 * at..2 * at + 2], &found[8 * at..8 * at + 8]);
            let mut twin = [0; 8];
            scene.eval_f32(Intrinsic::Camera, args, &mut twin);
            assert!(close(Intrinsic::Camera, &twin, found), "{view:?}");
            let wide = [0, 1].map(|i| f64::from(f32::from_bits(args[i])));
            let mut exact = [0.0; 8];
            scene.eval_f64(Intrinsic::Camera, &wide, &mut exact);
            let apart = |turn: f64| {
                (3..6).any(|i| (exact[i] + turn - f64::from(f32::from_bits(twin[i]))).abs() > 1e-6)
            };
            assert!(!apart(0.0) && apart(3e-6), "{view:?} {exact:?} {twin:?}");
        }
    }
}

fn close(intrinsic: Intrinsic, expected: &[u32], found: &[u32]) -> bool {
    let pairs = intrinsic.results().iter().zip(expected.iter().zip(found));
    pairs.into_iter().all(|(scalar, (a, b))| match scalar {
        Scalar::F32 => {
            let (a, b) = (f32::from_bits(*a), f32::from_bits(*b));
            (a - b).abs() <= 1e-4 * a.abs() + 1e-5
        }
        _ => a == b,
    })
}

#[test]
fn what_an_adapter_cannot_bind_is_named_with_the_mend() {
    let scene = scene(Terrain::builtin());
    let all = 4 * scene.sample_word_count();
    let binding = |bytes| wgpu::Limits { max_storage_buffer_binding_size: bytes, ..wgpu::Limits::default() };
    let fits = |bytes, uses| GpuTerrain::fits(&binding(bytes), &scene, uses).map_err(|e| e.to_string());
    let reads = Uses { samples: true, ..Uses::default() };
    assert_eq!(fits(all, reads), Ok(()));
    let why = fits(all - 4, reads).unwrap_err();
    assert_eq!(
        why,
        format!(
            "the field's samples take {all} bytes, but this adapter binds at most {}; cut or reduce the field",
            all - 4
        )
    );
    assert_eq!(fits(0, Uses { scene: true, ..Uses::default() }), Ok(()));
    let means = 4 * scene.mean_words().len() as u64;
    let why = fits(means - 4, Uses { means: true, ..Uses::default() });
    assert!(why.is_err_and(|why| why.contains("means")));
    let bakes = Uses { rasters: true, ..Uses::default() };
    let why = GpuTerrain::fits(&binding(16), &layered(&scene), bakes).map_err(|e| e.to_string());
    assert!(why.is_err_and(|why| why.contains("--no-bake")));
}
