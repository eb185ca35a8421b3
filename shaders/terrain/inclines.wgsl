// Least and greatest slope between neighbouring samples of the cells that a box touches: by x, then by y, metres a metre.
// More than 4 x 4 cells are bounded by the field's relief; beside a void by that of the cells, as surfaces repeat samples there.
fn terrain_relief(relief: vec2<f32>, sample: f32) -> vec2<f32> {
    let taken = vec2<f32>(min(relief.x, sample), max(relief.y, sample));
    return select(taken, relief, sample == TERRAIN_VOID);
}

fn inclines(x0: f32, y0: f32, x1: f32, y1: f32) -> vec4<f32> {
    let box = terrain_box(x0, y0, x1, y1);
    let scale = terrain_scene.z_scale * terrain_scene.inverse_spacing;
    let cells = box.high - box.low;
    if max(cells.x, cells.y) > 3u {
        let most = (terrain_scene.raw_relief.y - terrain_scene.raw_relief.x) * scale;
        return vec4<f32>(-most.x, most.x, -most.y, most.y);
    }
    let row = terrain_scene.size.x;
    var least = vec2<f32>(3.4e38);
    var most = vec2<f32>(-3.4e38);
    var missing = false;
    var relief = vec2<f32>(3.4e38, -3.4e38);
    for (var j = box.low.y; j <= box.high.y; j++) {
        let south = j * row;
        let north = south + row;
        var here = terrain_sample(south + box.low.x);
        var above = terrain_sample(north + box.low.x);
        missing |= here == TERRAIN_VOID || above == TERRAIN_VOID;
        relief = terrain_relief(terrain_relief(relief, here), above);
        least.y = min(least.y, above - here);
        most.y = max(most.y, above - here);
        for (var i = box.low.x; i <= box.high.x; i++) {
            let next = terrain_sample(south + i + 1u);
            let next_above = terrain_sample(north + i + 1u);
            missing |= next == TERRAIN_VOID || next_above == TERRAIN_VOID;
            relief = terrain_relief(terrain_relief(relief, next), next_above);
            least = min(least, vec2<f32>(min(next - here, next_above - above), next_above - next));
            most = max(most, vec2<f32>(max(next - here, next_above - above), next_above - next));
            here = next;
            above = next_above;
        }
    }
    if missing {
        let most = max(relief.y - relief.x, 0.0) * scale;
        return vec4<f32>(-most.x, most.x, -most.y, most.y);
    }
    // Beyond the rim surfaces are flat.
    let size = vec2<f32>(terrain_scene.size - vec2<u32>(1u)) * terrain_scene.spacing;
    let outside = (vec2<f32>(x0, y0) < vec2<f32>(0.0)) | (vec2<f32>(x1, y1) > size);
    let low = select(least, min(least, vec2<f32>(0.0)), outside) * scale;
    let high = select(most, max(most, vec2<f32>(0.0)), outside) * scale;
    return vec4<f32>(low.x, high.x, low.y, high.y);
}
