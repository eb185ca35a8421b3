//! Timings for docs/performance.md: `cargo test --release gpu::tests::bench -- --ignored --nocapture`.

use super::super::shader::Kernel;
use super::super::shape::{Shape, Windows};
use super::super::*;
use super::programs::{fib, gpu};

fn median(times: &[f64]) -> f64 {
    let mut times = times.to_vec();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// Processor time of this process in seconds, where the system tells; it counts the work of a software adapter
/// whatever else the machine does.
fn processor_time() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields = stat.rsplit(')').next().unwrap_or_default().split_whitespace().skip(11).take(2);
    fields.filter_map(|field| field.parse::<f64>().ok()).sum::<f64>() / 100.0
}

/// A variant: its name, its configuration, and what it changes in the sizes.
type Variant = (&'static str, Config, fn(&mut Shape));

/// Runs the variants in turn, so that what else the machine does falls on all of them.
fn compare(gpu: &Gpu, stream: &[(u32, bool)], turns: usize, variants: &[Variant]) {
    let mut engines: Vec<Engine> = variants
        .iter()
        .map(|(_, config, change)| {
            let mut shape = Shape::new(&fib(), config, 0, gpu.info().software).unwrap();
            change(&mut shape);
            Engine::with_shape(gpu, fib(), config.clone(), None, shape).unwrap()
        })
        .collect();
    let mut times = vec![Vec::new(); variants.len()];
    let mut processor = vec![0.0; variants.len()];
    let mut last = vec![Stats::default(); variants.len()];
    for turn in 0..turns + 3 {
        for (index, engine) in engines.iter_mut().enumerate() {
            let before = processor_time();
            let cold = turn == 0;
            let outcome = match engine.run(stream) {
                Ok(outcome) => outcome,
                Err(error) => panic!("{}: {error}", variants[index].0),
            };
            assert_eq!(outcome.words, [196_418]);
            if cold {
                println!(
                    "{:24} cold: processor {:7.0} ms",
                    variants[index].0,
                    (processor_time() - before) * 1e3
                );
            }
            if turn >= 3 {
                processor[index] += (processor_time() - before) / turns as f64;
                times[index].push(outcome.stats.time.as_secs_f64());
            }
            last[index] = outcome.stats;
        }
    }
    for (index, (name, ..)) in variants.iter().enumerate() {
        let time = median(&times[index]);
        let least = times[index].iter().copied().fold(f64::MAX, f64::min);
        println!(
            "{name:24} median {:7.2} ms, least {:7.2} ms, processor {:7.2} ms, {:5.1} M rewrites/s, {} rounds, {} submissions, {} tokens moved",
            time * 1e3,
            least * 1e3,
            processor[index] * 1e3,
            last[index].rewrites as f64 / time / 1e6,
            last[index].rounds,
            last[index].submissions,
            last[index].moved,
        );
    }
}

const FIB_27: [(u32, bool); 2] = [(27, false), (0, true)];

#[test]
#[ignore = "a measurement, not a test"]
fn fib_27_by_rewriter() {
    let Some(gpu) = gpu() else { return };
    let of = |rewriter| Config { rewriter, ..Config::default() };
    let same: fn(&mut Shape) = |_| {};
    let variants: [Variant; 7] = [
        ("auto", of(Rewriter::Auto), same),
        ("auto, checked", Config { trusted: false, ..Config::default() }, same),
        ("lane", of(Rewriter::Lane), same),
        ("block", of(Rewriter::Block), same),
        ("auto, workgroup windows", of(Rewriter::Auto), |s| s.windows = Windows::Workgroup),
        ("block, private windows", of(Rewriter::Block), |s| s.windows = Windows::Private),
        ("block, depth 8", Config { depth: Some(8), ..of(Rewriter::Block) }, same),
    ];
    compare(&gpu, &FIB_27, 5, &variants);
}

#[test]
#[ignore = "a measurement, not a test"]
fn fib_27_by_shape() {
    let Some(gpu) = gpu() else { return };
    let config = || Config { timeout: std::time::Duration::from_secs(60), ..Config::default() };
    let threads = |threads| Config { threads: Some(threads), ..Config::default() };
    let variants: [Variant; 13] = [
        ("as is", config(), |_| {}),
        ("workgroup windows", config(), |s| s.windows = Windows::Workgroup),
        ("burst 16", config(), |s| s.burst = 16),
        ("burst 256", config(), |s| s.burst = 256),
        ("window 32", config(), |s| s.window = 32),
        ("window 48", config(), |s| s.window = 48),
        ("window 128", config(), |s| s.window = 128),
        ("expand 4", config(), |s| s.expand = 4),
        ("expand 16", config(), |s| s.expand = 16),
        ("pull 1", config(), |s| s.pull = 1),
        ("32 threads", threads(32), |_| {}),
        ("128 threads", threads(128), |_| {}),
        ("256 threads", threads(256), |_| {}),
    ];
    compare(&gpu, &FIB_27, 9, &variants);
}

/// A pixel that iterates z = z^2 + c, fused (`shade`) or as three tasks.
fn mandelbrot() -> Code {
    let functions = "
fn escape(x: f32, y: f32) -> f32 {
    let c = vec2<f32>(x / 200.0 - 2.0, y / 200.0 - 1.3);
    var z = vec2<f32>(0.0);
    var n = 0.0;
    for (var i = 0; i < 200; i = i + 1) {
        z = vec2<f32>(z.x * z.x - z.y * z.y, 2.0 * z.x * z.y) + c;
        if (dot(z, z) > 4.0) { break; }
        n = n + 1.0;
    }
    return n;
}
fn colour(n: f32) -> vec3<f32> { return vec3<f32>(n, sqrt(n), n * n); }
fn shade(x: f32, y: f32) -> vec4<f32> { return vec4<f32>(colour(escape(x, y)), 1.0); }
fn task_0() {
    consume(2u);
    let x = operand(0u);
    let y = operand(1u);
    later(2u);
    literal(x);
    literal(y);
    invoke = 1u;
}
fn task_1() {
    consume(2u);
    literal(bitcast<u32>(escape(bitcast<f32>(operand(0u)), bitcast<f32>(operand(1u)))));
}
fn task_2() {
    consume(1u);
    let c = colour(bitcast<f32>(operand(0u)));
    literal(bitcast<u32>(c.x));
    literal(bitcast<u32>(c.y));
    literal(bitcast<u32>(c.z));
}";
    super::programs::code(functions, &[("pixel", 2), ("escape", 2), ("colour", 1)], 4)
}

/// Name, whether `shade` is there, what is changed in the sizes, and a lane's share of steps.
type PictureVariant = (&'static str, bool, fn(&mut Shape), i32);

#[test]
#[ignore = "a measurement, not a test"]
fn picture_by_lanes_and_directly() {
    let Some(gpu) = gpu() else { return };
    let variants: [PictureVariant; 7] = [
        ("direct", true, |_| {}, 256),
        ("lanes", false, |_| {}, 256),
        ("lanes, workgroup windows", false, |s| s.windows = Windows::Workgroup, 256),
        ("lanes, burst 8", false, |s| s.burst = 8, 256),
        ("lanes, burst 4", false, |s| s.burst = 4, 256),
        ("lanes, share 512", false, |_| {}, 512),
        ("lanes, share 2048", false, |_| {}, 2048),
    ];
    let mut engines: Vec<Engine> = variants
        .iter()
        .map(|(_, has_shade, change, share)| {
            let code = Code { has_shade: *has_shade, ..mandelbrot() };
            let mut shape = Shape::new(&code, &Config::default(), 3, gpu.info().software).unwrap();
            change(&mut shape);
            let mut engine = Engine::with_shape(&gpu, code, Config::default(), None, shape).unwrap();
            engine.pixel_share = *share;
            engine
        })
        .collect();
    let mut processor = vec![0.0; variants.len()];
    let mut walls = vec![Vec::new(); variants.len()];
    let mut submissions = vec![0; variants.len()];
    let reference = engines[0].render(600, 520, 0).unwrap().words;
    for turn in 0..8 {
        for (index, engine) in engines.iter_mut().enumerate() {
            let before = processor_time();
            let frame = engine.render(600, 520, 0).unwrap();
            assert!(frame.words == reference, "{}", variants[index].0);
            if turn >= 3 {
                processor[index] += (processor_time() - before) / 5.0;
                walls[index].push(frame.stats.time.as_secs_f64());
            }
            submissions[index] = frame.stats.submissions;
        }
    }
    for (index, variant) in variants.iter().enumerate() {
        let (wall, processor) = (median(&walls[index]) * 1e3, processor[index] * 1e3);
        println!(
            "{:26} median {wall:7.2} ms, processor {processor:7.2} ms, {} submissions, share {}",
            variant.0, submissions[index], engines[index].pixel_share
        );
    }
}

#[test]
#[ignore = "a measurement, not a test"]
fn compiling_by_kernel() {
    let Some(gpu) = gpu() else { return };
    for trusted in [true, false] {
        let config = Config { trusted, ..Config::default() };
        let mut engine = Engine::new(&gpu, fib(), config, None).unwrap();
        let state = engine.load(&FIB_27).unwrap();
        for kernel in [Kernel::Decode, Kernel::Execute, Kernel::Allocate, Kernel::Splice] {
            let before = processor_time();
            engine.prepare(&[kernel]).unwrap();
            let prepared = processor_time();
            engine.write(&engine.params(), &state);
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            let mut pass = encoder.begin_compute_pass(&Default::default());
            engine.bind(&mut pass, kernel);
            pass.dispatch_workgroups(1, 1, 1);
            drop(pass);
            gpu.queue.submit([encoder.finish()]);
            gpu.device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
            println!(
                "{:12} trusted {trusted}: processor {:4.0} ms to prepare, {:4.0} ms at the first dispatch",
                kernel.name(),
                (prepared - before) * 1e3,
                (processor_time() - prepared) * 1e3
            );
        }
    }
}
