// Baseline of `ghyll bench overhead`: the picture of fused.ghyll by a hand-written kernel with the same arithmetic. Terrain
// functions come from shaders/terrain. One invocation a pixel, a workgroup an 8 x 8 tile: the fastest of the forms tried
// (docs/performance.md).

@group(0) @binding(0) var<storage, read_write> picture: array<vec4<f32>>;
@group(0) @binding(1) var<uniform> frame: vec4<u32>;

const FAR: f32 = 1e9;

fn lerp(a: vec3<f32>, b: vec3<f32>, t: f32) -> vec3<f32> {
    return a * (1.0 - t) + b * t;
}

fn ground(z: f32) -> vec3<f32> {
    let low = relief();
    let x = min(max((z - low.x) / (low.y - low.x), 0.0), 1.0);
    return lerp(vec3<f32>(0.45, 0.6, 0.35), vec3<f32>(0.95, 0.95, 0.95), x);
}

fn air(dz: f32) -> vec3<f32> {
    return lerp(vec3<f32>(0.8, 0.87, 0.93), vec3<f32>(0.24, 0.46, 0.76), min(max(dz, 0.0), 1.0));
}

fn lambert(at: vec3<f32>, normal: vec3<f32>, spacing: f32) -> f32 {
    let sun = sun_dir();
    let cosine = normal.x * sun.x + normal.y * sun.y + normal.z * sun.z;
    if cosine <= 0.0 {
        return 0.0;
    }
    let size = abs(at.x) + abs(at.y) + abs(at.z);
    let gap = 4e-7 * size + 1e-5 * spacing;
    let o = at + gap * normal;
    if occluded_bilinear(o.x, o.y, o.z, sun.x, sun.y, sun.z, 0.0, FAR) {
        return 0.0;
    }
    return min(cosine, 1.0);
}

fn color(x: f32, y: f32) -> vec3<f32> {
    let ray = camera(x, y);
    let found = trace_bilinear(ray.r0, ray.r1, ray.r2, ray.r3, ray.r4, ray.r5, ray.r6, ray.r7);
    if !found.r0 {
        return air(ray.r5);
    }
    let t = found.r1;
    let p = vec3<f32>(ray.r0, ray.r1, ray.r2) + t * vec3<f32>(ray.r3, ray.r4, ray.r5);
    let z = bilinear(p.x, p.y);
    let step = texel();
    let spacing = step.x + step.y;
    let at = vec3<f32>(p.x, p.y, select(p.z, z, abs(p.z - z) < 0.02 * spacing));
    let rim = extent();
    let g = gradient_bilinear(min(max(p.x, 0.0), rim.x), min(max(p.y, 0.0), rim.y));
    let up = vec3<f32>(-g.x, -g.y, 1.0);
    let normal = up / sqrt(up.x * up.x + up.y * up.y + up.z * up.z);
    return ground(at.z) * (0.25 + 0.75 * lambert(at, normal, spacing));
}

@compute @workgroup_size(8, 8)
fn kernel(@builtin(global_invocation_id) pixel: vec3<u32>) {
    if pixel.x >= frame.x || pixel.y >= frame.y {
        return;
    }
    picture[pixel.y * frame.x + pixel.x] = vec4<f32>(color(f32(pixel.x) + 0.5, f32(pixel.y) + 0.5), 1.0);
}
