// Least and greatest slope between neighbouring samples of the cells that a box touches: by x, then by y, metres a metre.
// More than 2 x 2 cells are bounded by the field's relief. A void is a cliff without end.
fn inclines(x0: f32, y0: f32, x1: f32, y1: f32) -> vec4<f32> {
    let box = terrain_box(x0, y0, x1, y1);
    let scale = terrain_scene.z_scale * terrain_scene.inverse_spacing;
    if box.level > 0u {
        let most = (terrain_scene.raw_relief.y - terrain_scene.raw_relief.x) * scale;
        return vec4<f32>(-most.x, most.x, -most.y, most.y);
    }
    let row = terrain_scene.size.x;
    let i = vec3<u32>(box.low.x, box.low.x + 1u, box.high.x + 1u);
    let j = vec3<u32>(box.low.y, box.low.y + 1u, box.high.y + 1u) * row;
    let south = vec3<f32>(terrain_sample(j.x + i.x), terrain_sample(j.x + i.y), terrain_sample(j.x + i.z));
    let middle = vec3<f32>(terrain_sample(j.y + i.x), terrain_sample(j.y + i.y), terrain_sample(j.y + i.z));
    let north = vec3<f32>(terrain_sample(j.z + i.x), terrain_sample(j.z + i.y), terrain_sample(j.z + i.z));
    let lowest = min(min(south, middle), north);
    if min(min(lowest.x, lowest.y), lowest.z) == TERRAIN_VOID {
        return vec4<f32>(-1e12, 1e12, -1e12, 1e12);
    }
    // The second step; where there is but one, that again.
    let last_x = vec3<f32>(south.z, middle.z, north.z)
        - select(vec3<f32>(south.y, middle.y, north.y), vec3<f32>(south.x, middle.x, north.x), box.low.x == box.high.x);
    let first_x = vec3<f32>(south.y, middle.y, north.y) - vec3<f32>(south.x, middle.x, north.x);
    let first_y = middle - south;
    let last_y = north - select(middle, south, box.low.y == box.high.y);
    let least = vec2<f32>(terrain_least(min(first_x, last_x)), terrain_least(min(first_y, last_y)));
    let most = -vec2<f32>(terrain_least(-max(first_x, last_x)), terrain_least(-max(first_y, last_y)));
    // Beyond the rim surfaces are flat.
    let size = vec2<f32>(terrain_scene.size - vec2<u32>(1u)) * terrain_scene.spacing;
    let outside = (vec2<f32>(x0, y0) < vec2<f32>(0.0)) | (vec2<f32>(x1, y1) > size);
    let low = select(least, min(least, vec2<f32>(0.0)), outside) * scale;
    let high = select(most, max(most, vec2<f32>(0.0)), outside) * scale;
    return vec4<f32>(low.x, high.x, low.y, high.y);
}

fn terrain_least(v: vec3<f32>) -> f32 {
    return min(min(v.x, v.y), v.z);
}
