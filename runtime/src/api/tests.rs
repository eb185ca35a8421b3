//! Operator slots: what a live parameter of function type holds is replaced between pictures.

use super::*;
use crate::gpu::Gpu;
use crate::oracle::Precision;

const PROGRAM: &str = "
    use terrain;
    param lighting: fn(Hit) -> vec3 = flat;
    param gain: f32 = 1.0;
    param surface: fn(vec2) -> f32 = bilinear;
    fn flat(h: Hit) -> vec3 = vec3(h.at.z * 0.203125 / 1024.0, h.distance / 65536.0, 0.5);
    fn by_height(h: Hit) -> vec3 = vec3(h.at.z / 4096.0, h.normal.x * 0.40625 + 0.5, 0.25);
    @task fn by_slope(h: Hit) -> vec3 = vec3(h.normal.z * 0.8125, 0.5, 0.75);
    fn pixel(p: vec2) -> vec3 = match cast(surface, camera(p)) {
        Some(h) => lighting(h) * gain,
        None => vec3(0.0),
    };
";

/// Every machine there is; the GPU with what counts its pipelines.
fn runtimes() -> Vec<(Runtime, Option<Gpu>)> {
    let mut all = vec![
        (Runtime::on(Machine::Oracle(Precision::F64), Config::default()), None),
        (Runtime::on(Machine::Cpu, Config::default()), None),
    ];
    match Gpu::new(&GpuOptions::default()) {
        Ok(gpu) => {
            all.push((Runtime::on(Machine::Gpu(Box::new(gpu.clone())), Config::default()), Some(gpu)));
        }
        Err(error) if std::env::var("GHYLL_REQUIRE_GPU").is_ok_and(|v| v == "1") => panic!("{error}"),
        Err(error) => eprintln!("NOT TESTED ON A GPU: {error}"),
    }
    all
}

fn difference(a: &Image, b: &Image) -> f32 {
    let mut largest = 0.0f32;
    for y in 0..16 {
        for x in 0..16 {
            for (a, b) in a.pixel(x, y).iter().zip(b.pixel(x, y)) {
                largest = largest.max((a - b).abs());
            }
        }
    }
    largest
}

#[test]
fn functions_are_replaced_without_a_pipeline() {
    let program = compile(Source::new("slots", PROGRAM)).unwrap();
    for (runtime, gpu) in runtimes() {
        let made = || gpu.as_ref().map(Gpu::pipelines_made);
        let builder = || runtime.scene(&program).view(View::topdown());
        let mut live = builder().live("lighting").live("gain").build().unwrap();
        let mut pictures = vec![live.render(16, 16).unwrap()];
        let first = made();
        let values = [("flat", 1.0), ("by_height", 0.5), ("by_slope", 1.0), ("flat", 2.0)];
        for (name, gain) in &values[1..] {
            live.set("lighting", Function(name)).unwrap();
            live.set("gain", *gain).unwrap();
            pictures.push(live.render(16, 16).unwrap());
        }
        assert_eq!(made(), first, "a function was replaced");
        let machine = runtime.describe();
        for pair in pictures.windows(2) {
            assert!(difference(&pair[0], &pair[1]) > 1e-2, "a replaced function shows on {machine}");
        }
        for ((name, gain), picture) in values.iter().zip(&pictures) {
            let folded = builder().set("lighting", *name).unwrap().set("gain", *gain).unwrap();
            let folded = folded.build().unwrap().render(16, 16).unwrap();
            assert!(difference(picture, &folded) < 1e-5, "`{name}` on {machine}");
        }
        if let (Some(made), Some(first)) = (made(), first) {
            assert!(made > first, "the counter sees the pipelines of the folded programs");
        }
    }
}

#[test]
fn only_live_slots_compile_their_candidates_in() {
    let program = compile(Source::new("slots", PROGRAM)).unwrap();
    let code = |set: &str, live: &[&str]| {
        let options = compile::Options {
            set: vec![("lighting".into(), set.into())],
            live: live.iter().map(ToString::to_string).collect(),
            ..Default::default()
        };
        compile::compile(program.checked(), &options).unwrap().back.wgsl.text
    };
    let marks = ["0.203125", "0.40625", "0.8125"];
    let found = |text: &str| marks.map(|mark| text.contains(mark));
    assert_eq!(found(&code("flat", &[])), [true, false, false]);
    assert_eq!(found(&code("by_slope", &[])), [false, false, true]);
    assert_eq!(found(&code("flat", &["lighting"])), [true, true, true]);
}

#[test]
fn what_does_not_fit_is_refused() {
    let program = compile(Source::new("slots", PROGRAM)).unwrap();
    let runtime = Runtime::on(Machine::Cpu, Config::default());
    let mut picture = runtime.scene(&program).live("lighting").build().unwrap();
    let refused = |result: Result<(), Error>| result.unwrap_err().to_string();
    assert!(refused(picture.set("gain", 2.0)).contains("`gain` was fixed"));
    assert!(refused(picture.set("ligthing", Function("flat"))).contains("no parameter `ligthing`"));
    let names = refused(picture.set("lighting", "|h| vec3(1.0)"));
    assert!(names.contains("by_height") && names.contains("by_slope") && names.contains("flat"), "{names}");
    assert!(matches!(picture.set("lighting", Function("pixel")), Err(Error::Program(_))));
    assert!(matches!(picture.set("lighting", Function("nothing")), Err(Error::Program(_))));
    picture.set("lighting", Function("by_slope")).unwrap();
}
