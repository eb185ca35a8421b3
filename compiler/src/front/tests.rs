use super::*;

fn accepts(text: &str) -> Checked {
    front(Source::new("test.ghyll", text))
        .unwrap_or_else(|r| panic!("{text}\n{}", crate::report::render(&r, false)))
}

#[test]
fn tastes() {
    let fib = accepts(
        "fn fib(n: i32) -> i32 = if n < 2 { n } else { fib(n - 1) + fib(n - 2) };\nfn main(n: i32) -> i32 = fib(n);",
    );
    assert!(fib.module.function("fib").is_some());
    accepts(
        "use terrain; use shade;
        param detail: bool = false;
        param lighting: fn(Hit) -> vec3 = baked;
        fn rough(p: vec2) -> f32 = bilinear(p) + 4.0 * fbm(p / 60.0, 5);
        @task fn basic(ray: Ray) -> Option<Hit> = cast(bilinear, ray);
        @task fn detailed(ray: Ray) -> Option<Hit> = cast(rough, ray);
        @bake fn openness(p: vec2) -> f32 = ambient(bilinear, p, 64);
        fn baked(h: Hit) -> vec3 = hypsometric(h.at.z) * (0.2 + 0.8 * openness(h.at.xy));
        fn sunlit(h: Hit) -> vec3 = hypsometric(h.at.z) * lambert(bilinear, h);
        fn pixel(p: vec2) -> vec3 {
            let ray = camera(p);
            match if detail { detailed(ray) } else { basic(ray) } {
                Some(h) => lighting(h),
                None => sky(ray.dir),
            }
        }",
    );
}
