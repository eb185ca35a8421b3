// Baseline of `ghyll bench overhead`: the picture of fused.ghyll by a hand-written kernel with the same arithmetic. Terrain
// functions come from shaders/terrain. Workgroups draw 8 x 8 tiles from a counter, an invocation is one row of a tile: the
// fastest of the forms tried (docs/performance.md).

@group(0) @binding(0) var<storage, read_write> picture: array<vec4<f32>>;
@group(0) @binding(1) var<storage, read_write> next_tile: atomic<u32>;
@group(0) @binding(2) var<uniform> frame: vec4<u32>;

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
    let g = gradient_bilinear(p.x, p.y);
    let up = vec3<f32>(-g.x, -g.y, 1.0);
    let normal = up / sqrt(up.x * up.x + up.y * up.y + up.z * up.z);
    return ground(at.z) * (0.25 + 0.75 * lambert(at, normal, spacing));
}

@compute @workgroup_size(8)
fn kernel(@builtin(local_invocation_index) lane: u32) {
    let columns = (frame.x + 7u) / 8u;
    let rows = (frame.y + 7u) / 8u;
    loop {
        // A lane's own 8 pixels: column `lane` of the next tile.
        let tile = workgroup_tile(lane);
        if tile >= columns * rows {
            break;
        }
        let x = (tile % columns) * 8u + lane;
        for (var row = 0u; row < 8u; row++) {
            let y = (tile / columns) * 8u + row;
            if x < frame.x && y < frame.y {
                picture[y * frame.x + x] = vec4<f32>(color(f32(x) + 0.5, f32(y) + 0.5), 1.0);
            }
        }
    }
}

var<workgroup> drawn: u32;

fn workgroup_tile(lane: u32) -> u32 {
    if lane == 0u {
        drawn = atomicAdd(&next_tile, 1u);
    }
    return workgroupUniformLoad(&drawn);
}
