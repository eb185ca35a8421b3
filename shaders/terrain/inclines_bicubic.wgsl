// Bounds of the bicubic surface's slopes over a box within a cell: by x, then by y, metres a metre. They are those of the patch's
// Bezier points. Over a wider box, and beside a void, they are those that the field's relief allows.
const TERRAIN_SIXTH: f32 = 0.16666667;
// A slope is a sum of the steps between neighbours, whose weights below 0 add up to at most 7/16.
const TERRAIN_STEEPEST: f32 = 1.875;

// Bezier points between the second and the third of four samples, less that before: to the one by a third, by two thirds, by all.
struct TerrainSteps {
    first: vec4<f32>,
    second: vec4<f32>,
    third: vec4<f32>,
}

fn terrain_steps(a: vec4<f32>, b: vec4<f32>, c: vec4<f32>, d: vec4<f32>) -> TerrainSteps {
    let first = (c - a) * TERRAIN_SIXTH;
    let third = (d - b) * TERRAIN_SIXTH;
    return TerrainSteps(first, (c - b) - (first + third), third);
}

fn terrain_least(a: vec4<f32>, b: vec4<f32>, c: vec4<f32>, d: vec4<f32>) -> f32 {
    let least = min(min(a, b), min(c, d));
    return min(min(least.x, least.y), min(least.z, least.w));
}

// Of steps along an axis, in four samples across it: all along the cell are those of the Bezier points across.
fn terrain_hull(steps: TerrainSteps) -> vec2<f32> {
    let columns = transpose(mat4x4<f32>(steps.first, steps.second, steps.third, steps.second));
    let across = terrain_steps(columns[0], columns[1], columns[2], columns[3]);
    let a = columns[1];
    let b = a + across.first;
    let c = b + across.second;
    let d = columns[2];
    return vec2<f32>(terrain_least(a, b, c, d), -terrain_least(-a, -b, -c, -d));
}

fn inclines_bicubic(x0: f32, y0: f32, x1: f32, y1: f32) -> vec4<f32> {
    let last = terrain_scene.size - vec2<u32>(2u);
    let cells = vec2<f32>(terrain_scene.size - vec2<u32>(1u));
    let inverse = terrain_scene.inverse_spacing;
    let low = clamp(vec2<f32>(x0, y0) * inverse, vec2<f32>(0.0), cells);
    let high = clamp(vec2<f32>(x1, y1) * inverse, vec2<f32>(0.0), cells);
    let cell = min(vec2<u32>(0.5 * (low + high)), last);
    let corner = vec2<f32>(cell);
    let scale = terrain_scene.z_scale * inverse;
    // A rounding beyond the cell slopes are the same: they do not jump.
    let beside = 2e-6 * cells;
    let wide = any(low < corner - beside) || any(high > corner + (vec2<f32>(1.0) + beside));
    let samples = terrain_around_kept(cell.x, cell.y);
    if wide || samples.base == TERRAIN_VOID {
        let most = TERRAIN_STEEPEST * (terrain_scene.raw_relief.y - terrain_scene.raw_relief.x) * scale;
        return vec4<f32>(-most.x, most.x, -most.y, most.y);
    }
    let columns = transpose(mat4x4<f32>(samples.a, samples.b, samples.c, samples.d));
    let by_x = 3.0 * terrain_hull(terrain_steps(columns[0], columns[1], columns[2], columns[3]));
    let by_y = 3.0 * terrain_hull(terrain_steps(samples.a, samples.b, samples.c, samples.d));
    let relief = -terrain_least(-samples.a, -samples.b, -samples.c, -samples.d)
        - terrain_least(samples.a, samples.b, samples.c, samples.d);
    let rounded = 1e-6 * relief;
    // Beyond the rim surfaces are flat.
    let size = cells * terrain_scene.spacing;
    let outside = (vec2<f32>(x0, y0) < vec2<f32>(0.0)) | (vec2<f32>(x1, y1) > size);
    let least = vec2<f32>(by_x.x, by_y.x) - vec2<f32>(rounded);
    let most = vec2<f32>(by_x.y, by_y.y) + vec2<f32>(rounded);
    let lower = select(least, min(least, vec2<f32>(0.0)), outside) * scale;
    let upper = select(most, max(most, vec2<f32>(0.0)), outside) * scale;
    return vec4<f32>(lower.x, upper.x, lower.y, upper.y);
}
