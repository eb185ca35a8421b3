//! The interface for Rust programs, where the command line does not reach: changes between pictures.

use ghyll_compiler::source::Source;
use ghyll_runtime::api::{Error, Options, Program, Runtime, compile};
use ghyll_runtime::gpu::Gpu;
use ghyll_runtime::machine::Wanted;
use ghyll_runtime::terrain::{Raster, Sun, Terrain, View};

fn program(text: &str) -> Program {
    compile(Source::new("test", text)).unwrap_or_else(|e| panic!("{e}"))
}

fn runtimes() -> Vec<Runtime> {
    let mut wanted = vec![Wanted::Cpu];
    if !Gpu::list().is_empty() {
        wanted.push(Wanted::Gpu);
    }
    let open = |on| Runtime::new(Options { on, ..Options::default() }).unwrap();
    wanted.into_iter().map(open).collect()
}

fn flat() -> Terrain {
    Terrain::from_heights(3, 2, [10.0, 10.0], vec![0.0; 6]).unwrap()
}

#[test]
fn a_bake_follows_what_it_depends_on() {
    let text = "
        use terrain;
        param k: f32 = 1.0;
        @bake fn square(p: vec2) -> f32 = k * p.x * p.x;
        @bake fn over(p: vec2) -> f32 = square(p) + 1.0;
        @bake fn lit(p: vec2) -> f32 = sun_dir().z;
        fn pixel(p: vec2) -> vec2 = vec2(over(vec2(5.0, 0.0)), lit(p));
    ";
    let program = program(text);
    for runtime in runtimes() {
        let builder = runtime.scene(&program).terrain(flat()).live("k");
        let mut picture = builder.sun(Sun { azimuth: 0.0, elevation: 90.0 }).build().unwrap();
        let mut first = |change: Option<f32>| {
            if let Some(k) = change {
                picture.set("k", k).unwrap();
            }
            picture.render(2, 2).unwrap().pixel(0, 0).to_vec()
        };
        assert_eq!(first(None), [51.0, 1.0]);
        assert_eq!(first(Some(3.0)), [151.0, 1.0], "on {}", runtime.describe());
        picture.look(View::topdown(), Sun { azimuth: 0.0, elevation: 0.0 }).unwrap();
        let after = picture.render(2, 2).unwrap().pixel(0, 0).to_vec();
        assert!(after[0] == 151.0 && after[1].abs() < 1e-6, "{after:?} on {}", runtime.describe());
    }
}

#[test]
fn what_is_not_live_is_fixed() {
    let program = program("param k: f32 = 1.0; fn pixel(p: vec2) -> f32 = k;");
    let runtime = Runtime::new(Options { on: Wanted::Cpu, ..Options::default() }).unwrap();
    let mut picture = runtime.scene(&program).terrain(flat()).build().unwrap();
    assert!(matches!(picture.set("k", 2.0f32), Err(Error::Request(text)) if text.contains("live")));
    assert!(matches!(picture.set("q", 2.0f32), Err(Error::Request(_))));
}

#[test]
fn rasters_are_bound_by_name() {
    let program = program("raster layer: vec2; fn pixel(p: vec2) -> vec2 = layer(vec2(10.0, 5.0));");
    let raster = |components| Raster::from_floats(2, 1, components, vec![1.0; 2 * components as usize]);
    for runtime in runtimes() {
        let build = |name: &str, components| {
            runtime.scene(&program).terrain(flat()).raster(name, raster(components).unwrap()).build()
        };
        assert_eq!(build("layer", 2).unwrap().render(1, 1).unwrap().pixel(0, 0), [1.0, 1.0]);
        for (name, components, part) in [("layer", 3, "vec3"), ("leyer", 2, "did you mean")] {
            let error = build(name, components).err().expect("cannot be bound").to_string();
            assert!(error.contains(part), "{error}");
        }
        let unbound = runtime.scene(&program).terrain(flat()).build().err().expect("unbound").to_string();
        assert!(unbound.contains("`layer`"), "{unbound}");
    }
}
